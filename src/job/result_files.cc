#include "alidade/result_files.h"

#include "src/job/result_directory.h"

namespace alidade {

std::vector<std::string> Save(const CalibrationResult& result,
                              const std::string& directory) {
  return internal::WriteResultDirectory(directory,
                                        internal::RenderResult(result));
}

}  // namespace alidade
