#ifndef ALIDADE_SRC_DATAIO_LOAD_DATA_H_
#define ALIDADE_SRC_DATAIO_LOAD_DATA_H_

#include <string>

#include "alidade/arm.h"
#include "alidade/references.h"
#include "src/dataio/dataset_csv.h"
#include "src/dataio/read_options.h"

namespace alidade::internal {

/// A data set's file and what is to be known to read it. Must not outlive them.
struct DataFile {
  const std::string& path;
  const Arm& arm;
  const DataFormat& format;
};

/// LoadData with all its options. @throws InputError.
LoadedData LoadDataWith(const DataFile& file, References* references,
                        const ReadOptions& options);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_LOAD_DATA_H_
