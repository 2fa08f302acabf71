#include "src/io/load_data.h"

#include "alidade/io/dataset_npy.h"
#include "src/io/dataset_reader.h"
#include "src/io/npy_data.h"

namespace alidade {

LoadedData LoadDataWith(const DataFile& file, References* references,
                        const ReadOptions& options) {
  if (IsNpy(file.path)) return LoadNpy(file, references, options);
  DatasetReader reader(MappedFile(file.path), file.arm, file.format,
                       references);
  return reader.Read(options);
}

}  // namespace alidade
