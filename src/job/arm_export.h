#ifndef ALIDADE_SRC_JOB_ARM_EXPORT_H_
#define ALIDADE_SRC_JOB_ARM_EXPORT_H_

#include <string>
#include <vector>

#include "alidade/accuracy.h"
#include "alidade/arm.h"

namespace alidade::internal {

/// What an arm is written as, and how.
struct ExportRequest {
  std::string format;  ///< "dh", "mdh", "offsets", "ur", "urdf", "json"
  std::string table;   ///< of the first three: "csv", "yaml" or "latex"
  /// The file of the nominal arm: of "urdf", the arm file that names the URDF.
  std::string nominal_path;
};

/// The text, and what it is not able to say.
struct ArmExport {
  std::string text;
  std::vector<std::string> lost;  ///< a sentence each
  Accuracy cost;                  ///< distance of the targets (m)
};

/// `real` in another format, in base and tool of `nominal`; where the format
/// lacks something, the numbers that it has are fitted to the whole arm over
/// its workspace. @throws InputError.
ArmExport ExportArm(const ExportRequest& request, const Arm& nominal,
                    const Arm& real);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_ARM_EXPORT_H_
