#ifndef ALIDADE_RESULT_FILES_H_
#define ALIDADE_RESULT_FILES_H_

#include <string>
#include <vector>

#include "alidade/calibration_result.h"

namespace alidade {

/// Writes a result directory (docs/files.md): arm.yaml, which is loadable
/// wherever an arm is, result.json, report.txt, tables and figures. It is
/// created; files of an earlier result there are replaced, others stay. Returns
/// the paths. @pre the result is usable. @throws InputError where the directory
/// cannot be written, or a file that is not Alidade's is in the way.
std::vector<std::string> Save(const CalibrationResult& result,
                              const std::string& directory);

}  // namespace alidade

#endif  // ALIDADE_RESULT_FILES_H_
