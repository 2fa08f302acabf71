#include "src/report/correction_report.h"

#include <algorithm>

#include "alidade/accuracy.h"
#include "alidade/units.h"
#include "src/common/format.h"
#include "src/common/text.h"
#include "src/report/table.h"

namespace alidade::internal {
namespace {

constexpr std::size_t kMostListed = 20;

// The values of those that are reached.
Eigen::VectorXd Reached(const Correction& correction,
                        const Eigen::VectorXd& values) {
  Eigen::VectorXd kept(values.size());
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (correction.IsReached(i)) kept[count++] = values[i];
  }
  return kept.head(count);
}

void AddRow(const std::string& name, const Correction& correction,
            const Eigen::VectorXd& values, Dimension dimension, Table* table) {
  const Accuracy accuracy = SummarizeErrors(Reached(correction, values));
  if (accuracy.n == 0) return;
  table->AddRow({name, CountCell(accuracy.n),
                 QuantityCell(accuracy.mean, dimension, 4),
                 QuantityCell(accuracy.p95, dimension, 4),
                 QuantityCell(accuracy.max, dimension, 4)});
}

std::string ListProblems(const CorrectionReport& report) {
  const Correction& correction = report.correction;
  std::vector<std::string> lines;
  std::size_t count = 0;
  for (Eigen::Index i = 0; i < correction.shift.size(); ++i) {
    if (correction.IsReached(i) || ++count > kMostListed) continue;
    lines.push_back(
        "  " + report.names[i] + ": " + StatusOf(correction, i) + ", " +
        Millimetres(correction.solutions.position_error[i]) + " mm and " +
        FormatSignificant(correction.solutions.rotation_error[i] / kDegree, 3) +
        " deg remain");
  }
  if (correction.shift.size() == 0) {
    return "Nothing is corrected: no position to be corrected is stated in "
           "numbers.\n";
  }
  if (count == 0) return "All targets are reached.\n";
  if (count > kMostListed) {
    lines.push_back("  and " + std::to_string(count - kMostListed) + " more");
  }
  return "Not corrected: " + Count(static_cast<std::int64_t>(count), "target") +
         "\n" + Join(lines, "\n") + "\n";
}

std::string ListOutside(const CorrectionReport& report) {
  if (report.outside.empty()) return "";
  std::vector<std::string> lines;
  std::size_t count = 0;
  for (std::size_t i = 0; i < report.outside.size(); ++i) {
    if (report.outside[i].empty() || ++count > kMostListed) continue;
    const auto& texts =
        report.outside_values.empty() ? report.outside : report.outside_values;
    lines.push_back("  " + report.names[i] + ": " + texts[i]);
  }
  if (count == 0) return "All joints are within what was measured.\n";
  if (count > kMostListed) {
    lines.push_back("  and " + std::to_string(count - kMostListed) + " more");
  }
  return "Joints outside what was measured, where the calibration is an "
         "extrapolation: " +
         Count(static_cast<std::int64_t>(count), "target") + "\n" +
         Join(lines, "\n") + "\n";
}

// Of arms that have no freedom for the whole orientation.
std::string OrientationNote(const Correction& correction) {
  constexpr double kNothing = 1e-7;
  const Accuracy left =
      SummarizeErrors(Reached(correction, correction.solutions.rotation_error));
  if (left.n == 0 || left.max < kNothing) return "";
  return Paragraph(
      "The arm has no freedom to correct all of the orientation: positions are "
      "exact, of the orientation " +
      FormatSignificant(left.mean / kDegree, 3) + " deg remain in the mean, " +
      FormatSignificant(left.max / kDegree, 3) + " deg at most.");
}

// How accurate targets will be, as far as the calibration has shown it.
std::string Expectation(const CorrectionReport& report) {
  if (report.correction.shift.size() == 0) return "";
  std::string text;
  const Accuracy& validation = report.validation;
  if (validation.n > 0) {
    text = "What to expect: " + FormatLength(validation.mean, 3) +
           " in the mean, " + FormatLength(validation.max, 3) +
           " at most, as at the " +
           Count(validation.n, "validation measurement") +
           " of the calibration; errors of the controller's tool and base "
           "come on top.";
    const auto outside =
        std::count_if(report.outside.begin(), report.outside.end(),
                      [](const std::string& one) { return !one.empty(); });
    if (outside > 0) {
      text += " That does not hold for " + Count(outside, "target") +
              ", whose joints are outside what was measured.";
    }
  } else if (report.is_result && report.position_std.size() == 0) {
    text =
        "What to expect is not known: the calibration has no validation "
        "poses. `alidade plan --check` has poses to find out.";
  }
  if (report.position_std.size() > 0) {
    text += std::string(text.empty() ? "" : " ") +
            "The predicted standard deviation is that of the position in "
            "space (root of the sum over x, y and z), by the uncertainty of "
            "the arm's parameters alone.";
  }
  return text.empty() ? "" : Paragraph(text);
}

}  // namespace

