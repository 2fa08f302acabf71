#include "src/report/figures.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "src/calibration/improvement.h"
#include "src/common/constants.h"
#include "src/common/format.h"
#include "src/common/text.h"
#include "src/report/arm_view.h"
#include "src/report/report.h"
#include "src/solve/solver_names.h"

namespace alidade::internal {
namespace {

// Markers of more iterations than this would run into each other.
constexpr std::size_t kMostMarkedIterations = 40;
// Poses lie in one plane when their height varies by less than this share of
// their extent.
constexpr double kFlat = 0.05;
constexpr Eigen::Index kFewestOfPlane = 3;
// Of more observations than so many only the worst of neighbours are drawn: the
// others would lie behind them.
constexpr Eigen::Index kMostDrawn = 100000;
constexpr Eigen::Index kMostScattered = 4000;
// Errors that fall by more than this factor are drawn on a logarithmic axis.
constexpr double kLargeFall = 50.0;
// The numerical precision limit is shown where errors come within this factor
// of it.
constexpr double kNearFloor = 1e4;

// Keeps a number and its unit on one line.
constexpr const char* kNoBreak = "\u00a0";

std::string LengthInWords(double metres) {
  return FormatSignificant(metres / kMillimetre, 3) + kNoBreak + "mm";
}

// The errors of a set as people read them: of positions in mm, or of
// orientations in degrees where no length was measured.
class ShownErrors {
 public:
  ShownErrors(const EvaluatedSet& set, CalibrationState state)
      : set_(set),
        is_rotation_(set.after.n == 0 && set.rotation_after.n > 0),
        is_after_(state == CalibrationState::kAfter) {}

  Eigen::Index size() const { return set_.residual_after.cols(); }
  const char* unit() const { return is_rotation_ ? "deg" : "mm"; }
  std::string label() const {
    return std::string(is_rotation_ ? "orientation error"
                                    : LengthErrorName(set_)) +
           " [" + unit() + "]";
  }

  // NaN where the observation has none.
  double operator[](Eigen::Index i) const {
    const bool has_label = !set_.labels.empty();
    if (is_rotation_) {
      if (has_label && !set_.labels[i].has_rotation) return kNan;
      return Column(set_.rotation_residual_before, set_.rotation_residual_after,
                    i) /
             kDegree;
    }
    if (has_label && !set_.labels[i].has_length) return kNan;
    return Column(set_.residual_before, set_.residual_after, i) / kMillimetre;
  }

  std::string title() const {
    std::string name =
        is_rotation_ ? "orientation error" : LengthErrorName(set_);
    name[0] = static_cast<char>(name[0] - 'a' + 'A');
    return name + (is_after_ ? " after" : " before") + " calibration, ";
  }

  const Accuracy& accuracy() const {
    if (is_rotation_) {
      return is_after_ ? set_.rotation_after : set_.rotation_before;
    }
    return is_after_ ? set_.after : set_.before;
  }

  // "1.94 to 5.21 mm, mean 3.29 mm"; one number where all print the same.
  std::string Headline() const {
    const Accuracy& all = accuracy();
    if (all.n == 0) return "nothing was evaluated";
    const std::string end = std::string(kNoBreak) + unit();
    const std::string largest = Shown(all.max);
    if (Shown(all.min) == largest) return largest + end + " at every pose";
    return Shown(all.min) + " to " + largest + end + ", mean " +
           Shown(all.mean) + end;
  }

  // "pose 7, smr2: 0.123 mm", and where it was read.
  std::string Describe(Eigen::Index i) const {
    const std::string end =
        ": " + FormatSignificant((*this)[i], 3) + " " + unit();
    if (set_.labels.empty()) return "pose " + std::to_string(i + 1) + end;
    const ObservationLabel& label = set_.labels[i];
    std::string text =
        label.pose < 0 ? label.kind : "pose " + std::to_string(label.pose + 1);
    if (!label.target.empty()) text += ", " + label.target;
    const std::string where =
        label.where.substr(label.where.find_last_of('/') + 1);
    return text + end + (where.empty() ? "" : "\n" + where);
  }

 private:
  std::string Shown(double value) const {
    return FormatSignificant(value / (is_rotation_ ? kDegree : kMillimetre), 3);
  }
  double Column(const SharedMatrix& before, const SharedMatrix& after,
                Eigen::Index i) const {
    return (is_after_ ? after : before).col(i).norm();
  }

