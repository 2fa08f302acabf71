#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "alidade/units.h"
#include "src/common/format.h"
#include "src/common/text.h"
#include "src/report/arm_view.h"
#include "src/report/chart_frame.h"
#include "src/report/markup.h"
#include "src/report/page.h"
#include "src/report/svg_chart.h"

namespace alidade::internal {
namespace {

using Eigen::Vector3d;

constexpr double kWidth = 480.0;
constexpr double kHeight = 372.0;
// The view at first, as the script has it (arm_view.js).
constexpr double kAzimuth = -0.9;
constexpr double kElevation = 0.35;
constexpr double kSideMargin = 30.0;
constexpr double kTopMargin = 62.0;
constexpr double kBottomMargin = 34.0;
constexpr std::size_t kManyPlaces = 150;

const Vector3d kTowardsReader(std::cos(kElevation) * std::cos(kAzimuth),
                              std::cos(kElevation) * std::sin(kAzimuth),
                              std::sin(kElevation));

// Screen coordinates (right, up) of a point of the base's frame.
SvgPoint Project(const Vector3d& point) {
  const double forward =
      std::cos(kAzimuth) * point.x() + std::sin(kAzimuth) * point.y();
  return {-std::sin(kAzimuth) * point.x() + std::cos(kAzimuth) * point.y(),
          std::cos(kElevation) * point.z() - std::sin(kElevation) * forward};
}

// Where the base's frame is drawn: all that is shown, as large as it fits.
class Projection {
 public:
  explicit Projection(const std::vector<Vector3d>& points) {
    ValueRange x;
    ValueRange y;
    const auto include = [&](const Vector3d& point) {
      const SvgPoint flat = Project(point);
      x.Include(flat.x);
      y.Include(flat.y);
    };
    for (const Vector3d& point : points) {
      include(point);
      reach_ = std::max(reach_, point.head<2>().norm());
    }
    for (int i = 0; i < kFloorCorners; ++i) include(FloorCorner(i));
    const auto fit = [](double room, const ValueRange& range) {
      return room / (range.max > range.min ? range.max - range.min : 1.0);
    };
    unit_ = std::min(fit(kWidth - 2.0 * kSideMargin, x),
                     fit(kHeight - kTopMargin - kBottomMargin, y));
    middle_ = {0.5 * (x.min + x.max), 0.5 * (y.min + y.max)};
  }

  SvgPoint At(const Vector3d& point) const {
    const SvgPoint flat = Project(point);
    return {kWidth / 2.0 + (flat.x - middle_.x) * unit_,
            0.5 * (kTopMargin + kHeight - kBottomMargin) -
                (flat.y - middle_.y) * unit_};
  }
  std::string Text(const Vector3d& point) const {
    const SvgPoint at = At(point);
    return SvgNumber(at.x) + "," + SvgNumber(at.y);
  }
  double unit() const { return unit_; }

  // A circle about the base shows which way is up and how far it reaches.
  static constexpr int kFloorCorners = 72;
  Vector3d FloorCorner(int i) const {
    const double angle = 2.0 * kPi * i / kFloorCorners;
    return reach_ * Vector3d(std::cos(angle), std::sin(angle), 0.0);
  }

 private:
  double unit_ = 1.0;
  double reach_ = 0.0;
  SvgPoint middle_;
};

std::vector<Vector3d> ShownPoints(const ArmView& view) {
  std::vector<Vector3d> points;
  for (const ViewPlace& place : view.places) points.push_back(place.at);
  for (const Eigen::Matrix3Xd& line : view.lines) {
    for (Eigen::Index k = 0; k < line.cols(); ++k) {
      points.emplace_back(line.col(k));
    }
  }
  if (view.cloud.is_shown || points.empty()) {
    points.insert(points.end(), view.cloud.points.begin(),
                  view.cloud.points.end());
  }
  return points;
}

// Of a cloud. The ends of the scale hardly show on dark and on white.
std::string ColourOf(int shade) {
  return MapColour(0.25 + 0.65 * shade / (kShades - 1));
}

ValueRange RangeOf(const ViewCloud& cloud) {
  ValueRange range;
  for (const double value : cloud.values) range.Include(value);
  return range;
}

std::string DotPath(const std::vector<SvgPoint>& points, double radius) {
  std::string path;
  for (const SvgPoint at : points) {
    path += MarkerPath(MarkerStyle::kDot, at, radius);
  }
  return path;
}

class Drawing {
 public:
  Drawing(const ArmView& view, const std::string& title)
      : view_(view),
        projection_(ShownPoints(view)),
        svg_({kWidth, kHeight}, title, Description(), FigureMedium::kPage) {}

