#include "src/report/arm_view.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "alidade/units.h"
#include "src/calibration/outliers.h"
#include "src/common/format.h"
#include "src/common/number_text.h"
#include "src/common/text.h"
#include "src/model/chain_axes.h"
#include "src/report/chart_frame.h"
#include "src/report/markup.h"

namespace alidade::internal {
namespace {

constexpr Eigen::Index kMostPictures = 60;
constexpr Eigen::Index kMostPlaces = 400;
constexpr Eigen::Index kMostCloudPoints = 1000;
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

// Evenly spread over `count` things, at most `most` of them.
Eigen::Index StepOver(Eigen::Index count, Eigen::Index most) {
  return std::max<Eigen::Index>(1, (count + most - 1) / most);
}

// Those with a whole position.
// Without rejected observations, beside which the others' errors would be
// points.
std::vector<ViewPlace> PlacesOf(const Arm& arm, const EvaluatedSet& set,
                                const std::vector<Outlier>& outliers) {
  const std::vector<Eigen::Index> rejected = RejectedObservations(outliers);
  const Eigen::Isometry3d base_from_instrument =
      Eigen::Isometry3d(arm.instrument_from_base).inverse();
  std::vector<Eigen::Index> whole;
  for (Eigen::Index i = 0; i < set.residual_after.cols(); ++i) {
    if (set.positions.col(i).allFinite() &&
        !std::binary_search(rejected.begin(), rejected.end(), i)) {
      whole.push_back(i);
    }
  }
  const auto step = static_cast<std::size_t>(
      StepOver(static_cast<Eigen::Index>(whole.size()), kMostPlaces));
  std::vector<ViewPlace> places;
  for (std::size_t k = 0; k < whole.size(); k += step) {
    const Eigen::Index i = whole[k];
    const int pose =
        set.labels.empty() ? static_cast<int>(i) : set.labels[i].pose;
    const auto turned = [&](const Eigen::Vector3d& error) -> Eigen::Vector3d {
      return base_from_instrument.linear() * error / kMillimetre;
    };
    places.push_back({pose + 1,
                      base_from_instrument *
                          Eigen::Vector3d(set.positions.col(i)) / kMillimetre,
                      turned(set.residual_before.col(i)),
                      turned(set.residual_after.col(i))});
  }
  return places;
}

void TakePicture(const Arm& arm, const EvaluatedSet& set, ArmShapes shapes,
                 ArmView* view) {
  const Eigen::Isometry3d base_from_instrument =
      Eigen::Isometry3d(arm.instrument_from_base).inverse();
  ArmPicture picture = PictureOf(arm, set);
  view->shapes = std::move(shapes);
  if (!view->shapes.links.empty()) {
    for (const int pose : picture.poses) {
      std::vector<Eigen::Isometry3d>& frames = view->frames.emplace_back();
      for (const Eigen::Isometry3d& frame :
           LinkFrames(arm, set.joint_values.col(pose - 1))) {
        frames.push_back(base_from_instrument * frame);
        frames.back().translation() /= kMillimetre;
      }
    }
  }
  view->poses = std::move(picture.poses);
  for (const Eigen::Matrix3Xd& line : picture.lines) {
    view->lines.emplace_back((base_from_instrument * line) / kMillimetre);
  }
  view->notes.resize(view->poses.size());
}

// What was off at each pose, and the pose where it was most.
void NoteErrors(ArmView* view) {
  double largest = -1.0;
  for (std::size_t k = 0; k < view->poses.size(); ++k) {
    const auto place = std::find_if(
        view->places.begin(), view->places.end(),
        [&](const ViewPlace& each) { return each.pose == view->poses[k]; });
    if (place == view->places.end()) continue;
    const auto shown = [](const Eigen::Vector3d& error) {
      return FormatSignificant(error.norm(), 3) + " mm";
    };
    view->notes[k] =
        shown(place->before) + " before, " + shown(place->after) + " after";
    if (place->before.norm() > largest) {
      largest = place->before.norm();
      view->first_pose = k;
    }
  }
}

void TakeCloud(const Arm& arm, const Eigen::Matrix3Xd& positions,
               const Eigen::VectorXd& deviations, ViewCloud* cloud) {
  const Eigen::Isometry3d base_from_instrument =
      Eigen::Isometry3d(arm.instrument_from_base).inverse();
  const Eigen::Index step = StepOver(positions.cols(), kMostCloudPoints);
  for (Eigen::Index i = 0; i < positions.cols(); i += step) {
    if (!positions.col(i).allFinite() || !std::isfinite(deviations[i])) {
      continue;
    }
    cloud->points.emplace_back(base_from_instrument *
                               Eigen::Vector3d(positions.col(i)) / kMillimetre);
    cloud->values.push_back(deviations[i] / kMillimetre);
  }
}

std::string VectorJson(const Eigen::Vector3d& value, int digits) {
  std::string json = "[";
  for (const double each : value) {
    json += (json.size() > 1 ? "," : "") + FormatSignificant(each, digits);
  }
  return json + "]";
}

template <typename Items, typename Text>
std::string ListJson(const Items& items, const Text& text) {
  std::string json = "[";
  for (const auto& item : items) {
    json += (json.size() > 1 ? "," : "") + text(item);
  }
  return json + "]";
}

// Names of poses with what belongs to each.
template <typename Items, typename Text>
std::string PosesJson(const ArmView& view, const Items& items,
                      const Text& text) {
  std::string json = "{";
  for (std::size_t i = 0; i < items.size(); ++i) {
    json += (i > 0 ? ",\"" : "\"") + std::to_string(view.poses[i]) +
            "\":" + text(items[i]);
  }
  return json + "}";
}

std::string LineJson(const Eigen::Matrix3Xd& line) {
  std::string json = "[";
  for (Eigen::Index k = 0; k < line.cols(); ++k) {
    json += (k > 0 ? "," : "") + VectorJson(line.col(k), kDigits);
  }
  return json + "]";
}

std::string FramesJson(const std::vector<Eigen::Isometry3d>& frames) {
  return ListJson(frames, [](const Eigen::Isometry3d& frame) {
    std::string json = "[";
    for (int axis = 0; axis < 3; ++axis) {
      json += VectorJson(frame.linear().row(axis), kDigits) + ",";
    }
    return json + VectorJson(frame.translation(), kDigits) + "]";
  });
}

std::string ShapeJson(const LinkShape& shape) {
  std::string json =
      "{\"frame\":" + std::to_string(shape.frame) + ",\"vertices\":[";
  for (Eigen::Index k = 0; k < shape.vertices.cols(); ++k) {
    json +=
        (k > 0 ? "," : "") + VectorJson(shape.vertices.col(k), kErrorDigits);
  }
  json += "],\"triangles\":[";
  for (Eigen::Index k = 0; k < shape.triangles.cols(); ++k) {
    const Eigen::Vector3i corners = shape.triangles.col(k);
    json += (k > 0 ? ",[" : "[") + std::to_string(corners[0]) + "," +
            std::to_string(corners[1]) + "," + std::to_string(corners[2]) + "]";
  }
  return json + "]}";
}

std::string NoteJson(const std::string& note) {
  std::string text = "\"";
  for (const char c : Typeset(CleanUtf8(note))) {
    if (c == '"' || c == '\\') text += '\\';
    text += c;
  }
  return text + "\"";
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

std::vector<Eigen::Isometry3d> LinkFrames(const Arm& arm,
                                          const Eigen::VectorXd& joint_values) {
  ChainAxes axes;
  ComputeChainAxes(arm, joint_values.data(), &axes);
  std::vector<Eigen::Isometry3d> frames;
  for (Eigen::Index j = 0; j < arm.num_joints(); ++j) {
    // Where joint j + 1 begins; beta turns about the frame's own y.
    Eigen::Isometry3d& frame = frames.emplace_back();
    frame = Eigen::Isometry3d::Identity();
    frame.translation() = axes.origin_before.col(j);
    frame.linear() << axes.alpha_axis.col(j), axes.beta_axis.col(j),
        Eigen::Vector3d(axes.alpha_axis.col(j))
            .cross(Eigen::Vector3d(axes.beta_axis.col(j)));
  }
  frames.push_back(axes.instrument_from_last);
  return frames;
}

ArmView ViewOf(const CalibrationResult& result, ArmShapes shapes) {
  ArmView view;
  view.places = PlacesOf(result.arm, result.train, result.outliers);
  TakePicture(result.arm, result.train, std::move(shapes), &view);
  NoteErrors(&view);
  if (result.uncertainty && result.uncertainty->workspace) {
    const PredictedMap& map = *result.uncertainty->workspace;
    if (map.positions.cols() == map.position_std.size()) {
      TakeCloud(result.arm, map.positions, map.position_std, &view.cloud);
    }
  }
  view.cloud.label = "predicted std";
  view.cloud.is_shown = false;
  return view;
}

ArmView ViewOf(const PlanResult& result, ArmShapes shapes) {
  const Arm& arm = result.planned_arm;
  EvaluatedSet set;
  set.joint_dimensions = result.joint_dimensions;
  set.joint_values = result.joint_values;
  ArmView view;
  TakePicture(arm, set, std::move(shapes), &view);
  Eigen::Matrix3Xd positions(3, result.joint_values.cols());
  ChainAxes axes;
  for (Eigen::Index k = 0; k < positions.cols(); ++k) {
    const Eigen::VectorXd values = result.joint_values.col(k);
    ComputeChainAxes(arm, values.data(), &axes);
    positions.col(k) = axes.instrument_from_target.translation();
  }
  TakeCloud(arm, positions, result.pose_std, &view.cloud);
  view.cloud.label = "predicted std";
  for (std::size_t k = 0; k < view.poses.size(); ++k) {
    view.notes[k] =
        FormatLength(result.pose_std[view.poses[k] - 1], 3) + " predicted";
    std::vector<std::string> pairs;
    for (const LinkOverlap& overlap : result.links.overlaps) {
      if (overlap.pose != view.poses[k]) continue;
      pairs.push_back(overlap.first + " and " + overlap.second);
    }
    if (!pairs.empty()) {
      view.notes[k] += "; may touch: " + Join(pairs, ", ");
    }
  }
  return view;
}

int ShadeOf(double value, double lower, double upper) {
  if (!(upper > lower)) return kShades - 1;
  const double place = (value - lower) / (upper - lower);
  return std::clamp(static_cast<int>(std::floor(kShades * place)), 0,
                    kShades - 1);
}

double ErrorFactor(const ArmView& view, Eigen::Vector3d ViewPlace::*error) {
  Eigen::AlignedBox3d box;
  double largest = 0.0;
  for (const ViewPlace& place : view.places) {
    box.extend(place.at);
    largest = std::max(largest, (place.*error).norm());
  }
  for (const Eigen::Matrix3Xd& line : view.lines) {
    for (Eigen::Index k = 0; k < line.cols(); ++k) box.extend(line.col(k));
  }
  if (!(largest > 0.0)) return 1.0;
  const double rough = 0.1 * box.sizes().maxCoeff() / largest;
  if (!(rough > 1.0) || !std::isfinite(rough)) return 1.0;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {5.0, 2.0}) {
    if (factor * power <= rough) return factor * power;
  }
  return power;
}

std::string ArmViewJson(const ArmView& view) {
  if (view.empty()) return "";
  const auto shades = [&](auto member) {
    double largest = 0.0;
    for (const ViewPlace& place : view.places) {
      largest = std::max(largest, (place.*member).norm());
    }
    return ListJson(view.places, [&](const ViewPlace& place) {
      return std::to_string(ShadeOf((place.*member).norm(), 0.0, largest));
    });
  };
  ValueRange range;
  for (const double value : view.cloud.values) range.Include(value);
  std::size_t next = 0;
  return "{\"lines\":" + PosesJson(view, view.lines, LineJson) +
         ",\"notes\":" + PosesJson(view, view.notes, NoteJson) +
         ",\"places\":" +
         ListJson(view.places,
                  [](const ViewPlace& place) {
                    return "[" + std::to_string(place.pose) + "," +
                           VectorJson(place.at, kDigits) + "," +
                           VectorJson(place.before, kErrorDigits) + "," +
                           VectorJson(place.after, kErrorDigits) + "]";
                  }) +
         ",\"cloud\":" +
         ListJson(view.cloud.points,
                  [&](const Eigen::Vector3d& point) {
                    std::string json = VectorJson(point, kDigits);
                    json.back() = ',';
                    return json +
                           FormatSignificant(view.cloud.values[next++],
                                             kErrorDigits) +
                           "]";
                  }) +
         ",\"factors\":{\"before\":" +
         ShortestNumber(ErrorFactor(view, &ViewPlace::before)) +
         ",\"after\":" + ShortestNumber(ErrorFactor(view, &ViewPlace::after)) +
         "},\"shades\":{\"before\":" + shades(&ViewPlace::before) +
         ",\"after\":" + shades(&ViewPlace::after) + ",\"cloud\":" +
         ListJson(view.cloud.values,
                  [&](double value) {
                    return std::to_string(ShadeOf(value, range.min, range.max));
                  }) +
         "},\"frames\":" + PosesJson(view, view.frames, FramesJson) +
         ",\"shapes\":" + ListJson(view.shapes.links, ShapeJson) + "}";
}

}  // namespace alidade::internal
