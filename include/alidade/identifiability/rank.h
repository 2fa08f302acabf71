#ifndef ALIDADE_IDENTIFIABILITY_RANK_H_
#define ALIDADE_IDENTIFIABILITY_RANK_H_

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "alidade/measurement/position_model.h"
#include "alidade/results/identifiability_result.h"

namespace alidade {

/// The triangular factor of the whitened Jacobian whose angle columns are
/// divided by the reach, so that every column is "metres moved per metre" (or
/// per angle that moves the end of the reach by a metre). Singular values and
/// dependencies of it are those of the scaled Jacobian. columns x columns
/// (fewer rows where there are fewer measurements than columns).
Eigen::MatrixXd ScaledFactor(const PositionModel& model,
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

/// Walks through the columns in canonical order (lengths before angles: d, r,
/// base and tool lengths, theta, alpha, beta, then the frames' rotations; from
/// the base outwards within each) and returns those that depend on the ones
/// before, so that lengths are kept in preference to angles. A column depends
/// when the part of it that is orthogonal to those kept is below `tolerance`
/// times its norm. Terms below 1e-4 of the column's effect are left out.
std::vector<Dependency> FindDependencies(const PositionModel& model,
                                         const Eigen::VectorXd& values,
                                         const Dataset& data,
                                         const std::vector<int>& columns,
                                         double tolerance);

/// "alpha5 acts as -72 mm * r2", "theta4 acts as 0.5 mm/rad ...", in mm and
/// rad; "alpha5 has no effect".
std::string DescribeDependency(const ParameterLayout& layout,
                               const Dependency& dependency);

}  // namespace alidade

#endif  // ALIDADE_IDENTIFIABILITY_RANK_H_
