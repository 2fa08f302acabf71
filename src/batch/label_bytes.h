#ifndef ALIDADE_SRC_BATCH_LABEL_BYTES_H_
#define ALIDADE_SRC_BATCH_LABEL_BYTES_H_

#include "alidade/base/bytes.h"
#include "alidade/results/job_result.h"

namespace alidade {

/// Labels as the members of a team send them to each other.
void PutLabel(const ObservationLabel& label, ByteWriter* writer);
ObservationLabel GetLabel(ByteReader* reader);

}  // namespace alidade

#endif  // ALIDADE_SRC_BATCH_LABEL_BYTES_H_
