#ifndef ALIDADE_SRC_COMMON_MAPPED_FILE_H_
#define ALIDADE_SRC_COMMON_MAPPED_FILE_H_

#include <cstddef>
#include <string>
#include <string_view>

namespace alidade::internal {

/// The bytes of a file, for reading. Regular files are mapped into memory, so
/// that nothing is copied and threads read their own pages; others (pipes,
/// devices) are read into memory. A file that another program shortens while
/// it is mapped ends the process (SIGBUS): writers should rename, as Alidade's
/// do.
class MappedFile {
 public:
  /// @throws InputError naming the path and the cause.
  explicit MappedFile(const std::string& path);
  /// Text that is in no file; `path` is for messages.
  MappedFile(const std::string& path, std::string text);
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&&) = delete;
  ~MappedFile();

  const std::string& path() const { return path_; }
  /// Valid until the object is moved from or gone.
  std::string_view text() const {
    return data_ == nullptr ? std::string_view(text_)
                            : std::string_view(data_, size_);
  }

 private:
  std::string path_;
  std::string text_;
  const char* data_ = nullptr;  // null: `text_` has it all
  std::size_t size_ = 0;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMMON_MAPPED_FILE_H_
