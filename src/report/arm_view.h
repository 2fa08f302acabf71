#ifndef ALIDADE_SRC_REPORT_ARM_VIEW_H_
#define ALIDADE_SRC_REPORT_ARM_VIEW_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <string>
#include <vector>

#include "alidade/calibration_result.h"
#include "alidade/plan.h"

namespace alidade::internal {

/// The arm as a chain of links at some poses of a set, in the instrument's
/// frame (m).
struct ArmPicture {
  std::vector<int> poses;  ///< from 1
  /// One entry per pose: the corners from the base to the target.
  std::vector<Eigen::Matrix3Xd> lines;
};

/// At up to 60 poses; empty where the set's joint values are not this arm's.
ArmPicture PictureOf(const Arm& arm, const EvaluatedSet& set);

/// A place that was measured, and by how much the arm was off.
struct ViewPlace {
  int pose = 0;
  Eigen::Vector3d at;
  Eigen::Vector3d before;
  Eigen::Vector3d after;
};

/// Places and what is predicted there.
struct ViewCloud {
  std::string label;  ///< of the values: "predicted standard deviation"
  std::vector<Eigen::Vector3d> points;
  std::vector<double> values;
  bool is_shown = true;  ///< at first
};

/// The surface of a link, in mm in the frame of LinkFrames: columns are
/// vertices, and three of their numbers for each triangle.
struct LinkShape {
  int frame = 0;
  Eigen::Matrix3Xd vertices;
  Eigen::Matrix3Xi triangles;
};

/// What the links look like, as far as it is known.
struct ArmShapes {
  std::vector<LinkShape> links;
  std::string note;  ///< what is missing
};

/// A frame that is fixed to each link, in the instrument's frame: of the base,
/// and of what moves with joint 1 to n.
std::vector<Eigen::Isometry3d> LinkFrames(const Arm& arm,
                                          const Eigen::VectorXd& joint_values);

/// What is drawn of an arm: lengths in mm, in the frame of the base.
struct ArmView {
  std::vector<int> poses;               ///< from 1
  std::vector<Eigen::Matrix3Xd> lines;  ///< one entry per pose
  std::vector<std::string> notes;       ///< what is said of each pose
  std::vector<ViewPlace> places;
  ViewCloud cloud;
  std::size_t first_pose = 0;  ///< index of the one that is drawn first
  ArmShapes shapes;
  /// Where the links with shapes are: one entry per pose.
  std::vector<std::vector<Eigen::Isometry3d>> frames;

  bool empty() const {
    return lines.empty() && places.empty() && cloud.points.empty();
  }
};

/// The arm at up to 60 of the training poses, errors at up to 400 of them, and
/// the predicted standard deviation at up to 1000 configurations.
ArmView ViewOf(const CalibrationResult& result, ArmShapes shapes = {});
/// The arm at up to 60 of the planned poses; all of them are its cloud, up to
/// 1000.
ArmView ViewOf(const PlanResult& result, ArmShapes shapes = {});

/// How strong colours are of which a drawing has several, from 0, of equal
/// parts of the range from `lower` to `upper`.
int ShadeOf(double value, double lower, double upper);
inline constexpr int kShades = 5;

/// How many times as long as they are errors of a state are drawn, so that the
/// longest is a tenth of the drawing; 1 where there are none.
double ErrorFactor(const ArmView& view, Eigen::Vector3d ViewPlace::*error);

/// What the page's script turns the view with (docs/report.md). Empty where
/// there is nothing to draw.
std::string ArmViewJson(const ArmView& view);
inline std::string ArmViewJson(const CalibrationResult& result) {
  return ArmViewJson(ViewOf(result));
}

/// The view as a figure of a page, complete without its script; nothing where
/// there is nothing to draw.
std::string ArmViewFigure(const ArmView& view, const std::string& title);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_ARM_VIEW_H_
