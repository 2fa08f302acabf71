#ifndef ALIDADE_SRC_COMMON_FILE_DESCRIPTOR_H_
#define ALIDADE_SRC_COMMON_FILE_DESCRIPTOR_H_

#include <string>
#include <string_view>

namespace alidade::internal {

/// An open file of the system's, closed on every way out; on exec too.
class FileDescriptor {
 public:
  /// As open(2); get() is negative, and errno set, where it failed.
  FileDescriptor(const std::string& path, int flags);
  ~FileDescriptor();
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;

  int get() const { return fd_; }
  /// False with errno set where not all of it reached the file.
  bool WriteAll(std::string_view content) const;
  /// False with errno set where the last write did not reach the file.
  bool Close();

 private:
  int fd_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMMON_FILE_DESCRIPTOR_H_
