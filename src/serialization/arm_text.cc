#include <array>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "alidade/arm_file.h"
#include "src/common/names.h"
#include "src/common/numbers.h"
#include "src/common/text.h"
#include "src/serialization/arm_errors.h"
#include "src/serialization/arm_fields.h"

namespace alidade {
namespace internal {
namespace {

// "90 deg", for people: -0 is 0.
std::string Readable(double value, Dimension dimension) {
  const bool is_angle = dimension == Dimension::kAngle;
  std::array<char, 64> text;
  std::snprintf(text.data(), text.size(), "%.6g %s",
                value / (is_angle ? kDegree : kMillimetre) + 0.0,
                is_angle ? "deg" : "mm");
  return text.data();
}

// Writes the quantities of a map, each on a line of its own.
class QuantityWriter {
 public:
  static constexpr bool kReads = false;

  explicit QuantityWriter(const char* indent) : indent_(indent) {}

  void Field(const Key& key, double value, const char* /*text*/) {
    text_ += indent_ + key.name + ": " + FormatShifted(value, 0) + "  # " +
             Readable(value, *key.dimension) + "\n";
  }
  const std::string& text() const { return text_; }

 private:
  const std::string indent_;
  std::string text_;
};

std::string FormatLimit(double limit) {
  if (std::isinf(limit)) return limit < 0.0 ? "-.inf" : ".inf";
  return ShortestNumber(limit);
}

std::string FormatComment(const std::string& comment) {
  std::string text;
  std::istringstream lines(comment);
  for (std::string line; std::getline(lines, line);) {
    text += line.empty() ? "#\n" : "# " + OneLine(line) + "\n";
  }
  return text;
}

std::string FormatJoint(const Joint& joint, int number) {
  QuantityWriter writer("    ");
  VisitKhalil(writer, joint);
  std::string text = std::string("  - type: ") + WordOf(joint.type) +
                     "  # joint " + std::to_string(number) + "\n" +
                     writer.text();
  if (std::isinf(joint.lower) && std::isinf(joint.upper)) return text;
  const Dimension dimension = joint.dimension();
  return text + "    limits: [" + FormatLimit(joint.lower) + ", " +
         FormatLimit(joint.upper) + "]  # " + Readable(joint.lower, dimension) +
         " to " + Readable(joint.upper, dimension) + "\n";
}

std::string FormatRow(const Eigen::VectorXd& values) {
  std::string text;
  for (const double value : values) {
    text += (text.empty() ? "[" : ", ") + ShortestNumber(value);
  }
  return text + "]";
}

std::string FormatMotors(const Arm& arm) {
  std::string text;
  if (arm.joints_from_motors.size() > 0) {
    text += "  matrix:\n";
    for (const auto& row : arm.joints_from_motors.rowwise()) {
      text += "    - " + FormatRow(row.transpose()) + "\n";
    }
  }
  if (arm.motor_offsets.size() > 0) {
    text += "  offset: " + FormatRow(arm.motor_offsets) + "\n";
  }
  return text.empty() ? text : "motors:\n" + text;
}

std::string FormatFrame(const char* indent, const Eigen::Isometry3d& frame) {
  const FrameNumbers numbers = {frame.translation(),
                                VectorFromRotation(frame.linear())};
  QuantityWriter writer(indent);
  VisitFrame(writer, numbers);
  return writer.text();
}

std::string FormatFrame(const std::string& key,
                        const Eigen::Isometry3d& frame) {
  const bool is_identity = frame.matrix() == Eigen::Matrix4d::Identity();
  return is_identity ? "" : key + ":\n" + FormatFrame("  ", frame);
}

std::string FormatTargets(const Arm& arm) {
  if (arm.num_targets() == 1 && arm.targets[0].name.empty()) {
    return FormatFrame(std::string("tool"), arm.last_from_target());
  }
  std::string text = "targets:\n";
  for (const Target& target : arm.targets) {
    text += "  - name: " + QuoteYaml(target.name) + "\n" +
            FormatFrame("    ", target.last_from_target);
  }
  return text;
}

}  // namespace
}  // namespace internal

std::string FormatArm(const Arm& arm, const std::string& comment) {
  std::string text =
      internal::FormatComment(comment) +
      "format: alidade-arm-1\nname: " + internal::QuoteYaml(arm.name) +
      "\nunits: {length: m, angle: rad}\njoints:\n";
  int number = 0;
  for (const Joint& joint : arm.joints) {
    text += internal::FormatJoint(joint, ++number);
  }
  return text + internal::FormatMotors(arm) +
         internal::FormatErrors(arm.errors) +
         internal::FormatFrame(std::string("base"), arm.instrument_from_base) +
         internal::FormatTargets(arm);
}

}  // namespace alidade
