#include <glog/logging.h>

#include <filesystem>
#include <iostream>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/arm_file.h"
#include "alidade/error.h"
#include "alidade/units.h"
#include "src/calibration/evaluate.h"
#include "src/cli/command.h"
#include "src/cli/validation_data.h"
#include "src/common/files.h"
#include "src/common/names.h"
#include "src/job/calibrated_arm.h"
#include "src/job/result_directory.h"
#include "src/report/report.h"
#include "src/report/table.h"
#include "src/serialization/config_file.h"
#include "src/serialization/ur_kinematics.h"
#include "src/serialization/yaml_reader.h"

namespace alidade::internal {
namespace {

constexpr int kRandomPoses = 10000;
constexpr int kMapPoses = 2000;

// Where data state no sigma and none was found by a fit: for errors in mm it
// plays no part.
constexpr double kAnySigma = kMillimetre;

// Errors of so many times the predicted ones, which go where instrument or tool
// are refitted, are theirs. Tried of poses enough and not so many that it takes
// long.
constexpr double kFarOff = 10.0;
constexpr Eigen::Index kFewestPoses = 10;
constexpr Eigen::Index kMostPoses = 20000;

class Validation {
 public:
  explicit Validation(const CommandLine& line)
      : line_(line), seed_(line.seed.value_or(kDefaultSeed)) {
    const std::string& first = line.files.front();
    if (!IsResult(first)) {
      arm_ = LoadArm(first);
      return;
    }
    calibrated_ = LoadCalibratedArm(first);
    if (!calibrated_) {
      throw InputError({first, 0, 0, "uncertainty"},
                       "this result says nothing of its uncertainty: "
                       "calibrate again, or validate its arm.yaml");
    }
    arm_ = calibrated_->arm;
    if (!line.out.empty()) CheckOut();
  }

  ExitStatus Run() {
    std::vector<std::string> checks;
    for (std::size_t i = 1; i < line_.files.size(); ++i) {
      Compare(line_.files[i], &checks);
    }
    std::cout << "Position error of " << arm_.name << "\n" << table_.ToText();
    for (const std::string& check : checks) std::cout << "\n" << check;
    if (calibrated_ && !map_) map_ = MapOf(*calibrated_, kMapPoses, seed_);
    if (map_) std::cout << "\n" << FormatPredictedMap(*map_);
    if (!line_.out.empty()) WriteFiles();
    return kExitDone;
  }

 private:
  void CheckOut() const {
    std::vector<std::string> inputs = line_.files;
    const std::filesystem::path result = line_.files.front();
    const std::filesystem::path directory =
        std::filesystem::is_directory(result) ? result : result.parent_path();
    for (const char* name : {"arm.yaml", "result.json"}) {
      inputs.push_back((directory / name).string());
    }
    CheckResultDirectory(line_.out, OutputKind::kPredictions, inputs);
  }

  static bool IsJob(const std::string& file) {
    return !IsUrKinematics(ReadYaml(file)) &&
           DetectFormat(file) == FileFormat::kJob;
  }

  // Data state their own sigmas or have the fit's.
  double DefaultSigma() const {
    return calibrated_ && calibrated_->sigma > 0.0 ? calibrated_->sigma
                                                   : kAnySigma;
  }

