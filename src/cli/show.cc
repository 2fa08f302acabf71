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
#include "src/common/text_table.h"
#include "src/dataio/dataset_csv.h"
#include "src/report/report.h"
#include "src/serialization/config_file.h"
#include "src/serialization/job_file.h"
#include "src/serialization/result_json.h"
#include "src/simulation/simulation.h"

namespace alidade::internal {
namespace {

using Align = TextTable::Align;

constexpr Eigen::Index kRowsShown = 20;

double UnitOf(const Joint& joint) {
  return joint.type == JointType::kRevolute ? kDegree : kMillimetre;
}

std::string FormatLimits(const Joint& joint) {
  if (!std::isfinite(joint.lower) && !std::isfinite(joint.upper)) return "none";
  return FormatSignificant(joint.lower / UnitOf(joint), 6) + " .. " +
         FormatSignificant(joint.upper / UnitOf(joint), 6);
}

// A frame in another one: its origin, and the rotation vector of its axes.
void AddFrame(const std::string& name, const Eigen::Isometry3d& frame,
              TextTable* table) {
  std::vector<std::string> row = {name};
  for (const double coordinate : frame.translation()) {
    row.push_back(FormatSignificant(coordinate / kMillimetre, 8));
  }
  const Eigen::Vector3d turn = VectorFromRotation<double>(frame.linear());
  for (const double angle : turn) {
    row.push_back(FormatSignificant(angle / kDegree, 8));
  }
  table->AddRow(row);
}

void ShowFrames(const Arm& arm) {
  TextTable table({{"frame"},
                   {"x mm", Align::kRight},
                   {"y mm", Align::kRight},
                   {"z mm", Align::kRight},
                   {"wx deg", Align::kRight},
                   {"wy deg", Align::kRight},
                   {"wz deg", Align::kRight}});
  AddFrame("base in the instrument's", arm.instrument_from_base, &table);
  for (const Target& target : arm.targets) {
    const std::string name = target.name.empty() ? "tool" : target.name;
    AddFrame(name + " in the flange's", target.last_from_target, &table);
  }
  std::cout << table.ToString();
}

void ShowArm(const Arm& arm) {
  TextTable table({{"joint"},
                   {"type"},
                   {"beta deg", Align::kRight},
                   {"alpha deg", Align::kRight},
                   {"d mm", Align::kRight},
                   {"theta deg", Align::kRight},
                   {"r mm", Align::kRight},
                   {"limits"}});
  for (int j = 0; j < arm.num_joints(); ++j) {
    const Joint& joint = arm.joints[j];
    const bool revolute = joint.type == JointType::kRevolute;
    table.AddRow({std::to_string(j + 1), revolute ? "revolute" : "prismatic",
                  FormatSignificant(joint.beta / kDegree, 8),
                  FormatSignificant(joint.alpha / kDegree, 8),
                  FormatSignificant(joint.d / kMillimetre, 8),
                  FormatSignificant(joint.theta / kDegree, 8),
                  FormatSignificant(joint.r / kMillimetre, 8),
                  FormatLimits(joint)});
  }
  std::cout << arm.name << "\n" << table.ToString() << "\n";
  ShowFrames(arm);
  if (HasMotorMap(arm)) {
    std::cout << "data state the motors' values, which the arm file's "
                 "`motors` turn into joint values\n";
  }
}

TextTable DatasetTable(const Arm& arm) {
  std::vector<TextTable::Column> columns = {{"pose", Align::kRight}};
  for (int j = 0; j < arm.num_joints(); ++j) {
    const bool revolute = arm.joints[j].type == JointType::kRevolute;
    columns.push_back(
        {"q" + std::to_string(j + 1) + (revolute ? " deg" : " mm"),
         Align::kRight});
  }
  for (const char* axis : {"x mm", "y mm", "z mm"}) {
    columns.push_back({axis, Align::kRight});
  }
  return TextTable(columns);
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
  TextTable table = DatasetTable(arm);
  const Eigen::Index shown = std::min(kRowsShown, data.num_poses());
  for (Eigen::Index i = 0; i < shown; ++i) {
    std::vector<std::string> row = {std::to_string(i + 1)};
    for (int j = 0; j < arm.num_joints(); ++j) {
      row.push_back(FormatSignificant(
          data.joint_values(j, i) / UnitOf(arm.joints[j]), 7));
    }
    for (int axis = 0; axis < 3; ++axis) {
      const double coordinate = positions(axis, i) / kMillimetre;
      row.push_back(std::isnan(coordinate) ? "-"
                                           : FormatSignificant(coordinate, 7));
    }
    table.AddRow(row);
  }
  std::cout << data.name << ": " << data.num_poses() << " poses of " << arm.name
            << "\n"
            << table.ToString();
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
  const CalibrationResult result = LoadResultJson(path);
  std::cout << result.title << "\n\n"
            << FormatAccuracyTable(result) << "\n"
            << FormatParameters(result);
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
