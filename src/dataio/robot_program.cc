#include "src/dataio/robot_program.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <limits>

#include "alidade/units.h"
#include "src/common/characters.h"
#include "src/common/number_text.h"
#include "src/dataio/rotation_convention.h"

namespace alidade::internal {
namespace {

// A, B, C of KRL about z, y, x; W, P, R of Fanuc about fixed x, y, z: the same.
const RotationConvention kZyx = {false, true, {2, 1, 0}};
constexpr double kNoBound = std::numeric_limits<double>::infinity();
constexpr int kMostDecimals = 15;
// Axes whose quadrants cf1, cf4 and cf6 of RAPID state.
constexpr std::array kQuadrants = {0, 3, 5};

bool HasMillimetres(ProgramLanguage language) {
  return language != ProgramLanguage::kUrScript;
}

double LengthOf(ProgramLanguage language) {
  return HasMillimetres(language) ? kMillimetre : kMetre;
}

double AngleOf(ProgramLanguage language) {
  return HasMillimetres(language) ? kDegree : kRadian;
}

// rx, ry, rz (rad) of the numbers behind x, y, z.
Eigen::Vector3d TurnsOf(ProgramLanguage language, const ProgramTarget& target) {
  Eigen::Vector3d turns;
  for (int k = 0; k < 3; ++k) turns[k] = target.numbers[3 + k].value;
  turns *= AngleOf(language);
  if (language == ProgramLanguage::kKrl) std::swap(turns[0], turns[2]);
  return turns;
}

RotationConvention ConventionOf(ProgramLanguage language) {
  RotationConvention vector;
  vector.is_vector = true;
  return language == ProgramLanguage::kUrScript ? vector : kZyx;
}

// Decimals that a position is written with at least.
int FewestDecimals(ProgramLanguage language, const ProgramTarget& target,
                   std::size_t k) {
  switch (language) {
    case ProgramLanguage::kUrScript:
      return 6;
    case ProgramLanguage::kKrl:
      return target.is_joints || k >= 3 ? 4 : 3;
    case ProgramLanguage::kRapid:
      if (target.is_joints) return 4;
      return k >= 3 ? 6 : 2;
    case ProgramLanguage::kFanuc:
      break;
  }
  return 3;
}

struct Replacement {
  NumberSpan span;
  std::string text;
};

// Whether a number would become a part of the name before it.
bool RunsInto(const std::string& before, const std::string& number) {
  if (before.empty() || number.front() == '-') return false;
  return before.back() == '_' ||
         std::isalnum(static_cast<unsigned char>(before.back())) != 0;
}

// Fanuc's columns keep their width.
void Align(const std::string& text, Replacement* replacement) {
  NumberSpan& span = replacement->span;
  std::size_t begin = span.begin;
  while (begin > 0 && text[begin - 1] == ' ') --begin;
  const std::size_t spaces = span.begin - begin;
  if (spaces == 0) return;
  const std::size_t width = span.end - begin;
  const std::size_t size = std::max(width, replacement->text.size() + 1);
  replacement->text.insert(0, size - replacement->text.size(), ' ');
  span.begin = begin;
}

}  // namespace

bool IsWordCharacter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' ||
         c == '$';
}

std::optional<int> NumberSpan::Whole() const {
  constexpr double kMost = std::numeric_limits<int>::max();
  if (std::trunc(value) != value || std::abs(value) > kMost) return {};
  return static_cast<int>(value);
}

std::optional<ProgramLanguage> ProgramLanguageOf(const std::string& path) {
  const std::string ending =
      LowerCase(std::filesystem::path(path).extension().string());
  const auto is = [&](std::initializer_list<const char*> endings) {
    return std::any_of(endings.begin(), endings.end(),
                       [&](const char* e) { return ending == e; });
  };
  if (is({".script", ".urscript"})) return ProgramLanguage::kUrScript;
  if (is({".src", ".dat", ".sub"})) return ProgramLanguage::kKrl;
  if (is({".mod", ".modx", ".prg", ".sys"})) return ProgramLanguage::kRapid;
  if (is({".ls"})) return ProgramLanguage::kFanuc;
  return std::nullopt;
}

