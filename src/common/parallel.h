#ifndef ALIDADE_SRC_COMMON_PARALLEL_H_
#define ALIDADE_SRC_COMMON_PARALLEL_H_

#include <cstdint>
#include <functional>

namespace alidade::internal {

/// Calls work(begin, end) for consecutive blocks of [0, count), each at most
/// block_size long, from up to num_threads threads. Blocks do not depend on
/// num_threads, so work that writes only its own range gives the same bits
/// for any number of threads. Blocks until all is done. An exception thrown
/// by work is rethrown here once every thread has stopped.
/// @pre num_threads >= 1, block_size >= 1, count >= 0.
void ParallelFor(int num_threads, std::int64_t count, std::int64_t block_size,
                 const std::function<void(std::int64_t, std::int64_t)>& work);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMMON_PARALLEL_H_