  std::string Draw() {
    DrawFloor();
    DrawCloud();
    DrawShapes();
    DrawArm();
    if (!view_.places.empty()) {
      DrawErrors("before", &ViewPlace::before, "s2", 14.0);
      DrawErrors("after", &ViewPlace::after, "s1", 32.0);
      DrawPlaces();
    }
    DrawCloudKey();
    DrawTriad();
    DrawScale();
    return svg_.Finish();
  }

 private:
  std::string Description() const {
    std::string text = "The arm as a chain of links";
    if (!view_.places.empty()) {
      text += ", " +
              Count(static_cast<std::int64_t>(view_.places.size()),
                    "measured place") +
              ", and the position errors before and after calibration as lines";
    }
    if (!view_.cloud.points.empty()) text += ", " + view_.cloud.label;
    return text;
  }

  void DrawFloor() {
    std::string path;
    for (int i = 0; i <= Projection::kFloorCorners; ++i) {
      path +=
          (i == 0 ? "M" : "L") + projection_.Text(projection_.FloorCorner(i));
    }
    svg_.Layer("floor", path, "link ghost");
  }

  void DrawArm() {
    if (view_.lines.empty()) return;
    const Eigen::Matrix3Xd& line = view_.lines[view_.first_pose];
    std::string path;
    std::vector<SvgPoint> joints;
    for (Eigen::Index k = 0; k < line.cols(); ++k) {
      path += (k == 0 ? "M" : "L") + projection_.Text(line.col(k));
      if (k + 1 < line.cols()) joints.push_back(projection_.At(line.col(k)));
    }
    svg_.Layer("arm", path, "link");
    svg_.Layer("joints", DotPath(joints, 4.0), "joint");
  }

  // Triangles that face the reader, the farthest first.
  void DrawShapes() {
    if (view_.frames.empty()) return;
    struct Facet {
      double depth = 0.0;
      int shade = 0;
      std::string path;
    };
    std::vector<Facet> facets;
    for (const LinkShape& link : view_.shapes.links) {
      const Eigen::Isometry3d& frame =
          view_.frames[view_.first_pose][static_cast<std::size_t>(link.frame)];
      const Eigen::Matrix3Xd points = frame * link.vertices;
      for (Eigen::Index k = 0; k < link.triangles.cols(); ++k) {
        const Vector3d a = points.col(link.triangles(0, k));
        const Vector3d b = points.col(link.triangles(1, k));
        const Vector3d c = points.col(link.triangles(2, k));
        const Vector3d normal = (b - a).cross(c - a);
        const double facing = normal.dot(kTowardsReader) / normal.norm();
        if (!(facing > 0.0)) continue;
        facets.push_back(
            {(a + b + c).dot(kTowardsReader), ShadeOf(facing, 0.0, 1.0),
             "M" + projection_.Text(a) + "L" + projection_.Text(b) + "L" +
                 projection_.Text(c) + "z"});
      }
    }
    std::stable_sort(
        facets.begin(), facets.end(),
        [](const Facet& a, const Facet& b) { return a.depth < b.depth; });
    svg_.BeginPart("shapes", true);
    for (std::size_t k = 0; k < facets.size();) {
      const int shade = facets[k].shade;
      std::string path;
      for (; k < facets.size() && facets[k].shade == shade; ++k) {
        path += facets[k].path;
      }
      svg_.Path(path, "shape facet" + std::to_string(shade));
    }
    svg_.EndPart();
  }

  // A key of shades and what they mean, from `top` downwards.
  template <typename Shade>
  void DrawKey(double top, const std::string& text, const Shade& shade) {
    constexpr double kLength = 9.0;
    for (int k = 0; k < kShades; ++k) {
      shade(k, "M" + SvgNumber(12.0 + kLength * k) + "," + SvgNumber(top) +
                   "h" + SvgNumber(kLength));
    }
    svg_.Text({12.0 + kLength * kShades + 6.0, top + 4.0}, text, "tick halo");
  }

  void DrawErrors(const std::string& state, Vector3d ViewPlace::*error,
                  const std::string& colour, double top) {
    const double factor = ErrorFactor(view_, error);
    double largest = 0.0;
    for (const ViewPlace& place : view_.places) {
      largest = std::max(largest, (place.*error).norm());
    }
    std::vector<std::string> paths(kShades);
    for (const ViewPlace& place : view_.places) {
      const int shade = ShadeOf((place.*error).norm(), 0.0, largest);
      paths[static_cast<std::size_t>(shade)] +=
          "M" + projection_.Text(place.at) + "L" +
          projection_.Text(place.at + factor * place.*error);
    }
    svg_.BeginPart(state, true);
    const auto look = [&](int shade) {
      return "vector " + colour + " shade" + std::to_string(shade);
    };
    for (int shade = 0; shade < kShades; ++shade) {
      svg_.Layer(state + "-" + std::to_string(shade),
                 paths[static_cast<std::size_t>(shade)], look(shade));
    }
    DrawKey(top,
            "error " + state + ", 0 to " + FormatSignificant(largest, 3) +
                " mm, drawn " + FormatSignificant(factor, 1) + " times as long",
            [&](int shade, const std::string& path) {
              svg_.Path(path, look(shade) + " key");
            });
    svg_.EndPart();
  }

