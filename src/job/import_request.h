#ifndef ALIDADE_SRC_JOB_IMPORT_REQUEST_H_
#define ALIDADE_SRC_JOB_IMPORT_REQUEST_H_

#include <optional>
#include <string>
#include <vector>

#include "alidade/arm.h"
#include "src/common/numbers.h"
#include "src/dataio/csv_dialect.h"
#include "src/dataio/rotation_convention.h"
#include "src/dataio/row_condition.h"

namespace alidade::internal {

/// What is known of a file of measurements that another program wrote.
struct ImportRequest {
  std::string path;
  const Arm& arm;
  /// Of columns whose names state none: "mm", "deg"; empty: found.
  const Unit* length_unit = nullptr;
  const Unit* angle_unit = nullptr;
  /// Of three angles of an orientation; null: `angle_unit`, or found.
  const Unit* rotation_unit = nullptr;
  std::optional<RotationConvention> rotation = {};  ///< of three angles
  std::string rotation_name = {};                   ///< of that, as stated
  /// How it is written, as far as that is known, and lines that are left out.
  StatedDialect dialect = {};
  /// Rows that are left out by what is in them.
  std::vector<RowCondition> exclude = {};
  /// Where the job will be, from which paths are seen; empty: as they are.
  std::string directory = {};
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_IMPORT_REQUEST_H_
