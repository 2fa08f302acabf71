#include "src/report/uncertainty_report.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "src/calibration/verdict.h"
#include "src/common/format.h"
#include "src/common/text.h"
#include "src/report/figures.h"
#include "src/report/report.h"
#include "src/report/rows.h"
#include "src/report/table.h"
#include "src/uncertainty/lack_of_fit.h"

namespace alidade::internal {
namespace {

constexpr std::size_t kPosesListed = 5;
constexpr std::size_t kMostPoses = 8;  // of a page

// A pose that moves the estimate by as much as its own spread: Cook's usual
// bound.
constexpr double kDominates = 1.0;

const ParameterResult* Find(const CalibrationResult& result,
                            const std::string& name) {
  for (const ParameterResult& parameter : result.parameters) {
    if (parameter.name == name) return &parameter;
  }
  return nullptr;
}

std::string IntervalTable(const CalibrationResult& result) {
  Table table({"name", "unit", ">deviation", ">std", ">robust", ">from", ">to",
               ">in std", ">nonlinearity", ">prior %", "interval"});
  for (const ParameterUncertainty& one : result.uncertainty->parameters) {
    const ParameterResult* parameter = Find(result, one.name);
    if (parameter == nullptr) continue;
    const Dimension dimension = parameter->dimension;
    const double nominal = parameter->nominal;
    table.AddRow({one.name, UnitForPeople(dimension),
                  InUnit(parameter->deviation(), dimension, 4),
                  InUnit(one.std, dimension, 2),
                  InUnit(one.robust_std, dimension, 2),
                  InUnit(one.interval.lower - nominal, dimension, 4),
                  InUnit(one.interval.upper - nominal, dimension, 4),
                  FormatSignificant(parameter->deviation() / one.std, 2),
                  FormatSignificant(one.nonlinearity, 1),
                  FixedNumber(100.0 * one.prior_share, 0),
                  one.interval.is_profile ? "profile" : "linear"});
  }
  return table.ToText();
}

std::string Correlations(const UncertaintyResult& uncertainty) {
  if (uncertainty.correlated.empty()) return "";
  std::vector<std::string> pairs;
  for (const CorrelatedPair& pair : uncertainty.correlated) {
    pairs.push_back(pair.first + " and " + pair.second + " (" +
                    FixedNumber(pair.correlation, 3) + ")");
  }
  return Paragraph("Strongly correlated: " + Join(pairs, ", ") + ".");
}

// "0.03 mm from parameters, 0.09 mm from what the model lacks".
std::string DescribeParts(const PredictionParts& parts) {
  return FormatLength(parts.from_parameters, 3) + " from parameters, " +
         FormatLength(parts.from_model, 3) +
         " from what the model lacks; a measurement adds " +
         FormatLength(parts.from_measurement, 3);
}

std::string Influences(const ResidualDiagnostics& residuals) {
  const Table table = InfluenceTable(residuals);
  if (table.empty()) return "";
  std::string text = "\nPoses that the result depends on most:\n";
  text += table.ToText(kPosesListed);
  const auto dominates = [](const Influence& pose) {
    return pose.cooks_distance > kDominates;
  };
  if (std::any_of(residuals.poses.begin(), residuals.poses.end(), dominates)) {
    text += Paragraph(
        "The first moves the result by more than its own uncertainty: measure "
        "it again, or others like it.");
  }
  return text;
}

// Refers to `poses`.
TextSource InfluenceCsv(const std::vector<Influence>& poses) {
  const auto append_row = [&poses](std::int64_t row, std::string* csv) {
    const Influence& pose = poses[static_cast<std::size_t>(row)];
    *csv += std::to_string(pose.pose + 1);
    for (const double value :
         {pose.leverage, pose.cooks_distance, pose.standardised}) {
      *csv += ',';
      AppendShortest(value, csv);
    }
    *csv += '\n';
  };
  return MakeRows("pose,leverage,cooks_distance,standardised_residual\n",
                  static_cast<std::int64_t>(poses.size()), append_row);
}

std::string MapCsv(const PredictedMap& map,
                   const std::vector<Dimension>& joints) {
  std::string csv;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    csv += "q" + std::to_string(j + 1) +
           (joints[j] == Dimension::kAngle ? "_deg," : "_mm,");
  }
  csv +=
      "x_mm,y_mm,z_mm,position_std_mm,axis1_mm,axis2_mm,axis3_mm,"
      "rotation_std_deg";
  const bool has_truth = map.true_error.size() > 0;
  csv += has_truth ? ",true_error_mm\n" : "\n";
  for (Eigen::Index i = 0; i < map.position_std.size(); ++i) {
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const double unit =
          joints[j] == Dimension::kAngle ? kDegree : kMillimetre;
      csv += ShortestNumber(map.joint_values(static_cast<Eigen::Index>(j), i) /
                            unit) +
             ",";
    }
    for (const double value : map.positions.col(i)) {
      csv += ShortestNumber(value / kMillimetre) + ",";
    }
    csv += ShortestNumber(map.position_std[i] / kMillimetre);
    for (const double value : map.semi_axes.col(i)) {
      csv += "," + ShortestNumber(value / kMillimetre);
    }
    csv += "," + ShortestNumber(map.rotation_std[i] / kDegree);
    if (has_truth) csv += "," + ShortestNumber(map.true_error[i] / kMillimetre);
    csv += "\n";
  }
  return csv;
}

