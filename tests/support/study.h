#ifndef ALIDADE_TESTS_SUPPORT_STUDY_H_
#define ALIDADE_TESTS_SUPPORT_STUDY_H_

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "alidade/arm.h"
#include "alidade/dataset.h"
#include "alidade/parameter_layout.h"
#include "alidade/units.h"
#include "src/serialization/job_config.h"
#include "src/simulation/simulation.h"
#include "tests/support/rv2aj_arms.h"

namespace alidade::internal::testing {

/// How positions are measured.
struct Measurement {
  std::uint64_t seed = 2;
  double noise_sigma = 0.0;  ///< (m); 0 = exact, with sigmas of 1 m
};

/// Values of the assumed real arm, one per column of the layout. `nominal` is
/// one of the RV-2AJ arms.
inline Eigen::VectorXd Rv2ajTrueValues(const Arm& nominal) {
  return ParameterLayout(nominal.num_joints())
      .Values(WithRv2ajDeviations(nominal));
}

inline SimulationConfig MeasurementOf(const Arm& nominal,
                                      const Eigen::VectorXd& true_values,
                                      const Measurement& measurement) {
  SimulationConfig config;
  config.arm = nominal;
  config.true_values = true_values;
  config.noise_sigma = measurement.noise_sigma;
  config.seed = measurement.seed;
  return config;
}

/// The RV-2AJ at the study's 56 poses in the plane z = 215 mm: 8 azimuths
/// times 7 radii, the elevation of the last axis drawn.
inline Dataset MeasureStudyPoses(const Arm& nominal,
                                 const Measurement& measurement = {}) {
  SimulationConfig config =
      MeasurementOf(nominal, Rv2ajTrueValues(nominal), measurement);
  CylinderGrid grid;
  grid.azimuth = {-140.0 * kDegree, 140.0 * kDegree, 8};
  grid.radius = {210.0 * kMillimetre, 400.0 * kMillimetre, 7};
  grid.height = 215.0 * kMillimetre;
  grid.elevation_from = -110.0 * kDegree;
  grid.elevation_to = -30.0 * kDegree;
  grid.start.resize(5);
  grid.start << 0.0, 40.0, 80.0, 40.0, 0.0;
  grid.start *= kDegree;
  config.poses = grid;
  return Simulate(config);
}

/// Any arm at poses drawn uniformly within its limits.
inline Dataset MeasureGenericPoses(const Arm& nominal,
                                   const Eigen::VectorXd& true_values,
                                   int num_poses,
                                   const Measurement& measurement = {}) {
  SimulationConfig config = MeasurementOf(nominal, true_values, measurement);
  config.poses = RandomPoses{num_poses};
  return Simulate(config);
}

/// Columns of parameters by name. @pre every name exists.
inline std::vector<int> ColumnsOf(const ParameterLayout& layout,
                                  const std::vector<std::string>& names) {
  std::vector<int> columns;
  for (const std::string& name : names) {
    columns.push_back(layout.Find(name).value());
  }
  return columns;
}

/// Columns of all parameters of the joints: all but base and tool.
inline std::vector<int> JointColumns(const ParameterLayout& layout) {
  std::vector<int> columns;
  for (int column = 0; column < layout.size(); ++column) {
    if (ParameterLayout::IsJointKind(layout.parameter(column).kind)) {
      columns.push_back(column);
    }
  }
  return columns;
}

/// The 17 parameters that the study identifies at the wrist.
inline std::vector<int> WristFreeColumns(const ParameterLayout& layout) {
  return ColumnsOf(layout, {"beta1", "beta3", "beta4", "alpha1", "alpha2",
                            "alpha3", "d1", "d2", "d3", "d4", "d5", "theta1",
                            "theta2", "theta3", "r1", "r2", "r5"});
}

/// The 18 that are left at the flange once alpha5 and theta4 are fixed.
inline std::vector<int> FlangeFreeColumns(const ParameterLayout& layout) {
  return ColumnsOf(layout, {"beta1", "beta3", "beta4", "alpha1", "alpha2",
                            "alpha3", "alpha4", "d1", "d2", "d3", "d4", "d5",
                            "theta1", "theta2", "theta3", "r1", "r2", "r5"});
}

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_SUPPORT_STUDY_H_
