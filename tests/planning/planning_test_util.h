#ifndef ALIDADE_TESTS_PLANNING_PLANNING_TEST_UTIL_H_
#define ALIDADE_TESTS_PLANNING_PLANNING_TEST_UTIL_H_

#include <Eigen/Dense>
#include <algorithm>
#include <vector>

#include "src/common/random.h"
#include "src/kernel/measurement_model.h"
#include "src/planning/candidates.h"
#include "src/planning/exchange.h"
#include "tests/support/rv2aj_arms.h"

namespace alidade::internal::testing {

/// Rows of standard normal numbers: `count` poses of `rows_each` rows.
inline PoseRows RandomRows(int parameters, int rows_each, int count,
                           Random* random) {
  PoseRows rows;
  rows.rows_each = rows_each;
  rows.transposed.resize(parameters, Eigen::Index{rows_each} * count);
  for (double& entry : rows.transposed.reshaped()) entry = random->Normal();
  return rows;
}

/// A problem of random rows; `known` times the identity is known.
inline DesignProblem RandomProblem(int parameters, int rows_each, int count,
                                   double known, Random* random) {
  DesignProblem problem;
  problem.candidates = RandomRows(parameters, rows_each, count, random);
  problem.known = known * Eigen::MatrixXd::Identity(parameters, parameters);
  problem.region = RandomRows(parameters, 3, 5, random);
  problem.joint_values = Eigen::MatrixXd(2, count);
  for (double& entry : problem.joint_values.reshaped()) {
    entry = random->Uniform();
  }
  return problem;
}

/// The columns of the study's 17 parameters and alpha4.
inline std::vector<int> EighteenColumns(const ParameterLayout& layout) {
  std::vector<int> columns;
  for (const char* name : {"beta1", "beta3", "beta4", "alpha1", "alpha2",
                           "alpha3", "alpha4", "d1", "d2", "d3", "d4", "d5",
                           "theta1", "theta2", "theta3", "r1", "r2", "r5"}) {
    columns.push_back(layout.Find(name).value());
  }
  return columns;
}

inline constexpr double kFlangeSigma = 2e-5;  // m

/// The RV-2AJ at its flange, positions measured with 0.02 mm.
inline PoseRows FlangeRows(const Eigen::MatrixXd& joint_values) {
  const MeasurementModel model(Rv2ajFlange());
  PoseMeasurement measurement;
  measurement.sigma = kFlangeSigma;
  return MakePoseRows(model, model.NominalValues(),
                      MakePlannedData(model, joint_values, measurement),
                      EighteenColumns(model.layout()));
}

inline DesignProblem FlangeProblem(int count, std::uint64_t seed) {
  CandidateOptions options;
  options.count = count;
  options.seed = seed;
  DesignProblem problem;
  problem.joint_values =
      DrawCandidates(Rv2ajFlange(), {}, options).joint_values;
  problem.candidates = FlangeRows(problem.joint_values);
  const int p = problem.candidates.num_parameters();
  problem.known = Eigen::MatrixXd::Zero(p, p);
  return problem;
}

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_PLANNING_PLANNING_TEST_UTIL_H_
