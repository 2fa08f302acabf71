#include "src/common/files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <glog/logging.h>
#include <openssl/evp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>
#include <vector>

#include "alidade/error.h"
#include "src/common/characters.h"
#include "src/common/file_descriptor.h"

namespace alidade::internal {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void Fail(const std::string& path, const std::string& what,
                       int error) {
  throw InputError({path, 0, 0, ""},
                   what + ": " + std::generic_category().message(error));
}

[[noreturn]] void FailToWrite(const std::string& path, const std::string& what,
                              int error) {
  throw InputError({path, 0, 0, ""},
                   what + ": " + std::generic_category().message(error) +
                       "; choose another --out");
}

constexpr std::string_view kTemporaryMark = ".tmp-";

// Unique among threads by the counter and among processes by the id; O_EXCL
// takes care of files that a killed process of the same id left behind.
std::string TemporaryName(const std::string& path) {
  static std::atomic<unsigned> counter{0};
  return path + std::string(kTemporaryMark) + std::to_string(getpid()) + "-" +
         std::to_string(counter.fetch_add(1));
}

bool IsTemporary(std::string_view name) {
  const auto are_digits = [](std::string_view text) {
    return !text.empty() && std::all_of(text.begin(), text.end(), IsDigit);
  };
  const std::size_t mark = name.rfind(kTemporaryMark);
  if (mark == std::string_view::npos) return false;
  name.remove_prefix(mark + kTemporaryMark.size());
  const std::size_t dash = name.find('-');
  return dash != std::string_view::npos && are_digits(name.substr(0, dash)) &&
         are_digits(name.substr(dash + 1));
}

// What a symbolic link points to, so that the link stays one.
std::string TargetOfLinks(const std::string& path) {
  std::error_code error;
  if (!fs::is_symlink(path, error)) return path;
  const fs::path target = fs::weakly_canonical(path, error);
  return error ? path : target.string();
}

constexpr int kNewFile = O_WRONLY | O_CREAT | O_EXCL;

// Takes a file away again on every way out but that where it is complete.
class Unfinished {
 public:
  explicit Unfinished(const std::string& path) : path_(path) {}
  ~Unfinished() {
    if (!is_finished_) unlink(path_.c_str());
  }
  Unfinished(const Unfinished&) = delete;
  Unfinished& operator=(const Unfinished&) = delete;

  void Finish() { is_finished_ = true; }

 private:
  const std::string path_;
  bool is_finished_ = false;
};

// All of `content`, synced; returns its size. `path`: what errors name.
std::uint64_t WriteAndSync(const std::string& path, const TextSource& content,
                           FileDescriptor* file) {
  std::uint64_t size = 0;
  content([&](std::string_view piece) {
    if (!file->WriteAll(piece)) FailToWrite(path, "cannot be written", errno);
    size += piece.size();
  });
  if (fsync(file->get()) != 0 || !file->Close()) {
    FailToWrite(path, "cannot be written", errno);
  }
  return size;
}

TextSource InOnePiece(const std::string& content) {
  return [&content](const TextSink& sink) { sink(content); };
}

// What may never end, and files that are almost nothing but holes: reading all
// of their zeros takes as long as their size says, which costs nothing to
// write.
void RefuseStatus(const std::string& path, const struct stat& status) {
  constexpr off_t kLeastSize = 1 << 24;
  constexpr off_t kBlock = 512;
  constexpr off_t kMostHoles = 64;  // times what is there
  if (S_ISREG(status.st_mode)) {
    if (status.st_size > kLeastSize &&
        status.st_size / kMostHoles > status.st_blocks * kBlock) {
      throw InputError(
          {path, 0, 0, ""},
          "says that it is " + std::to_string(status.st_size) +
              " bytes long and holds almost none of them, expected "
              "a file without holes");
    }
  } else if (!S_ISDIR(status.st_mode)) {
    throw InputError({path, 0, 0, ""},
                     "is a pipe or a device, which may never end, expected a "
                     "file: write what it holds to one");
  }
}

// "a/link/../b" is not "a/b" where link is a symbolic link.
bool LeavesSymbolicLink(const fs::path& path) {
  fs::path walked;
  for (const fs::path& part : path) {
    std::error_code error;
    if (part == ".." && fs::is_symlink(walked, error)) return true;
    walked /= part;
  }
  return false;
}

// take(data, size) of the file's consecutive pieces.
template <typename Take>
void ReadPieces(const std::string& path, const Take& take) {
  // Without waiting for whoever may write to a pipe.
  const FileDescriptor file(path, O_RDONLY | O_NONBLOCK);
  if (file.get() < 0) Fail(path, "cannot be read", errno);
  struct stat status = {};
  if (fstat(file.get(), &status) == 0) RefuseStatus(path, status);
  std::vector<char> buffer(std::size_t{1} << 18);
  while (true) {
    const ssize_t count = read(file.get(), buffer.data(), buffer.size());
    if (count == 0) return;
    if (count < 0 && errno != EINTR) Fail(path, "cannot be read", errno);
    if (count > 0) take(buffer.data(), static_cast<std::size_t>(count));
  }
}

}  // namespace