  const EvaluatedSet& set_;
  bool is_rotation_;
  bool is_after_;
};

// The worst of neighbours, no more than `most`.
std::vector<Eigen::Index> DrawnObservations(const ShownErrors& errors,
                                            Eigen::Index most) {
  std::vector<Eigen::Index> drawn;
  const Eigen::Index step = (errors.size() + most - 1) / most;
  for (Eigen::Index first = 0; first < errors.size(); first += step) {
    Eigen::Index worst = first;
    const Eigen::Index end = std::min(first + step, errors.size());
    for (Eigen::Index i = first + 1; i < end; ++i) {
      if (!(errors[i] <= errors[worst])) worst = i;
    }
    drawn.push_back(worst);
  }
  return drawn;
}

// A copy of so few is no burden.
bool MayLieInPlane(const EvaluatedSet& set) {
  return set.positions.cols() >= kFewestOfPlane &&
         set.positions.cols() <= kMostDrawn && set.positions.map().allFinite();
}

bool IsHorizontalPlane(const Eigen::Matrix3Xd& places) {
  const Eigen::Vector3d extent =
      places.rowwise().maxCoeff() - places.rowwise().minCoeff();
  return extent.z() < kFlat * extent.head<2>().maxCoeff();
}

// `places` are in the frame of the base.
MapChart PlaneChart(const EvaluatedSet& set, CalibrationState state,
                    const Eigen::Matrix3Xd& places) {
  const ShownErrors errors(set, state);
  MapChart chart{errors.title() + "validation poses",
                 errors.Headline() + " (" + Count(errors.accuracy().n, "pose") +
                     " at z" + kNoBreak + "=" + kNoBreak +
                     LengthInWords(places.row(2).mean()) + ")",
                 {"x [mm]"},
                 {"y [mm]"},
                 {errors.label()}};
  for (Eigen::Index i = 0; i < errors.size(); ++i) {
    chart.px.push_back(places(0, i) / kMillimetre);
    chart.py.push_back(places(1, i) / kMillimetre);
    chart.value.push_back(errors[i]);
  }
  chart.tip = [errors](std::size_t i) {
    return errors.Describe(static_cast<Eigen::Index>(i));
  };
  return chart;
}

ChartSeries ConvergenceCurve(const SolverSummary& summary, MarkerStyle marker) {
  ChartSeries series;
  series.label = SolverTitle(summary.solver);
  for (const IterationRecord& record : summary.iterations) {
    series.x.push_back(record.iteration);
    series.y.push_back(record.max_error / kMillimetre);
  }
  if (series.x.size() <= kMostMarkedIterations) series.marker = marker;
  series.tip = [&summary, title = series.label](std::size_t i) {
    const IterationRecord& record = summary.iterations[i];
    return title + ", iteration " + std::to_string(record.iteration) + ":\n" +
           LengthInWords(record.max_error);
  };
  return series;
}

std::string ConvergenceHeadline(const std::vector<SolverRun>& runs) {
  std::vector<std::string> parts;
  for (const SolverRun& run : runs) {
    const auto& iterations = run.summary.iterations;
    if (iterations.empty()) continue;
    parts.push_back(ShortSolverTitle(run.summary.solver) + ": " +
                    LengthInWords(iterations.back().max_error) + " after " +
                    Count(iterations.back().iteration, "iteration"));
  }
  const std::int64_t rejected =
      runs.empty() ? 0 : runs.front().summary.num_rejected;
  if (rejected > 0) {
    parts.push_back("without " + Count(rejected, "rejected observation"));
  }
  return Join(parts, "; ");
}

}  // namespace

Figure ErrorFigure(const EvaluatedSet& set, CalibrationState state,
                   const std::string& pose) {
  const ShownErrors errors(set, state);
  LineChart chart{
      errors.title() + pose + "s",
      errors.Headline() + " (" + Count(errors.accuracy().n, pose) + ")",
      CountAxis(pose),
      {errors.label()}};
  ChartSeries series = Markers("", MarkerStyle::kStem,
                               state == CalibrationState::kAfter ? "s1" : "s2");
  std::vector<Eigen::Index> drawn = DrawnObservations(errors, kMostDrawn);
  for (const Eigen::Index i : drawn) {
    series.x.push_back(static_cast<double>(i + 1));
    series.y.push_back(errors[i]);
  }
  series.tip = [errors, drawn = std::move(drawn)](std::size_t i) {
    return errors.Describe(drawn[i]);
  };
  chart.series.push_back(std::move(series));
  return chart;
}

Figure ValidationFigure(const EvaluatedSet& set, CalibrationState state,
                        const Arm& arm) {
  if (MayLieInPlane(set)) {
    const Eigen::Matrix3Xd places = OutlineOf(arm, {}).InBase(set.positions);
    if (IsHorizontalPlane(places)) return PlaneChart(set, state, places);
  }
  return ErrorFigure(set, state, ObservationName(set, "validation"));
}

ArmOutline OutlineOf(const Arm& arm, const EvaluatedSet& set) {
  ArmOutline outline;
  outline.base_from_instrument =
      Eigen::Isometry3d(arm.instrument_from_base).inverse();
  const ArmPicture picture = PictureOf(arm, set);
  outline.corners.setZero(3, 1);
  if (!picture.lines.empty()) {
    outline.corners = outline.InBase(picture.lines.front());
  }
  return outline;
}

ArmOutline OutlineOf(const CalibrationResult& result) {
  return OutlineOf(result.arm, result.train);
}

bool HasNothing(const Histogram& histogram) {
  return std::all_of(histogram.counts.begin(), histogram.counts.end(),
                     [](std::int64_t count) { return count == 0; });
}

Figure JointFigure(const EvaluatedSet& set, Eigen::Index joint) {
  const bool is_angle = set.joint_dimensions[joint] == Dimension::kAngle;
  const ShownErrors before(set, CalibrationState::kBefore);
  const ShownErrors after(set, CalibrationState::kAfter);
  const std::string name = "joint " + std::to_string(joint + 1);
  LineChart chart{"Error by the value of " + name,
                  "",
                  {name + (is_angle ? " [deg]" : " [mm]")},
                  {after.label()}};
  chart.y.logarithmic =
      before.accuracy().max > kLargeFall * after.accuracy().max &&
      after.accuracy().max > 0.0;
  const std::vector<Eigen::Index> drawn =
      DrawnObservations(after, kMostScattered);
  for (const ShownErrors& errors : {before, after}) {
    ChartSeries series = chart.series.empty()
                             ? Markers("before", MarkerStyle::kSquare, "s2")
                             : Markers("after", MarkerStyle::kDot, "s1");
    for (const Eigen::Index i : drawn) {
      const Eigen::Index pose = set.labels.empty() ? i : set.labels[i].pose;
      series.x.push_back(pose < 0 ? kNan
                                  : set.joint_values(joint, pose) /
                                        (is_angle ? kDegree : kMillimetre));
      series.y.push_back(errors[i]);
    }
    series.tip = [errors, drawn](std::size_t i) {
      return errors.Describe(drawn[i]);
    };
    chart.series.push_back(std::move(series));
  }
  return chart;
}

Figure ConvergenceFigure(const std::vector<SolverRun>& runs) {
  constexpr MarkerStyle kMarkers[] = {MarkerStyle::kDot, MarkerStyle::kSquare,
                                      MarkerStyle::kTriangle};
  LineChart chart{"Largest position error by iteration, training poses",
                  ConvergenceHeadline(runs), CountAxis("iteration"),
                  LogarithmicAxis("largest position error [mm]")};
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < runs.size(); ++i) {
    chart.series.push_back(
        ConvergenceCurve(runs[i].summary, kMarkers[i % std::size(kMarkers)]));
    for (const double error : chart.series.back().y) {
      smallest = std::min(smallest, error * kMillimetre);
    }
  }
  const double floor =
      runs.empty() ? 0.0 : runs.front().summary.precision_limit;
  if (floor > 0.0 && smallest < kNearFloor * floor) {
    chart.references.push_back(
        {floor / kMillimetre,
         "numerical precision limit, " + LengthInWords(floor)});
  }
  return chart;
}

std::vector<std::pair<std::string, Figure>> ResultFigures(
    const CalibrationResult& result) {
  std::vector<std::pair<std::string, Figure>> figures;
  constexpr auto kBefore = CalibrationState::kBefore;
  constexpr auto kAfter = CalibrationState::kAfter;
  const std::string pose = ObservationName(result.train, "training");
  figures.emplace_back("error_before",
                       ErrorFigure(result.train, kBefore, pose));
  figures.emplace_back("error_after", ErrorFigure(result.train, kAfter, pose));
  figures.emplace_back("convergence", ConvergenceFigure(result.runs));
  if (result.validation) {
    figures.emplace_back(
        "validation_before",
        ValidationFigure(*result.validation, kBefore, result.arm));
    figures.emplace_back(
        "validation_after",
        ValidationFigure(*result.validation, kAfter, result.arm));
  }
  return figures;
}

std::vector<ReportFile> MakeFigures(const CalibrationResult& result) {
  std::vector<ReportFile> files;
  for (const auto& [name, figure] : ResultFigures(result)) {
    files.emplace_back(name + ".svg", figure.render(FigureMedium::kFile));
  }
  return files;
}

}  // namespace alidade::internal