// As the histogram's title says; the normal curve of as many values.
ChartSeries NormalCurve(const Histogram& histogram, double total) {
  constexpr int kSteps = 120;
  ChartSeries normal;
  normal.label = "standard normal";
  const double width =
      histogram.width * static_cast<double>(histogram.counts.size());
  for (int i = 0; i <= kSteps; ++i) {
    const double x = histogram.lower + width * i / kSteps;
    normal.x.push_back(x);
    normal.y.push_back(total * histogram.width / std::sqrt(2.0 * kPi) *
                       std::exp(-0.5 * x * x));
  }
  return normal;
}

}  // namespace

Figure HistogramFigure(const std::string& title, const Histogram& histogram) {
  LineChart chart;
  chart.title = title;
  chart.x.label = "standard deviations";
  chart.y.label = "number";
  ChartSeries bars;
  bars.marker = MarkerStyle::kBar;
  bars.bar_width = histogram.width;
  bars.label = "observed";
  std::int64_t total = 0;
  for (std::size_t k = 0; k < histogram.counts.size(); ++k) {
    total += histogram.counts[k];
    bars.x.push_back(histogram.lower +
                     histogram.width * (static_cast<double>(k) + 0.5));
    bars.y.push_back(static_cast<double>(histogram.counts[k]));
  }
  bars.tip = [x = bars.x, y = bars.y,
              half = 0.5 * histogram.width](std::size_t k) {
    return FixedNumber(x[k] - half, 2) + " to " + FixedNumber(x[k] + half, 2) +
           ": " + FixedNumber(y[k], 0);
  };
  chart.subtitle =
      Count(total, "value") + "; the outermost bars hold all beyond them";
  chart.series = {bars, NormalCurve(histogram, static_cast<double>(total))};
  return chart;
}

Figure PredictedMapFigure(const PredictedMap& map, const ArmOutline& arm) {
  MapChart chart;
  chart.title = "Predicted standard deviation of the position";
  chart.subtitle = Count(map.summary.n, "configuration") + ", median " +
                   FormatLength(map.summary.median, 3) + ", 95 % below " +
                   FormatLength(map.summary.p95, 3);
  chart.x.label = "distance from the base's z axis [mm]";
  chart.y.label = "height [mm]";
  chart.colour.label = "standard deviation [mm]";
  for (Eigen::Index k = 0; k < arm.corners.cols(); ++k) {
    chart.outline.emplace_back(
        arm.corners.col(k).head<2>().norm() / kMillimetre,
        arm.corners(2, k) / kMillimetre);
  }
  const Eigen::Matrix3Xd places = arm.InBase(map.positions);
  for (Eigen::Index i = 0; i < map.position_std.size(); ++i) {
    if (!std::isfinite(map.position_std[i])) continue;
    chart.px.push_back(places.col(i).head<2>().norm() / kMillimetre);
    chart.py.push_back(places(2, i) / kMillimetre);
    chart.value.push_back(map.position_std[i] / kMillimetre);
  }
  chart.tip = [values = chart.value](std::size_t i) {
    return FormatSignificant(values[i], 3) + " mm";
  };
  const auto worst = std::max_element(chart.value.begin(), chart.value.end());
  constexpr double kSame = 1.02;  // as in words
  if (worst != chart.value.end() &&
      *worst * kMillimetre > kSame * map.summary.median) {
    const auto k = static_cast<std::size_t>(worst - chart.value.begin());
    chart.marked = {chart.px[k], chart.py[k]};
    chart.marked_name = "worst";
  }
  return chart;
}