void RefuseEndless(const std::string& path) {
  struct stat status = {};
  if (stat(path.c_str(), &status) == 0) RefuseStatus(path, status);
}

std::string ReadFile(const std::string& path) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 30;
  std::string content;
  ReadPieces(path, [&](const char* data, std::size_t count) {
    content.append(data, count);
    if (content.size() <= kMostBytes) return;
    throw InputError({path, 0, 0, ""},
                     "is larger than 1 GiB, expected a text to be read whole");
  });
  return content;
}

void WriteFileAtomically(const std::string& path, const std::string& content) {
  WriteFileAtomically(path, InOnePiece(content));
}

std::uint64_t WriteFileAtomically(const std::string& given,
                                  const TextSource& content) {
  const std::string path = TargetOfLinks(given);
  // Renaming over a device or a pipe would put a file in its place.
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (fs::exists(status) && !fs::is_regular_file(status) &&
      !fs::is_directory(status)) {
    SourceLocation location;
    location.file = given;
    throw InputError(location,
                     "is a device or a pipe, expected a file or a new name");
  }
  std::string temporary;
  std::optional<FileDescriptor> file;
  do {
    temporary = TemporaryName(path);
    file.emplace(temporary, kNewFile);
  } while (file->get() < 0 && errno == EEXIST);
  if (file->get() < 0) FailToWrite(path, "cannot be written", errno);
  Unfinished unfinished(temporary);
  const std::uint64_t size = WriteAndSync(path, content, &*file);
  if (rename(temporary.c_str(), path.c_str()) != 0) {
    FailToWrite(path, "cannot be written", errno);
  }
  unfinished.Finish();
  return size;
}

void WriteNewFile(const std::string& path, const std::string& content) {
  WriteNewFile(path, InOnePiece(content));
}

std::uint64_t WriteNewFile(const std::string& path, const TextSource& content) {
  FileDescriptor file(path, kNewFile);
  if (file.get() < 0) FailToWrite(path, "cannot be written", errno);
  Unfinished unfinished(path);
  const std::uint64_t size = WriteAndSync(path, content, &file);
  unfinished.Finish();
  return size;
}

void SyncDirectory(const std::string& path) {
  FileDescriptor directory(path, O_RDONLY | O_DIRECTORY);
  if (directory.get() < 0 || fsync(directory.get()) != 0) {
    Fail(path, "directory cannot be synced", errno);
  }
}

void RemoveTemporaries(const std::string& directory) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(directory, error)) {
    std::error_code ignored;
    if (IsTemporary(entry.path().filename().string()) &&
        entry.is_regular_file(ignored)) {
      fs::remove(entry.path(), ignored);
    }
  }
}

void MakeDirectories(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) FailToWrite(path, "directory cannot be made", error.value());
}

namespace {

// SHA-256 of what it is given piece by piece.
class Hasher {
 public:
  Hasher() : context_(EVP_MD_CTX_new()) {
    CHECK(context_ != nullptr);
    CHECK_EQ(EVP_DigestInit_ex(context_, EVP_sha256(), nullptr), 1);
  }
  ~Hasher() { EVP_MD_CTX_free(context_); }
  Hasher(const Hasher&) = delete;
  Hasher& operator=(const Hasher&) = delete;

  void Add(const char* data, std::size_t size) {
    CHECK_EQ(EVP_DigestUpdate(context_, data, size), 1);
  }
  std::string Finish() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest;
    unsigned int size = 0;
    CHECK_EQ(EVP_DigestFinal_ex(context_, digest.data(), &size), 1);
    return fmt::format("{:02x}",
                       fmt::join(digest.data(), digest.data() + size, ""));
  }

 private:
  EVP_MD_CTX* const context_;
};

}  // namespace

std::string Sha256(const std::string& content) {
  Hasher hasher;
  hasher.Add(content.data(), content.size());
  return hasher.Finish();
}

std::string Sha256OfFile(const std::string& path) {
  Hasher hasher;
  ReadPieces(path, [&](const char* data, std::size_t size) {
    hasher.Add(data, size);
  });
  return hasher.Finish();
}

SourceLocation LocationOfByte(const std::string& path, const std::string& text,
                              std::size_t byte) {
  const std::string before = text.substr(0, byte);
  const auto breaks = std::count(before.begin(), before.end(), '\n');
  // Without a line break npos + 1, which is 0.
  const std::size_t line_begin = before.rfind('\n') + 1;
  return {path, static_cast<int>(breaks) + 1,
          static_cast<int>(before.size() - line_begin) + 1, ""};
}

std::string ResolvePath(const std::string& from_file, const std::string& path) {
  if (fs::path(path).is_absolute()) return path;
  const fs::path joined = fs::path(from_file).parent_path() / path;
  if (LeavesSymbolicLink(joined)) return joined.string();
  return joined.lexically_normal().string();
}

}  // namespace alidade::internal
