#include "src/serialization/arm_errors.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdio>

#include "src/common/number_text.h"

namespace alidade::internal {
namespace {

template <typename Numbers>
std::string FormatList(const Numbers& numbers) {
  std::string text;
  for (const double number : numbers) {
    text += (text.empty() ? "[" : ", ") + ShortestNumber(number);
  }
  return text.empty() ? "[]" : text + "]";
}

std::string FormatLoad(const Load& load) {
  return fmt::format("{{mass: {}, centre: {}}}", ShortestNumber(load.mass),
                     FormatList(load.centre));
}

// Whether loads are others than those that arm files have by default.
bool HasLoads(const ErrorTerms& errors) {
  const ErrorTerms by_default;
  return !errors.links.empty() ||
         errors.payload.mass != by_default.payload.mass ||
         errors.payload.centre != by_default.payload.centre ||
         errors.gravity != by_default.gravity;
}

std::string FormatFunction(const JointFunction& function) {
  std::string text = fmt::format(
      "      function:\n        first: {}\n        spacing: {}\n"
      "        values: {}\n",
      ShortestNumber(function.first), ShortestNumber(function.spacing),
      FormatList(function.values));
  if (function.is_periodic) text += "        periodic: true\n";
  if (function.deviations.size() > 0) {
    text += "        deviations: " + FormatList(function.deviations) + "\n";
  }
  return text;
}

std::string FormatJoint(const JointErrors& joint, int number) {
  std::string text =
      fmt::format("    - compliance: {}  # joint {}, rad / (N m)\n",
                  FormatList(joint.compliance), number);
  if (!joint.function.empty()) text += FormatFunction(joint.function);
  if (!joint.harmonics.empty()) {
    text += "      harmonics:\n";
    for (const auto& [cycles, cosine, sine] : joint.harmonics) {
      text += "        - " + FormatList(Eigen::Vector3d(cycles, cosine, sine)) +
              "\n";
    }
  }
  if (joint.backlash != 0.0) {
    text += "      backlash: " + ShortestNumber(joint.backlash) + "\n";
  }
  return text;
}

}  // namespace

std::string QuoteYaml(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      std::array<char, 8> escape;
      std::snprintf(escape.data(), escape.size(), "\\x%02x",
                    static_cast<unsigned>(c));
      quoted += escape.data();
    } else {
      if (c == '"' || c == '\\') quoted += '\\';
      quoted += c;
    }
  }
  return quoted + "\"";
}

std::vector<double> ReadQuantities(const YamlValue& value, Dimension dimension,
                                   const Units& units) {
  std::vector<double> all;
  for (const YamlValue& item : value.List()) {
    all.push_back(item.Quantity(dimension, units));
  }
  return all;
}

std::vector<Harmonic> ReadHarmonics(const YamlValue& value,
                                    const Units& units) {
  std::vector<Harmonic> harmonics;
  for (const YamlValue& item : value.List()) {
    const std::vector<YamlValue> numbers =
        item.List(3, "cycles per turn, cosine, sine");
    Harmonic harmonic;
    harmonic.cycles = ReadNumber(numbers[0], Key("cycles").Above(0), units);
    harmonic.cosine = numbers[1].Quantity(Dimension::kAngle, units);
    harmonic.sine = numbers[2].Quantity(Dimension::kAngle, units);
    harmonics.push_back(harmonic);
  }
  return harmonics;
}

Eigen::MatrixXd ReadCouplingMatrix(const YamlValue& value, const Units& units,
                                   const Arm& arm) {
  const int n = arm.num_joints();
  Eigen::MatrixXd matrix(n, n);
  const std::vector<YamlValue> rows = value.List(n, "one row per joint");
  for (int i = 0; i < n; ++i) {
    const std::vector<YamlValue> row = rows[i].List(n, "one entry per joint");
    for (int j = 0; j < n; ++j) {
      const Dimension to = arm.joints[i].dimension();
      const Dimension from = arm.joints[j].dimension();
      matrix(i, j) = row[j].Number();
      if (to != from) {
        matrix(i, j) *= units.Of(to).InSi() / units.Of(from).InSi();
      }
    }
  }
  return matrix;
}

void CheckErrors(const YamlMap& map, const Arm& arm) {
  constexpr double kRounding = 1e-6;  // rad
  const ErrorTerms& errors = arm.errors;
  const std::size_t num_joints = arm.joints.size();
  const auto check_count = [&](const char* key, std::size_t count) {
    if (count == 0 || count == num_joints) return;
    map.Required(key).Fail("expected one per joint, " +
                           std::to_string(num_joints) + ", found " +
                           std::to_string(count));
  };
  check_count("joints", errors.joints.size());
  check_count("links", errors.links.size());
  for (std::size_t j = 0; j < errors.joints.size(); ++j) {
    const JointFunction& function = errors.joints[j].function;
    if (function.empty()) continue;
    const YamlValue joint = map.Required("joints").List()[j];
    if (!(function.spacing > 0.0)) {
      joint.Fail("the spacing of its function's knots must be above 0");
    }
    const double turn =
        function.spacing * static_cast<double>(function.values.size());
    if (function.is_periodic && (arm.joints[j].type == JointType::kPrismatic ||
                                 !(std::abs(turn - 2.0 * M_PI) < kRounding))) {
      joint.Fail(
          "a periodic function is of a revolute joint, and its spacing times "
          "its number of values is a turn");
    }
    const Eigen::Index deviations = function.deviations.size();
    if (deviations > 0 && deviations != function.values.size()) {
      joint.Fail(fmt::format(
          "its function has {} values and {} deviations, expected as many",
          function.values.size(), deviations));
    }
  }
}

std::string FormatErrors(const ErrorTerms& errors) {
  if (errors.empty() && !HasLoads(errors)) return "";
  std::string text = "errors:\n  gravity: " + FormatList(errors.gravity) + "\n";
  if (!errors.links.empty()) {
    text += "  links:\n";
    for (const Load& load : errors.links) {
      text += "    - " + FormatLoad(load) + "\n";
    }
  }
  text += "  payload: " + FormatLoad(errors.payload) + "\n";
  if (!errors.joints.empty()) {
    text += "  joints:\n";
    int number = 0;
    for (const JointErrors& joint : errors.joints) {
      text += FormatJoint(joint, ++number);
    }
  }
  if (errors.coupling.size() > 0) {
    text += "  coupling:\n";
    for (const auto& row : errors.coupling.rowwise()) {
      text += "    - " + FormatList(row.eval()) + "\n";
    }
  }
  if (!errors.covariates.empty()) text += "  covariates:\n";
  for (const CovariateEffect& effect : errors.covariates) {
    text += fmt::format(
        "    - name: {}\n      reference: {}\n      move: {}\n      turn: {}\n",
        QuoteYaml(effect.name), ShortestNumber(effect.reference),
        FormatList(Eigen::Vector3d(effect.base.head<3>())),
        FormatList(Eigen::Vector3d(effect.base.tail<3>())));
    if (effect.joints.size() > 0) {
      text += "      joints: " + FormatList(effect.joints) + "\n";
    }
    if (!effect.target.isZero(0.0)) {
      text += fmt::format("      target_move: {}\n      target_turn: {}\n",
                          FormatList(Eigen::Vector3d(effect.target.head<3>())),
                          FormatList(Eigen::Vector3d(effect.target.tail<3>())));
    }
    if (effect.payload != 0.0) {
      text += "      payload: " + ShortestNumber(effect.payload) + "\n";
    }
  }
  return text;
}

}  // namespace alidade::internal