Eigen::Isometry3d PoseOf(ProgramLanguage language,
                         const ProgramTarget& target) {
  const auto& n = target.numbers;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() =
      LengthOf(language) * Eigen::Vector3d(n[0].value, n[1].value, n[2].value);
  pose.linear() =
      language == ProgramLanguage::kRapid
          ? Eigen::Quaterniond(n[3].value, n[4].value, n[5].value, n[6].value)
                .normalized()
                .toRotationMatrix()
          : RotationOf(ConventionOf(language), TurnsOf(language, target));
  return pose;
}

Eigen::VectorXd MotorsOf(ProgramLanguage language, const ProgramTarget& target,
                         const Arm& arm) {
  Eigen::VectorXd motors(arm.num_joints());
  for (int j = 0; j < arm.num_joints(); ++j) {
    const bool turns = arm.joints[j].type == JointType::kRevolute;
    motors[j] = target.numbers[j].value *
                (turns ? AngleOf(language) : LengthOf(language));
  }
  return motors;
}

std::vector<double> NumbersOfPose(ProgramLanguage language,
                                  const ProgramTarget& target,
                                  const Eigen::Isometry3d& pose) {
  std::vector<double> numbers;
  for (const double x : pose.translation()) {
    numbers.push_back(x / LengthOf(language));
  }
  if (language == ProgramLanguage::kRapid) {
    const Eigen::Quaterniond quaternion(pose.linear());
    Eigen::Vector4d q(quaternion.w(), quaternion.x(), quaternion.y(),
                      quaternion.z());
    double along = 0.0;
    for (int k = 0; k < 4; ++k) along += q[k] * target.numbers[3 + k].value;
    if (along < 0.0) q = -q;
    numbers.insert(numbers.end(), q.begin(), q.end());
    return numbers;
  }
  Eigen::Vector3d turns = NumbersOf(ConventionOf(language), pose.linear(),
                                    TurnsOf(language, target));
  if (language == ProgramLanguage::kKrl) std::swap(turns[0], turns[2]);
  for (const double turn : turns) numbers.push_back(turn / AngleOf(language));
  return numbers;
}

std::vector<double> NumbersOfMotors(ProgramLanguage language, const Arm& arm,
                                    const Eigen::VectorXd& motors) {
  std::vector<double> numbers;
  for (int j = 0; j < arm.num_joints(); ++j) {
    const bool turns = arm.joints[j].type == JointType::kRevolute;
    numbers.push_back(motors[j] /
                      (turns ? AngleOf(language) : LengthOf(language)));
  }
  return numbers;
}

Eigen::MatrixXd PostureBounds(ProgramLanguage language,
                              const ProgramTarget& target, int num_joints) {
  // Positions are rounded, and so is what the posture was read of.
  constexpr double kSlack = 0.1 * kDegree;
  Eigen::MatrixXd bounds(num_joints, 2);
  bounds.col(0).setConstant(-kNoBound);
  bounds.col(1).setConstant(kNoBound);
  if (target.posture.empty()) return bounds;
  if (language == ProgramLanguage::kKrl) {
    const auto turn =
        static_cast<unsigned>(target.posture[0].Whole().value_or(0));
    for (int j = 0; j < std::min(num_joints, 6); ++j) {
      const bool is_negative = ((turn >> j) & 1U) != 0;
      bounds(j, is_negative ? 1 : 0) = is_negative ? kSlack : -kSlack;
    }
  } else if (language == ProgramLanguage::kRapid && num_joints == 6) {
    for (std::size_t k = 0; k < kQuadrants.size(); ++k) {
      const double quadrant = target.posture[k].value * 90.0 * kDegree;
      bounds(kQuadrants[k], 0) = quadrant - kSlack;
      bounds(kQuadrants[k], 1) = quadrant + 90.0 * kDegree + kSlack;
    }
  }
  return bounds;
}

std::vector<int> StatedPosture(const ProgramTarget& target) {
  std::vector<int> posture;
  for (const NumberSpan& span : target.posture) {
    posture.push_back(span.Whole().value_or(0));
  }
  return posture;
}

