#ifndef ALIDADE_TESTS_ERROR_TERMS_TERM_TEST_UTIL_H_
#define ALIDADE_TESTS_ERROR_TERMS_TERM_TEST_UTIL_H_

#include <Eigen/Core>
#include <numeric>
#include <vector>

#include "src/error_terms/term_columns.h"
#include "src/error_terms/term_normal.h"
#include "src/error_terms/term_rows.h"
#include "tests/support/random_measurements.h"

namespace alidade::internal::testing {

/// Every term that there is.
inline TermSet AllTerms(double function_length) {
  TermSet set;
  set.name = "all";
  set.elasticity = true;
  set.function_length = function_length;
  set.cycles = {1.0, 2.5};
  set.scale = true;
  set.backlash = true;
  set.joint_cycles = {{3, 20.0}};
  set.coupling = {{2, 1}, {0, 3}};
  set.covariates = true;
  set.uses = {{"temperature", true, false, {1}}, {"tilt", true, true, {3}}};
  return set;
}

/// Of the covariates of MeasuredForTerms.
inline Eigen::VectorXd Deviations() { return Eigen::Vector3d(0.7, 1.3, 2.0); }

/// Loads and gravity of random error terms, moments of the geometry of the
/// values, and no terms yet.
inline ErrorTerms LoadsAt(const MeasuredArm& measured, Random* random) {
  ErrorTerms errors = RandomErrors(measured.arm, random);
  errors.Clear();
  errors.covariates = measured.arm.errors.covariates;
  for (CovariateEffect& effect : errors.covariates) {
    effect.base.setZero();
    effect.joints.resize(0);
    effect.target.setZero();
  }
  const Arm at = measured.layout.WithValues(measured.arm, measured.values);
  for (int j = 0; j < at.num_joints(); ++j) {
    const Joint& joint = at.joints[j];
    errors.load_geometry.col(j) << joint.beta, joint.alpha, joint.d,
        joint.theta, joint.r;
  }
  errors.load_target = MeanTargetOf(at);
  return errors;
}

/// All kinds of measurements of an arm of four joints, the second prismatic,
/// whose first joint moves so little that all poses share its knots.
inline MeasuredArm MeasuredForTerms(Random* random) {
  MeasuredArm measured = RandomMeasurements(4, Weighting::kFull, random, 0.0);
  measured.arm.joints[1].type = JointType::kPrismatic;
  Eigen::MatrixXd q = measured.data.joint_values.map();
  for (Eigen::Index i = 0; i < q.cols(); ++i) {
    q(0, i) = 0.01 * static_cast<double>(i);
  }
  q.row(1) *= 0.1;
  measured.data.joint_values = q;
  AddCovariates(&measured, random);
  measured.arm.errors = LoadsAt(measured, random);
  return measured;
}

inline std::vector<int> AllColumnsOf(const ParameterLayout& layout) {
  std::vector<int> columns(layout.size());
  std::iota(columns.begin(), columns.end(), 0);
  return columns;
}

/// All columns of terms, densely, one by one.
inline Eigen::MatrixXd DenseTerms(const TermRows& rows,
                                  const TermColumns& columns) {
  Eigen::MatrixXd dense =
      Eigen::MatrixXd::Zero(rows.residuals.size(), columns.size());
  for (const TermRows::Observation& one : rows.observations) {
    for (int k = 0; k < columns.size(); ++k) {
      dense.block(one.first_row, k, one.height, 1) = ApplyTerms(
          rows, columns, Eigen::VectorXd::Unit(columns.size(), k), one);
    }
  }
  return dense;
}

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_ERROR_TERMS_TERM_TEST_UTIL_H_
