#include "alidade/stated_poses.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "alidade/error.h"
#include "src/common/constants.h"
#include "src/common/random.h"
#include "tests/support/matrix_kinematics.h"
#include "tests/support/random_arms.h"

namespace alidade::internal {
namespace {

using testing::Matrix3l;
using testing::MatrixFromVector;
using testing::Vector3l;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using RowMatrix = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

constexpr int kCount = 5;

// Positions, and orientations as rotation vectors.
struct Poses {
  Eigen::MatrixXd points, vectors;
};

Poses RandomPoses() {
  Random random(4);
  Poses poses{Eigen::MatrixXd(3, kCount), Eigen::MatrixXd(3, kCount)};
  for (int i = 0; i < kCount; ++i) {
    poses.points.col(i) = testing::RandomVector(1.0, &random);
    poses.vectors.col(i) =
        testing::RandomDirection(&random) * random.Uniform(0.1, 3.0);
  }
  return poses;
}

StatedPoses Stated() {
  const Poses poses = RandomPoses();
  StatedPoses stated;
  stated.positions = poses.points;
  stated.orientations = poses.vectors;
  stated.sigmas = Eigen::Vector3d(1e-5, 2e-5, 3e-5);
  stated.rotation_sigmas = Eigen::Vector3d(1e-4, 2e-4, 3e-4);
  return stated;
}

Eigen::Matrix3d MatrixOf(const Eigen::Vector3d& vector) {
  return MatrixFromVector(vector.cast<long double>()).cast<double>();
}

Matrix6d RandomCovariance(Random* random) {
  Matrix6d factor;
  for (double& entry : factor.reshaped()) entry = random->Uniform(-1.0, 1.0);
  return 1e-10 * (factor * factor.transpose() + 0.1 * Matrix6d::Identity());
}

// The covariance that a block says its observation has.
Eigen::MatrixXd CovarianceOf(const ObservationBlock& block, int i) {
  const Eigen::Index rows = block.rows_each();
  Eigen::MatrixXd whitener = Eigen::MatrixXd::Identity(rows, rows);
  Whiten(block, i, 1, whitener);
  return (whitener.transpose() * whitener).inverse();
}

void ExpectNear(const Eigen::MatrixXd& actual, const Eigen::MatrixXd& expected,
                double relative) {
  EXPECT_LT((actual - expected).cwiseAbs().maxCoeff(),
            relative * expected.cwiseAbs().maxCoeff())
      << actual << "\nexpected\n"
      << expected;
}

TEST(MakeObservationsTest, EveryFormGivesTheSameOrientation) {
  const StatedPoses stated = Stated();
  const ObservationBlock vectors = MakeObservations(stated);
  EXPECT_EQ(vectors.kind, MeasurementKind::kPose);
  EXPECT_TRUE(vectors.whiteners.empty());
  ExpectNear(vectors.measured.map().topRows(3), stated.positions, 1e-300);
  ExpectNear(vectors.measured.map().bottomRows(3), stated.orientations, 1e-15);
  StatedPoses matrices = stated, quaternions = stated, angles = stated;
  matrices.convention = "matrix";
  matrices.orientations.resize(9, kCount);
  quaternions.convention = "quaternion";
  quaternions.orientations.resize(4, kCount);
  angles.convention = "intrinsic_zyx";
  for (int i = 0; i < kCount; ++i) {
    const Eigen::Vector3d vector = stated.orientations.col(i);
    const Eigen::Matrix3d m = MatrixOf(vector);
    Eigen::Map<RowMatrix>(matrices.orientations.col(i).data()) = m;
    const double half = 0.5 * vector.norm();
    // Either sign is the same rotation, and three digits are enough.
    quaternions.orientations.col(i) << std::cos(half),
        std::sin(half) * vector.normalized();
    quaternions.orientations.col(i) *= i % 2 == 0 ? 1.0004 : -0.9996;
    angles.orientations.col(i) << std::atan2(m(2, 1), m(2, 2)),
        std::asin(-m(2, 0)), std::atan2(m(1, 0), m(0, 0));
  }
  for (const StatedPoses* same : {&matrices, &quaternions, &angles}) {
    const ObservationBlock block = MakeObservations(*same);
    // Half a turn is sensitive to rounding: arcs of 3 rad.
    ExpectNear(block.measured.map(), vectors.measured.map(), 2e-14);
    EXPECT_EQ(block.sigmas.map(), vectors.sigmas.map()) << same->convention;
  }
}

TEST(MakeObservationsTest, SigmasOfAllOrOfEach) {
  StatedPoses stated = Stated();
  const ObservationBlock one = MakeObservations(stated);
  stated.sigmas = stated.sigmas.replicate(1, kCount).eval();
  stated.rotation_sigmas = stated.rotation_sigmas.replicate(1, kCount).eval();
  EXPECT_EQ(MakeObservations(stated).sigmas.map(), one.sigmas.map());
  stated.sigmas(1, 3) = kInfinity;
  EXPECT_EQ(MakeObservations(stated).Dimension(3), 5);
}

TEST(MakeObservationsTest, WhitenersAreThoseOfTheCovariances) {
  Random random(5);
  StatedPoses stated = Stated();
  StatedPoses points = stated;
  points.orientations.resize(0, 0);
  stated.covariances.resize(36, kCount);
  points.covariances.resize(9, kCount);
  std::vector<Matrix6d> expected;
  for (int i = 0; i < kCount; ++i) {
    expected.push_back(RandomCovariance(&random));
    stated.covariances.col(i) = expected[i].reshaped();
    points.covariances.col(i) =
        expected[i].topLeftCorner<3, 3>().reshaped().eval();
  }
  const ObservationBlock poses = MakeObservations(stated);
  const ObservationBlock positions = MakeObservations(points);
  EXPECT_EQ(positions.kind, MeasurementKind::kPosition);
  for (int i = 0; i < kCount; ++i) {
    ExpectNear(CovarianceOf(poses, i), expected[i], 1e-12);
    ExpectNear(CovarianceOf(positions, i), expected[i].topLeftCorner<3, 3>(),
               1e-12);
  }
}

// Small changes of each angle turn the pose by so much about fixed axes.
TEST(MakeObservationsTest, SigmasOfAnglesArePropagated) {
  StatedPoses stated = Stated();
  stated.convention = "extrinsic_xyz";
  stated.orientations = 0.7 * stated.positions;
  stated.rotation_sigmas.resize(0, 0);
  stated.angle_sigmas = Eigen::Vector3d(1e-4, 2e-4, 5e-4);
  const ObservationBlock block = MakeObservations(stated);
  const auto rotation = [](const Eigen::Vector3d& angles) -> Matrix3l {
    return (testing::RotationZ(angles[2]) * testing::RotationY(angles[1]) *
            testing::RotationX(angles[0]))
        .topLeftCorner<3, 3>();
  };
  constexpr double kStep = 1e-6;
  for (int i = 0; i < kCount; ++i) {
    Eigen::Matrix3d turns;
    for (int k = 0; k < 3; ++k) {
      Eigen::Vector3d above = stated.orientations.col(i);
      Eigen::Vector3d below = above;
      above[k] += kStep;
      below[k] -= kStep;
      const Matrix3l turn = rotation(above) * rotation(below).transpose();
      turns.col(k) =
          Vector3l(turn(2, 1), turn(0, 2), turn(1, 0)).cast<double>() /
          (2 * kStep) * stated.angle_sigmas(k, 0);
    }
    ExpectNear(CovarianceOf(block, i).bottomRightCorner<3, 3>(),
               turns * turns.transpose(), 1e-6);
  }
}

// Of poses with noise, turned round one by one.
TEST(MakeObservationsTest, InversePosesCarryTheirNoise) {
  StatedPoses stated = Stated();
  stated.is_inverse = true;
  const ObservationBlock block = MakeObservations(stated);
  const Poses poses = RandomPoses();
  Random random(6);
  for (int i = 0; i < kCount; ++i) {
    const Eigen::Matrix3d rotation = MatrixOf(poses.vectors.col(i));
    const Eigen::Vector3d point = poses.points.col(i);
    const Eigen::Vector3d expected = -rotation.transpose() * point;
    ExpectNear(block.measured.col(i).head<3>(), expected, 1e-14);
    ExpectNear(block.measured.col(i).tail<3>(), -poses.vectors.col(i), 1e-14);
    constexpr int kDraws = 20000;
    Matrix6d sum = Matrix6d::Zero();
    for (int draw = 0; draw < kDraws; ++draw) {
      Eigen::Vector3d shift, turn;
      for (int k = 0; k < 3; ++k) {
        shift[k] = stated.sigmas(k, 0) * random.Normal();
        turn[k] = stated.rotation_sigmas(k, 0) * random.Normal();
      }
      const Eigen::Matrix3d noisy = MatrixOf(turn) * rotation;
      const Eigen::Matrix3d turned = noisy.transpose() * rotation;
      Eigen::Matrix<double, 6, 1> error;
      error << -noisy.transpose() * (point + shift) - expected, turned(2, 1),
          turned(0, 2), turned(1, 0);
      sum += error * error.transpose();
    }
    // 1 / sqrt(20000) of each variance: five of these standard errors.
    ExpectNear(CovarianceOf(block, i), sum / kDraws, 0.05);
  }
}

struct Hostile {
  std::string key;
  std::function<void(StatedPoses*)> spoil;
};

TEST(MakeObservationsTest, RefusesWhatIsWrongByItsName) {
  const std::vector<Hostile> cases = {
      {"positions", [](auto* s) { s->positions.resize(2, kCount); }},
      {"positions", [](auto* s) { s->positions(1, 2) = NAN; }},
      {"orientations", [](auto* s) { s->orientations(0, 4) = kInfinity; }},
      {"orientations", [](auto* s) { s->orientations.resize(3, 4); }},
      {"orientations", [](auto* s) { s->convention = "quaternion"; }},
      {"orientations",
       [](auto* s) {
         s->convention = "quaternion";
         s->orientations = Eigen::MatrixXd::Constant(4, kCount, 0.6);
       }},
      {"orientations",
       [](auto* s) {
         s->convention = "matrix";
         s->orientations = Eigen::MatrixXd::Constant(9, kCount, 1.0);
       }},
      {"orientations",
       [](auto* s) {
         // A mirror.
         s->convention = "matrix";
         s->orientations = Eigen::MatrixXd::Zero(9, kCount);
         s->orientations.row(0).setConstant(-1.0);
         s->orientations.row(4).setOnes();
         s->orientations.row(8).setOnes();
       }},
      {"convention", [](auto* s) { s->convention = "zyx"; }},
      {"convention", [](auto* s) { s->convention = ""; }},
      {"sigmas", [](auto* s) { s->sigmas.resize(0, 0); }},
      {"sigmas", [](auto* s) { s->sigmas(0, 0) = 0.0; }},
      {"sigmas", [](auto* s) { s->sigmas(0, 0) = NAN; }},
      {"sigmas", [](auto* s) { s->sigmas = Eigen::MatrixXd::Ones(3, 2); }},
      {"rotation_sigmas", [](auto* s) { s->rotation_sigmas.resize(0, 0); }},
      {"rotation_sigmas", [](auto* s) { s->rotation_sigmas(2, 0) = -1.0; }},
      {"angle_sigmas",
       [](auto* s) { s->angle_sigmas = Eigen::Vector3d::Ones(); }},
      {"angle_sigmas",
       [](auto* s) {
         // ry is a quarter of a turn: rx and rz turn about one axis.
         s->convention = "intrinsic_zyx";
         s->orientations.row(1).setConstant(std::acos(0.0));
         s->angle_sigmas = Eigen::Vector3d::Constant(1e-4);
       }},
      {"covariances",
       [](auto* s) { s->covariances = Eigen::MatrixXd::Ones(4, 1); }},
      {"covariances",
       [](auto* s) { s->covariances = Eigen::MatrixXd::Ones(36, 1); }},
      {"covariances",
       [](auto* s) {
         s->covariances = Matrix6d(Matrix6d::Identity()).reshaped();
         s->covariances(1, 0) = 0.5;
       }},
      {"covariances",
       [](auto* s) {
         s->covariances = Matrix6d(-Matrix6d::Identity()).reshaped();
       }},
      {"covariances",
       [](auto* s) { s->covariances = Matrix6d::Constant(NAN).reshaped(); }},
      {"angle_sigmas",
       [](auto* s) {
         s->covariances = Matrix6d(Matrix6d::Identity()).reshaped();
         s->angle_sigmas = Eigen::Vector3d::Ones();
       }},
      {"is_inverse",
       [](auto* s) {
         s->is_inverse = true;
         s->orientations.resize(0, 0);
       }},
      {"sigmas",
       [](auto* s) {
         s->is_inverse = true;
         s->sigmas(0, 0) = kInfinity;
       }},
  };
  for (std::size_t k = 0; k < cases.size(); ++k) {
    StatedPoses stated = Stated();
    cases[k].spoil(&stated);
    try {
      MakeObservations(stated);
      ADD_FAILURE() << "case " << k << " (" << cases[k].key << ") is taken";
    } catch (const InputError& error) {
      EXPECT_EQ(error.location().key, cases[k].key)
          << "case " << k << ": " << error.what();
      EXPECT_THAT(error.message(), ::testing::HasSubstr("xpected"));
    }
  }
}

TEST(MakeObservationsTest, NoneAreABlockOfNone) {
  StatedPoses stated = Stated();
  stated.positions.resize(3, 0);
  stated.orientations.resize(0, 0);
  EXPECT_EQ(MakeObservations(stated).size(), 0);
}

}  // namespace
}  // namespace alidade::internal
