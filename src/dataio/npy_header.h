#ifndef ALIDADE_SRC_DATAIO_NPY_HEADER_H_
#define ALIDADE_SRC_DATAIO_NPY_HEADER_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace alidade::internal {

/// What NumPy's format 1.0, 2.0 or 3.0 says before the numbers (numpy.org,
/// "NEP 1, a simple file format for NumPy arrays"): a one-dimensional array of
/// records, each of one little-endian double for every name.
struct NpyHeader {
  std::vector<std::string> names;
  std::int64_t num_rows = 0;
  std::size_t data_offset = 0;  ///< of the first record (bytes)

  std::size_t record_bytes() const { return 8 * names.size(); }
};

/// Reads the header of a file whose bytes are `bytes` and checks that all of
/// its records are there. Any bytes at all may be given.
/// @throws InputError naming the file, the field, what was found and what to
/// do where it is any other array, or none.
NpyHeader ReadNpyHeader(const std::string& path, std::string_view bytes);

/// The bytes before the records. @pre names are printable, without quotes.
std::string FormatNpyHeader(const std::vector<std::string>& names,
                            std::int64_t num_rows);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_NPY_HEADER_H_
