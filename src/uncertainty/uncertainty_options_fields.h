#ifndef ALIDADE_SRC_UNCERTAINTY_UNCERTAINTY_OPTIONS_FIELDS_H_
#define ALIDADE_SRC_UNCERTAINTY_UNCERTAINTY_OPTIONS_FIELDS_H_

#include "alidade/uncertainty_options.h"
#include "src/common/option_fields.h"

namespace alidade::internal {

template <>
inline constexpr std::array kWords<IntervalMethod> = {
    std::pair{IntervalMethod::kAutomatic, "auto"},
    std::pair{IntervalMethod::kLinear, "linear"},
    std::pair{IntervalMethod::kProfile, "profile"},
};

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, UncertaintyOptions>& options) {
  v.Field(Key("confidence").Above(0).Below(1), options.confidence,
          "of intervals and ellipsoids");
  v.Field(Key("intervals"), options.intervals,
          "`linear`: estimate +- quantile * standard deviation; `profile`: of "
          "the profile likelihood, for every parameter; `auto`: for those "
          "whose nonlinearity is above the limit. Profiles need the solver "
          "`ceres` and 100 000 observations at most");
  v.Field(Key("nonlinearity_limit").Above(0), options.nonlinearity_limit,
          "second-order part of an estimate, in standard deviations");
  v.Field(Key("map").AtLeast(0).AtMost(1000000), options.map_configurations,
          "configurations, drawn within the joint limits, that the accuracy is "
          "predicted at; 0 = none");
  v.Field(Key("seed"), options.seed, "of these");
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_UNCERTAINTY_UNCERTAINTY_OPTIONS_FIELDS_H_