Table InfluenceTable(const ResidualDiagnostics& residuals) {
  std::vector<Influence> poses = residuals.poses;
  std::stable_sort(poses.begin(), poses.end(),
                   [](const Influence& a, const Influence& b) {
                     return a.cooks_distance > b.cooks_distance;
                   });
  if (poses.size() > kMostPoses) poses.resize(kMostPoses);
  Table table("influence", "Influential poses",
              {">pose", ">leverage",
               ">Cook's distance|how far the fit moves without it",
               ">residual [sigma]", Table::TextOnly("where")});
  for (const Influence& pose : poses) {
    table.AddRow({CountCell(pose.pose + 1), NumberCell(pose.leverage, 3),
                  NumberCell(pose.cooks_distance, 3),
                  NumberCell(pose.standardised, 3), pose.where});
  }
  return table;
}

Table CorrelationTable(const UncertaintyResult& uncertainty) {
  Table table("correlated", "Strongly correlated parameters",
              {"first", "second", ">correlation"});
  for (const CorrelatedPair& pair : uncertainty.correlated) {
    table.AddRow({pair.first, pair.second, FixedCell(pair.correlation, 3)});
  }
  return table;
}

std::string DescribeMap(const PredictedMap& map) {
  std::string text =
      "Predicted standard deviation of the target's position over " +
      Count(map.summary.n, "configuration") +
      " drawn within the joint limits: median " +
      FormatLength(map.summary.median, 3) + ", 95 % below " +
      FormatLength(map.summary.p95, 3) + ", largest " +
      FormatLength(map.summary.max, 3);
  if (map.rotation_summary.n > 0) {
    text += "; of its orientation: median " +
            FormatSignificant(map.rotation_summary.median / kDegree, 3) +
            " deg";
  }
  text += ". Root mean square: " + DescribeParts(map.parts);
  if (map.true_summary.n > 0) {
    text += ". The true error there, of the arm that is known: median " +
            FormatLength(map.true_summary.median, 3) + ", 95 % below " +
            FormatLength(map.true_summary.p95, 3) + ", largest " +
            FormatLength(map.true_summary.max, 3);
  }
  return text + ".";
}

std::string DescribeLackOfFit(const UncertaintyResult& uncertainty) {
  const LackOfFit& lack = uncertainty.lack_of_fit;
  if (!(lack.degrees_of_freedom > 0.0)) return "";
  std::string text = "The residuals are " + FormatLength(lack.residual, 3) +
                     " in each coordinate";
  const auto p_value = [](double p) {
    return p < 1e-16 ? "p < 1e-16" : "p = " + FormatSignificant(p, 2);
  };
  switch (lack.source) {
    case NoiseSource::kNone:
      text +=
          "; what of it the model lacks cannot be separated from noise: "
          "measure some poses several times, or state the instrument's sigma";
      break;
    case NoiseSource::kStated:
    case NoiseSource::kRepeats:
      text += ", " +
              std::string(lack.source == NoiseSource::kRepeats
                              ? "those of repeated poses "
                              : "as stated they would be ") +
              FormatLength(lack.noise, 3) +
              " (lack of fit: " + p_value(lack.p_value) + ")";
      break;
    case NoiseSource::kStructure:
      text += ", without the structure that was found in them " +
              FormatLength(lack.noise, 3);
  }
  std::vector<std::string> found;
  for (const StructureTest& test : lack.structure) {
    if (test.is_found) found.push_back(NameOf(test));
  }
  const auto tests = static_cast<std::int64_t>(lack.structure.size());
  if (tests > 0) {
    text += ". " + Count(tests, "test") + " of structure: the residuals " +
            (found.empty()
                 ? "depend on none of what was looked at (smallest corrected " +
                       p_value(lack.structure.front().p_value) + ")"
                 : "depend on " + Join(found, ", "));
  }
  if (lack.is_sample) text += ". An even sample of the poses was looked at";
  return text + ".";
}

Table StructureTable(const LackOfFit& lack) {
  constexpr std::size_t kMost = 8;
  Table table("structure", "What the residuals depend on",
              {"on", ">F", ">degrees of freedom", ">p, corrected",
               ">explained [%]", "found"});
  for (std::size_t k = 0; k < std::min(kMost, lack.structure.size()); ++k) {
    const StructureTest& test = lack.structure[k];
    table.AddRow(
        {NameOf(test), NumberCell(test.statistic, 3),
         NumberCell(test.degrees_of_freedom, 3), NumberCell(test.p_value, 2),
         FixedCell(100.0 * test.explained, 1), test.is_found ? "yes" : ""});
  }
  return table;
}