std::string LargeCorrectionWarning(const CorrectionReport& report) {
  constexpr double kFar = 3.0;
  const Accuracy shift =
      SummarizeErrors(Reached(report.correction, report.correction.shift));
  const Accuracy& before = report.before;
  if (before.n == 0 || shift.n == 0 || shift.mean <= kFar * before.max) {
    return "";
  }
  return "corrections of " + FormatLength(shift.mean, 3) +
         " in the mean are far larger than what the calibration found: the "
         "nominal arm was off by " +
         FormatLength(before.max, 3) +
         " at most at its poses, base and tool fitted. " + report.nominal_name +
         " is hardly the arm that the controller computes with, nor the one "
         "that was calibrated: check --nominal, and the pendant's poses by "
         "`alidade fk`";
}

std::string StatusOf(const Correction& correction, Eigen::Index i) {
  const PoseStatus asked = correction.asked_status[i];
  if (asked == PoseStatus::kReached) {
    return ToString(correction.solutions.status[i]);
  }
  return std::string(ToString(asked)) + " (controller)";
}

std::string FormatCorrection(const CorrectionReport& report) {
  const Correction& correction = report.correction;
  Table position({"position", ">targets", ">mean mm", ">p95 mm", ">max mm"});
  AddRow("correction", correction, correction.shift, Dimension::kLength,
         &position);
  if (report.position_std.size() > 0) {
    AddRow("predicted standard deviation", correction, report.position_std,
           Dimension::kLength, &position);
  }
  Table rotation(
      {"orientation", ">targets", ">mean deg", ">p95 deg", ">max deg"});
  AddRow("correction", correction, correction.turn, Dimension::kAngle,
         &rotation);
  std::string text = "Targets of " + report.arm_name + "\n";
  if (!report.nominal_name.empty()) {
    text += "The controller is taken to compute with " + report.nominal_name +
            ".\n\n";
  }
  if (!position.empty()) text += position.ToText() + "\n" + rotation.ToText();
  return text + "\n" + ListProblems(report) + report.uncorrected +
         OrientationNote(correction) + ListOutside(report) +
         Expectation(report);
}

Figure CorrectionFigure(const CorrectionReport& report) {
  const Correction& correction = report.correction;
  LineChart chart;
  chart.title = "Correction of each target";
  const Accuracy shift = SummarizeErrors(Reached(correction, correction.shift));
  chart.subtitle = "mean " + Millimetres(shift.mean) + " mm, largest " +
                   Millimetres(shift.max) + " mm";
  chart.x = CountAxis("target");
  chart.y = {"position [mm]"};
  ChartSeries shifts = Markers("correction", MarkerStyle::kDot);
  ChartSeries failed =
      Markers("not reached: remaining error", MarkerStyle::kTriangle, "s2");
  ChartSeries spread =
      Markers("predicted standard deviation", MarkerStyle::kSquare, "s3");
  for (Eigen::Index i = 0; i < correction.shift.size(); ++i) {
    const auto x = static_cast<double>(i + 1);
    const bool is_reached = correction.IsReached(i);
    ChartSeries& series = is_reached ? shifts : failed;
    const double value = is_reached ? correction.shift[i]
                                    : correction.solutions.position_error[i];
    series.x.push_back(x);
    series.y.push_back(value / kMillimetre);
    if (report.position_std.size() == 0) continue;
    spread.x.push_back(x);
    spread.y.push_back(report.position_std[i] / kMillimetre);
  }
  for (ChartSeries* series : {&shifts, &failed, &spread}) {
    if (!series->x.empty()) chart.series.push_back(std::move(*series));
  }
  return chart;
}

}  // namespace alidade::internal
