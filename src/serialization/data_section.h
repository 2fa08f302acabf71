#ifndef ALIDADE_SRC_SERIALIZATION_DATA_SECTION_H_
#define ALIDADE_SRC_SERIALIZATION_DATA_SECTION_H_

#include "src/dataio/dataset_csv.h"
#include "src/serialization/job_config.h"
#include "src/serialization/job_context.h"

namespace alidade::internal {

/// What `measurement` says of data that state no sigmas of their own.
struct MeasurementSigmas {
  double length = 0.0;    ///< (m)
  double rotation = 0.0;  ///< (rad); 0 = from that of lengths
};

/// The job's `measurement`. @throws InputError.
MeasurementSigmas ReadSigmas(const JobContext& context, JobConfig* job);

/// Reads data for the job's arm: a path, a map of a file and what it does not
/// say itself, or a list of both, merged. The job's references grow by what
/// the files name, its list of rejected rows by theirs. @throws InputError.
LoadedData ReadData(const YamlValue& value, const MeasurementSigmas& sigmas,
                    JobContext* context, JobConfig* job);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_DATA_SECTION_H_
