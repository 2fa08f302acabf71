#ifndef ALIDADE_SRC_IDENTIFIABILITY_RANK_H_
#define ALIDADE_SRC_IDENTIFIABILITY_RANK_H_

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "alidade/identifiability.h"
#include "src/identifiability/elimination.h"
#include "src/kernel/measurement_model.h"

namespace alidade::internal {

/// The triangular factor of the whitened Jacobian whose angle columns are
/// divided by the reach, so that every column is "metres moved per metre" (or
/// per angle that moves the end of the reach by a metre). Singular values and
/// dependencies of it are those of the scaled Jacobian. columns x columns.
Eigen::MatrixXd ScaledFactor(const MeasurementModel& model,
                             const Eigen::VectorXd& values, const Dataset& data,
                             const std::vector<int>& columns);

/// Singular values of a factor and the rank read from them: those below
/// `relative_tolerance` times the largest count as zero. The rank of an
/// empty or zero matrix is 0.
RankReport AnalyzeRank(const Eigen::MatrixXd& factor,
                       double relative_tolerance);

/// column = sum of coefficient * other, in the units of the layout: moving
/// `column` by 1 moves the target as moving each other by its coefficient.
struct Dependency {
  int column = 0;
  std::vector<std::pair<int, double>> terms;  ///< empty: no effect at all
};

/// How many of the first columns the user wants free: those that no basis may
/// leave out.
int NumForced(const MeasurementModel& model,
              const IdentifiabilityOptions& options,
              const std::vector<int>& columns);

/// The canonical order: base and tool (lengths, then rotations), which are
/// known worst beforehand, then the joints' lengths before their angles (d, r,
/// theta, alpha, beta), from the base outwards within each: a parameter is kept
/// in preference to those after it that depend on it.
std::vector<int> InCanonicalOrder(const ParameterLayout& layout,
                                  std::vector<int> columns);

/// The dependent columns of a scaled factor in units of the layout. Column i of
/// the factor belongs to parameter order[i]. Terms below `smallest` times the
/// column's effect are left out, or below the elimination's tolerance if that
/// is larger: the relation itself holds no better.
std::vector<Dependency> ToDependencies(const MeasurementModel& model,
                                       const Eigen::MatrixXd& factor,
                                       const std::vector<int>& order,
                                       const Elimination& elimination,
                                       double smallest);

/// `smallest` over measured poses: with some that are not quite in the plane
/// that they were meant for, a relation holds only so far.
inline constexpr double kSmallestMeasuredTerm = 1e-4;

/// Eliminates the columns in canonical order and returns those that depend on
/// the ones kept before them (elimination.h).
std::vector<Dependency> FindDependencies(const MeasurementModel& model,
                                         const Eigen::VectorXd& values,
                                         const Dataset& data,
                                         const std::vector<int>& columns,
                                         double tolerance);

/// coefficient * name, the coefficient turning a change of parameter `from`
/// into one of parameter `to` (columns of the layout).
struct Term {
  double coefficient = 0.0;
  int from = 0;
  int to = 0;
  int named = 0;  ///< whose name is printed
};

/// "r3", "-r3", "0.5 * r3", "-72 mm * r2" (from an angle to a length), "0.02
/// /mm * theta1" (the other way): mm and rad, four significant digits.
std::string FormatTerm(const ParameterLayout& layout, const Term& term);

/// Adds a term to a sum: "r2", "-72 mm * alpha5" -> "r2 - 72 mm * alpha5".
std::string AppendTerm(const std::string& sum, const std::string& term);

/// "alpha5 is linearly dependent on -72 mm * r2", "alpha5 has no effect".
std::string DescribeDependency(const ParameterLayout& layout,
                               const Dependency& dependency);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_IDENTIFIABILITY_RANK_H_
