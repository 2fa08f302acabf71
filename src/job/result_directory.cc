#include "src/job/result_directory.h"

#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <set>
#include <system_error>

#include "alidade/arm_file.h"
#include "alidade/error.h"
#include "src/common/files.h"
#include "src/job/directory_swap.h"
#include "src/job/written_files.h"
#include "src/report/budget_report.h"
#include "src/serialization/result_json.h"

namespace alidade::internal {
namespace {

std::string ArmComment(const CalibrationResult& result) {
  return "Calibrated by alidade " + result.version + ": " + result.title;
}

void Append(std::vector<ReportFile> more, std::vector<ReportFile>* files) {
  for (ReportFile& file : more) files->push_back(std::move(file));
}

constexpr char kPage[] = "report.html";

// What each command may write.
std::set<std::string> NamesOf(OutputKind kind) {
  switch (kind) {
    case OutputKind::kCalibration:
      return {"arm.yaml",
              "arm.rejected.yaml",
              "report.txt",
              "residuals.csv",
              "validation.csv",
              "iterations.csv",
              "error_before.svg",
              "error_after.svg",
              "convergence.svg",
              "influence.csv",
              "validation_before.svg",
              "relations.svg",
              "validation_after.svg",
              "predicted_map.csv",
              "singular_values.svg",
              "predicted_map.svg",
              "residual_histogram.svg",
              "report.html",
              "validation_z_scores.svg",
              "error_stages.svg",
              "error_effects.svg",
              "joint_functions.csv",
              "joint_functions.svg",
              "joint_residuals.csv",
              "joint_residuals.svg",
              "budget.csv",
              "iso9283.csv",
              "result.json",
              "heldout.csv",
              "heldout_z_scores.svg"};
    case OutputKind::kComparison:
      return {
          "residuals.csv",         "validation.csv",       "iterations.csv",
          "error_before.svg",      "error_after.svg",      "convergence.svg",
          "validation_before.svg", "validation_after.svg", "noise_study.csv",
          "noise_study.svg",       "comparison.txt"};
    case OutputKind::kMonteCarlo:
      return {"montecarlo.csv",      "trials.csv",      "coverage.svg",
              "workspace_error.svg", "montecarlo.html", "montecarlo.txt"};
    case OutputKind::kPlan:
      return {"poses.csv", "plan.txt",  "accuracy.svg",
              "curve.csv", "plan.html", "plan.json"};
    case OutputKind::kPredictions:
      return {"predicted_map.csv", "predicted_map.svg", "z_scores.svg"};
  }
  return {};
}

// Names that a run writes or, as those of an earlier one, removes.
std::set<std::string> WithListed(std::set<std::string> names,
                                 const WrittenFiles& written) {
  for (const auto& file : written) names.insert(file.first);
  if (!written.empty()) names.insert(kPage);
  return names;
}

bool IsSameFile(const std::string& a, const std::string& b) {
  std::error_code error;
  return std::filesystem::equivalent(a, b, error) && !error;
}

// Found before the work, not after it.
void CheckWritable(const std::string& directory) {
  std::filesystem::path path = directory;
  std::error_code ignored;
  while (!std::filesystem::exists(path, ignored) && !path.empty()) {
    path = path.parent_path();
  }
  if (path.empty()) path = ".";
  if (!std::filesystem::is_directory(path, ignored)) {
    throw InputError({path.string(), 0, 0, ""},
                     "is no directory to write results to: choose another "
                     "--out");
  }
  if (access(path.c_str(), W_OK | X_OK) != 0) {
    throw InputError(
        {path.string(), 0, 0, ""},
        "cannot be written: " + std::generic_category().message(errno) +
            "; choose another --out");
  }
}

std::string DirectoryOf(const std::filesystem::path& file) {
  const std::filesystem::path directory = file.parent_path();
  return directory.empty() ? "." : directory.string();
}

ReportFile RenderArm(const CalibrationResult& result) {
  const bool is_rejected = result.IsRejected();
  return {is_rejected ? "arm.rejected.yaml" : "arm.yaml",
          FormatArm(result.arm, (is_rejected ? "Rejected, not to be used: " +
                                                   result.message + ". "
                                             : "") +
                                    ArmComment(result))};
}

}  // namespace

std::string ResultJsonOf(const std::string& path) {
  const std::filesystem::path result = path;
  return std::filesystem::is_directory(result)
             ? (result / "result.json").string()
             : path;
}

std::vector<ReportFile> RenderResult(const CalibrationResult& result,
                                     const std::string& further) {
  std::vector<ReportFile> files;
  files.push_back(RenderArm(result));
  files.emplace_back("report.txt", FormatReport(result, further));
  Append(MakeCsvFiles(result), &files);
  Append(MakeFigures(result), &files);
  Append(MakeUncertaintyFiles(result), &files);
  Append(MakeBudgetFiles(result), &files);
  Append(MakeErrorTermFiles(result), &files);
  Append(MakeIdentifiabilityFigures(result.identifiability), &files);
  files.emplace_back("result.json", FormatResultJson(result));
  return files;
}

std::vector<ReportFile> RenderResult(const CalibrationResult& result,
                                     JobOutputs outputs) {
  if (outputs == JobOutputs::kFull) return RenderResult(result);
  return {RenderArm(result), {"result.json", FormatResultJson(result)}};
}

void CheckOutputFile(const std::string& path,
                     const std::vector<std::string>& inputs) {
  for (const std::string& input : inputs) {
    if (!IsSameFile(path, input)) continue;
    throw InputError(
        {path, 0, 0, ""},
        "is read by this run, which would replace or remove it: choose "
        "another --out");
  }
}

void CheckResultDirectory(const std::string& directory, OutputKind kind,
                          const std::vector<std::string>& inputs) {
  CheckWritable(directory);
  const WrittenFiles written = ReadWrittenFiles(directory);
  const std::set<std::string> names = WithListed(NamesOf(kind), written);
  for (const std::string& name : names) {
    CheckOutputFile((std::filesystem::path(directory) / name).string(), inputs);
  }
  RefuseForeign(directory, names, written);
}

namespace {

// An error names the file by the place that it was for.
void WriteStaged(const StagedDirectory& staged, const ReportFile& file,
                 const std::string& path) {
  try {
    WriteNewFile(staged.path() + "/" + file.name, file.content);
  } catch (const InputError& error) {
    throw InputError({path, 0, 0, ""}, error.message());
  }
}

std::vector<std::string> WriteInto(const std::string& directory,
                                   const std::vector<ReportFile>& files) {
  const std::string place = std::filesystem::canonical(directory).string();
  const DirectoryLock lock(place);
  ClearStaged(place);
  std::set<std::string> names;
  for (const ReportFile& file : files) names.insert(file.name);
  const WrittenFiles earlier = ReadWrittenFiles(place);
  const std::set<std::string> both = WithListed(names, earlier);
  RefuseForeign(directory, both, earlier);
  StagedDirectory staged(place);
  std::vector<std::string> paths;
  for (const ReportFile& file : files) {
    paths.push_back(directory + "/" + file.name);
    WriteStaged(staged, file, paths.back());
  }
  NoteAllWritten(staged.path(), {names.begin(), names.end()});
  staged.PutInPlace(both, files.empty() ? "" : files.back().name);
  return paths;
}

}  // namespace

std::vector<std::string> WriteResultDirectory(
    const std::string& directory, const std::vector<ReportFile>& files) {
  std::error_code ignored;
  const bool is_new = !std::filesystem::exists(directory, ignored);
  MakeDirectories(directory);
  try {
    return WriteInto(directory, files);
  } catch (const InputError&) {
    // Nothing but an empty directory goes.
    if (is_new) std::filesystem::remove(directory, ignored);
    throw;
  }
}

void RemoveResult(const std::string& directory) {
  if (!ReadWrittenFiles(directory).empty()) WriteResultDirectory(directory, {});
}

void CheckReportPage(const std::string& path) {
  const std::filesystem::path page = path;
  const std::string directory = DirectoryOf(page);
  const WrittenFiles written = ReadWrittenFiles(directory);
  const std::string name = page.filename().string();
  if (written.count(name) > 0 || !IsOwnPage(path)) {
    RefuseForeign(directory, {name}, written);
  }
}

void NoteReportPage(const std::string& path) {
  const std::filesystem::path page = path;
  const std::string directory = DirectoryOf(page);
  WrittenFiles written = ReadWrittenFiles(directory);
  const std::string name = page.filename().string();
  // What compares several results is none of the files of one.
  if (written.empty() || (name != kPage && written.count(name) == 0)) return;
  written[name] = MarkOf(path);
  NoteWrittenFiles(directory, written);
}

}  // namespace alidade::internal
