#ifndef ALIDADE_SRC_DATAIO_READ_OPTIONS_H_
#define ALIDADE_SRC_DATAIO_READ_OPTIONS_H_

#include <cstdint>
#include <limits>
#include <string>

#include "alidade/error.h"

namespace alidade::internal {

/// Poses that a data set may have: they are numbered by int.
inline constexpr std::int64_t kMostRows = std::numeric_limits<int>::max() - 1;

/// Refuses more. @throws InputError naming `path`.
inline void RequireFewRows(const std::string& path, std::int64_t rows) {
  if (rows <= kMostRows) return;
  throw InputError({path, 0, 0, ""},
                   std::to_string(rows) + " poses, expected at most " +
                       std::to_string(kMostRows) +
                       ": make it several jobs, or leave poses out");
}

/// How a data set is read. No option changes what comes out.
struct ReadOptions {
  int num_threads = 1;
  /// Threads take pieces of about so many bytes: large enough that starting
  /// one costs nothing beside reading it, small enough for its text and its
  /// numbers to stay in a core's cache between the passes.
  std::int64_t chunk_bytes = 1 << 18;
  /// Arrays of so many bytes stay in their file where they can be used as they
  /// are: it must not change then as long as the data are in use. Smaller ones
  /// are copied.
  std::int64_t fewest_bytes_in_place = std::int64_t{1} << 26;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_READ_OPTIONS_H_
