#ifndef ALIDADE_SRC_CALIBRATION_LABEL_BYTES_H_
#define ALIDADE_SRC_CALIBRATION_LABEL_BYTES_H_

#include "alidade/calibration_result.h"
#include "src/common/bytes.h"

namespace alidade::internal {

/// Labels as ranks send them to each other.
void PutLabel(const ObservationLabel& label, ByteWriter* writer);
ObservationLabel GetLabel(ByteReader* reader);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_LABEL_BYTES_H_
