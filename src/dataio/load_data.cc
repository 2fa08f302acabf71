#include "src/dataio/load_data.h"

#include "src/dataio/dataset_npy.h"
#include "src/dataio/dataset_reader.h"
#include "src/dataio/npy_data.h"

namespace alidade::internal {

LoadedData LoadDataWith(const DataFile& file, References* references,
                        const ReadOptions& options) {
  if (IsNpy(file.path)) return LoadNpy(file, references, options);
  DatasetReader reader(MappedFile(file.path), file.arm, file.format,
                       references);
  return reader.Read(options);
}

}  // namespace alidade::internal
