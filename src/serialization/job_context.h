#ifndef ALIDADE_SRC_SERIALIZATION_JOB_CONTEXT_H_
#define ALIDADE_SRC_SERIALIZATION_JOB_CONTEXT_H_

#include <map>
#include <string>

#include "src/serialization/config_file.h"
#include "src/serialization/yaml_reader.h"

namespace alidade::internal {

/// What every part of a job file needs to be read.
struct JobContext {
  Units units;
  NamedFiles files;
  int num_threads = 1;  ///< to read data sets with
  /// The rank that reads each data set's file.
  std::map<std::string, int> readers = {};
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_JOB_CONTEXT_H_
