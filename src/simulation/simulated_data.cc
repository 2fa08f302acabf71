#include "src/simulation/simulated_data.h"

#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "alidade/rotation.h"

namespace alidade::internal {
namespace {

// Adds a change to the measured values of an observation: lengths by addition,
// an orientation by a rotation on the left.
void Move(const Eigen::VectorXd& change, MeasurementKind kind,
          Eigen::Ref<Eigen::VectorXd> measured) {
  if (kind != MeasurementKind::kPose) {
    measured += change;
    return;
  }
  measured.head<3>() += change.head<3>();
  const Eigen::Vector3d turn = change.tail<3>();
  const Eigen::Vector3d before = measured.tail<3>();
  measured.tail<3>() = VectorFromRotation<double>(
      RotationFromVector<double>(turn) * RotationFromVector<double>(before));
}

// Noise of one observation.
Eigen::VectorXd DrawNoise(const ObservationBlock& block, Eigen::Index i,
                          Random* random) {
  Eigen::VectorXd noise = Eigen::VectorXd::Zero(block.rows_each());
  std::vector<Eigen::Index> measured;
  for (Eigen::Index row = 0; row < noise.size(); ++row) {
    if (std::isinf(block.sigmas(row, i))) continue;
    measured.push_back(row);
    noise[row] = random->Normal();
  }
  if (block.whiteners.empty() || block.whiteners[i].size() == 0) {
    for (const Eigen::Index row : measured) noise[row] *= block.sigmas(row, i);
    return noise;
  }
  const Eigen::MatrixXd whitener = block.whiteners[i](measured, measured);
  const Eigen::VectorXd white = noise(measured);
  const Eigen::VectorXd coloured = whitener.partialPivLu().solve(white);
  noise(measured) = coloured;
  return noise;
}

bool IsLength(int row) { return row < 3; }

}  // namespace

void MeasureExactly(const MeasurementModel& model,
                    const Eigen::VectorXd& values,
                    const SharedMatrix& joint_values, Dataset* data) {
  const SharedMatrix stated = data->joint_values;
  data->joint_values = joint_values;
  const SharedVector errors = model.Errors(values, *data);
  data->joint_values = stated;
  Eigen::Index row = 0;
  for (ObservationBlock& block : data->blocks) {
    MatrixBuilder measured(block.measured);
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      Move(errors.map().segment(row, block.rows_each()), block.kind,
           measured.map().col(i));
      row += block.rows_each();
    }
    block.measured = measured.Freeze();
  }
}

void AddNoise(const MonteCarloOptions& config, double reach, Random* random,
              Dataset* data) {
  for (ObservationBlock& block : data->blocks) {
    MatrixBuilder measured(block.measured);
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      Eigen::VectorXd noise = DrawNoise(block, i, random);
      if (config.outlier_fraction > 0.0 &&
          random->Uniform() < config.outlier_fraction) {
        for (int row = 0; row < block.rows_each(); ++row) {
          if (std::isinf(block.sigmas(row, i))) continue;
          const double size =
              IsLength(row) ? config.outlier_size : config.outlier_size / reach;
          noise[row] += size * random->Normal();
        }
      }
      Move(noise, block.kind, measured.map().col(i));
    }
    block.measured = measured.Freeze();
  }
}

Eigen::MatrixXd MissedJointValues(const MonteCarloOptions& config,
                                  const Arm& arm,
                                  const SharedMatrix& joint_values,
                                  Random* random) {
  Eigen::MatrixXd missed = joint_values.map();
  for (Eigen::Index i = 0; i < missed.cols(); ++i) {
    for (int j = 0; j < arm.num_joints(); ++j) {
      const double sigma = arm.joints[j].type == JointType::kRevolute
                               ? config.joint_angle_sigma
                               : config.joint_length_sigma;
      missed(j, i) += sigma * random->Normal();
    }
  }
  return missed;
}

}  // namespace alidade::internal
