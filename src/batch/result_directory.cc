#include "alidade/batch/result_directory.h"

#include <filesystem>
#include <set>
#include <sstream>
#include <system_error>

#include "alidade/base/error.h"
#include "alidade/io/arm_file.h"
#include "alidade/io/files.h"
#include "alidade/io/result_json.h"

namespace alidade {
namespace {

std::string ArmComment(const JobResult& result) {
  return "Calibrated by alidade " + result.version + ": " + result.title;
}

void Append(std::vector<ReportFile> more, std::vector<ReportFile>* files) {
  for (ReportFile& file : more) files->push_back(std::move(file));
}

constexpr char kManifest[] = ".alidade-files";
constexpr char kPage[] = "report.html";

// The names that an earlier run has noted, a line each.
std::set<std::string> ReadManifest(const std::string& directory) {
  const std::string path = directory + "/" + kManifest;
  std::set<std::string> names;
  if (!std::filesystem::exists(path)) return names;
  std::istringstream lines(ReadFile(path));
  std::string name;
  while (std::getline(lines, name)) {
    // Whoever wrote it: never anything but a file in this directory.
    const bool is_plain = !name.empty() && name.front() != '.' &&
                          name.find('/') == std::string::npos;
    if (is_plain) names.insert(name);
  }
  return names;
}

void WriteManifest(const std::string& directory,
                   const std::set<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += name + "\n";
  WriteFileAtomically(directory + "/" + kManifest, text);
}

void Remove(const std::string& directory, const std::string& name) {
  const std::filesystem::path path = std::filesystem::path(directory) / name;
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return;
  if (!std::filesystem::remove(path, error)) {
    throw InputError(
        {path.string(), 0, 0, ""},
        "is of an earlier result and cannot be removed: " + error.message());
  }
}

ReportFile RenderArm(const JobOutcome& outcome) {
  return {"arm.yaml",
          FormatArm(outcome.calibrated, ArmComment(outcome.result))};
}

}  // namespace

std::vector<ReportFile> RenderResult(const JobOutcome& outcome) {
  const JobResult& result = outcome.result;
  std::vector<ReportFile> files;
  files.push_back(RenderArm(outcome));
  files.push_back({"report.txt", FormatReport(result)});
  Append(MakeCsvFiles(result), &files);
  Append(MakeFigures(result), &files);
  Append(MakeUncertaintyFiles(result), &files);
  Append(MakeIdentifiabilityFigures(result.identifiability), &files);
  files.push_back({"result.json", FormatResultJson(result)});
  return files;
}

std::vector<ReportFile> RenderResult(const JobOutcome& outcome,
                                     JobOutputs outputs) {
  if (outputs == JobOutputs::kFull) return RenderResult(outcome);
  return {RenderArm(outcome),
          {"result.json", FormatResultJson(outcome.result)}};
}

std::vector<std::string> WriteResultDirectory(
    const std::string& directory, const std::vector<ReportFile>& files) {
  MakeDirectories(directory);
  std::set<std::string> names;
  for (const ReportFile& file : files) names.insert(file.name);
  std::set<std::string> earlier = ReadManifest(directory);
  if (!earlier.empty()) earlier.insert(kPage);
  std::set<std::string> both = earlier;
  both.insert(names.begin(), names.end());
  // Whatever happens below, the next run knows all that may be there.
  WriteManifest(directory, both);
  if (!files.empty()) Remove(directory, files.back().name);
  for (const std::string& name : earlier) {
    if (names.count(name) == 0) Remove(directory, name);
  }
  std::vector<std::string> paths;
  for (const ReportFile& file : files) {
    paths.push_back(directory + "/" + file.name);
    WriteFileAtomically(paths.back(), file.content);
  }
  WriteManifest(directory, names);
  return paths;
}

}  // namespace alidade
