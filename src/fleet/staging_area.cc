#include "src/fleet/staging_area.h"

#include <cstdint>
#include <filesystem>
#include <system_error>

#include "src/common/files.h"
#include "src/job/written_files.h"

namespace alidade::internal {
namespace {

namespace fs = std::filesystem;

constexpr char kStaged[] = "staged-";

}  // namespace

StagingArea::StagingArea(const std::string& directory, const std::string& mark)
    : path_(directory + "/.batch"), mark_(mark.empty() ? "" : mark + "-") {}

void StagingArea::Clear() const {
  for (const auto& entry : fs::directory_iterator(path_)) {
    if (entry.path().filename().string().rfind(kStaged, 0) == 0) {
      RemoveStaged(entry.path().string());
    }
  }
}

std::string StagingArea::NewName() {
  return path_ + "/" + kStaged + mark_ + std::to_string(next_.fetch_add(1));
}

std::string StagingArea::Stage(const std::vector<ReportFile>& files,
                               std::vector<ResultFile>* written) {
  written->clear();
  std::string staged = NewName();
  try {
    MakeDirectories(staged);
    std::vector<std::string> names;
    for (const ReportFile& file : files) {
      const std::uint64_t size =
          WriteNewFile(staged + "/" + file.name, file.content);
      written->push_back({file.name, size});
      names.push_back(file.name);
    }
    NoteAllWritten(staged, names);
    SyncDirectory(staged);
  } catch (...) {
    RemoveStaged(staged);
    throw;
  }
  return staged;
}

void RemoveStaged(const std::string& path) {
  std::error_code ignored;
  fs::remove_all(path, ignored);
}

}  // namespace alidade::internal
