#ifndef ALIDADE_SRC_DATAIO_NPY_DATA_H_
#define ALIDADE_SRC_DATAIO_NPY_DATA_H_

#include <string>

#include "alidade/error.h"
#include "alidade/references.h"
#include "src/dataio/data_format.h"
#include "src/dataio/read_options.h"

namespace alidade::internal {

/// Reads a data set from a NumPy array (docs/files.md, "Data set (NPY)"): what
/// comes out is what a CSV with the same header and the shortest digits of each
/// number gives, to the same bits. Plain data sets are read by one pass at
/// about the speed of memory; where anything is in doubt or wrong,
/// DatasetReader reads that CSV, made in memory. In sources and messages, lines
/// are rows from
/// 1. @throws InputError.
LoadedData LoadNpy(const DataFile& file, References* references,
                   const ReadOptions& options);

/// The array as the text of a CSV, for readers that go row by row.
/// @throws InputError.
std::string NpyAsCsv(const std::string& path);

/// An error in that text, placed by the array's rows instead of the text's
/// lines.
InputError InArray(const InputError& error);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_NPY_DATA_H_
