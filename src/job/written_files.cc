#include "src/job/written_files.h"

#include <sys/stat.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>

#include "alidade/error.h"
#include "src/common/files.h"

namespace alidade::internal {
namespace {

namespace fs = std::filesystem;

constexpr char kList[] = ".alidade-files";
constexpr char kReportPage[] = "report.html";
// Of larger files size and time must do: to read gigabytes back would take
// longer than to write them.
constexpr std::uint64_t kMostHashed = std::uint64_t{1} << 26;
constexpr char kNotHashed[] = "-";
constexpr char kWhatToDo[] = "choose another --out, or move or remove the file";

// Size and time; nothing where there is no such file.
std::optional<FileMark> StatusOf(const std::string& path) {
  struct stat status;
  if (stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) {
    return std::nullopt;
  }
  constexpr std::int64_t kNanoseconds = 1000000000;
  FileMark mark;
  mark.bytes = static_cast<std::uint64_t>(status.st_size);
  mark.modified = status.st_mtim.tv_sec * kNanoseconds + status.st_mtim.tv_nsec;
  return mark;
}

bool IsUnchanged(const std::string& path, const FileMark& mark) {
  const std::optional<FileMark> now = StatusOf(path);
  if (!now || now->bytes != mark.bytes) return false;
  if (now->modified == mark.modified) return true;
  return mark.sha256 != kNotHashed && Sha256OfFile(path) == mark.sha256;
}

std::optional<FileMark> ParseMark(std::istringstream* line) {
  FileMark mark;
  if (*line >> mark.bytes >> mark.modified >> mark.sha256) return mark;
  return std::nullopt;
}

}  // namespace

FileMark MarkOf(const std::string& path) {
  std::optional<FileMark> mark = StatusOf(path);
  if (!mark) throw InputError({path, 0, 0, ""}, "cannot be read");
  mark->sha256 = mark->bytes <= kMostHashed ? Sha256OfFile(path) : kNotHashed;
  return *std::move(mark);
}

WrittenFiles ReadWrittenFiles(const std::string& directory) {
  const std::string path = directory + "/" + kList;
  WrittenFiles files;
  if (!fs::exists(path)) return files;
  std::istringstream lines(ReadFile(path));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream cells(line);
    std::string name;
    std::getline(cells, name, '\t');
    const bool is_plain = !name.empty() && name.front() != '.' &&
                          name.find('/') == std::string::npos;
    if (is_plain) files[name] = ParseMark(&cells);
  }
  return files;
}

void NoteWrittenFiles(const std::string& directory, const WrittenFiles& files) {
  std::string text;
  for (const auto& [name, mark] : files) {
    text += name;
    if (mark) {
      text += "\t" + std::to_string(mark->bytes) + "\t" +
              std::to_string(mark->modified) + "\t" + mark->sha256;
    }
    text += "\n";
  }
  // Never through a link that somebody has put there.
  const std::string path = directory + "/" + kList;
  std::error_code ignored;
  if (fs::is_symlink(path, ignored)) fs::remove(path, ignored);
  WriteFileAtomically(path, text);
}

void MoveWrittenFiles(const std::string& from, const std::string& to) {
  std::error_code error;
  fs::rename(fs::path(from) / kList, fs::path(to) / kList, error);
  if (error) {
    throw InputError({to, 0, 0, ""}, "cannot be written: " + error.message());
  }
}

void NoteAllWritten(const std::string& directory,
                    const std::vector<std::string>& names) {
  WrittenFiles files;
  for (const std::string& name : names) {
    files[name] = MarkOf(directory + "/" + name);
  }
  NoteWrittenFiles(directory, files);
}

bool IsOwnPage(const std::string& path) {
  constexpr std::size_t kEnough = 65536;
  std::string start(kEnough, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(start.data(), kEnough);
  start.resize(static_cast<std::size_t>(file.gcount()));
  return start.find("<style id=\"page-style\">") != std::string::npos;
}

void RefuseForeign(const std::string& directory,
                   const std::set<std::string>& names,
                   const WrittenFiles& written) {
  for (const std::string& name : names) {
    const std::string path = (fs::path(directory) / name).string();
    std::error_code ignored;
    if (!fs::exists(fs::symlink_status(path, ignored))) continue;
    const auto found = written.find(name);
    if (found == written.end()) {
      if (name == kReportPage && !written.empty() && IsOwnPage(path)) continue;
      throw InputError({path, 0, 0, ""},
                       std::string("is there already and is not known as "
                                   "written by alidade, so that it is not "
                                   "replaced: ") +
                           kWhatToDo);
    }
    if (!found->second || IsUnchanged(path, *found->second)) continue;
    throw InputError(
        {path, 0, 0, ""},
        std::string("was written by an earlier run and has been changed since, "
                    "so that it is not replaced: ") +
            kWhatToDo);
  }
}

std::set<std::string> NamesIn(const std::string& directory) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(directory)) {
    names.insert(entry.path().filename().string());
  }
  names.erase(kList);
  return names;
}

}  // namespace alidade::internal
