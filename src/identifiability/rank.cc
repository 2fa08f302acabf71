#include "src/identifiability/rank.h"

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "src/common/svd.h"
#include "src/identifiability/factor.h"
#include "src/kernel/reduction.h"

namespace alidade::internal {
namespace {

// References first: nothing else says where they are. Then frames: where an arm
// stands and what it holds is known worst a priori, and a joint's number held
// in their stead would carry its narrow prior over to them. Then lengths: they
// are what drawings and people state, and a length that takes an angle's part
// reads better than the reverse.
constexpr std::array<ParameterKind, 12> kCanonicalOrder = {
    ParameterKind::kPoint,
    ParameterKind::kPlaneOffset,
    ParameterKind::kPlaneTilt,
    ParameterKind::kBaseTranslation,
    ParameterKind::kToolTranslation,
    ParameterKind::kBaseRotation,
    ParameterKind::kToolRotation,
    ParameterKind::kD,
    ParameterKind::kR,
    ParameterKind::kTheta,
    ParameterKind::kAlpha,
    ParameterKind::kBeta};

int CanonicalRank(ParameterKind kind) {
  return static_cast<int>(
      std::find(kCanonicalOrder.begin(), kCanonicalOrder.end(), kind) -
      kCanonicalOrder.begin());
}

// Coefficients that print as 1 in four digits are not printed.
constexpr double kPrintsAsOne = 5e-5;

std::string FormatNumber(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4g", value);
  return text.data();
}

}  // namespace

int NumForced(const MeasurementModel& model,
              const IdentifiabilityOptions& options,
              const std::vector<int>& columns) {
  const auto is_forced = [&](int column) {
    const std::string& name = model.layout().parameter(column).name;
    return std::find(options.free.begin(), options.free.end(), name) !=
           options.free.end();
  };
  return static_cast<int>(
      std::find_if_not(columns.begin(), columns.end(), is_forced) -
      columns.begin());
}

std::vector<int> InCanonicalOrder(const ParameterLayout& layout,
                                  std::vector<int> columns) {
  std::stable_sort(columns.begin(), columns.end(), [&](int a, int b) {
    return CanonicalRank(layout.parameter(a).kind) <
           CanonicalRank(layout.parameter(b).kind);
  });
  return columns;
}

std::vector<Dependency> ToDependencies(const MeasurementModel& model,
                                       const Eigen::MatrixXd& factor,
                                       const std::vector<int>& order,
                                       const Elimination& elimination,
                                       double smallest) {
  const double negligible = std::max(smallest, elimination.tolerance);
  std::vector<Dependency> dependencies;
  for (const DependentColumn& dependent : elimination.dependent) {
    const int id = order[dependent.index];
    const double norm = factor.col(dependent.index).norm();
    Dependency dependency{id, {}};
    for (Eigen::Index k = 0; k < dependent.coefficients.size(); ++k) {
      const double coefficient = dependent.coefficients[k];
      const int kept = elimination.kept[k];
      const double effect = std::abs(coefficient) * factor.col(kept).norm();
      if (dependent.is_zero || effect <= negligible * norm) continue;
      const int other = order[kept];
      dependency.terms.emplace_back(
          other,
          coefficient * ColumnScale(model, id) / ColumnScale(model, other));
    }
    dependencies.push_back(std::move(dependency));
  }
  return dependencies;
}

Eigen::MatrixXd ScaledFactor(const MeasurementModel& model,
                             const Eigen::VectorXd& values, const Dataset& data,
                             const std::vector<int>& columns) {
  return ScaleColumns(model, columns,
                      JacobianFactor(model, values, data, columns));
}

RankReport AnalyzeRank(const Eigen::MatrixXd& factor,
                       double relative_tolerance) {
  RankReport report;
  report.gap = std::numeric_limits<double>::infinity();
  if (factor.size() == 0) return report;
  report.singular_values = SingularValues(factor);
  const double largest = report.singular_values[0];
  if (!(largest > 0.0)) return report;
  report.singular_values /= largest;
  report.rank = static_cast<int>(
      (report.singular_values.array() > relative_tolerance).count());
  if (report.rank < report.singular_values.size()) {
    report.gap = report.singular_values[report.rank - 1] /
                 report.singular_values[report.rank];
  }
  return report;
}

std::vector<Dependency> FindDependencies(const MeasurementModel& model,
                                         const Eigen::VectorXd& values,
                                         const Dataset& data,
                                         const std::vector<int>& columns,
                                         double tolerance) {
  const std::vector<int> order = InCanonicalOrder(model.layout(), columns);
  const Eigen::MatrixXd factor = ScaledFactor(model, values, data, order);
  return ToDependencies(model, factor, order, Eliminate(factor, tolerance),
                        kSmallestMeasuredTerm);
}

std::string FormatTerm(const ParameterLayout& layout, const Term& term) {
  const bool from_angle =
      layout.parameter(term.from).dimension == Dimension::kAngle;
  const bool to_angle =
      layout.parameter(term.to).dimension == Dimension::kAngle;
  const std::string& name = layout.parameter(term.named).name;
  const double value = term.coefficient;
  if (from_angle == to_angle) {
    if (std::abs(value - 1.0) < kPrintsAsOne) return name;
    if (std::abs(value + 1.0) < kPrintsAsOne) return "-" + name;
    return FormatNumber(value) + " * " + name;
  }
  if (from_angle) return FormatNumber(value / kMillimetre) + " mm * " + name;
  return FormatNumber(value * kMillimetre) + " /mm * " + name;
}

std::string AppendTerm(const std::string& sum, const std::string& term) {
  if (sum.empty()) return term;
  const bool negative = term[0] == '-';
  return sum + (negative ? " - " : " + ") + term.substr(negative ? 1 : 0);
}

std::string DescribeDependency(const ParameterLayout& layout,
                               const Dependency& dependency) {
  const std::string& name = layout.parameter(dependency.column).name;
  if (dependency.terms.empty()) return name + " has no effect";
  std::string sum;
  for (const auto& [column, coefficient] : dependency.terms) {
    sum = AppendTerm(sum, FormatTerm(layout, {coefficient, dependency.column,
                                              column, column}));
  }
  return name + " is linearly dependent on " + sum;
}

}  // namespace alidade::internal
