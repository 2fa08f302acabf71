#ifndef ALIDADE_SRC_COMMON_ACCURACY_FIELDS_H_
#define ALIDADE_SRC_COMMON_ACCURACY_FIELDS_H_

#include "alidade/accuracy.h"
#include "src/common/fields.h"

namespace alidade::internal {

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, Accuracy>& accuracy) {
  v.Field("mean", accuracy.mean);
  v.Field("rms", accuracy.rms);
  v.Field("stddev", accuracy.stddev);
  v.Field("median", accuracy.median);
  v.Field("p95", accuracy.p95);
  v.Field("min", accuracy.min);
  v.Field("max", accuracy.max);
  v.Field("n", accuracy.n);
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMMON_ACCURACY_FIELDS_H_
