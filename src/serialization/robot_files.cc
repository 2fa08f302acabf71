#include "src/serialization/robot_files.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>
#include <sstream>

#include "src/common/characters.h"
#include "src/common/names.h"
#include "src/serialization/yaml_reader.h"

namespace alidade::internal {
namespace {

namespace fs = std::filesystem;

constexpr char kPrefix[] = "robots/";
constexpr char kEnding[] = ".yaml";

// An installation may have been moved as a whole.
fs::path BesideProgram() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (error) return {};
  return program.parent_path() / ALIDADE_ROBOTS_FROM_PROGRAM;
}

// A file that cannot be read is listed, so that somebody sees why.
bool IsOtherThanArm(const std::string& path) {
  try {
    const std::optional<YamlValue> format = ReadYaml(path).Find("format");
    return format && format->Text() != "alidade-arm-1";
  } catch (const InputError&) {
    return false;
  }
}

// "ur10e" of "robots/ur10e" and "robots/ur10e.yaml"; nothing of other texts.
std::string StemOf(const std::string& text) {
  if (text.rfind(kPrefix, 0) != 0) return "";
  const fs::path file = text.substr(sizeof(kPrefix) - 1);
  const std::string ending = file.extension().string();
  return ending.empty() || ending == kEnding ? file.stem().string() : "";
}

std::string Condensed(const std::string& text) {
  std::string condensed;
  for (const char c : text) {
    const char lower = LowerCase(c);
    if (IsDigit(lower) || (lower >= 'a' && lower <= 'z')) condensed += lower;
  }
  return condensed;
}

}  // namespace

std::vector<std::string> RobotFolders() {
  std::vector<fs::path> candidates;
  if (const char* const own = std::getenv("ALIDADE_ROBOTS")) {
    std::istringstream folders(own);
    for (std::string folder; std::getline(folders, folder, ':');) {
      candidates.emplace_back(folder);
    }
  }
  candidates.push_back(BesideProgram());
  candidates.emplace_back(ALIDADE_SOURCE_ROBOTS);
  candidates.emplace_back(ALIDADE_INSTALLED_ROBOTS);
  std::vector<std::string> found;
  for (const fs::path& candidate : candidates) {
    std::error_code error;
    const std::string folder = fs::canonical(candidate, error).string();
    if (error || !fs::is_directory(folder, error)) continue;
    if (std::find(found.begin(), found.end(), folder) == found.end()) {
      found.push_back(folder);
    }
  }
  return found;
}

std::vector<RobotFile> ListRobots() {
  std::map<std::string, std::string> paths;
  for (const std::string& folder : RobotFolders()) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
      const fs::path& path = entry.path();
      if (path.extension() != kEnding || IsOtherThanArm(path)) continue;
      paths.emplace(kPrefix + path.stem().string(), path.string());
    }
  }
  std::vector<RobotFile> files;
  for (const auto& [name, path] : paths) files.push_back({name, path});
  return files;
}

bool HasRobotName(const std::string& name, const std::string& part) {
  return Condensed(name).find(Condensed(part)) != std::string::npos;
}

std::string RobotNameOf(const std::string& path) {
  const fs::path file = path;
  const std::string name = kPrefix + file.stem().string();
  for (const std::string& folder : RobotFolders()) {
    const fs::path first = fs::path(folder) / (file.stem().string() + kEnding);
    std::error_code error;
    // A file of an earlier folder hides the others of its name.
    if (fs::exists(first, error)) return first == file ? name : "";
  }
  return "";
}

std::string ArmPath(const std::string& text, const std::string& path,
                    const SourceLocation& location) {
  const std::string stem = StemOf(text);
  std::error_code error;
  if (stem.empty() || fs::exists(path, error)) return path;
  for (const std::string& folder : RobotFolders()) {
    const fs::path file = fs::path(folder) / (stem + kEnding);
    if (fs::exists(file, error)) return file.string();
  }
  std::vector<std::string> names;
  for (const RobotFile& file : ListRobots()) names.push_back(file.name);
  throw InputError(location, UnknownName("arm", text, names) +
                                 "; 'alidade robots' lists them");
}

void RefuseBareName(const std::string& text, const std::string& path,
                    const SourceLocation& location) {
  const std::string name = kPrefix + text;
  std::error_code error;
  if (text.find('/') != std::string::npos || StemOf(name).empty() ||
      fs::exists(path, error)) {
    return;
  }
  constexpr std::size_t kFewest = 3;  // characters that say something
  constexpr std::size_t kMost = 5;    // names that are read
  // Files of arms of one's own are called "arm.yaml".
  const bool is_file = fs::path(text).extension() == kEnding;
  const std::string part = Condensed(text);
  std::vector<std::string> similar;
  for (const RobotFile& robot : ListRobots()) {
    if (robot.name == kPrefix + StemOf(name)) {
      throw InputError(location, Quote(text) + " is no file, did you mean \"" +
                                     robot.name +
                                     "\"? 'alidade robots' lists them");
    }
    if (is_file || part.size() < kFewest || similar.size() == kMost) continue;
    const std::string own = robot.name.substr(sizeof(kPrefix) - 1);
    if (HasRobotName(own, part)) similar.push_back(robot.name);
  }
  if (similar.empty()) return;
  throw InputError(location, Quote(text) + " is no file, did you mean " +
                                 JoinNames(similar) +
                                 "? 'alidade robots' lists them");
}

}  // namespace alidade::internal
