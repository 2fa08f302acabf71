#include "src/common/memory.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <new>
#include <string>
#include <system_error>

#include "alidade/error.h"

namespace alidade::internal {
namespace {

constexpr std::size_t kUnlimited = std::numeric_limits<std::size_t>::max();
constexpr std::size_t kAlignment = 64;
// What is smaller is not counted: it would cost more than it is worth.
constexpr std::size_t kFewestCounted = std::size_t{1} << 20;

std::size_t OwnLimit() {
  rlimit limit{};
  if (getrlimit(RLIMIT_DATA, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) {
    return kUnlimited;
  }
  return static_cast<std::size_t>(limit.rlim_cur);
}

std::size_t MachineMemory() {
  const auto pages = sysconf(_SC_PHYS_PAGES);
  const auto page = sysconf(_SC_PAGESIZE);
  if (pages <= 0 || page <= 0) return kUnlimited;
  return static_cast<std::size_t>(pages) * static_cast<std::size_t>(page);
}

std::atomic<std::size_t>& Limit() {
  static std::atomic<std::size_t> limit{std::min(OwnLimit(), MachineMemory()) /
                                        2};
  return limit;
}

std::atomic<std::size_t>& Taken() {
  static std::atomic<std::size_t> taken{0};
  return taken;
}

// False where that would be more than the limit.
bool Take(std::size_t bytes) {
  std::size_t taken = Taken();
  do {
    if (bytes > Limit() || taken > Limit() - bytes) return false;
  } while (!Taken().compare_exchange_weak(taken, taken + bytes));
  return true;
}

// Large pages below what nothing was written to yet. With small ones, most of
// the time of filling it is the system's, which provides and clears one page
// after the other. Only a hint.
void AskForLargePages(double* first, std::size_t bytes) {
#ifdef MADV_HUGEPAGE
  constexpr std::size_t kPage = std::size_t{1} << 21;
  const std::size_t before =
      (kPage - reinterpret_cast<std::uintptr_t>(first) % kPage) % kPage;
  if (before + kPage > bytes) return;
  (void)madvise(reinterpret_cast<char*>(first) + before,
                (bytes - before) / kPage * kPage, MADV_HUGEPAGE);
#else
  (void)first;
  (void)bytes;
#endif
}

// Null where there is none.
double* Allocate(std::size_t bytes) {
  return static_cast<double*>(std::aligned_alloc(
      kAlignment, (bytes + kAlignment - 1) / kAlignment * kAlignment));
}

// Not /tmp, which many systems keep in memory.
std::string TemporaryDirectory() {
  const char* const chosen = std::getenv("TMPDIR");
  return chosen != nullptr && *chosen != '\0' ? chosen : "/var/tmp";
}

// A file that is gone when it is closed and unmapped, or less than 0.
int OpenNameless(const std::string& directory) {
#ifdef O_TMPFILE
  const int file = open(directory.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC,
                        S_IRUSR | S_IWUSR);
  if (file >= 0) return file;
#endif
  std::string name = directory + "/alidade-XXXXXX";
  const int named = mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) unlink(name.c_str());
  return named;
}

double* MapTemporary(std::size_t bytes) {
  const std::string directory = TemporaryDirectory();
  const int file = OpenNameless(directory);
  int error = file < 0 ? errno : 0;
  void* first = MAP_FAILED;
  if (error == 0) {
    // Room that is not there is reported here, not by a signal when it is
    // needed.
    do {
      error = posix_fallocate(file, 0, static_cast<off_t>(bytes));
    } while (error == EINTR);
    if (error == 0) {
      first = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
      if (first == MAP_FAILED) error = errno;
    }
    close(file);
  }
  if (error == 0) return static_cast<double*>(first);
  throw InputError(
      {directory, 0, 0, ""},
      "no temporary file of " + std::to_string(bytes >> 20U) +
          " MB for data that do not fit into the memory: " +
          std::generic_category().message(error) +
          "; make room, or name another directory in the variable TMPDIR");
}

void FillRepeated(const double* numbers, std::size_t size, std::size_t count,
                  double* to) {
  for (std::size_t i = 0; i < count; ++i, to += size) {
    std::copy_n(numbers, size, to);
  }
}

// A file in memory that holds the numbers `count` times, or less than 0.
int RepeatInFile(const double* numbers, std::size_t size, std::size_t count) {
  const std::size_t bytes = count * size * sizeof(double);
  const int file = memfd_create("alidade", MFD_CLOEXEC);
  if (file < 0) return file;
  void* memory = MAP_FAILED;
  if (ftruncate(file, static_cast<off_t>(bytes)) == 0) {
    memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  }
  if (memory == MAP_FAILED) {
    close(file);
    return -1;
  }
  FillRepeated(numbers, size, count, static_cast<double*>(memory));
  munmap(memory, bytes);
  return file;
}

// Maps `piece` bytes of a file again and again, `bytes` in all; null where the
// system does not.
double* MapAgainAndAgain(int file, std::size_t piece, std::size_t bytes) {
  void* const first = mmap(nullptr, bytes, PROT_NONE,
                           MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (first == MAP_FAILED) return nullptr;
  for (std::size_t done = 0; done < bytes; done += piece) {
    if (mmap(static_cast<char*>(first) + done, std::min(piece, bytes - done),
             PROT_READ, MAP_SHARED | MAP_FIXED, file, 0) == MAP_FAILED) {
      munmap(first, bytes);
      return nullptr;
    }
  }
  return static_cast<double*>(first);
}

}  // namespace

std::size_t MemoryLimit() { return Limit(); }

void SetMemoryLimit(std::size_t bytes) { Limit() = bytes; }

std::shared_ptr<double> AllocateLarge(std::size_t count) {
  const std::size_t bytes = std::max<std::size_t>(count, 1) * sizeof(double);
  if (bytes < kFewestCounted) {
    double* const first = Allocate(bytes);
    if (first == nullptr) throw std::bad_alloc();
    return {first, [](double* memory) { std::free(memory); }};
  }
  if (Take(bytes)) {
    if (double* const first = Allocate(bytes); first != nullptr) {
      AskForLargePages(first, bytes);
      return {first, [bytes](double* memory) {
                std::free(memory);
                Taken() -= bytes;
              }};
    }
    Taken() -= bytes;
  }
  return {MapTemporary(bytes),
          [bytes](double* memory) { munmap(memory, bytes); }};
}

std::shared_ptr<const double> RepeatLarge(const double* first, std::size_t size,
                                          std::size_t count) {
  // A whole number of pages and of repetitions, small enough for a cache.
  constexpr std::size_t kRepetitions = std::size_t{1} << 16;
  const std::size_t piece = kRepetitions * size * sizeof(double);
  const std::size_t bytes = count * size * sizeof(double);
  if (bytes > 4 * piece) {
    const int file = RepeatInFile(first, size, kRepetitions);
    if (file >= 0) {
      double* const memory = MapAgainAndAgain(file, piece, bytes);
      close(file);
      if (memory != nullptr) {
        return {memory, [bytes](double* begin) { munmap(begin, bytes); }};
      }
    }
  }
  const std::shared_ptr<double> memory = AllocateLarge(size * count);
  FillRepeated(first, size, count, memory.get());
  return memory;
}

}  // namespace alidade::internal
