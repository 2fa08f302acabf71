#include "src/common/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <utility>

#include "src/common/files.h"

namespace alidade::internal {
namespace {

// Null where the file cannot be mapped; an empty one cannot.
const char* Map(const char* path, std::size_t* size) {
  const int fd = open(path, O_RDONLY | O_CLOEXEC);
  if (fd < 0) return nullptr;
  struct stat status = {};
  void* data = MAP_FAILED;
  if (fstat(fd, &status) == 0 && status.st_size > 0) {
    *size = static_cast<std::size_t>(status.st_size);
    data = mmap(nullptr, *size, PROT_READ, MAP_PRIVATE, fd, 0);
  }
  close(fd);
  if (data == MAP_FAILED) return nullptr;
  // Only a hint: its failure does no harm.
  (void)madvise(data, *size, MADV_WILLNEED);
  return static_cast<const char*>(data);
}

}  // namespace

MappedFile::MappedFile(const std::string& path) : path_(path) {
  RefuseEndless(path);
  data_ = Map(path.c_str(), &size_);
  if (data_ == nullptr) text_ = ReadFile(path);
}

MappedFile::MappedFile(const std::string& path, std::string text)
    : path_(path), text_(std::move(text)) {}

MappedFile::MappedFile(MappedFile&& other) noexcept
    : path_(std::move(other.path_)),
      text_(std::move(other.text_)),
      data_(std::exchange(other.data_, nullptr)),
      size_(other.size_) {}

MappedFile::~MappedFile() {
  if (data_ == nullptr) return;
  munmap(const_cast<char*>(data_), size_);
}

}  // namespace alidade::internal
