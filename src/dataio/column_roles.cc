#include "src/dataio/column_roles.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <map>
#include <string_view>

#include "alidade/error.h"
#include "src/common/characters.h"
#include "src/common/names.h"
#include "src/common/numbers.h"
#include "src/common/yaml_text.h"
#include "src/dataio/csv_columns.h"

namespace alidade::internal {
namespace {

using Words = std::vector<std::string>;

bool IsOneOf(const std::string& word,
             std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

bool HasOneOf(const Words& words,
              std::initializer_list<std::string_view> some) {
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
    return IsOneOf(word, some);
  });
}

// "actual", "q", "0" of "actual_q0 [rad]": runs of letters and of digits, and
// what "TargetPosX" has of words.
Words WordsOf(std::string_view name) {
  Words words;
  char before = ' ';
  for (const char c : WithoutUnit(name)) {
    const bool is_upper = c >= 'A' && c <= 'Z';
    const bool is_letter =
        is_upper || (c >= 'a' && c <= 'z') || (c & 0x80) != 0;
    if (!is_letter && !IsDigit(c)) {
      before = ' ';
      continue;
    }
    const bool was_lower = before >= 'a' && before <= 'z';
    const bool begins = before == ' ' || IsDigit(c) != IsDigit(before) ||
                        (is_upper && was_lower);
    if (begins) words.emplace_back();
    words.back() += static_cast<char>(is_upper ? c | 0x20 : c);
    before = c;
  }
  return words;
}

bool IsJointWord(const std::string& word) {
  return IsOneOf(word, {"q", "j", "a", "joint", "axis", "axes", "theta",
                        "motor", "jnt", "ax", "achse", "gelenk", "th"});
}

// What is beside the measured value in exports.
bool IsOther(const Words& words) {
  return HasOneOf(words, {"nominal",   "nom",     "cmd",         "command",
                          "commanded", "desired", "set",         "setpoint",
                          "std",       "sigma",   "stddev",      "dev",
                          "deviation", "delta",   "d",           "err",
                          "error",     "rms",     "uncertainty", "residual",
                          "velocity",  "vel",     "speed",       "torque",
                          "current",   "temp",    "temperature", "u",
                          "du",        "diff",    "difference"});
}

bool IsRotation(const Words& words) {
  return HasOneOf(words, {"rotation", "rot", "orientation", "quaternion",
                          "quat", "r", "angle"});
}

// 1 to 6 of Universal Robots' names; -1 where it is none of them.
int NamedJointOf(const Words& words) {
  Words name;
  for (const std::string& word : words) {
    const bool is_filler =
        IsOneOf(word, {"joint", "angle", "actual", "act", "measured", "meas",
                       "q", "pos", "position", "axis"});
    if (!is_filler) name.push_back(word);
  }
  if (name.size() == 1) {
    constexpr std::array<std::string_view, 3> kFirst = {"base", "shoulder",
                                                        "elbow"};
    const auto found = std::find(kFirst.begin(), kFirst.end(), name[0]);
    return found == kFirst.end() ? -1
                                 : static_cast<int>(found - kFirst.begin()) + 1;
  }
  if (name.size() != 2 || name[0] != "wrist") return -1;
  const int number = ParseWhole<int>(name[1]).value_or(-1);
  return number >= 1 && number <= 3 ? number + 3 : -1;
}

// -1 where the name is no joint's.
int JointOf(const Words& words) {
  for (std::size_t i = 1; i < words.size(); ++i) {
    if (!IsDigit(words[i].front()) || !IsJointWord(words[i - 1])) continue;
    return IsOther(words) ? -1 : ParseWhole<int>(words[i]).value_or(-1);
  }
  return -1;
}

constexpr std::string_view kAxes = "xyz";

// 0 to 2 of x, y, z; -1 where the name is none.
int PositionAxisOf(const Words& words) {
  if (IsOther(words) || IsRotation(words)) return -1;
  for (const std::string& word : words) {
    for (int axis = 0; axis < 3; ++axis) {
      const std::string name(1, kAxes[static_cast<std::size_t>(axis)]);
      if (word == name || word == "t" + name || word == "p" + name ||
          word == "pos" + name || word == name + "pos") {
        return axis;
      }
    }
  }
  return -1;
}

// 0 to 3 of w, x, y, z.
int QuaternionPartOf(const Words& words) {
  if (IsOther(words)) return -1;
  constexpr std::string_view kParts = "wxyz";
  for (int part = 0; part < 4; ++part) {
    const std::string name(1, kParts[static_cast<std::size_t>(part)]);
    const bool is_rotated =
        IsRotation(words) &&
        std::find(words.begin(), words.end(), name) != words.end();
    if (is_rotated || HasOneOf(words, {"q" + name})) return part;
  }
  return -1;
}

int AngleOf(const Words& words) {
  if (IsOther(words)) return -1;
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name(1, kAxes[static_cast<std::size_t>(axis)]);
    const bool is_rotated =
        IsRotation(words) &&
        std::find(words.begin(), words.end(), name) != words.end();
    if (is_rotated || HasOneOf(words, {"r" + name, "rot" + name})) return axis;
  }
  return -1;
}