std::vector<int> PostureOf(ProgramLanguage language,
                           const ProgramTarget& target,
                           const Eigen::VectorXd& motors) {
  // Joint values that are zero, or a quarter of a turn, but for rounding leave
  // what is written.
  constexpr double kSlack = 1e-4 * kDegree;
  std::vector<int> posture = StatedPosture(target);
  if (posture.empty()) return posture;
  if (language == ProgramLanguage::kKrl) {
    auto turn = static_cast<unsigned>(posture[0]);
    for (Eigen::Index j = 0; j < std::min<Eigen::Index>(motors.size(), 6);
         ++j) {
      const unsigned bit = 1U << static_cast<unsigned>(j);
      if (motors[j] < -kSlack) turn |= bit;
      if (motors[j] > kSlack) turn &= ~bit;
    }
    posture[0] = static_cast<int>(turn);
  } else if (language == ProgramLanguage::kRapid && motors.size() == 6) {
    for (std::size_t k = 0; k < kQuadrants.size(); ++k) {
      const double quarters = motors[kQuadrants[k]] / (90.0 * kDegree);
      const double low = std::floor(quarters - kSlack);
      const double high = std::floor(quarters + kSlack);
      if (low == high) posture[k] = static_cast<int>(low);
    }
  }
  return posture;
}

std::string PostureText(ProgramLanguage language,
                        const std::vector<int>& posture) {
  if (language == ProgramLanguage::kKrl) {
    return "T " + std::to_string(posture[0]);
  }
  std::string text;
  for (const int quadrant : posture) {
    text += (text.empty() ? "[" : ",") + std::to_string(quadrant);
  }
  return text + "]";
}

std::string PostureMeaning(ProgramLanguage language,
                           const std::vector<int>& posture, int num_joints) {
  std::string text;
  const auto add = [&](const std::string& part) {
    text += (text.empty() ? "" : ", ") + part;
  };
  if (language == ProgramLanguage::kKrl) {
    const auto turn = static_cast<unsigned>(posture[0]);
    for (int j = 0; j < std::min(num_joints, 6); ++j) {
      const bool is_negative = ((turn >> j) & 1U) != 0;
      add("A" + std::to_string(j + 1) + (is_negative ? " < 0" : " >= 0"));
    }
    return text;
  }
  for (std::size_t k = 0; k < std::min(posture.size(), kQuadrants.size());
       ++k) {
    add("axis " + std::to_string(kQuadrants[k] + 1) + " between " +
        std::to_string(90 * posture[k]) + " and " +
        std::to_string(90 * (posture[k] + 1)) + " deg");
  }
  return text;
}

std::vector<std::string> RewriteProgram(
    const RobotProgram& program, const std::vector<ProgramValues>& values) {
  std::vector<Replacement> replacements;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const ProgramTarget& target = program.targets[i];
    for (std::size_t k = 0; k < values[i].numbers.size(); ++k) {
      const NumberSpan& span = target.numbers[k];
      const int decimals =
          std::clamp(span.decimals, FewestDecimals(program.language, target, k),
                     kMostDecimals);
      replacements.push_back(
          {span, FixedNumber(values[i].numbers[k], decimals)});
      if (program.language != ProgramLanguage::kFanuc) continue;
      Align(program.text, &replacements.back());
    }
    for (std::size_t k = 0; k < values[i].posture.size(); ++k) {
      replacements.push_back(
          {target.posture[k], std::to_string(values[i].posture[k])});
    }
  }
  std::sort(replacements.begin(), replacements.end(),
            [](const Replacement& a, const Replacement& b) {
              return a.span.begin < b.span.begin;
            });
  std::vector<std::string> texts;
  auto replacement = replacements.begin();
  for (std::size_t k = 0; k < program.files.size(); ++k) {
    const bool is_last = k + 1 == program.files.size();
    const std::size_t end =
        is_last ? program.text.size() : program.files[k + 1].begin - 1;
    std::string text;
    std::size_t from = program.files[k].begin;
    for (; replacement != replacements.end() && replacement->span.end <= end;
         ++replacement) {
      text += program.text.substr(from, replacement->span.begin - from);
      if (RunsInto(text, replacement->text)) text += ' ';
      text += replacement->text;
      from = replacement->span.end;
    }
    texts.push_back(text + program.text.substr(from, end - from));
  }
  return texts;
}

}  // namespace alidade::internal
