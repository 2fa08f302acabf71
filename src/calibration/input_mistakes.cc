#include "src/calibration/input_mistakes.h"

#include <algorithm>
#include <utility>

#include "alidade/units.h"
#include "src/common/text.h"

namespace alidade::internal {
namespace {

using Kind = InputMistake::Kind;

std::string JointName(int j) { return "q" + std::to_string(j + 1); }

// Joint values are mended in every row, its neighbours too.
template <typename Mend>
void MendJoints(PositionSample* sample, const Mend& mend) {
  mend(&sample->joint_values);
  mend(&sample->joint_values_before);
  mend(&sample->joint_values_after);
}

InputMistake AngleMistake(const Arm& arm, double factor, std::string text) {
  return {Kind::kAngleUnit, std::move(text),
          [&arm, factor](PositionSample* sample) {
            MendJoints(sample, [&](Eigen::MatrixXd* q) {
              for (int j = 0; j < arm.num_joints(); ++j) {
                if (arm.joints[j].type != JointType::kRevolute) continue;
                q->row(j) *= factor;
              }
            });
          }};
}

InputMistake LengthMistake(double factor, std::string text) {
  return {Kind::kLengthUnit, std::move(text),
          [factor](PositionSample* sample) { sample->points *= factor; }};
}

std::vector<InputMistake> UnitMistakes(const Arm& arm) {
  constexpr double kDegreesOfGrad = 0.9;
  return {
      AngleMistake(arm, kDegree,
                   "the joint angles are in degrees but read as radians: "
                   "state the unit deg"),
      AngleMistake(arm, 1.0 / kDegree,
                   "the joint angles are in radians but read as degrees: "
                   "state the unit rad"),
      AngleMistake(arm, kDegreesOfGrad,
                   "the joint angles are in grad (400 a turn) but read as "
                   "degrees: multiply them by 0.9"),
      LengthMistake(kMillimetre,
                    "the positions are in mm but read as m: state the unit mm"),
      LengthMistake(1.0 / kMillimetre,
                    "the positions are in m but read as mm: state the unit m"),
      LengthMistake(10.0,
                    "the positions are ten times too small, as cm read as mm: "
                    "state their unit"),
      LengthMistake(0.1,
                    "the positions are ten times too large, as mm read as cm: "
                    "state their unit"),
      LengthMistake(25.4,
                    "the positions are in inches but read as mm: multiply "
                    "them by 25.4"),
      LengthMistake(0.3048,
                    "the positions are in feet but read as m: multiply them "
                    "by 0.3048"),
      {Kind::kMirror,
       "two of the columns x, y and z are swapped, or one of them has the "
       "wrong sign: they make a mirror image",
       [](PositionSample* sample) {
         sample->points.row(0).swap(sample->points.row(1));
       }},
      {Kind::kRow,
       "the measurements are one row late: row k holds what was measured at "
       "the joint values of row k - 1",
       [](PositionSample* sample) {
         sample->joint_values = sample->joint_values_before;
       }},
      {Kind::kRow,
       "the measurements are one row early: row k holds what was measured at "
       "the joint values of row k + 1",
       [](PositionSample* sample) {
         sample->joint_values = sample->joint_values_after;
       }}};
}

template <typename Mend>
InputMistake JointMistake(std::string text, const Mend& mend) {
  return {Kind::kJoint, std::move(text),
          [mend](PositionSample* sample) { MendJoints(sample, mend); }};
}

void AddMistakesOf(const Arm& arm, int j, std::vector<InputMistake>* list) {
  const std::string joint = "joint " + std::to_string(j + 1);
  list->push_back(JointMistake(
      joint + " counts the other way: give it `sign: -1` in the arm file",
      [j](Eigen::MatrixXd* q) { q->row(j) *= -1.0; }));
  if (arm.joints[j].type == JointType::kRevolute) {
    for (const int turn : {90, -90, 180}) {
      list->push_back(JointMistake(
          "the zero of " + joint + " is elsewhere: add " +
              std::to_string(turn) + " deg to its theta in the arm file",
          [j, turn](Eigen::MatrixXd* q) {
            q->row(j).array() += turn * kDegree;
          }));
    }
  }
  for (int k = j + 1; k < arm.num_joints(); ++k) {
    list->push_back(JointMistake(
        "the columns " + JointName(j) + " and " + JointName(k) + " are swapped",
        [j, k](Eigen::MatrixXd* q) { q->row(j).swap(q->row(k)); }));
  }
  list->push_back({Kind::kJoint, "column " + JointName(j) + " is one row early",
                   [j](PositionSample* sample) {
                     sample->joint_values.row(j) =
                         sample->joint_values_before.row(j);
                   }});
  list->push_back({Kind::kJoint, "column " + JointName(j) + " is one row late",
                   [j](PositionSample* sample) {
                     sample->joint_values.row(j) =
                         sample->joint_values_after.row(j);
                   }});
}

// One column in another unit than the rest.
void AddColumnUnits(const Arm& arm, std::vector<InputMistake>* list) {
  for (int j = 0; j < arm.num_joints(); ++j) {
    if (arm.joints[j].type != JointType::kRevolute) continue;
    for (const bool is_degree : {true, false}) {
      const double factor = is_degree ? kDegree : 1.0 / kDegree;
      InputMistake mistake = JointMistake(
          "column " + JointName(j) + " alone is in " +
              (is_degree ? "degrees but read as radians"
                         : "radians but read as degrees") +
              ": state its unit",
          [j, factor](Eigen::MatrixXd* q) { q->row(j) *= factor; });
      mistake.kind = Kind::kColumn;
      list->push_back(std::move(mistake));
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    for (const double factor : {kMillimetre, 1.0 / kMillimetre}) {
      list->push_back(
          {Kind::kColumn,
           std::string("column ") + "xyz"[axis] + " alone is in " +
               (factor < 1.0 ? "mm but read as m" : "m but read as mm") +
               ": state its unit",
           [axis, factor](PositionSample* sample) {
             sample->points.row(axis) *= factor;
           }});
    }
  }
}

// "give row 3 of `motors` a 1 in column 2"; where there is a matrix already,
// what the row is to be.
std::string MotorRow(const Arm& arm, int j, double sign) {
  const std::string row = "row " + std::to_string(j + 1) + " of `motors`";
  if (arm.joints_from_motors.size() == 0) {
    return "give " + row + " a " + (sign > 0.0 ? "1" : "-1") + " in column " +
           std::to_string(j);
  }
  const Eigen::RowVectorXd mended =
      arm.joints_from_motors.row(j) + sign * arm.joints_from_motors.row(j - 1);
  std::string numbers;
  for (const double entry : mended) {
    numbers += (numbers.empty() ? "" : ", ") + ShortestNumber(entry);
  }
  return "make " + row + " [" + numbers + "]";
}

// A pendant that shows the angle of a link to the ground, as of arms with a
// parallelogram.
void AddCouplings(const Arm& arm, std::vector<InputMistake>* list) {
  for (int j = 1; j < arm.num_joints(); ++j) {
    if (arm.joints[j].type != JointType::kRevolute ||
        arm.joints[j - 1].type != JointType::kRevolute) {
      continue;
    }
    for (const double sign : {1.0, -1.0}) {
      const std::string number = std::to_string(j + 1);
      list->push_back(JointMistake(
          "joint " + number + " is coupled to joint " + std::to_string(j) +
              ": its motor counts q" + number + (sign > 0.0 ? " - " : " + ") +
              JointName(j - 1) + "; " + MotorRow(arm, j, sign),
          [j, sign](Eigen::MatrixXd* q) {
            q->row(j) += sign * q->row(j - 1);
          }));
    }
  }
}

}  // namespace

std::vector<InputMistake> SingleMistakes(const Arm& arm) {
  std::vector<InputMistake> mistakes = UnitMistakes(arm);
  for (int j = 0; j < arm.num_joints(); ++j) AddMistakesOf(arm, j, &mistakes);
  AddCouplings(arm, &mistakes);
  AddColumnUnits(arm, &mistakes);
  mistakes.push_back(JointMistake(
      "the columns of the joints are in reversed order",
      [](Eigen::MatrixXd* q) { *q = q->colwise().reverse().eval(); }));
  return mistakes;
}

std::vector<InputMistake> DoubleMistakes(
    const Arm& arm, const std::vector<std::string>& without) {
  std::vector<InputMistake> singles = SingleMistakes(arm);
  const auto is_left_out = [&without](const InputMistake& mistake) {
    return std::find(without.begin(), without.end(), mistake.text) !=
           without.end();
  };
  singles.erase(std::remove_if(singles.begin(), singles.end(), is_left_out),
                singles.end());
  std::vector<InputMistake> doubles;
  for (std::size_t a = 0; a < singles.size(); ++a) {
    for (std::size_t b = a + 1; b < singles.size(); ++b) {
      if (singles[a].kind == Kind::kColumn ||
          singles[b].kind == Kind::kColumn) {
        continue;
      }
      const bool go_together =
          singles[a].kind != singles[b].kind || singles[a].kind == Kind::kJoint;
      if (!go_together) continue;
      doubles.push_back({singles[b].kind,
                         singles[a].text + "; and " + singles[b].text,
                         [first = singles[a].mend,
                          second = singles[b].mend](PositionSample* sample) {
                           first(sample);
                           second(sample);
                         }});
    }
  }
  return doubles;
}

}  // namespace alidade::internal
