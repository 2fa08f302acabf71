#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>

#include "alidade/arm_file.h"
#include "alidade/dataset_file.h"
#include "alidade/error.h"
#include "alidade/rotation.h"
#include "alidade/units.h"
#include "src/cli/command.h"
#include "src/common/format.h"
#include "src/report/error_term_tables.h"
#include "src/report/report.h"
#include "src/report/table.h"
#include "src/serialization/config_file.h"
#include "src/serialization/job_config.h"
#include "src/serialization/result_json.h"

namespace alidade::internal {
namespace {

constexpr Eigen::Index kRowsShown = 20;

std::string FormatLimits(const Joint& joint) {
  if (!std::isfinite(joint.lower) && !std::isfinite(joint.upper)) return "none";
  return InUnit(joint.lower, joint.dimension(), 6) + " .. " +
         InUnit(joint.upper, joint.dimension(), 6);
}

// A frame in another one: its origin, and the rotation vector of its axes.
void AddFrame(const std::string& name, const Eigen::Isometry3d& frame,
              Table* table) {
  std::vector<TableCell> row = {name};
  for (const double coordinate : frame.translation()) {
    row.push_back(QuantityCell(coordinate, Dimension::kLength, 8));
  }
  const Eigen::Vector3d turn = VectorFromRotation<double>(frame.linear());
  for (const double angle : turn) {
    row.push_back(QuantityCell(angle, Dimension::kAngle, 8));
  }
  table->AddRow(row);
}

void ShowFrames(const Arm& arm) {
  Table table(
      {"frame", ">x mm", ">y mm", ">z mm", ">wx deg", ">wy deg", ">wz deg"});
  AddFrame("base in the instrument's", arm.instrument_from_base, &table);
  for (const Target& target : arm.targets) {
    const std::string name = target.name.empty() ? "tool" : target.name;
    AddFrame(name + " in the flange's", target.last_from_target, &table);
  }
  std::cout << table.ToText();
}

void ShowArm(const Arm& arm) {
  constexpr Dimension kLength = Dimension::kLength;
  constexpr Dimension kAngle = Dimension::kAngle;
  Table table({"joint", "type", ">beta deg", ">alpha deg", ">d mm",
               ">theta deg", ">r mm", "limits"});
  int number = 0;
  for (const Joint& joint : arm.joints) {
    table.AddRow({CountCell(++number),
                  joint.type == JointType::kRevolute ? "revolute" : "prismatic",
                  QuantityCell(joint.beta, kAngle, 8),
                  QuantityCell(joint.alpha, kAngle, 8),
                  QuantityCell(joint.d, kLength, 8),
                  QuantityCell(joint.theta, kAngle, 8),
                  QuantityCell(joint.r, kLength, 8), FormatLimits(joint)});
  }
  std::cout << arm.name << "\n" << table.ToText() << "\n";
  ShowFrames(arm);
  std::cout << FormatArmErrors(arm);
  if (HasMotorMap(arm)) {
    std::cout << "data state the motors' values, which the arm file's "
                 "`motors` turn into joint values\n";
  }
}

// Coordinates of the first target, 3 x poses (m); NaN where not measured.
Eigen::Matrix3Xd Positions(const Dataset& data) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Eigen::Matrix3Xd positions =
      Eigen::Matrix3Xd::Constant(3, data.num_poses(), nan);
  for (const ObservationBlock& block : data.blocks) {
    if (!HoldsPosition(block.kind)) continue;
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      if (block.target(i) != 0) continue;
      for (int axis = 0; axis < 3; ++axis) {
        if (std::isinf(block.sigmas(axis, i))) continue;
        positions(axis, block.pose(i)) = block.measured(axis, i);
      }
    }
  }
  return positions;
}

void ShowDataset(const Arm& arm, const Dataset& data) {
  const Eigen::Matrix3Xd positions = Positions(data);
  const std::vector<Dimension> joints = arm.JointDimensions();
  std::vector<Table::Column> columns = {">pose"};
  for (std::size_t j = 0; j < joints.size(); ++j) {
    columns.emplace_back(">q" + std::to_string(j + 1) + " " +
                         UnitForPeople(joints[j]));
  }
  columns.insert(columns.end(), {">x mm", ">y mm", ">z mm"});
  Table table(columns);
  const Eigen::Index shown = std::min(kRowsShown, data.num_poses());
  for (Eigen::Index i = 0; i < shown; ++i) {
    std::vector<TableCell> row = {CountCell(i + 1)};
    for (std::size_t j = 0; j < joints.size(); ++j) {
      row.push_back(QuantityCell(
          data.joint_values(static_cast<Eigen::Index>(j), i), joints[j], 7));
    }
    for (const double coordinate : positions.col(i)) {
      row.push_back(std::isnan(coordinate)
                        ? "-"
                        : QuantityCell(coordinate, Dimension::kLength, 7));
    }
    table.AddRow(row);
  }
  std::cout << data.name << ": " << data.num_poses() << " poses of " << arm.name
            << "\n"
            << table.ToText();
  if (shown < data.num_poses()) {
    std::cout << "... and " << data.num_poses() - shown << " more\n";
  }
}

void ShowJob(const std::string& path, int num_threads) {
  const JobConfig config = LoadJob(path, num_threads);
  std::cout << config.title << "\n\n";
  if (config.data.validation) {
    std::cout << "left out of the fit: " << config.data.validation->num_poses()
              << " poses\n\n";
  }
  ShowArm(config.arm);
  std::cout << "\n";
  ShowDataset(config.arm, config.data.training);
}

void ShowResult(const std::string& path) {
  CalibrationResult result = LoadResultJson(path);
  const auto arm = std::filesystem::path(path).parent_path() / "arm.yaml";
  if (std::filesystem::exists(arm)) result.arm = LoadArm(arm.string());
  std::cout << result.title << "\n\n"
            << FormatAccuracyTable(result) << "\n"
            << FormatParameters(result);
  const std::string errors = ErrorTermsSection(result);
  if (!errors.empty()) std::cout << "\n" << errors;
}

}  // namespace

ExitStatus RunShow(const CommandLine& line) {
  namespace fs = std::filesystem;
  std::string path = line.files.front();
  if (fs::is_directory(path)) {
    const fs::path result = fs::path(path) / "result.json";
    if (!fs::exists(result)) {
      throw InputError({path, 0, 0, ""},
                       "has no result.json, expected a result directory of "
                       "`calibrate`");
    }
    path = result.string();
  }
  if (fs::path(path).extension() == ".json") {
    ShowResult(path);
  } else if (IsDataFile(path)) {
    throw InputError({path, 0, 0, ""},
                     "a data set is shown with its arm: alidade show ARM.yaml "
                     "DATA.csv");
  } else if (DetectFormat(path) == FileFormat::kJob) {
    ShowJob(path, line.threads);
  } else if (line.files.size() == 1) {
    ShowArm(LoadArm(path));
  } else {
    const Arm arm = LoadArm(path);
    ShowDataset(arm,
                LoadDataset(line.files[1], arm, kMillimetre, line.threads));
  }
  return kExitDone;
}

}  // namespace alidade::internal
