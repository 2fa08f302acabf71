#include "input_doubt.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "alidade/base/units.h"
#include "alidade/measurement/frame_start.h"
#include "alidade/model/chain_axes.h"
#include "alidade/report/format.h"

namespace alidade {
namespace {

constexpr Eigen::Index kFewest = 12;
constexpr Eigen::Index kEnough = 60;
constexpr double kTolerated = 0.02;  // of the reach
constexpr double kClearlyBetter = 4.0;

// Joint values and the positions measured there, one by one.
struct Pairs {
  Eigen::MatrixXd joint_values;
  Eigen::Matrix3Xd points;
};

Pairs PositionsOf(const Dataset& data) {
  std::vector<int> poses;
  std::vector<Eigen::Vector3d> points;
  for (const ObservationBlock& block : data.blocks) {
    if (!HoldsPosition(block.kind)) continue;
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      if (block.target(i) != 0) continue;
      if (!block.sigmas.col(i).head<3>().allFinite()) continue;
      poses.push_back(block.pose(i));
      points.emplace_back(block.measured.col(i).head<3>());
    }
  }
  const auto count = static_cast<Eigen::Index>(poses.size());
  Pairs pairs{Eigen::MatrixXd(data.num_joints(), count),
              Eigen::Matrix3Xd(3, count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    pairs.joint_values.col(i) = data.joint_values.col(poses[i]);
    pairs.points.col(i) = points[i];
  }
  return pairs;
}

Pairs Thinned(const Pairs& all) {
  const Eigen::Index count = std::min(kEnough, all.points.cols());
  Pairs some{Eigen::MatrixXd(all.joint_values.rows(), count),
             Eigen::Matrix3Xd(3, count)};
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Index i = k * all.points.cols() / count;
    some.joint_values.col(k) = all.joint_values.col(i);
    some.points.col(k) = all.points.col(i);
  }
  return some;
}

// Median misfit of the nominal arm with any base and tool (m).
double Misfit(const Arm& arm, const Pairs& all) {
  const Pairs pairs = Thinned(all);
  Arm in_base = arm;
  in_base.instrument_from_base.setIdentity();
  std::vector<Eigen::Isometry3d> frames;
  ChainAxes axes;
  for (Eigen::Index i = 0; i < pairs.points.cols(); ++i) {
    ComputeChainAxes(in_base, pairs.joint_values.col(i).data(), &axes);
    frames.push_back(axes.instrument_from_last);
  }
  const std::optional<PositionStart> start = StartFromPositions(
      frames, pairs.points, std::vector<int>(frames.size(), 0), 1);
  return start ? start->misfit.median : std::numeric_limits<double>::infinity();
}

struct Slip {
  std::string text;  // what the user should do
  std::function<void(Pairs*)> mend;
};

std::string JointName(int j) { return "q" + std::to_string(j + 1); }

void ScaleAngles(const Arm& arm, double factor, Pairs* pairs) {
  for (int j = 0; j < arm.num_joints(); ++j) {
    if (arm.joints[j].type != JointType::kRevolute) continue;
    pairs->joint_values.row(j) *= factor;
  }
}

// Measurements moved by one row against the joint values.
void Shift(int by, Pairs* pairs) {
  const Eigen::Index count = pairs->points.cols() - 1;
  const Eigen::MatrixXd joints =
      by > 0 ? pairs->joint_values.leftCols(count).eval()
             : pairs->joint_values.rightCols(count).eval();
  const Eigen::Matrix3Xd points = by > 0 ? pairs->points.rightCols(count).eval()
                                         : pairs->points.leftCols(count).eval();
  pairs->joint_values = joints;
  pairs->points = points;
}

std::vector<Slip> UnitSlips(const Arm& arm) {
  return {
      {"the joint angles are in degrees but read as radians: state the "
       "unit deg",
       [&arm](Pairs* pairs) { ScaleAngles(arm, kDegree, pairs); }},
      {"the joint angles are in radians but read as degrees: state the "
       "unit rad",
       [&arm](Pairs* pairs) { ScaleAngles(arm, 1.0 / kDegree, pairs); }},
      {"the positions are in mm but read as m: state the unit mm",
       [](Pairs* pairs) { pairs->points *= kMillimetre; }},
      {"the positions are in m but read as mm: state the unit m",
       [](Pairs* pairs) { pairs->points /= kMillimetre; }},
      {"two of the columns x, y and z are swapped, or one of them has the "
       "wrong sign: they make a mirror image",
       [](Pairs* pairs) { pairs->points.row(0).swap(pairs->points.row(1)); }},
      {"the measurements are one row late: row k holds what was measured "
       "at the joint values of row k - 1",
       [](Pairs* pairs) { Shift(1, pairs); }},
      {"the measurements are one row early: row k holds what was measured "
       "at the joint values of row k + 1",
       [](Pairs* pairs) { Shift(-1, pairs); }}};
}

std::vector<Slip> JointSlips(const Arm& arm) {
  std::vector<Slip> slips;
  for (int j = 0; j < arm.num_joints(); ++j) {
    slips.push_back(
        {"joint " + std::to_string(j + 1) +
             " counts the other way: give it `sign: -1` in the arm "
             "file",
         [j](Pairs* pairs) { pairs->joint_values.row(j) *= -1.0; }});
    for (int k = j + 1; k < arm.num_joints(); ++k) {
      slips.push_back({"the columns " + JointName(j) + " and " + JointName(k) +
                           " are swapped",
                       [j, k](Pairs* pairs) {
                         pairs->joint_values.row(j).swap(
                             pairs->joint_values.row(k));
                       }});
    }
  }
  return slips;
}

}  // namespace

InputDoubt DoubtInput(const Arm& arm, const Dataset& data) {
  const Pairs pairs = PositionsOf(data);
  if (pairs.points.cols() < kFewest || !pairs.points.allFinite()) return {};
  const double misfit = Misfit(arm, pairs);
  Arm at_origin = arm;
  at_origin.instrument_from_base.setIdentity();
  const double tolerated = kTolerated * Reach(at_origin);
  if (!(misfit > tolerated) || !std::isfinite(misfit)) return {};
  std::vector<Slip> slips = UnitSlips(arm);
  for (Slip& slip : JointSlips(arm)) slips.push_back(std::move(slip));
  const Slip* best = nullptr;
  double best_misfit = std::min(tolerated, misfit / kClearlyBetter);
  for (const Slip& slip : slips) {
    Pairs mended = pairs;
    slip.mend(&mended);
    const double mended_misfit = Misfit(arm, mended);
    if (mended_misfit >= best_misfit) continue;
    best = &slip;
    best_misfit = mended_misfit;
  }
  std::string text =
      "the measured positions do not fit this arm wherever its base and tool "
      "are: half of them are more than " +
      FormatLength(misfit, 3) + " off";
  if (best == nullptr) {
    text +=
        ". No single slip of units, columns or signs explains it: look "
        "whether the arm file describes the arm that was measured";
    return {text, false};
  }
  text += ". They fit to " + FormatLength(best_misfit, 3) + " if " + best->text;
  return {text, true};
}

}  // namespace alidade
