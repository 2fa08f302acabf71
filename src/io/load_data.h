#ifndef ALIDADE_SRC_IO_LOAD_DATA_H_
#define ALIDADE_SRC_IO_LOAD_DATA_H_

#include <string>

#include "alidade/io/dataset_csv.h"
#include "alidade/measurement/references.h"
#include "alidade/model/arm.h"
#include "src/io/read_options.h"

namespace alidade {

/// A data set's file and what is to be known to read it. Must not outlive them.
struct DataFile {
  const std::string& path;
  const Arm& arm;
  const DataFormat& format;
};

/// LoadData with all its options. @throws InputError.
LoadedData LoadDataWith(const DataFile& file, References* references,
                        const ReadOptions& options);

}  // namespace alidade

#endif  // ALIDADE_SRC_IO_LOAD_DATA_H_