// 0 to 8 of "r11" ... "r33".
int MatrixPartOf(const Words& words) {
  if (words.size() != 2 || !IsOneOf(words[0], {"r", "m", "rot"})) return -1;
  const auto number = ParseWhole<int>(words[1]).value_or(0);
  const int row = number / 10;
  const int column = number % 10;
  if (row < 1 || row > 3 || column < 1 || column > 3) return -1;
  return 3 * (row - 1) + column - 1;
}

std::string Joined(const Words& words) {
  std::string text;
  for (const std::string& word : words) text += word;
  return text;
}

// "smr1" of "SMR1 X" and "smr_1_x_mm".
std::string OwnerOf(Words words) {
  const auto axis = std::find_if(
      words.begin(), words.end(),
      [](const std::string& word) { return PositionAxisOf({word}) >= 0; });
  if (axis != words.end()) words.erase(axis);
  return Joined(words);
}

// Columns of x, y, z that belong together, by what else is in their names.
struct OwnedPosition {
  std::string owner;
  std::vector<int> columns = std::vector<int>(3, 0);  // 0 = none

  bool IsWhole() const {
    return std::count(columns.begin(), columns.end(), 0) == 0;
  }
};

std::string YamlList(const std::vector<int>& columns,
                     const std::vector<std::string>& names) {
  std::string text;
  for (const int column : columns) {
    text += (text.empty() ? "[" : ", ") +
            YamlText(names[static_cast<std::size_t>(column) - 1]);
  }
  return text + "]";
}

class RoleFinder {
 public:
  RoleFinder(const std::string& path, const std::vector<std::string>& names,
             int num_joints, const std::vector<std::string>& targets)
      : path_(path),
        names_(names),
        num_joints_(num_joints),
        targets_(targets) {}

  ColumnRoles Find() const {
    if (WithoutUnit(names_.front()) == "1" &&
        WithoutUnit(names_.back()) == std::to_string(size())) {
      return ByNumbers();
    }
    ColumnRoles roles;
    roles.joints = Joints();
    if (targets_.size() > 1) roles.targets = Targets();
    // Orientations are of one target in a row.
    if (!roles.targets.empty()) {
      RefuseOtherTargets();
      return roles;
    }
    RefuseSeveralPositions(roles);
    roles.position = Group(PositionAxisOf, 3);
    const std::vector<int> quaternion = Group(QuaternionPartOf, 4);
    roles.matrix = Group(MatrixPartOf, 9);
    if (roles.matrix.empty()) roles.quaternion = quaternion;
    if (roles.matrix.empty() && quaternion.empty()) {
      roles.angles = Group(AngleOf, 3);
    }
    if (roles.position.empty()) {
      FailMissing("the position: x, y and z", kNoPositions);
    }
    return roles;
  }

 private:
  using Role = int (*)(const Words& words);

  int size() const { return static_cast<int>(names_.size()); }

  Words WordsAt(int i) const {
    return WordsOf(names_[static_cast<std::size_t>(i)]);
  }

  // "; a job can name them: ...".
  std::string Remedy() const {
    return "; a job can name them: `data: {file: ..., columns: {joints: [...], "
           "position: [...]}}`, or rename the columns to J1 ... J" +
           std::to_string(num_joints_) + ", X, Y, Z";
  }