  void DrawPlaces() {
    std::vector<SvgPoint> points;
    for (const ViewPlace& place : view_.places) {
      points.push_back(projection_.At(place.at));
    }
    svg_.Layer("places",
               DotPath(points, points.size() > kManyPlaces ? 1.0 : 1.8),
               "place s7");
  }

  void DrawCloud() {
    const ViewCloud& cloud = view_.cloud;
    if (cloud.points.empty()) return;
    const ValueRange range = RangeOf(cloud);
    std::vector<std::string> paths(kShades);
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      const int shade = ShadeOf(cloud.values[i], range.min, range.max);
      paths[static_cast<std::size_t>(shade)] +=
          "M" + projection_.Text(cloud.points[i]) + "h0";
    }
    svg_.BeginPart("cloud", cloud.is_shown);
    const std::string look =
        cloud.points.size() > kManyPlaces ? "cloud" : "cloud large";
    for (int shade = 0; shade < kShades; ++shade) {
      svg_.Layer("cloud-" + std::to_string(shade),
                 paths[static_cast<std::size_t>(shade)], look, ColourOf(shade));
    }
    svg_.EndPart();
  }

  // Above all else, as far as it is drawn.
  void DrawCloudKey() {
    const ViewCloud& cloud = view_.cloud;
    if (cloud.points.empty()) return;
    const ValueRange range = RangeOf(cloud);
    svg_.BeginPart("cloud-key", cloud.is_shown);
    DrawKey(view_.places.empty() ? 14.0 : 50.0,
            cloud.label + ", " + FormatSignificant(range.min, 3) + " to " +
                FormatSignificant(range.max, 3) + " mm",
            [&](int shade, const std::string& path) {
              svg_.Strokes(path, ColourOf(shade), 8.0);
            });
    svg_.EndPart();
  }

  // The axes of the base.
  void DrawTriad() {
    const double size = 34.0 / projection_.unit();
    const SvgPoint origin = projection_.At(Vector3d::Zero());
    std::string path;
    svg_.BeginPart("triad", true);
    for (int k = 0; k < 3; ++k) {
      const SvgPoint tip = projection_.At(size * Vector3d::Unit(k));
      path += "M" + SvgNumber(origin.x) + "," + SvgNumber(origin.y) + "L" +
              SvgNumber(tip.x) + "," + SvgNumber(tip.y);
      svg_.Text({tip.x + 3.0, tip.y + 3.0}, std::string(1, "xyz"[k]), "tick");
    }
    svg_.Layer("axes", path, "axis");
    svg_.EndPart();
  }

  void DrawScale() {
    const double length = StepAbove(24.0 / projection_.unit());
    const double end = 12.0 + length * projection_.unit();
    svg_.BeginPart("scale", true);
    svg_.Layer("scale",
               "M12," + SvgNumber(kHeight - 10.0) + "H" + SvgNumber(end),
               "axis");
    svg_.Text({end + 6.0, kHeight - 6.0}, ShortestNumber(length) + " mm",
              "tick halo");
    svg_.EndPart();
  }

  const ArmView& view_;
  Projection projection_;
  SvgWriter svg_;
};

std::string Caption(const ArmView& view) {
  std::string html;
  if (!view.places.empty()) {
    html = Words(
        "Errors point from the measured point towards where the arm believed "
        "to be, before and after each on a scale of its own. ");
  }
  if (view.poses.empty()) return html;
  // The script says so itself of the pose that is chosen.
  const std::string pose = std::to_string(view.poses[view.first_pose]);
  const std::string& note = view.notes[view.first_pose];
  return html + Element("span", {{"data-pose", pose}},
                        Words("The arm stands at pose " + pose +
                              (note.empty() ? "." : " (" + note + ").")));
}

}  // namespace

std::string ArmViewFigure(const ArmView& view, const std::string& title) {
  if (view.empty()) return "";
  return Element(
             "figure", {{"id", "arm"}},
             Element("div", {{"class", "table-head"}},
                     Element("h3", {}, Words(title))) +
                 Element("div", {{"class", "drawing"}},
                         Drawing(view, title).Draw()) +
                 Element("figcaption", {},
                         Caption(view) + Words(view.shapes.note.empty()
                                                   ? ""
                                                   : " " + view.shapes.note))) +
         "\n";
}

}  // namespace alidade::internal