  void Compare(const std::string& file, std::vector<std::string>* checks) {
    if (!IsDataFile(file) && !IsJob(file)) {
      const Arm other = LoadArm(file);
      AddRow(file, CompareArms(arm_, other, kRandomPoses, seed_));
      AddRow(file + ", base and tool aligned",
             CompareArms(AlignedWith(arm_, other, seed_, line_.threads), other,
                         kRandomPoses, seed_));
      if (!calibrated_) return;
      const ArmCheck check =
          CheckAgainst(*calibrated_, other, kMapPoses, seed_);
      map_ = check.map;
      checks->push_back(FormatPredictionCheck(file, check.check));
      check_ = check.check;
      return;
    }
    Arm arm = arm_;
    CalibrationData data =
        LoadValidationData(file, refit_, DefaultSigma(), line_.threads, &arm);
    const CalibrationData stated = data;
    const Dataset& measured = stated.training;
    const bool has_references =
        data.references.num_points() > 0 || data.references.num_planes() > 0;
    const std::vector<std::string> unknown = UnknownReferences(data.references);
    std::string against = file;
    if (refit_.any()) against += ", " + refit_.Text() + " refitted";
    if (!unknown.empty()) against += "; " + JoinNames(unknown) + " found here";
    const Accuracy accuracy =
        ValidationAccuracy(file, arm, std::move(data), refit_, line_.threads);
    AddRow(against, accuracy);
    // Predictions are of the arm where it stood.
    if (!calibrated_ || refit_.any() || has_references) return;
    check_ = CheckAgainst(*calibrated_, measured, line_.threads);
    checks->push_back(FormatPredictionCheck(file, *check_));
    WarnIfFitted(file);
    if (check_->rms_z > kFarOff) WarnIfMoved(file, arm, stated, accuracy.rms);
  }

  // Whether the errors are those of an instrument or a tool that stands
  // elsewhere now, which is tried.
  void WarnIfMoved(const std::string& file, const Arm& arm,
                   const CalibrationData& data, double rms) const {
    const Eigen::Index poses = data.training.num_poses();
    if (poses < kFewestPoses || poses > kMostPoses) return;
    const std::vector<std::pair<const char*, const char*>> kCures = {
        {"base", "the instrument seems"},
        {"tool", "the tool or its target seems"},
        {"base,tool", "instrument and tool seem"}};
    for (const auto& [parts, what] : kCures) {
      const double refitted = RmsRefitted(file, arm, data, ReadRefit(parts));
      if (refitted * kFarOff > rms) continue;
      LOG(WARNING) << "warning: " << file << ": with --refit=" << parts
                   << " the errors are " << Millimetres(refitted)
                   << " mm (root mean square) and not " << Millimetres(rms)
                   << ": " << what
                   << " to be elsewhere than when the arm was calibrated";
      return;
    }
  }

  // Infinite where it cannot be done.
  double RmsRefitted(const std::string& file, const Arm& arm,
                     const CalibrationData& data, const Refit& refit) const {
    try {
      return ValidationAccuracy(file, arm, data, refit, line_.threads).rms;
    } catch (const InputError&) {
      return std::numeric_limits<double>::infinity();
    }
  }

  void WarnIfFitted(const std::string& file) const {
    const std::string hash = Sha256OfFile(file);
    for (const InputFile& input : calibrated_->inputs) {
      if (input.sha256 != hash) continue;
      LOG(WARNING) << "warning: " << file
                   << " is what the result was fitted to (" << input.path
                   << "): its errors say nothing of other poses";
      return;
    }
  }

  void AddRow(const std::string& file, const Accuracy& accuracy) {
    std::vector<TableCell> row = {file, CountCell(accuracy.n)};
    for (const double value :
         {accuracy.mean, accuracy.rms, accuracy.p95, accuracy.max}) {
      row.push_back(QuantityCell(value, Dimension::kLength, 4));
    }
    table_.AddRow(row);
  }

  void WriteFiles() const {
    if (!calibrated_) {
      throw InputError({line_.files.front(), 0, 0, ""},
                       "--out writes predictions, which need a result "
                       "directory of `calibrate` instead of an arm file");
    }
    PrintResults(WriteResultDirectory(
        line_.out, MakePredictionFiles(arm_, *map_, check_)));
  }

  const CommandLine& line_;
  const std::uint64_t seed_;
  const Refit refit_ = ReadRefit(line_.refit);
  Arm arm_;
  std::optional<CalibratedArm> calibrated_;
  std::optional<PredictedMap> map_;
  std::optional<PredictionCheck> check_;
  Table table_{
      {"against", ">poses", ">mean mm", ">rms mm", ">p95 mm", ">max mm"}};
};

}  // namespace

ExitStatus RunValidate(const CommandLine& line) {
  return line.check ? RunArmCheck(line) : Validation(line).Run();
}

}  // namespace alidade::internal