  [[noreturn]] void FailMissing(const std::string& what,
                                const std::string& why = "") const {
    throw InputError({path_, 0, 0, ""}, "no columns seem to hold " + what +
                                            ", among " + JoinNames(names_) +
                                            Remedy() + why);
  }

  [[noreturn]] void FailTwice(int first, int second,
                              const std::string& remedy) const {
    throw InputError({path_, 0, 0, ""},
                     "columns " + std::to_string(first) + " (" +
                         Quote(names_[static_cast<std::size_t>(first) - 1]) +
                         ") and " + std::to_string(second) + " (" +
                         Quote(names_[static_cast<std::size_t>(second) - 1]) +
                         ") seem to hold the same" + remedy);
  }

  std::vector<OwnedPosition> OwnedPositions() const {
    std::vector<OwnedPosition> all;
    for (int i = 0; i < size(); ++i) {
      const Words words = WordsAt(i);
      const int axis = PositionAxisOf(words);
      if (axis < 0) continue;
      const std::string owner = OwnerOf(words);
      auto found = std::find_if(
          all.begin(), all.end(),
          [&](const OwnedPosition& one) { return one.owner == owner; });
      if (found == all.end()) {
        all.push_back({owner});
        found = all.end() - 1;
      }
      int& column = found->columns[static_cast<std::size_t>(axis)];
      if (column != 0) FailTwice(column, i + 1, Remedy());
      column = i + 1;
    }
    all.erase(
        std::remove_if(all.begin(), all.end(),
                       [](const OwnedPosition& one) { return !one.IsWhole(); }),
        all.end());
    return all;
  }

  // Beside those of the arm's targets.
  void RefuseOtherTargets() const {
    for (const OwnedPosition& one : OwnedPositions()) {
      const bool is_known = std::any_of(
          targets_.begin(), targets_.end(), [&](const std::string& target) {
            return Joined(WordsOf(target)) == one.owner;
          });
      if (is_known) continue;
      const int first = one.columns.front();
      throw InputError(
          {path_, 0, 0, ""},
          "column " + std::to_string(first) + " (" +
              Quote(names_[static_cast<std::size_t>(first) - 1]) +
              ") seems to hold a position of none of the arm's targets " +
              JoinNames(targets_) + ": rename it and those beside it (" +
              targets_.front() +
              " X ...), name the target in the arm file, or take the columns "
              "out");
    }
  }

  std::vector<std::pair<std::string, std::vector<int>>> Targets() const {
    std::vector<std::pair<std::string, std::vector<int>>> found;
    for (const OwnedPosition& one : OwnedPositions()) {
      for (const std::string& target : targets_) {
        if (Joined(WordsOf(target)) != one.owner) continue;
        found.emplace_back(target, one.columns);
      }
    }
    return found;
  }

  // Of targets that the arm does not have.
  void RefuseSeveralPositions(const ColumnRoles& roles) const {
    std::vector<OwnedPosition> all = OwnedPositions();
    all.erase(std::remove_if(
                  all.begin(), all.end(),
                  [](const OwnedPosition& one) { return one.owner.empty(); }),
              all.end());
    if (all.size() < 2) return;
    ColumnRoles as_targets;
    as_targets.joints = roles.joints;
    for (const OwnedPosition& one : all) {
      as_targets.targets.emplace_back(one.owner, one.columns);
    }
    const bool has_targets = targets_.size() > 1;
    FailTwice(
        all[0].columns[0], all[1].columns[0],
        ": where they are of several targets, the arm file has to name its "
        "`targets` so (" +
            (has_targets ? "it names " + JoinNames(targets_)
                         : std::string("as robots/irb120_reflectors does")) +
            "), or a job says which is which: `data: {file: ..., columns: {" +
            DescribeMapping(as_targets, names_) +
            "}}`; of one target, it names one `position`");
  }

  // All of the parts or none.
  std::vector<int> Group(Role role, int count) const {
    std::vector<int> columns(static_cast<std::size_t>(count), 0);
    for (int i = 0; i < size(); ++i) {
      const int part = role(WordsAt(i));
      if (part < 0) continue;
      int& column = columns[static_cast<std::size_t>(part)];
      if (column != 0) FailTwice(column, i + 1, Remedy());
      column = i + 1;
    }
    const bool is_whole =
        std::find(columns.begin(), columns.end(), 0) == columns.end();
    return is_whole ? columns : std::vector<int>();
  }

