#ifndef ALIDADE_SRC_SERIALIZATION_JOB_FILE_H_
#define ALIDADE_SRC_SERIALIZATION_JOB_FILE_H_

#include <string>

#include "alidade/communicator.h"
#include "alidade/dataset.h"
#include "src/serialization/field_records.h"
#include "src/serialization/job_config.h"
#include "src/serialization/yaml_tree.h"
#include "src/simulation/simulation.h"

namespace alidade::internal {

/// The keys of one job.
const std::vector<std::string>& JobKeys();

/// What a job file may hold.
std::vector<FieldRecord> JobFields();

/// Reads a job, those that it extends, and every file they name; paths are
/// relative to the file that states them. `execution` is the job's as well;
/// the threads make no difference to what is read.
///
/// Ranks read the same job and consecutive files of its data each: what they
/// get is a part of the data (partition.h). Collective. What needs all data in
/// one place is then refused: other solvers than Ceres, folds.
/// @throws InputError with file, line, column and key; also where the file has
/// a `matrix`, which is many jobs (job_matrix.h).
JobConfig LoadJob(const std::string& path, const Execution& execution = {});

/// The job that a tree describes, its files loaded. @pre no `matrix` in it.
/// @throws InputError.
JobConfig LoadJobTree(YamlDocument tree, const Execution& execution);

/// The same without `validation`, and without limits of validation poses in
/// `acceptance`: no pose is left out of `data`. For plans, and for studies that
/// hold out their own.
JobConfig LoadWholeJob(const std::string& path);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_JOB_FILE_H_
