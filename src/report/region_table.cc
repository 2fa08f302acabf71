#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "src/calibration/improvement.h"
#include "src/common/format.h"
#include "src/common/text.h"
#include "src/report/figures.h"
#include "src/report/uncertainty_report.h"

namespace alidade::internal {
namespace {

// Of the distance from the base's axis, and of the height.
constexpr int kBands = 3;

// Values from `lower` on in equal bands.
struct Bands {
  explicit Bands(const Eigen::VectorXd& values)
      : lower(values.minCoeff()),
        width((values.maxCoeff() - values.minCoeff()) / kBands) {}

  // -1 beyond them.
  int Of(double value) const {
    const double slack = 1e-9 * width;
    if (!(value >= lower - slack && value <= lower + kBands * width + slack)) {
      return -1;
    }
    if (!(width > 0.0)) return 0;
    return std::clamp(static_cast<int>((value - lower) / width), 0, kBands - 1);
  }
  // "120 to 340".
  std::string Name(int band) const {
    const auto end = [&](int k) {
      return FixedNumber((lower + k * width) / kMillimetre, 0);
    };
    return end(band) + " to " + end(band + 1);
  }

  double lower;
  double width;
};

// Distance from the base's z axis and height of each place.
Eigen::Matrix2Xd DistancesAndHeights(const Eigen::Matrix3Xd& in_base) {
  Eigen::Matrix2Xd places(2, in_base.cols());
  places.row(0) = in_base.topRows<2>().colwise().norm();
  places.row(1) = in_base.row(2);
  return places;
}

// Observations that what the result is judged by leaves out.
std::set<std::int64_t> RejectedOf(const CalibrationResult& result,
                                  const EvaluatedSet& set) {
  constexpr double kRejected = 0.5;
  std::set<std::int64_t> rejected;
  if (!set.kept) return rejected;
  for (const Outlier& outlier :
       &set == &result.train ? result.outliers : result.validation_outliers) {
    if (outlier.weight < kRejected) rejected.insert(outlier.observation);
  }
  return rejected;
}

Accuracy Summarize(const std::vector<double>& values) {
  return SummarizeErrors(Eigen::Map<const Eigen::VectorXd>(
      values.data(), static_cast<Eigen::Index>(values.size())));
}

}  // namespace

Table RegionTable(const CalibrationResult& result) {
  const EvaluatedSet& set = JudgedSet(result);
  const std::string poses = &set == &result.train ? "training" : "validation";
  Table table(
      "regions", "Accuracy by region, in the frame of the base",
      {">distance from the axis [mm]|of the base's z axis", ">height [mm]",
       ">predicted std [mm]|median over the region", ">95 % below [mm]",
       ">error, " + poses + " mean [mm]|measured, after calibration",
       ">max [mm]", ">n"});
  if (!result.uncertainty || !result.uncertainty->workspace) return table;
  const PredictedMap& map = *result.uncertainty->workspace;
  if (map.positions.cols() == 0 ||
      map.positions.cols() != map.position_std.size()) {
    return table;
  }
  const ArmOutline arm = OutlineOf(result);
  const Eigen::Matrix2Xd places =
      DistancesAndHeights(arm.InBase(map.positions));
  const Bands distances(places.row(0));
  const Bands heights(places.row(1));
  std::vector<std::vector<double>> predicted(kBands * kBands);
  std::vector<std::vector<double>> measured(kBands * kBands);
  const auto add = [&](const Eigen::Vector2d& place, double value,
                       std::vector<std::vector<double>>* regions) {
    const int distance = distances.Of(place[0]);
    const int height = heights.Of(place[1]);
    if (distance < 0 || height < 0 || !std::isfinite(value)) return;
    // To the picometre: the same whether it was computed or read.
    (*regions)[static_cast<std::size_t>(kBands * distance + height)].push_back(
        std::round(1e12 * value) / 1e12);
  };
  for (Eigen::Index i = 0; i < places.cols(); ++i) {
    add(places.col(i), map.position_std[i], &predicted);
  }
  if (set.positions.cols() == set.residual_after.cols() &&
      set.positions.rows() == 3) {
    const Eigen::Matrix2Xd at = DistancesAndHeights(arm.InBase(set.positions));
    const std::set<std::int64_t> rejected = RejectedOf(result, set);
    for (Eigen::Index i = 0; i < at.cols(); ++i) {
      if (rejected.count(i) > 0) continue;
      add(at.col(i), set.residual_after.col(i).norm(), &measured);
    }
  }
  for (std::size_t k = 0; k < predicted.size(); ++k) {
    if (predicted[k].empty()) continue;
    const Accuracy std = Summarize(predicted[k]);
    const bool has_errors = !measured[k].empty();
    const Accuracy error = has_errors ? Summarize(measured[k]) : Accuracy();
    const auto cell = [&](double value) {
      return has_errors ? QuantityCell(value, Dimension::kLength, 3)
                        : TableCell("-");
    };
    table.AddRow({distances.Name(static_cast<int>(k) / kBands),
                  heights.Name(static_cast<int>(k) % kBands),
                  QuantityCell(std.median, Dimension::kLength, 3),
                  QuantityCell(std.p95, Dimension::kLength, 3),
                  cell(error.mean), cell(error.max),
                  has_errors ? CountCell(error.n) : TableCell("-")});
  }
  return table;
}

}  // namespace alidade::internal
