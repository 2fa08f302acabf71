#ifndef ALIDADE_SRC_COMMON_MEMORY_H_
#define ALIDADE_SRC_COMMON_MEMORY_H_

#include <cstddef>
#include <memory>

namespace alidade::internal {

/// What arrays with an entry for each pose or observation may take of the
/// memory, all together (bytes). What does not fit lies in temporary files.
/// At first half of what the process may have: the machine's memory, or its
/// own limit (ulimit -d) where that is less.
std::size_t MemoryLimit();

/// Another limit, for what is allocated from then on. Results do not depend on
/// it.
void SetMemoryLimit(std::size_t bytes);

/// Memory for `count` numbers, which are anything; aligned to 64 bytes, and
/// freed with the last copy of the pointer. Beyond MemoryLimit() it is that of
/// a temporary file without a name, in $TMPDIR or else /var/tmp: the system
/// moves it there and back as it needs the memory. Threads may allocate at the
/// same time. @throws InputError where the file system has no room for it.
std::shared_ptr<double> AllocateLarge(std::size_t count);

/// `count` times the `size` numbers at `first`, one after the other. Many of
/// them are the same pages of memory, seen again and again.
/// @throws InputError as AllocateLarge, std::bad_alloc.
std::shared_ptr<const double> RepeatLarge(const double* first, std::size_t size,
                                          std::size_t count);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMMON_MEMORY_H_
