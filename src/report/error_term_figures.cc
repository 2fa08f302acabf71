#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "src/common/constants.h"
#include "src/common/format.h"
#include "src/common/text.h"
#include "src/report/error_term_tables.h"
#include "src/report/figures.h"
#include "src/report/report.h"
#include "src/report/rows.h"

namespace alidade::internal {
namespace {

constexpr double kBand = 1.96;  // standard deviations

// What a joint's value and its error are shown in.
struct JointUnits {
  double value;
  const char* value_name;
  const char* error_name;
};

JointUnits UnitsOf(const Arm& arm, int joint) {
  return arm.joints[joint].dimension() == Dimension::kAngle
             ? JointUnits{kDegree, "deg", "mrad"}
             : JointUnits{kMillimetre, "mm", "mm"};
}

// The middle 98 % of values, with a margin, so that single ones do not flatten
// all others.
ValueRange MostOf(std::vector<double> values) {
  constexpr double kPart = 0.01;
  constexpr double kMargin = 0.25;
  ValueRange range;
  values.erase(std::remove_if(values.begin(), values.end(),
                              [](double v) { return !std::isfinite(v); }),
               values.end());
  if (values.empty()) return range;
  std::sort(values.begin(), values.end());
  const auto last = static_cast<double>(values.size() - 1);
  const double low = values[static_cast<std::size_t>(kPart * last)];
  const double high = values[static_cast<std::size_t>((1.0 - kPart) * last)];
  const double margin = kMargin * (high - low);
  range.Include(low - margin);
  range.Include(high + margin);
  return range;
}

void SetRange(const ValueRange& range, ChartAxis* axis) {
  if (range.empty()) return;
  axis->lower = range.min;
  axis->upper = range.max;
}

// "3 residuals are beyond the chart".
std::string BeyondNote(const LineChart& chart) {
  std::int64_t beyond = 0;
  for (const ChartSeries& series : chart.series) {
    if (series.line) continue;
    for (const double y : series.y) {
      if (std::isfinite(y) && !IsDrawable(chart.y, y)) ++beyond;
    }
  }
  if (beyond == 0) return "";
  return Count(beyond, "residual") + (beyond == 1 ? " is" : " are") +
         " beyond the chart";
}

// A joint's function at values from below the measured ones to above them.
class FunctionCurve {
 public:
  FunctionCurve(const CalibrationResult& result, int joint)
      : errors_(result.arm.errors.joints[joint]),
        measured_(result.error_terms->measured),
        joint_(joint) {
    constexpr double kBeyond = 0.12;
    constexpr int kSteps = 480;
    ValueRange range;
    for (const MeasuredRange& one : measured_) {
      if (one.joint != joint + 1) continue;
      range.Include(one.lower);
      range.Include(one.upper);
    }
    const JointFunction& function = errors_.function;
    if (range.empty() && !function.empty()) {
      range = {function.first, function.last()};
    }
    if (range.empty()) return;
    const double beyond = kBeyond * (range.max - range.min);
    double first = range.min - beyond;
    double last = range.max + beyond;
    if (!function.empty()) {
      first = std::max(first, function.first);
      last = std::min(last, function.last());
    }
    for (int k = 0; k <= kSteps; ++k) {
      at_.push_back(first + (last - first) * k / kSteps);
    }
  }

  // Where the joint was measured, or where it was not; both meet.
  ChartSeries Series(bool is_measured, const JointUnits& units) const {
    ChartSeries series;
    const auto is_shown = [&](std::size_t k) {
      return IsMeasured(measured_, joint_ + 1, at_[k]) == is_measured;
    };
    for (std::size_t k = 0; k < at_.size(); ++k) {
      const bool is_edge =
          !is_measured && ((k > 0 && is_shown(k - 1)) ||
                           (k + 1 < at_.size() && is_shown(k + 1)));
      const bool shown = is_shown(k) || is_edge;
      const double value = JointErrorAt(errors_, at_[k]) / kMilli;
      const double half = kBand * errors_.function.DeviationAt(at_[k]) / kMilli;
      series.x.push_back(at_[k] / units.value);
      series.y.push_back(shown ? value : kNan);
      if (errors_.function.deviations.size() == 0) continue;
      series.lower.push_back(shown ? value - half : kNan);
      series.upper.push_back(shown ? value + half : kNan);
    }
    return series;
  }

