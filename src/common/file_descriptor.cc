#include "src/common/file_descriptor.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

namespace alidade::internal {

FileDescriptor::FileDescriptor(const std::string& path, int flags)
    : fd_(open(path.c_str(), flags | O_CLOEXEC, 0666)) {}

FileDescriptor::~FileDescriptor() {
  if (fd_ >= 0) close(fd_);
}

bool FileDescriptor::WriteAll(std::string_view content) const {
  std::size_t written = 0;
  while (written < content.size()) {
    const ssize_t count =
        write(fd_, content.data() + written, content.size() - written);
    if (count < 0 && errno != EINTR) return false;
    if (count > 0) written += static_cast<std::size_t>(count);
  }
  return true;
}

bool FileDescriptor::Close() {
  const int fd = fd_;
  fd_ = -1;
  return close(fd) == 0;
}

}  // namespace alidade::internal
