#ifndef ALIDADE_SRC_JOB_IMPORT_FILES_H_
#define ALIDADE_SRC_JOB_IMPORT_FILES_H_

#include <string>

#include "alidade/arm.h"
#include "src/job/import_data.h"

namespace alidade::internal {

/// The data set as a file, with the places as a column `note`. `title`: a
/// comment on top.
std::string DataText(const ImportedData& imported, const Arm& arm,
                     const std::string& title);

/// A job that calibrates with the data set, ready to run; paths are as seen
/// from the job's folder.
std::string JobText(const std::string& title, const std::string& arm,
                    const std::string& data, Eigen::Index num_poses);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_IMPORT_FILES_H_
