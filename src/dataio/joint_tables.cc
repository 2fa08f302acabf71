#include "src/dataio/joint_tables.h"

#include <utility>

#include "alidade/rotation.h"
#include "alidade/units.h"
#include "src/common/number_text.h"
#include "src/common/text.h"
#include "src/common/yaml_text.h"

namespace alidade::internal {
namespace {

JointTable MakeTable(const Arm& arm, std::string convention,
                     std::vector<std::string> keys) {
  JointTable table{arm.name, std::move(convention), std::move(keys), {}, {}};
  for (const Joint& joint : arm.joints) {
    table.is_prismatic.push_back(joint.type == JointType::kPrismatic);
  }
  return table;
}

// An offset is in the unit of its joint.
bool IsLength(const JointTable& table, std::size_t row,
              const std::string& key) {
  return key == "d" || key == "a" ||
         (key == "offset" && table.is_prismatic[row]);
}

const char* TypeOf(const JointTable& table, std::size_t row) {
  return table.is_prismatic[row] ? "prismatic" : "revolute";
}

std::string Frame(const char* name, const Eigen::Isometry3d& frame) {
  if (frame.isApprox(Eigen::Isometry3d::Identity(), 1e-15)) return "";
  const Eigen::Matrix3d rotation = frame.linear();
  const Eigen::Vector3d turn = VectorFromRotation(rotation);
  const char* const axes = "xyz";
  std::string text = std::string(name) + ": {";
  for (int k = 0; k < 3; ++k) {
    text += std::string(1, axes[k]) + ": " +
            ShortestNumber(frame.translation()[k] / kMillimetre) + ", ";
  }
  for (int k = 0; k < 3; ++k) {
    text += std::string("r") + axes[k] + ": " +
            ShortestNumber(turn[k] / kDegree) + (k < 2 ? ", " : "}\n");
  }
  return text;
}

}  // namespace

JointTable StandardTable(const Arm& arm, double last_a, double last_alpha) {
  JointTable table = MakeTable(arm, "standard", {"theta", "d", "a", "alpha"});
  for (int j = 0; j < arm.num_joints(); ++j) {
    const bool is_last = j + 1 == arm.num_joints();
    const double a = is_last ? last_a : arm.joints[j + 1].d;
    const double alpha = is_last ? last_alpha : arm.joints[j + 1].alpha;
    table.rows.push_back({arm.joints[j].theta / kDegree,
                          arm.joints[j].r / kMillimetre, a / kMillimetre,
                          alpha / kDegree});
  }
  return table;
}

JointTable CraigTable(const Arm& arm) {
  JointTable table = MakeTable(arm, "craig", {"alpha", "a", "theta", "d"});
  for (const Joint& joint : arm.joints) {
    table.rows.push_back({joint.alpha / kDegree, joint.d / kMillimetre,
                          joint.theta / kDegree, joint.r / kMillimetre});
  }
  return table;
}

JointTable OffsetTable(const Arm& nominal, const Arm& real) {
  JointTable table = MakeTable(nominal, "", {"offset"});
  for (int j = 0; j < nominal.num_joints(); ++j) {
    const Joint& from = nominal.joints[j];
    const Joint& to = real.joints[j];
    table.rows.push_back({table.is_prismatic[j]
                              ? (to.r - from.r) / kMillimetre
                              : (to.theta - from.theta) / kDegree});
  }
  return table;
}

std::string FormatCsv(const JointTable& table) {
  std::string text = "joint,type";
  for (const std::string& key : table.keys) {
    text += "," + key;
    if (key != "offset") text += key == "d" || key == "a" ? "_mm" : "_deg";
  }
  text += table.convention.empty() ? ",unit\n" : "\n";
  for (std::size_t j = 0; j < table.rows.size(); ++j) {
    text += std::to_string(j + 1) + "," + TypeOf(table, j);
    for (const double value : table.rows[j]) {
      text += "," + ShortestNumber(value);
    }
    if (table.convention.empty()) {
      text += table.is_prismatic[j] ? ",mm" : ",deg";
    }
    text += "\n";
  }
  return text;
}

std::string FormatLatex(const JointTable& table) {
  std::string text =
      "\\begin{tabular}{r" + std::string(table.keys.size(), 'r') + "}\n$j$";
  for (const std::string& key : table.keys) {
    const bool is_greek = key == "theta" || key == "alpha";
    text += " & $" + std::string(is_greek ? "\\" : "") + key + "_j$";
    if (key != "offset") text += IsLength(table, 0, key) ? " [mm]" : " [deg]";
  }
  text += " \\\\ \\hline\n";
  for (std::size_t j = 0; j < table.rows.size(); ++j) {
    text += std::to_string(j + 1);
    for (std::size_t k = 0; k < table.keys.size(); ++k) {
      text += " & " + FixedNumber(table.rows[j][k], 6);
    }
    text += " \\\\\n";
  }
  return text + "\\end{tabular}\n";
}

std::string FormatYaml(const JointTable& table, const Arm& arm) {
  const bool is_arm = !table.convention.empty();
  std::string text;
  if (is_arm) {
    text = "format: alidade-arm-1\nname: " + QuotedYaml(table.name) +
           "\nconvention: " + table.convention + "\n";
  }
  text += "units: {length: mm, angle: deg}\njoints:\n";
  for (std::size_t j = 0; j < table.rows.size(); ++j) {
    text += std::string("  - {type: ") + TypeOf(table, j);
    for (std::size_t k = 0; k < table.keys.size(); ++k) {
      text += ", " + table.keys[k] + ": " + ShortestNumber(table.rows[j][k]);
    }
    const Joint& joint = arm.joints[j];
    if (is_arm && HasLimits(joint)) {
      const double unit = table.is_prismatic[j] ? kMillimetre : kDegree;
      text += ", limits: [" + ShortestNumber(joint.lower / unit) + ", " +
              ShortestNumber(joint.upper / unit) + "]";
    }
    text += "}\n";
  }
  if (!is_arm) return text;
  return text + Frame("base", arm.instrument_from_base) +
         Frame("tool", arm.last_from_target());
}

}  // namespace alidade::internal
