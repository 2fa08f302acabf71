#include "tests/support/study.h"

namespace alidade::internal::testing {

Eigen::VectorXd Rv2ajTrueValues(const Arm& nominal) {
  return ParameterLayout(nominal.num_joints())
      .Values(WithRv2ajDeviations(nominal));
}

SimulationConfig MeasurementOf(const Arm& nominal,
                               const Eigen::VectorXd& true_values,
                               const Measurement& measurement) {
  SimulationConfig config;
  config.arm = nominal;
  config.true_values = true_values;
  config.noise_sigma = measurement.noise_sigma;
  config.seed = measurement.seed;
  return config;
}

Dataset MeasureStudyPoses(const Arm& nominal, const Measurement& measurement) {
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

Dataset StudyData(const Arm& nominal) {
  Dataset data = MeasureStudyPoses(nominal);
  return MakePositions(data.joint_values, data.positions(), 0.02 * kMillimetre);
}

Dataset MeasureGenericPoses(const Arm& nominal,
                            const Eigen::VectorXd& true_values, int num_poses,
                            const Measurement& measurement) {
  SimulationConfig config = MeasurementOf(nominal, true_values, measurement);
  config.poses = RandomPoses{num_poses};
  return Simulate(config);
}

std::vector<int> ColumnsOf(const ParameterLayout& layout,
                           const std::vector<std::string>& names) {
  std::vector<int> columns;
  for (const std::string& name : names) {
    columns.push_back(layout.Find(name).value());
  }
  return columns;
}

std::vector<int> JointColumns(const ParameterLayout& layout) {
  std::vector<int> columns;
  for (int column = 0; column < layout.size(); ++column) {
    if (ParameterLayout::IsJointKind(layout.parameter(column).kind)) {
      columns.push_back(column);
    }
  }
  return columns;
}

std::vector<int> WristFreeColumns(const ParameterLayout& layout) {
  return ColumnsOf(layout, {"beta1", "beta3", "beta4", "alpha1", "alpha2",
                            "alpha3", "d1", "d2", "d3", "d4", "d5", "theta1",
                            "theta2", "theta3", "r1", "r2", "r5"});
}

std::vector<int> FlangeFreeColumns(const ParameterLayout& layout) {
  return ColumnsOf(layout, {"beta1", "beta3", "beta4", "alpha1", "alpha2",
                            "alpha3", "alpha4", "d1", "d2", "d3", "d4", "d5",
                            "theta1", "theta2", "theta3", "r1", "r2", "r5"});
}

}  // namespace alidade::internal::testing
