#ifndef ALIDADE_IO_JOB_FILE_H_
#define ALIDADE_IO_JOB_FILE_H_

#include <string>

#include "alidade/base/team.h"
#include "alidade/io/job_config.h"

namespace alidade {

/// What a YAML file says it is in its `format` key.
enum class FileFormat { kArm, kDeviations, kJob, kSimulation, kPlan };

/// @throws InputError where the file is no YAML map or its format is unknown.
FileFormat DetectFormat(const std::string& path);

/// Reads a job and every file it names; paths are relative to the job file.
/// Large data sets are read by `num_threads`; the result does not depend on it.
///
/// Members of a team read the same job and consecutive files of its data each:
/// what they get is a share of the data (measurement/share.h). Collective
/// (base/team.h); a team of one, or null, reads all. What needs all data in one
/// place is refused: other solvers than Ceres, a published study, folds.
/// @throws InputError with file, line, column and key.
JobConfig LoadJob(const std::string& path, int num_threads = 1,
                  Team* team = nullptr);

/// The same without `validation`: no pose is held out of `data`. For studies
/// that hold out their own.
JobConfig LoadWholeJob(const std::string& path);

/// Reads a simulation and every file it names.
/// @throws InputError with file, line, column and key.
SimulationConfig LoadSimulation(const std::string& path);

}  // namespace alidade

#endif  // ALIDADE_IO_JOB_FILE_H_