std::string UncertaintySection(const CalibrationResult& result) {
  if (!result.uncertainty) return "";
  const UncertaintyResult& uncertainty = *result.uncertainty;
  std::string text = Paragraph(
      "Deviations from nominal with their " +
      FixedPercent(uncertainty.confidence, 1) + " intervals" +
      (std::isfinite(uncertainty.degrees_of_freedom)
           ? ", Student's t with " +
                 FormatSignificant(uncertainty.degrees_of_freedom, 4) +
                 " degrees of freedom"
           : ", sigma as stated") +
      (uncertainty.estimator == "sandwich" ? ", sandwich estimator" : "") +
      ". \"robust\": the standard deviation that the residuals of each "
      "configuration give (sandwich); \"nonlinearity\": the second-order part "
      "of an "
      "estimate in standard "
      "deviations; \"prior\": the part of it that is known a priori.");
  text += "\n" + IntervalTable(result) + "\n";
  text += Correlations(uncertainty);
  const std::string tests =
      FindingSentences(result, {"normality", "whiteness"});
  if (!tests.empty()) text += Paragraph(tests);
  text += Paragraph(DescribeLackOfFit(uncertainty));
  text += Influences(uncertainty.residuals);
  if (uncertainty.workspace) {
    text += "\n" + Paragraph(DescribeMap(*uncertainty.workspace));
    const Table regions = RegionTable(result);
    if (!regions.empty()) {
      text += "\nBy region, in the frame of the base:\n\n" + regions.ToText() +
              "\n";
    }
  }
  const std::string prediction = FindingSentences(result, {"prediction"});
  if (!prediction.empty()) {
    text += Paragraph(prediction + " Predicted: " +
                      DescribeParts(uncertainty.validation->parts) + ".");
  }
  return text;
}

std::string FormatPredictionCheck(const std::string& where,
                                  const PredictionCheck& check) {
  const std::string text = DescribePrediction(where, check);
  if (text.empty()) return "";
  return Paragraph(text + " Predicted: " + DescribeParts(check.parts) + ".");
}

std::string FormatPredictedMap(const PredictedMap& map) {
  return Paragraph(DescribeMap(map));
}

std::vector<ReportFile> MakePredictionFiles(
    const Arm& arm, const PredictedMap& map,
    const std::optional<PredictionCheck>& check) {
  std::vector<ReportFile> files = {
      {"predicted_map.csv", MapCsv(map, arm.JointDimensions())},
      {"predicted_map.svg", PredictedMapFigure(map, OutlineOf(arm, {}))
                                .render(FigureMedium::kFile)}};
  if (!check) return files;
  files.emplace_back("z_scores.svg",
                     HistogramFigure("Errors over their predicted standard "
                                     "deviations",
                                     check->histogram)
                         .render(FigureMedium::kFile));
  return files;
}

std::vector<ReportFile> MakeUncertaintyFiles(const CalibrationResult& result) {
  std::vector<ReportFile> files;
  if (!result.uncertainty) return files;
  const UncertaintyResult& uncertainty = *result.uncertainty;
  if (!uncertainty.residuals.poses.empty()) {
    files.emplace_back("influence.csv",
                       InfluenceCsv(uncertainty.residuals.poses));
  }
  files.emplace_back("residual_histogram.svg",
                     HistogramFigure("Residuals over their own sigmas",
                                     uncertainty.residuals.histogram)
                         .render(FigureMedium::kFile));
  if (uncertainty.workspace) {
    files.emplace_back(
        "predicted_map.csv",
        MapCsv(*uncertainty.workspace, result.train.joint_dimensions));
    files.emplace_back(
        "predicted_map.svg",
        PredictedMapFigure(*uncertainty.workspace, OutlineOf(result))
            .render(FigureMedium::kFile));
  }
  if (uncertainty.validation) {
    files.emplace_back(
        "validation_z_scores.svg",
        HistogramFigure(
            "Validation errors over their predicted standard deviations",
            uncertainty.validation->histogram)
            .render(FigureMedium::kFile));
  }
  return files;
}

}  // namespace alidade::internal
