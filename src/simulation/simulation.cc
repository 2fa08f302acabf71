#include "src/simulation/simulation.h"

#include <cmath>
#include <cstdio>
#include <string>
#include <variant>

#include "alidade/error.h"
#include "alidade/forward_kinematics.h"
#include "alidade/interruption.h"
#include "alidade/inverse_kinematics.h"
#include "alidade/units.h"
#include "src/common/random.h"
#include "src/model/joint_draw.h"
#include "src/model/motors.h"

namespace alidade::internal {
namespace {

// Streams of the seed: poses and noise draw from different ones, so that a
// change of the noise leaves the poses as they are.
constexpr std::uint64_t kNoiseStreams = std::uint64_t{1} << 32;

// Draws of the elevation before a target counts as out of reach.
constexpr int kMaxDraws = 1000;

double ValueAt(const Range& range, int i) {
  if (range.count == 1) return range.from;
  return range.from + (range.to - range.from) * i / (range.count - 1);
}

// Motors' values as a data set with so many decimals states them, to the bits
// that its reader makes of them; the joints follow: the arm is measured exactly
// where the file says.
Eigen::MatrixXd RoundedJointValues(const Arm& arm, int decimals,
                                   const Eigen::MatrixXd& joint_values) {
  if (decimals < 0) return joint_values;
  Eigen::MatrixXd q = MotorsFromJoints(arm, joint_values);
  const double scale = std::pow(10.0, decimals);
  const std::vector<Dimension> dimensions = MotorDimensions(arm);
  for (Eigen::Index i = 0; i < q.cols(); ++i) {
    for (Eigen::Index j = 0; j < q.rows(); ++j) {
      double& value = q(j, i);
      if (dimensions[j] == Dimension::kAngle) {
        value = std::round(value / kDegree * scale) / scale * kDegree;
      } else {
        value = std::round(value / kMillimetre * scale) / (scale * 1000.0);
      }
    }
  }
  return JointsFromMotors(arm, q);
}

class CylinderPlanner {
 public:
  CylinderPlanner(const SimulationConfig& config, const CylinderGrid& grid)
      : config_(config), grid_(grid) {}

  Eigen::MatrixXd Plan() const {
    Eigen::MatrixXd q(config_.arm.num_joints(),
                      grid_.azimuth.count * grid_.radius.count);
    for (int a = 0; a < grid_.azimuth.count; ++a) {
      for (int b = 0; b < grid_.radius.count; ++b) {
        const int pose = a * grid_.radius.count + b;
        q.col(pose) =
            Reach(ValueAt(grid_.azimuth, a), ValueAt(grid_.radius, b), pose);
      }
    }
    return q;
  }

 private:
  Eigen::VectorXd Reach(double azimuth, double radius, int pose) const {
    Random random(config_.seed, static_cast<std::uint64_t>(pose));
    const Eigen::Vector3d outwards(std::cos(azimuth), std::sin(azimuth), 0.0);
    const Eigen::Isometry3d& base = config_.arm.instrument_from_base;
    const Eigen::Vector3d target(radius * outwards.x(), radius * outwards.y(),
                                 grid_.height);
    Eigen::VectorXd start = grid_.start;
    const int last = config_.arm.num_joints() - 1;
    for (int draw = 0; draw < kMaxDraws; ++draw) {
      const double elevation =
          random.Uniform(grid_.elevation_from, grid_.elevation_to);
      const Eigen::Vector3d direction =
          std::cos(elevation) * outwards +
          std::sin(elevation) * Eigen::Vector3d::UnitZ();
      // A first joint that turns is turned towards the target; the last one
      // turns the tool about the direction, which leaves it free.
      if (config_.arm.joints[0].type == JointType::kRevolute) {
        start[0] = azimuth;
      }
      start[last] = DrawJointValue(config_.arm, last, &random);
      const auto q = SolveInverseKinematics(
          config_.arm, {base * target, base.linear() * direction}, start);
      if (q) return *q;
    }
    ThrowUnreachable(azimuth, radius);
  }

  [[noreturn]] void ThrowUnreachable(double azimuth, double radius) const {
    char text[200];
    std::snprintf(text, sizeof(text),
                  "no joint values within the limits reach azimuth %.4g deg, "
                  "radius %.4g mm, height %.4g mm at any of %d elevations "
                  "drawn; change the grid, the elevation or the start",
                  azimuth / kDegree, radius / kMillimetre,
                  grid_.height / kMillimetre, kMaxDraws);
    throw InputError({config_.path, 0, 0, "poses.cylinder"}, text);
  }

  const SimulationConfig& config_;
  const CylinderGrid& grid_;
};

Eigen::MatrixXd PlanPoses(const SimulationConfig& config) {
  if (const auto* grid = std::get_if<CylinderGrid>(&config.poses)) {
    return CylinderPlanner(config, *grid).Plan();
  }
  if (const auto* random = std::get_if<RandomPoses>(&config.poses)) {
    return DrawJointValues(config.arm, random->count, config.seed);
  }
  return std::get<PosesFromFile>(config.poses).joint_values;
}

MatrixBuilder TruePositions(const SimulationConfig& config,
                            const SharedMatrix& joint_values) {
  using Real = long double;
  const ParameterLayout layout(config.arm);
  const Eigen::Matrix<Real, Eigen::Dynamic, 1> values =
      config.true_values.cast<Real>();
  const GeometryView<Real> geometry = ViewOf(layout, values.data());
  MatrixBuilder positions(3, joint_values.cols());
  MatrixBuilder::Map columns = positions.map();
  for (Eigen::Index i = 0; i < joint_values.cols(); ++i) {
    CheckInterruption();
    columns.col(i) =
        TargetPosition(config.arm, geometry, joint_values.col(i).data())
            .cast<double>();
  }
  return positions;
}

void AddNoise(const SimulationConfig& config, MatrixBuilder::Map positions) {
  for (Eigen::Index i = 0; i < positions.cols(); ++i) {
    CheckInterruption();
    Random random(config.seed, kNoiseStreams + static_cast<std::uint64_t>(i));
    for (int axis = 0; axis < 3; ++axis) {
      positions(axis, i) += config.noise_sigma * random.Normal();
    }
  }
}

}  // namespace

Dataset Simulate(const SimulationConfig& config) {
  Dataset data;
  data.name = config.output;
  data.joint_values =
      MatrixBuilder(RoundedJointValues(config.arm, config.joint_decimals,
                                       PlanPoses(config)))
          .Freeze();
  MatrixBuilder positions = TruePositions(config, data.joint_values);
  if (config.noise_sigma > 0.0) AddNoise(config, positions.map());
  data.positions() = positions.Freeze();
  if (!data.joint_values.map().allFinite() ||
      !data.positions().map().allFinite()) {
    throw InputError({config.path, 0, 0, ""},
                     "the arm, its limits or its deviations are so large that "
                     "positions are not finite");
  }
  data.sigmas() = SharedMatrix::Repeated(
      Eigen::Vector3d::Constant(config.noise_sigma > 0.0 ? config.noise_sigma
                                                         : 1.0),
      data.num_poses());
  return data;
}

}  // namespace alidade::internal
