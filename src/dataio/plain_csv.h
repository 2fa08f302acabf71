#ifndef ALIDADE_SRC_DATAIO_PLAIN_CSV_H_
#define ALIDADE_SRC_DATAIO_PLAIN_CSV_H_

#include <optional>

#include "alidade/arm.h"
#include "src/dataio/data_format.h"
#include "src/dataio/plain_layout.h"
#include "src/dataio/read_options.h"
#include "src/dataio/row_reader.h"

namespace alidade::internal {

/// The fast path of DatasetReader: reads the rows after the header of a plain
/// data set, in pieces cut at line ends, straight into its matrices. What comes
/// out has the bits that DatasetReader's own rows have. Nothing comes out where
/// any cell is not one plain number (a text in its column, without quotes), or
/// anything else is not as it should be: DatasetReader then reads the rows one
/// by one, and says what is wrong with them.
///
/// @pre `rows` stands at the header that `layout` was made of. Cost: some 10 ns
/// a number and thread.
std::optional<LoadedData> ReadPlainCsv(const RowReader& rows,
                                       const PlainLayout& layout,
                                       const Arm& arm,
                                       const ReadOptions& options);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_PLAIN_CSV_H_
