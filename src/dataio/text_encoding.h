#ifndef ALIDADE_SRC_DATAIO_TEXT_ENCODING_H_
#define ALIDADE_SRC_DATAIO_TEXT_ENCODING_H_

#include <string>

#include "src/common/mapped_file.h"

namespace alidade::internal {

/// A text file as UTF-8 without a byte-order mark and with '\n' at the ends of
/// lines.
struct TextFile {
  MappedFile file;
  std::size_t begin = 0;  ///< of the text: after a byte-order mark
  std::string encoding;   ///< what it was converted from; empty: nothing was
};

/// The text of a file. It stays mapped as it is where it is UTF-8 already;
/// UTF-16 (by its mark, or by its zeros), Windows-1252 (where its first lines
/// are no UTF-8) and carriage returns without line feeds are converted.
/// @throws InputError where it is no text.
TextFile OpenText(MappedFile file);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_TEXT_ENCODING_H_
