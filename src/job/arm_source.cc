#include "src/job/arm_source.h"

#include <algorithm>
#include <filesystem>
#include <mutex>

#include "alidade/arm_file.h"
#include "alidade/error.h"
#include "src/common/files.h"
#include "src/common/mapped_file.h"
#include "src/common/names.h"
#include "src/dataio/csv_table.h"
#include "src/job/result_directory.h"
#include "src/serialization/config_file.h"
#include "src/serialization/result_json.h"
#include "src/serialization/robot_files.h"

namespace alidade::internal {
namespace {

namespace fs = std::filesystem;

std::string FileBeside(const std::string& json, const char* name) {
  return (fs::path(json).parent_path() / name).string();
}

bool IsUnchangedArm(const InputFile& input) {
  if (!fs::is_regular_file(input.path)) return false;
  const std::string ending = fs::path(input.path).extension().string();
  if (ending != ".yaml" && ending != ".yml") return false;
  if (Sha256OfFile(input.path) != input.sha256) return false;
  return DetectFormat(input.path) == FileFormat::kArm;
}

std::string FindNominal(const std::string& path,
                        const CalibrationResult& result) {
  std::string seen;
  for (const InputFile& input : result.inputs) {
    if (IsUnchangedArm(input)) return input.path;
    seen += (seen.empty() ? "" : ", ") + input.path;
  }
  throw InputError(
      {path, 0, 0, ""},
      "the nominal arm that it was calibrated from is not found, or has been "
      "changed since, expected --nominal=ARM.yaml (the result names " +
          seen + ", from the folder that `calibrate` ran in)");
}

// Of residuals.csv, whose joint values are those of the training poses.
Eigen::MatrixXd MeasuredRange(const std::string& path, const Arm& arm) {
  if (!fs::is_regular_file(path)) return {};
  const TableContent content{arm, JointColumns(arm), true};
  const CsvTable table(MappedFile(path), content, ReadOptions());
  const int n = arm.num_joints();
  Eigen::MatrixXd range(n, 2);
  range.col(0).setConstant(std::numeric_limits<double>::infinity());
  range.col(1) = -range.col(0);
  table.VisitRows(1, [&](const TableRow& row) {
    for (int j = 0; j < n; ++j) {
      range(j, 0) = std::min(range(j, 0), row.Number(j));
      range(j, 1) = std::max(range(j, 1), row.Number(j));
    }
  });
  return range;
}

// A folder may hold anything, a job above all.
void RequireResult(const std::string& path) {
  const fs::path folder = path;
  if (!fs::is_directory(folder) || fs::exists(folder / "result.json")) return;
  const fs::path job = folder / "job.yaml";
  throw InputError(
      {path, 0, 0, ""},
      fs::exists(job)
          ? "this folder holds a job, no result: `alidade calibrate " +
                job.string() + "` first, and name the folder that it writes"
          : "this folder holds no result.json: name the one that `alidade "
            "calibrate` has written");
}

void RequireSameJoints(const ArmSource& source, const std::string& path) {
  const Arm& nominal = source.nominal;
  if (nominal.JointDimensions() == source.real.JointDimensions()) return;
  throw InputError({source.nominal_path, 0, 0, "joints"},
                   "the nominal arm has other joints than " + path + ": " +
                       std::to_string(nominal.num_joints()) + " and " +
                       std::to_string(source.real.num_joints()) +
                       ", or other types");
}

}  // namespace

Arm LoadArmOrResult(const std::string& path) {
  RequireResult(path);
  if (!IsResult(path)) return LoadArm(path);
  return LoadArm(FileBeside(ResultJsonOf(path), "arm.yaml"));
}

ArmSource LoadArmSource(const std::string& path,
                        const std::string& nominal_path) {
  ArmSource source;
  source.real = LoadArmOrResult(path);
  source.nominal_path = nominal_path;
  if (IsResult(path)) {
    const std::string json = ResultJsonOf(path);
    source.inputs = {json, FileBeside(json, "arm.yaml")};
    const CalibrationResult result = LoadResultJson(json);
    if (nominal_path.empty()) source.nominal_path = FindNominal(path, result);
    source.before = result.train.Judged().before;
    if (result.validation) {
      source.validation = result.validation->Judged().after;
    }
    source.calibrated = LoadCalibratedArm(json);
    source.measured =
        MeasuredRange(FileBeside(json, "residuals.csv"), source.real);
  } else {
    source.inputs = {path};
    if (nominal_path.empty()) {
      throw InputError({path, 0, 0, ""},
                       "an arm file, which says neither what was measured nor "
                       "which arm the controller believes in: calibrate first, "
                       "and name the folder of the result; or, where this is "
                       "the calibrated arm, expected --nominal=ARM.yaml");
    }
  }
  source.nominal = LoadArm(source.nominal_path, &source.inputs);
  source.inputs.push_back(source.nominal_path);
  RequireSameJoints(source, path);
  return source;
}

std::string NominalName(const ArmSource& source) {
  const std::string name = RobotNameOf(source.nominal_path);
  return source.nominal.name + " (" +
         (name.empty() ? source.nominal_path : name) + ")";
}

}  // namespace alidade::internal
