#ifndef ALIDADE_TESTS_SOLVE_SOLVERS_TEST_UTIL_H_
#define ALIDADE_TESTS_SOLVE_SOLVERS_TEST_UTIL_H_

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <ostream>
#include <string>
#include <vector>

#include "src/common/random.h"
#include "src/identifiability/rank.h"
#include "src/solve/solve.h"
#include "tests/support/edit.h"
#include "tests/support/random_arms.h"
#include "tests/support/random_datasets.h"
#include "tests/support/reference_solution.h"
#include "tests/support/rv2aj_arms.h"
#include "tests/support/study.h"

namespace alidade::internal {

inline void PrintTo(SolverStatus status, std::ostream* out) {
  *out << ToString(status);
}

}  // namespace alidade::internal

namespace alidade::internal::testing {

/// One of the solvers, to run the same tests with each.
struct SolverCase {
  std::string name;
  SolverSummary (*solve)(const CalibrationProblem&, const SolverOptions&,
                         Eigen::VectorXd*);
};

inline void PrintTo(const SolverCase& solver, std::ostream* out) {
  *out << solver.name;
}

inline const SolverCase kCeres = {"Ceres", SolveLevenbergMarquardt};
inline const SolverCase kPseudoInverse = {"PseudoInverse", SolvePseudoInverse};

inline std::string NameOfSolver(
    const ::testing::TestParamInfo<SolverCase>& info) {
  return info.param.name;
}

/// An arm, how the real one differs, and its measurements.
struct Calibration {
  Calibration(const Arm& nominal, int num_threads = 1)
      : model(nominal, num_threads), true_values(model.NominalValues()) {}

  /// @pre data and free_columns are set. The rank counts down to 1e-6, in the
  /// middle of the gap that the plane of the study leaves.
  void CountStartRank() {
    start_rank = AnalyzeRank(
        ScaledFactor(model, model.NominalValues(), data, free_columns), 1e-6);
  }

  CalibrationProblem Problem() const {
    return {model, data, free_columns, start_rank};
  }

  SolverSummary Solve(const SolverCase& solver, Eigen::VectorXd* values,
                      const SolverOptions& options = {}) const {
    return solver.solve(Problem(), options, values);
  }

  /// The independent minimum with the fixed values at nominal.
  ReferenceSolution Reference() const {
    VectorXl start = model.NominalValues().cast<long double>();
    for (const int column : free_columns) start[column] = true_values[column];
    return SolveReference(model.nominal(), start, data, free_columns);
  }

  MeasurementModel model;
  Eigen::VectorXd true_values;
  Dataset data;
  std::vector<int> free_columns;
  RankReport start_rank;
};

inline Calibration WristCalibration(std::uint64_t seed) {
  Calibration calibration(Rv2ajWrist());
  calibration.true_values = Rv2ajTrueValues(Rv2ajWrist());
  calibration.data = MeasureStudyPoses(Rv2ajWrist(), {seed, 0.0});
  calibration.free_columns = WristFreeColumns(calibration.model.layout());
  calibration.CountStartRank();
  return calibration;
}

inline Calibration FlangeCalibration(std::uint64_t seed) {
  Calibration calibration(Rv2ajFlange());
  calibration.true_values = Rv2ajTrueValues(Rv2ajFlange());
  calibration.data = MeasureStudyPoses(Rv2ajFlange(), {seed, 0.0});
  calibration.free_columns = FlangeFreeColumns(calibration.model.layout());
  calibration.CountStartRank();
  return calibration;
}

/// Adds to each coordinate noise of its sigma.
inline void AddNoise(Random* random, Dataset* data) {
  auto positions = Edit(&data->positions());
  for (Eigen::Index i = 0; i < data->num_poses(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      positions.at(axis, i) += data->sigmas()(axis, i) * random->Normal();
    }
  }
}

/// The RV-2AJ at the flange over generic poses, where all 18 parameters are
/// distinguished well; the fixed ones are at nominal. Noise of 0.02 mm.
inline Calibration NoisyFlangeCalibration(std::uint64_t seed, int num_poses,
                                          int num_threads = 1) {
  Calibration calibration(Rv2ajFlange(), num_threads);
  calibration.free_columns = FlangeFreeColumns(calibration.model.layout());
  const Eigen::VectorXd real = Rv2ajTrueValues(Rv2ajFlange());
  for (const int column : calibration.free_columns) {
    calibration.true_values[column] = real[column];
  }
  calibration.data = MeasureGenericPoses(Rv2ajFlange(), calibration.true_values,
                                         num_poses, {seed, 2e-5});
  calibration.CountStartRank();
  return calibration;
}

/// A random arm whose free parameters, a well-conditioned choice, deviate by
/// up to `deviation` (m and rad), measured exactly with uneven sigmas.
inline Calibration RandomCalibration(int num_joints, int draw,
                                     double deviation) {
  constexpr int kPoses = 60;
  Random random(1000 + num_joints, draw);
  Calibration calibration(RandomArm(num_joints, &random));
  const Arm& arm = calibration.model.nominal();
  Random poses = random;
  const Dataset planned =
      RandomDataset(arm, calibration.true_values, kPoses, &poses);
  calibration.free_columns =
      IndependentColumns(arm, MatrixValues(arm), planned, 0.01L);
  poses = random;
  Random deviations(2000 + num_joints, draw);
  for (const int column : calibration.free_columns) {
    calibration.true_values[column] +=
        deviations.Uniform(-deviation, deviation);
  }
  calibration.data =
      RandomDataset(arm, calibration.true_values, kPoses, &poses);
  calibration.CountStartRank();
  return calibration;
}

/// The largest difference of lengths (m) and angles (rad).
struct Difference {
  double length = 0.0;
  double angle = 0.0;
};

inline Difference DifferenceOf(const ParameterLayout& layout,
                               const Eigen::VectorXd& values,
                               const VectorXl& reference) {
  Difference difference;
  for (int c = 0; c < layout.size(); ++c) {
    const auto off = static_cast<double>(std::abs(values[c] - reference[c]));
    double* const largest = layout.parameter(c).dimension == Dimension::kLength
                                ? &difference.length
                                : &difference.angle;
    *largest = std::max(*largest, off);
  }
  return difference;
}

inline bool SameBits(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(),
                     sizeof(double) * static_cast<std::size_t>(a.size())) == 0;
}

/// True where every value but those of `columns` has the bits of `start`.
inline bool HoldsTheOthers(const Eigen::VectorXd& start,
                           const Eigen::VectorXd& values,
                           const std::vector<int>& columns) {
  Eigen::VectorXd others = values;
  for (const int column : columns) others[column] = start[column];
  return SameBits(others, start);
}

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_SOLVE_SOLVERS_TEST_UTIL_H_