  std::map<int, int> NamedJoints() const {
    std::map<int, int> found;
    for (int i = 0; i < size(); ++i) {
      const int joint = NamedJointOf(WordsAt(i));
      if (joint < 0) continue;
      const auto [at, is_new] = found.emplace(joint, i + 1);
      if (!is_new) FailTwice(at->second, i + 1, Remedy());
    }
    return found;
  }

  std::vector<int> Joints() const {
    std::map<int, int> found;  // column by number of the joint
    for (int i = 0; i < size(); ++i) {
      const int joint = JointOf(WordsAt(i));
      if (joint < 0) continue;
      const auto [at, is_new] = found.emplace(joint, i + 1);
      if (!is_new) FailTwice(at->second, i + 1, Remedy());
    }
    if (found.empty() && num_joints_ == 6) found = NamedJoints();
    const int first = found.count(0) > 0 ? 0 : 1;
    std::vector<int> joints;
    for (int j = first; j < first + num_joints_; ++j) {
      if (found.count(j) == 0) {
        FailMissing(
            "joint " + std::to_string(j) + " of " + std::to_string(num_joints_),
            found.empty() ? kNoJoints : "");
      }
      joints.push_back(found.at(j));
    }
    if (static_cast<int>(found.size()) > num_joints_) {
      FailMissing(std::to_string(num_joints_) + " joints and no more (" +
                  std::to_string(found.size()) + " do)");
    }
    return joints;
  }

  static std::vector<int> Range(int first, int count) {
    std::vector<int> columns;
    for (int i = 0; i < count; ++i) columns.push_back(first + i);
    return columns;
  }

  ColumnRoles ByNumbers() const {
    const int least = num_joints_ + 3;
    const bool is_counted = size() == least + 1;
    const int first = is_counted ? 2 : 1;
    ColumnRoles roles;
    roles.joints = Range(first, num_joints_);
    roles.position = Range(first + num_joints_, 3);
    const int behind = first + least;
    if (size() == least || is_counted) return roles;
    if (size() == least + 4) {
      roles.quaternion = Range(behind, 4);
    } else if (size() == least + 9) {
      roles.matrix = Range(behind, 9);
    } else {
      throw InputError({path_, 0, 0, ""},
                       "has no header and " + std::to_string(size()) +
                           " columns, expected " + std::to_string(least) +
                           ": the joints', then x, y, z" + Remedy());
    }
    return roles;
  }

  static constexpr char kNoJoints[] =
      "; where another file has the joint values, `import JOINTS.csv "
      "POINTS.txt --match=COLUMN` puts the rows together by the points' names";
  static constexpr char kNoPositions[] =
      "; where another file has the positions, `import JOINTS.csv POINTS.txt "
      "--match=COLUMN` puts the rows together by the points' names";

  const std::string& path_;
  const std::vector<std::string>& names_;
  const int num_joints_;
  const std::vector<std::string>& targets_;
};

}  // namespace

ColumnRoles FindColumnRoles(const std::string& path,
                            const std::vector<std::string>& names,
                            int num_joints,
                            const std::vector<std::string>& targets) {
  return RoleFinder(path, names, num_joints, targets).Find();
}

std::string DescribeMapping(const ColumnRoles& roles,
                            const std::vector<std::string>& names) {
  std::string text = "joints: " + YamlList(roles.joints, names);
  if (roles.targets.empty()) {
    text += ", position: " + YamlList(roles.position, names);
    for (const auto* const columns :
         {&roles.quaternion, &roles.matrix, &roles.angles}) {
      if (columns->empty()) continue;
      text += ", orientation: " + YamlList(*columns, names);
    }
    return text;
  }
  std::string targets;
  for (const auto& [name, columns] : roles.targets) {
    targets += (targets.empty() ? "" : ", ") + YamlText(name) + ": " +
               YamlList(columns, names);
  }
  return text + ", targets: {" + targets + "}";
}

}  // namespace alidade::internal
