#include "src/planning/design_problem.h"

namespace alidade::internal {

DesignProblem RestrictCandidates(const DesignProblem& problem,
                                 const std::vector<int>& candidates) {
  const int m = problem.candidates.rows_each;
  const auto count = static_cast<Eigen::Index>(candidates.size());
  DesignProblem part;
  part.known = problem.known;
  part.region = problem.region;
  part.minimum_motion = problem.minimum_motion;
  part.candidates.rows_each = m;
  part.candidates.transposed.resize(problem.candidates.num_parameters(),
                                    count * m);
  part.joint_values.resize(problem.joint_values.rows(), count);
  for (Eigen::Index i = 0; i < count; ++i) {
    part.candidates.transposed.middleCols(i * m, m) =
        problem.candidates.Pose(candidates[i]);
    part.joint_values.col(i) = problem.joint_values.col(candidates[i]);
  }
  return part;
}

Eigen::MatrixXd InformationOf(const PoseRows& rows,
                              const std::vector<int>& chosen) {
  const Eigen::Index p = rows.num_parameters();
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(p, p);
  for (const int k : chosen) {
    information += rows.Pose(k) * rows.Pose(k).transpose();
  }
  return information;
}

}  // namespace alidade::internal
