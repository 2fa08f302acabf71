#ifndef ALIDADE_SRC_SERIALIZATION_JOB_FILE_H_
#define ALIDADE_SRC_SERIALIZATION_JOB_FILE_H_

#include <string>

#include "alidade/dataset.h"
#include "alidade/team.h"
#include "src/serialization/job_config.h"
#include "src/serialization/yaml_tree.h"
#include "src/simulation/simulation.h"

namespace alidade::internal {

/// How a job is read. What comes out does not depend on the threads.
struct JobReading {
  int num_threads = 1;  ///< for large data sets
  /// Members of a team read the same job and consecutive files of its data
  /// each: what they get is a share of the data (measurement/share.h).
  /// Collective (base/team.h); a team of one, or null, reads all. What needs
  /// all data in one place is refused: other solvers than Ceres, a published
  /// study, folds.
  Team* team = nullptr;
};

/// Reads a job, those that it extends, and every file they name; paths are
/// relative to the file that states them.
/// @throws InputError with file, line, column and key; also where the file has
/// a `matrix`, which is many jobs (job_matrix.h).
JobConfig LoadJob(const std::string& path, const JobReading& reading);
JobConfig LoadJob(const std::string& path, int num_threads = 1,
                  Team* team = nullptr);

/// The job that a tree describes, its files loaded. @pre no `matrix` in it.
/// @throws InputError.
JobConfig LoadJobTree(YamlDocument tree, const JobReading& reading);

/// The same without `validation`, and without limits of held-out poses in
/// `acceptance`: no pose is held out of `data`. For plans, and for studies that
/// hold out their own.
JobConfig LoadWholeJob(const std::string& path);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_JOB_FILE_H_