 private:
  const JointErrors& errors_;
  const std::vector<MeasuredRange>& measured_;
  int joint_;
  std::vector<double> at_;
};

void IncludeFinite(const std::vector<double>& values, ValueRange* range) {
  for (const double value : values) {
    if (std::isfinite(value)) range->Include(value);
  }
}

// Residuals of a joint in its units; `of` is one of the matrices.
ChartSeries ResidualDots(const JointResiduals& residuals,
                         const Eigen::MatrixXd& of, int joint,
                         const JointUnits& units, const std::string& label) {
  ChartSeries dots = Markers(label, MarkerStyle::kDot, "s0");
  for (Eigen::Index k = 0; k < of.cols(); ++k) {
    dots.x.push_back(residuals.joint_values(joint, k) / units.value);
    dots.y.push_back(of(joint, k) / kMilli);
  }
  return dots;
}

// "+ functions of 0.1 rad": rows have little room for names, and each set of
// terms adds to the one above it.
std::string ShortName(const ErrorRung& rung) {
  if (rung.num_terms == 0) return "all geometry";
  std::string name = rung.name;
  const auto replace = [&name](const std::string& part, const std::string& by) {
    const std::size_t at = name.find(part);
    if (at != std::string::npos) name.replace(at, part.size(), by);
  };
  replace("elasticity + ", "+ ");
  replace(" of length ", " of ");
  return name;
}

bool HasResiduals(const CalibrationResult& result) {
  return result.error_terms &&
         result.error_terms->residuals.joint_values.cols() > 0;
}

}  // namespace

Figure ErrorStagesFigure(const CalibrationResult& result) {
  const ErrorTermsResult& errors = *result.error_terms;
  const bool is_validated = result.validation.has_value();
  RowChart chart{"Mean position error by what was calibrated",
                 "",
                 {"mean position error [mm]"}};
  chart.looks = {
      Markers(is_validated ? "validation poses" : "training poses",
              MarkerStyle::kBar, "s1"),
      Markers("regions left out of the fit", MarkerStyle::kBar, "s2")};
  const auto add = [&](const std::string& name, double error, double region) {
    ChartRow& row = chart.rows.emplace_back();
    row.label = name;
    for (std::size_t k = 0; k < chart.looks.size(); ++k) {
      const double value = k == 0 ? error : region;
      if (!(value > 0.0)) continue;
      RowMark& mark = row.marks.emplace_back();
      mark.series = k;
      mark.at = value / kMillimetre;
      mark.tip =
          name + ", " + chart.looks[k].label + ": " + FormatLength(value, 3);
    }
  };
  const auto mean = [&](const Accuracy& train, const Accuracy& validation) {
    return is_validated ? validation.mean : train.mean;
  };
  for (const StageResult& stage : result.stages) {
    if (&stage == &result.stages.back()) break;  // the first rung is the last
    add(stage.name, mean(stage.train, stage.validation), 0.0);
  }
  for (const ErrorRung& rung : errors.rungs) {
    add(ShortName(rung), mean(rung.train, rung.validation), rung.region_error);
  }
  add("delivered",
      mean(result.train.after,
           is_validated ? result.validation->after : Accuracy()),
      errors.region_error);
  chart.rows.back().is_emphasised = true;
  return chart;
}

Figure ErrorEffectsFigure(const ErrorTermsResult& errors) {
  RowChart chart{"How far the error terms move the target",
                 "",
                 {"root mean square over the joint limits [mm]"}};
  for (const ErrorTermEffect& effect : errors.effects) {
    if (effect.joint == 0 || effect.term == "all") continue;
    const auto found = std::find_if(
        chart.looks.begin(), chart.looks.end(),
        [&](const ChartSeries& look) { return look.label == effect.term; });
    const auto series = static_cast<std::size_t>(found - chart.looks.begin());
    if (found == chart.looks.end()) {
      chart.looks.push_back(Markers(effect.term, MarkerStyle::kBar));
    }
    const std::string name = "joint " + std::to_string(effect.joint);
    if (chart.rows.empty() || chart.rows.back().label != name) {
      chart.rows.emplace_back().label = name;
    }
    RowMark& mark = chart.rows.back().marks.emplace_back();
    mark.series = series;
    mark.at = effect.rms / kMillimetre;
    mark.tip = name + ", " + effect.term + ": " + FormatLength(effect.rms, 3) +
               ", at most " + FormatLength(effect.max, 3);
  }
  return chart;
}

std::optional<LineChart> JointFunctionChart(const CalibrationResult& result,
                                            int joint) {
  const ErrorTerms& errors = result.arm.errors;
  if (!result.error_terms || errors.joints.empty()) return std::nullopt;
  const JointErrors& of = errors.joints[joint];
  if (of.function.empty() && of.harmonics.empty()) return std::nullopt;
  const JointUnits units = UnitsOf(result.arm, joint);
  const std::string name = "joint " + std::to_string(joint + 1);
  const FunctionCurve curve(result, joint);
  ChartSeries measured = curve.Series(true, units);
  const bool has_band = !measured.upper.empty();
  measured.label = has_band ? "function, 95 %" : "function";
  measured.colour = "s1";
  ChartSeries beyond = curve.Series(false, units);
  beyond.label = "not measured";
  beyond.colour = "s0";
  LineChart chart{"Error of " + name,
                  "",
                  {"value of " + name + " [" + units.value_name + "]"},
                  {std::string("error [") + units.error_name + "]"}};
  ValueRange range;
  if (HasResiduals(result)) {
    const JointResiduals& residuals = result.error_terms->residuals;
    ChartSeries dots = ResidualDots(residuals, residuals.remaining, joint,
                                    units, "training poses");
    for (std::size_t k = 0; k < dots.y.size(); ++k) {
      dots.y[k] += JointErrorAt(of, dots.x[k] * units.value) / kMilli;
    }
    range = MostOf(dots.y);
    chart.series.push_back(std::move(dots));
  }
  IncludeFinite(measured.y, &range);
  IncludeFinite(measured.lower, &range);
  IncludeFinite(measured.upper, &range);
  SetRange(range, &chart.y);
  chart.series.push_back(std::move(beyond));
  chart.series.push_back(std::move(measured));
  chart.subtitle = BeyondNote(chart);
  return chart;
}

std::optional<LineChart> JointResidualChart(const CalibrationResult& result,
                                            int joint) {
  if (!HasResiduals(result)) return std::nullopt;
  const JointResiduals& residuals = result.error_terms->residuals;
  const JointUnits units = UnitsOf(result.arm, joint);
  const std::string name = "joint " + std::to_string(joint + 1);
  LineChart chart{"Residuals along " + name,
                  "",
                  {"value of " + name + " [" + units.value_name + "]"},
                  {std::string("residual [") + units.error_name + "]"}};
  chart.series = {ResidualDots(residuals, residuals.geometry, joint, units,
                               "geometry alone"),
                  ResidualDots(residuals, residuals.remaining, joint, units,
                               "with error terms")};
  chart.series[1].colour = "s1";
  ValueRange range = MostOf(chart.series[0].y);
  const ValueRange with_terms = MostOf(chart.series[1].y);
  if (range.empty()) return std::nullopt;
  range.Include(with_terms.min);
  range.Include(with_terms.max);
  SetRange(range, &chart.y);
  chart.subtitle = BeyondNote(chart);
  return chart;
}

namespace {

std::string FunctionRows(const CalibrationResult& result) {
  std::string text = "joint,q,q_unit,value,std,unit,measured\n";
  const Arm& arm = result.arm;
  for (std::size_t j = 0; j < arm.errors.joints.size(); ++j) {
    const JointFunction& function = arm.errors.joints[j].function;
    const int joint = static_cast<int>(j) + 1;
    const JointUnits units = UnitsOf(arm, static_cast<int>(j));
    for (Eigen::Index k = 0; k < function.values.size(); ++k) {
      const double at =
          function.first + function.spacing * static_cast<double>(k);
      const double std =
          function.deviations.size() == 0 ? kNan : function.deviations[k];
      AppendCsvCells(&text, joint, at / units.value,
                     std::string(units.value_name), function.values[k] / kMilli,
                     std / kMilli, std::string(units.error_name));
      EndCsvRow(&text, IsMeasured(result.error_terms->measured, joint, at));
    }
  }
  return text;
}

std::string ResidualRows(const CalibrationResult& result) {
  const JointResiduals& residuals = result.error_terms->residuals;
  std::vector<JointUnits> units;
  std::string text = "pose";
  for (int j = 0; j < result.arm.num_joints(); ++j) {
    units.push_back(UnitsOf(result.arm, j));
    const std::string number = std::to_string(j + 1);
    const std::string unit = std::string("_") + units.back().error_name;
    text += ",q" + number + "_" + units.back().value_name + ",geometry" +
            number + unit + ",remaining" + number + unit;
  }
  text += "\n";
  for (std::size_t k = 0; k < residuals.poses.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    text += std::to_string(residuals.poses[k] + 1);
    for (std::size_t j = 0; j < units.size(); ++j) {
      const auto row = static_cast<Eigen::Index>(j);
      text += ",";
      AppendCsvCells(&text,
                     residuals.joint_values(row, column) / units[j].value,
                     residuals.geometry(row, column) / kMilli);
      AppendCsvCell(&text, residuals.remaining(row, column) / kMilli);
    }
    text += "\n";
  }
  return text;
}

template <typename MakeChart>
void AddPanels(const CalibrationResult& result, const std::string& name,
               PanelChart chart, const MakeChart& make,
               std::vector<ReportFile>* files) {
  for (int j = 0; j < result.arm.num_joints(); ++j) {
    std::optional<LineChart> panel = make(result, j);
    if (panel) chart.panels.push_back(*std::move(panel));
  }
  if (chart.panels.empty()) return;
  files->emplace_back(name, RenderSvg(chart));
}

}  // namespace

std::vector<ReportFile> MakeErrorTermFiles(const CalibrationResult& result) {
  std::vector<ReportFile> files;
  if (!result.error_terms) return files;
  const ErrorTermsResult& errors = *result.error_terms;
  if (!errors.rungs.empty()) {
    files.emplace_back("error_stages.svg",
                       ErrorStagesFigure(result).render(FigureMedium::kFile));
  }
  if (!(errors.share > 0.0)) return files;
  files.emplace_back("joint_functions.csv", FunctionRows(result));
  if (HasResiduals(result)) {
    files.emplace_back("joint_residuals.csv", ResidualRows(result));
  }
  files.emplace_back("error_effects.svg",
                     ErrorEffectsFigure(errors).render(FigureMedium::kFile));
  AddPanels(result, "joint_functions.svg",
            {"Error functions of the joints",
             "with 95 % bands; dots: residuals of training poses about them"},
            JointFunctionChart, &files);
  AddPanels(result, "joint_residuals.svg",
            {"Residuals along each joint, by its value",
             "what each joint would have to turn further, training poses"},
            JointResidualChart, &files);
  return files;
}

}  // namespace alidade::internal
