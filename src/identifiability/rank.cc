#include "alidade/identifiability/rank.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

namespace alidade {
namespace {

// Lengths first: they are what drawings and people state, and a length that
// stands for an angle reads better than the reverse.
constexpr std::array<ParameterKind, 9> kCanonicalOrder = {
    ParameterKind::kD,
    ParameterKind::kR,
    ParameterKind::kBaseTranslation,
    ParameterKind::kToolTranslation,
    ParameterKind::kTheta,
    ParameterKind::kAlpha,
    ParameterKind::kBeta,
    ParameterKind::kBaseRotation,
    ParameterKind::kToolRotation};

int CanonicalRank(ParameterKind kind) {
  return static_cast<int>(
      std::find(kCanonicalOrder.begin(), kCanonicalOrder.end(), kind) -
      kCanonicalOrder.begin());
}

std::vector<int> InCanonicalOrder(const ParameterLayout& layout,
                                  std::vector<int> columns) {
  std::stable_sort(columns.begin(), columns.end(), [&](int a, int b) {
    return CanonicalRank(layout.parameter(a).kind) <
           CanonicalRank(layout.parameter(b).kind);
  });
  return columns;
}

// What a unit of the parameter moves a point at the end of the reach by.
double ColumnScale(const PositionModel& model, int column) {
  const bool angle =
      model.layout().parameter(column).dimension == Dimension::kAngle;
  return angle ? Reach(model.nominal()) : 1.0;
}

// Terms of less than this part of a column's effect are not told: with poses
// that are not quite in the plane they were meant for, a relation holds only so
// far.
constexpr double kNegligibleTerm = 1e-4;

// Coefficients of a dependent column: the triangular system of the columns
// kept so far, in units of the layout, without those that are only rounding.
std::vector<std::pair<int, double>> SolveTerms(
    const PositionModel& model, const Eigen::MatrixXd& kept_columns,
    const std::vector<int>& kept, const Eigen::VectorXd& column, int id) {
  const Eigen::VectorXd scaled =
      kept_columns.colPivHouseholderQr().solve(column);
  std::vector<std::pair<int, double>> terms;
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const double effect = std::abs(scaled[i]) * kept_columns.col(i).norm();
    if (effect <= kNegligibleTerm * column.norm()) continue;
    terms.emplace_back(kept[k], scaled[i] * ColumnScale(model, id) /
                                    ColumnScale(model, kept[k]));
  }
  return terms;
}

std::string FormatNumber(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4g", value);
  return text.data();
}

// A coefficient in mm and rad, with the unit that its dimensions give it.
std::string FormatTerm(const ParameterLayout& layout, int dependent,
                       const std::pair<int, double>& term) {
  const bool from_angle =
      layout.parameter(dependent).dimension == Dimension::kAngle;
  const bool to_angle =
      layout.parameter(term.first).dimension == Dimension::kAngle;
  const std::string& name = layout.parameter(term.first).name;
  const double value = term.second;
  if (from_angle == to_angle) {
    if (std::abs(value - 1.0) < 1e-9) return name;
    if (std::abs(value + 1.0) < 1e-9) return "-" + name;
    return FormatNumber(value) + " * " + name;
  }
  if (from_angle) return FormatNumber(value / kMillimetre) + " mm * " + name;
  return FormatNumber(value * kMillimetre) + " /mm * " + name;
}

}  // namespace

Eigen::MatrixXd ScaledFactor(const PositionModel& model,
                             const Eigen::VectorXd& values, const Dataset& data,
                             const std::vector<int>& columns) {
  Linearization linearization;
  model.Linearize(values, data, columns, &linearization);
  Eigen::MatrixXd& jacobian = linearization.jacobian;
  for (Eigen::Index c = 0; c < jacobian.cols(); ++c) {
    jacobian.col(c) /= ColumnScale(model, columns[c]);
  }
  const Eigen::Index rows = std::min(jacobian.rows(), jacobian.cols());
  const Eigen::HouseholderQR<Eigen::Ref<Eigen::MatrixXd>> qr(jacobian);
  return qr.matrixQR().topRows(rows).triangularView<Eigen::Upper>();
}

RankReport AnalyzeRank(const Eigen::MatrixXd& factor,
                       double relative_tolerance) {
  RankReport report;
  report.gap = std::numeric_limits<double>::infinity();
  if (factor.size() == 0) return report;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(factor);
  report.singular_values = svd.singularValues();
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

std::vector<Dependency> FindDependencies(const PositionModel& model,
                                         const Eigen::VectorXd& values,
                                         const Dataset& data,
                                         const std::vector<int>& columns,
                                         double tolerance) {
  const std::vector<int> order = InCanonicalOrder(model.layout(), columns);
  const Eigen::MatrixXd factor = ScaledFactor(model, values, data, order);
  const double negligible = tolerance * factor.colwise().norm().maxCoeff();
  std::vector<int> kept;
  std::vector<Dependency> dependencies;
  Eigen::MatrixXd basis(factor.rows(), 0);
  Eigen::MatrixXd kept_columns(factor.rows(), 0);
  for (Eigen::Index c = 0; c < factor.cols(); ++c) {
    const Eigen::VectorXd column = factor.col(c);
    const int id = order[c];
    Eigen::VectorXd rest = column;
    // Twice is enough: one pass of Gram-Schmidt leaves rounding of the kept
    // columns behind (Kahan; Parlett 1980, "The symmetric eigenvalue problem").
    for (int pass = 0; pass < 2; ++pass) {
      rest -= basis * (basis.transpose() * rest).eval();
    }
    if (column.norm() <= negligible) {
      dependencies.push_back({id, {}});
    } else if (rest.norm() <= tolerance * column.norm()) {
      dependencies.push_back(
          {id, SolveTerms(model, kept_columns, kept, column, id)});
    } else {
      kept.push_back(id);
      basis.conservativeResize(Eigen::NoChange, basis.cols() + 1);
      basis.rightCols<1>() = rest.normalized();
      kept_columns.conservativeResize(Eigen::NoChange, basis.cols());
      kept_columns.rightCols<1>() = column;
    }
  }
  return dependencies;
}

std::string DescribeDependency(const ParameterLayout& layout,
                               const Dependency& dependency) {
  const std::string& name = layout.parameter(dependency.column).name;
  if (dependency.terms.empty()) return name + " has no effect";
  std::string text = name + " acts as ";
  bool first = true;
  for (const auto& term : dependency.terms) {
    const std::string formatted = FormatTerm(layout, dependency.column, term);
    const bool negative = formatted[0] == '-';
    if (first) {
      text += formatted;
    } else {
      text += negative ? " - " : " + ";
      text += formatted.substr(negative ? 1 : 0);
    }
    first = false;
  }
  return text;
}

}  // namespace alidade
