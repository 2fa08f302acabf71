#include "src/report/arm_view.h"

#include "alidade/units.h"
#include "src/common/format.h"
#include "src/model/chain_axes.h"

namespace alidade::internal {
namespace {

constexpr Eigen::Index kMostPictures = 60;
constexpr Eigen::Index kMostPlaces = 400;
// A tenth of a micrometre.
constexpr int kDigits = 6;
constexpr int kErrorDigits = 4;

// Base, corner and axis of every joint, last frame, target; points that
// coincide once.
Eigen::Matrix3Xd Corners(const Arm& arm, const Eigen::VectorXd& joint_values) {
  constexpr double kSamePlace = 1e-6;  // m
  ChainAxes axes;
  ComputeChainAxes(arm, joint_values.data(), &axes);
  const Eigen::Index joints = arm.num_joints();
  Eigen::Matrix3Xd points(3, 2 * joints + 2);
  for (Eigen::Index j = 0; j < joints; ++j) {
    points.col(2 * j) = axes.origin_before.col(j);
    points.col(2 * j + 1) = axes.origin_on_axis.col(j);
  }
  points.col(points.cols() - 2) = axes.instrument_from_last.translation();
  points.col(points.cols() - 1) = axes.instrument_from_target.translation();
  Eigen::Index kept = 1;
  for (Eigen::Index i = 1; i < points.cols(); ++i) {
    if ((points.col(i) - points.col(kept - 1)).norm() < kSamePlace) continue;
    points.col(kept++) = points.col(i);
  }
  return points.leftCols(kept);
}

bool HasJointsOf(const Arm& arm, const EvaluatedSet& set) {
  if (set.joint_values.rows() != arm.num_joints() || arm.num_joints() == 0 ||
      set.joint_dimensions.size() != arm.joints.size()) {
    return false;
  }
  for (int j = 0; j < arm.num_joints(); ++j) {
    const bool is_angle = set.joint_dimensions[j] == Dimension::kAngle;
    if (is_angle != (arm.joints[j].type == JointType::kRevolute)) return false;
  }
  return true;
}

std::string VectorJson(const Eigen::Vector3d& metres, int digits) {
  std::string json = "[";
  for (const double value : metres) {
    json += (json.size() > 1 ? "," : "") +
            FormatSignificant(value / kMillimetre, digits);
  }
  return json + "]";
}

std::string LinesJson(const Arm& arm, const EvaluatedSet& set) {
  const Eigen::Isometry3d base_from_instrument =
      Eigen::Isometry3d(arm.instrument_from_base).inverse();
  const ArmPicture picture = PictureOf(arm, set);
  std::string json = "{";
  for (std::size_t i = 0; i < picture.lines.size(); ++i) {
    json +=
        (i > 0 ? "," : "") + ("\"" + std::to_string(picture.poses[i])) + "\":[";
    for (Eigen::Index k = 0; k < picture.lines[i].cols(); ++k) {
      const Eigen::Vector3d corner = picture.lines[i].col(k);
      json += (k > 0 ? "," : "") +
              VectorJson(base_from_instrument * corner, kDigits);
    }
    json += "]";
  }
  return json + "}";
}

// Those with a whole position, spread evenly.
std::string PlacesJson(const Arm& arm, const EvaluatedSet& set) {
  const Eigen::Isometry3d base_from_instrument =
      Eigen::Isometry3d(arm.instrument_from_base).inverse();
  std::vector<Eigen::Index> whole;
  for (Eigen::Index i = 0; i < set.residual_after.cols(); ++i) {
    if (set.positions.col(i).allFinite()) whole.push_back(i);
  }
  const Eigen::Index step =
      1 + static_cast<Eigen::Index>(whole.size()) / (kMostPlaces + 1);
  std::string json = "[";
  for (std::size_t k = 0; k < whole.size();
       k += static_cast<std::size_t>(step)) {
    const Eigen::Index i = whole[k];
    const int pose =
        set.labels.empty() ? static_cast<int>(i) : set.labels[i].pose;
    const auto turned = [&](const Eigen::Vector3d& error) {
      return VectorJson(base_from_instrument.linear() * error, kErrorDigits);
    };
    json +=
        (k > 0 ? ",[" : "[") + std::to_string(pose + 1) + "," +
        VectorJson(base_from_instrument * Eigen::Vector3d(set.positions.col(i)),
                   kDigits) +
        "," + turned(set.residual_before.col(i)) + "," +
        turned(set.residual_after.col(i)) + "]";
  }
  return json + "]";
}

}  // namespace

ArmPicture PictureOf(const Arm& arm, const EvaluatedSet& set) {
  ArmPicture picture;
  if (!HasJointsOf(arm, set)) return picture;
  const Eigen::Index poses = set.joint_values.cols();
  const Eigen::Index step = (poses + kMostPictures - 1) / kMostPictures;
  for (Eigen::Index pose = 0; pose < poses; pose += step) {
    const Eigen::VectorXd values = set.joint_values.col(pose);
    if (!values.allFinite()) continue;
    picture.poses.push_back(static_cast<int>(pose) + 1);
    picture.lines.push_back(Corners(arm, values));
  }
  return picture;
}

std::string ArmViewJson(const CalibrationResult& result) {
  const std::string lines = LinesJson(result.arm, result.train);
  const std::string places = PlacesJson(result.arm, result.train);
  if (lines == "{}" && places == "[]") return "";
  return "{\"lines\":" + lines + ",\"places\":" + places + "}";
}

}  // namespace alidade::internal
