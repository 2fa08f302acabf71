// Jobs of every kind of measurement: an arm whose geometry is off by
// manufacturing tolerances is measured with noise, and the job, which knows the
// nominal arm alone, has to find it.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/forward_kinematics.h"
#include "alidade/inverse_kinematics.h"
#include "alidade/rotation.h"
#include "src/common/random.h"
#include "src/job/run_job.h"
#include "src/model/joint_draw.h"
#include "tests/calibration/kinds_util.h"
#include "tests/support/edit.h"

namespace alidade::internal::kinds_test {
namespace {

CalibrationResult Calibrate(const JobConfig& job) {
  const CalibrationResult outcome = RunJob(job, "test");
  EXPECT_EQ(outcome.status, CalibrationStatus::kDone) << outcome.message;
  EXPECT_NEAR(outcome.reduced_chi_square, 1.0, 0.3);
  EXPECT_TRUE(outcome.validation.has_value());
  return outcome;
}

TEST(KindsTest, PosesFindTheFrameOfTheTargetToo) {
  const Arm real = RealArm();
  const Eigen::MatrixXd q = DrawJointValues(real, 100, 5);
  const CalibrationResult result =
      Calibrate(JobOf(Bench(real, q).Poses().data()));
  // 4R + 2P + 6 = 30.
  EXPECT_EQ(result.identifiability.num_free, 30);
  // Noise has norms of 0.087 mm and 0.030 deg in three coordinates.
  EXPECT_NEAR(result.validation->after.rms, 9.2e-5, 1.5e-5);
  EXPECT_NEAR(result.validation->rotation_after.rms, 5.4e-4, 0.8e-4);
  EXPECT_GT(result.validation->rotation_before.rms,
            2.0 * result.validation->rotation_after.rms);
  ASSERT_EQ(result.stages.size(), 3u);
  EXPECT_EQ(result.stages[0].num_free, 12);
  EXPECT_GT(result.stages[0].validation_rotation.n, 0);
}

TEST(KindsTest, SeveralTargetsAreFoundAtOnce) {
  Arm real = RealArm();
  real.targets.resize(3);
  real.last_from_target(1).translation() << -0.05, 0.02, 0.12;
  real.last_from_target(2).translation() << 0.01, 0.09, 0.03;
  const Eigen::MatrixXd q = DrawJointValues(real, 60, 5);
  JobConfig job =
      JobOf(Bench(real, q).Positions(0).Positions(1).Positions(2).data());
  job.arm.targets.resize(3);
  const CalibrationResult outcome = RunJob(job, "test");
  ASSERT_EQ(outcome.status, CalibrationStatus::kDone) << outcome.message;
  // 4R + 2P + 3 for the first target, 3 for each of the others.
  EXPECT_EQ(outcome.identifiability.num_free, 33);
  EXPECT_NEAR(outcome.validation->after.rms, 9.2e-5, 1.5e-5);
  // Sides of the triangle of targets do not depend on any frame.
  for (int k = 1; k < 3; ++k) {
    const double side = (outcome.arm.last_from_target(k).translation() -
                         outcome.arm.last_from_target(0).translation())
                            .norm();
    const double expected = (real.last_from_target(k).translation() -
                             real.last_from_target(0).translation())
                                .norm();
    EXPECT_NEAR(side, expected, 5e-5);
  }
}

TEST(KindsTest, AxesThatWereNotMeasuredDoNotCount) {
  const Arm real = RealArm();
  const Eigen::MatrixXd q = DrawJointValues(real, 120, 5);
  Dataset data = Bench(real, q).Positions(0).data();
  for (Eigen::Index i = 0; i < 120; i += 2) {
    // Garbage where nothing was measured.
    testing::Edit(&data.blocks[0].measured).at(1, i) = 123.0;
    testing::Edit(&data.blocks[0].sigmas).at(1, i) =
        std::numeric_limits<double>::infinity();
  }
  const CalibrationResult result = Calibrate(JobOf(data));
  // The root mean square of the norms of 2 and 3 coordinates alternately.
  EXPECT_NEAR(result.validation->after.rms, 8.2e-5, 1.5e-5);
}

TEST(KindsTest, DifferencesTellGeometryButNoPlace) {
  const Arm real = RealArm();
  const Eigen::MatrixXd q = DrawJointValues(real, 100, 5);
  JobConfig job;
  job.arm = NominalArm();
  job.arm.instrument_from_base.linear() = real.instrument_from_base.linear();
  job.data.training = Bench(real, q).Differences().data();
  job.options.identifiability.candidates = {true, true, true};
  const CalibrationResult outcome = RunJob(job, "test");
  ASSERT_EQ(outcome.status, CalibrationStatus::kDone) << outcome.message;
  // As positions, less the base's place.
  EXPECT_EQ(outcome.identifiability.num_free, 24);
  EXPECT_NEAR(outcome.reduced_chi_square, 1.0, 0.3);
}

TEST(KindsTest, TwoWiresFindTheirAnchorsAndTheTarget) {
  const Arm real = RealArm();
  const Eigen::MatrixXd q = DrawJointValues(real, 150, 5);
  JobConfig job = JobOf(Bench(real, q)
                            .Distances(0, {3.0, -2.0, 0.0})
                            .Distances(1, {5.5, -3.5, 0.2})
                            .data());
  job.arm.instrument_from_base = real.instrument_from_base;
  job.options.identifiability.candidates = {true, false, true};
  job.data.references.points = {{"left"}, {"right"}};
  const CalibrationResult result = Calibrate(job);
  EXPECT_NEAR(result.validation->after.rms, kSigma, 0.25 * kSigma);
  EXPECT_GT(result.validation->before.rms, 5.0 * kSigma);
  ASSERT_EQ(result.aliases.size(), 2u);
  EXPECT_EQ(result.aliases[1].first, "point2");
  EXPECT_EQ(result.aliases[1].second, "right");
}

// Joint values that put the real arm's target where `places` say.
Eigen::MatrixXd Touching(const Arm& real,
                         const std::vector<Eigen::Vector3d>& places) {
  Eigen::MatrixXd q(real.num_joints(),
                    static_cast<Eigen::Index>(places.size()));
  Random random(23);
  for (std::size_t i = 0; i < places.size(); ++i) {
    std::optional<Eigen::VectorXd> solution;
    while (!solution) {
      Eigen::VectorXd start(real.num_joints());
      for (double& value : start) value = random.Uniform(-2.0, 2.0);
      solution = SolveInverseKinematics(real, {places[i], std::nullopt}, start);
    }
    q.col(static_cast<Eigen::Index>(i)) = *solution;
  }
  // What the encoders say is not exact either: the ball sits in its socket to
  // about sigma.
  for (double& value : q.reshaped()) value += 3e-5 * random.Normal();
  return q;
}

Eigen::Vector3d InInstrument(const Arm& real, double x, double y, double z) {
  return real.instrument_from_base * Eigen::Vector3d(x, y, z);
}

ObservationBlock KnownDistance(int first, int second, double length) {
  ObservationBlock block;
  block.kind = MeasurementKind::kPointDistance;
  block.references = {first};
  block.seconds = {second};
  block.measured = Eigen::MatrixXd::Constant(1, 1, length);
  block.sigmas = Eigen::MatrixXd::Constant(1, 1, 1e-5);
  return block;
}

// Two plates of two sockets each, which the second is said to have so far
// apart.
JobConfig SocketJob(const Arm& real, double second_length) {
  const std::vector<Eigen::Vector3d> sockets = {
      InInstrument(real, 0.6, 0.2, 0.1), InInstrument(real, 0.6, 0.25, 0.1),
      InInstrument(real, -0.3, 0.6, 0.4), InInstrument(real, -0.3, 0.6, 0.45)};
  std::vector<Eigen::Vector3d> places;
  std::vector<int> points;
  for (int i = 0; i < 160; ++i) {
    points.push_back(i % 4);
    places.push_back(sockets[i % 4]);
  }
  const Eigen::MatrixXd q = Touching(real, places);
  JobConfig job = JobOf(Bench(real, q)
                            .Contacts(MeasurementKind::kFixedPoint, points)
                            .Append(KnownDistance(0, 1, 0.05))
                            .Append(KnownDistance(2, 3, second_length))
                            .data());
  job.arm.instrument_from_base = real.instrument_from_base;
  job.options.identifiability.candidates = {true, false, true};
  job.data.references.points = {{"a/0"}, {"a/1"}, {"b/0"}, {"b/1"}};
  job.options.estimate_sigma = true;
  return job;
}

bool WarnsOfDistances(const CalibrationResult& result) {
  return std::any_of(result.warnings.begin(), result.warnings.end(),
                     [](const std::string& warning) {
                       return warning.find("contradict the known distances") !=
                              std::string::npos;
                     });
}

TEST(KindsTest, ABallInSocketsAKnownDistanceApartIsEnough) {
  const Arm real = RealArm();
  const JobConfig job = SocketJob(real, 0.05);
  const CalibrationResult result = Calibrate(job);
  EXPECT_FALSE(WarnsOfDistances(result));
  EXPECT_GT(result.validation->before.rms, 1e-3);
  EXPECT_LT(result.validation->after.rms, 2e-4);
  EXPECT_GT(result.validation->after.rms, 2e-5);
  // The scale is that of the known distances, told to 1e-5 / 0.05 each: were
  // it free, the fit would shrink the arm by all that its priors allow.
  const CalibrationResult outcome = RunJob(job, "test");
  EXPECT_NEAR(std::abs(outcome.arm.joints[2].d), std::abs(real.joints[2].d),
              1e-3);
}

// Of two plates that are alike one is said to be 0.2 mm longer: no arm has both
// lengths, and what the arm measures is taken to be as good.
TEST(KindsTest, DistancesThatMeasurementsContradictWeighLess) {
  const Arm real = RealArm();
  const CalibrationResult result = RunJob(SocketJob(real, 0.0502), "test");
  ASSERT_EQ(result.status, CalibrationStatus::kDone) << result.message;
  EXPECT_TRUE(WarnsOfDistances(result));
  const auto distance = [&](int first, int second) {
    return (result.references[first].vector - result.references[second].vector)
        .norm();
  };
  // Held at 0.01 mm they would be 0.19 mm apart.
  EXPECT_LT(std::abs(distance(0, 1) - distance(2, 3)), 1e-4);
  EXPECT_NEAR(distance(0, 1), 0.0501, 1e-4);
}

TEST(KindsTest, SocketsWithoutAKnownDistanceLeaveTheSizeOpen) {
  const Arm real = RealArm();
  std::vector<Eigen::Vector3d> places;
  std::vector<int> points;
  for (int i = 0; i < 120; ++i) {
    points.push_back(i % 2);
    places.push_back(i % 2 == 0 ? InInstrument(real, 0.6, 0.2, 0.1)
                                : InInstrument(real, -0.3, 0.6, 0.4));
  }
  const Eigen::MatrixXd q = Touching(real, places);
  JobConfig job = JobOf(
      Bench(real, q).Contacts(MeasurementKind::kFixedPoint, points).data());
  job.arm.instrument_from_base = real.instrument_from_base;
  job.options.identifiability.candidates = {true, false, true};
  job.data.references.points = {{"a"}, {"b"}};
  for (const bool with_distance : {false, true}) {
    if (with_distance) {
      job.data.training.blocks.push_back(
          KnownDistance(0, 1, (places[0] - places[1]).norm()));
    }
    const CalibrationResult outcome = RunJob(job, "test");
    ASSERT_EQ(outcome.status, CalibrationStatus::kDone) << outcome.message;
    bool is_warned = false;
    for (const std::string& warning : outcome.warnings) {
      is_warned = is_warned ||
                  warning.find("size of the arm open") != std::string::npos;
    }
    EXPECT_EQ(is_warned, !with_distance);
  }
}

TEST(KindsTest, ContactWithAPlaneFindsThePlane) {
  const Arm real = RealArm();
  Random random(3);
  std::vector<Eigen::Vector3d> places;
  for (int i = 0; i < 150; ++i) {
    places.push_back(InInstrument(real, random.Uniform(-0.7, 0.7),
                                  random.Uniform(0.2, 0.8), 0.1));
  }
  const Eigen::MatrixXd q = Touching(real, places);
  JobConfig job = JobOf(
      Bench(real, q)
          .Contacts(MeasurementKind::kPlane, std::vector<int>(places.size(), 0))
          .data());
  job.arm.instrument_from_base = real.instrument_from_base;
  job.arm.last_from_target() = real.last_from_target();
  job.options.identifiability.candidates = {true, false, false};
  job.data.references.planes = {{"table"}};
  job.options.estimate_sigma = true;
  const CalibrationResult result = Calibrate(job);
  EXPECT_LT(result.validation->after.rms, 1.5e-4);
  EXPECT_GT(result.validation->before.rms, 3.0 * result.validation->after.rms);
}

TEST(KindsTest, KindsMixFreely) {
  const Arm real = RealArm();
  const Eigen::MatrixXd q = DrawJointValues(real, 80, 5);
  JobConfig job =
      JobOf(Bench(real, q).Poses().Distances(0, {3.0, -2.0, 0.0}).data());
  job.data.references.points = {{"anchor"}};
  job.options.folds = FoldsOptions{4, 1};
  const CalibrationResult result = Calibrate(job);
  EXPECT_EQ(result.identifiability.num_free, 33);
  ASSERT_TRUE(result.cross_validation.has_value());
  EXPECT_EQ(result.cross_validation->folds, 4);
  // 56 training poses with an observation of each kind, each held out once.
  EXPECT_EQ(result.cross_validation->position.n, 112);
  EXPECT_EQ(result.cross_validation->rotation.n, 56);
  ASSERT_EQ(result.validation->labels.size(), 48u);
  EXPECT_EQ(result.validation->labels[0].kind, "pose");
  EXPECT_EQ(result.validation->labels[24].kind, "distance");
}

TEST(KindsTest, SigmasOfLengthsAndOrientationsAreEstimatedApart) {
  const Arm real = RealArm();
  const Eigen::MatrixXd q = DrawJointValues(real, 200, 5);
  JobConfig job = JobOf(Bench(real, q).Poses().data());
  testing::Edit(&job.data.training.blocks[0].sigmas)->topRows<3>() *= 4.0;
  testing::Edit(&job.data.training.blocks[0].sigmas)->bottomRows<3>() /= 5.0;
  job.options.estimate_sigma = true;
  const CalibrationResult result = Calibrate(job);
  EXPECT_NEAR(result.estimated_sigma, kSigma, 0.12 * kSigma);
  EXPECT_NEAR(result.estimated_rotation_sigma, kRotationSigma,
              0.12 * kRotationSigma);
}

TEST(KindsTest, RepeatsTellTheirOwnSpread) {
  const Arm real = RealArm();
  Eigen::MatrixXd q = DrawJointValues(real, 90, 5);
  for (int i = 0; i < 90; ++i) q.col(i) = q.col(3 * (i / 3)).eval();
  const CalibrationResult outcome =
      RunJob(JobOf(Bench(real, q).Poses().data()), "test");
  ASSERT_EQ(outcome.status, CalibrationStatus::kDone) << outcome.message;
  const RepeatSpread& repeats = outcome.repeats;
  // 21 of 30 configurations are fitted, each with two degrees of freedom in
  // three coordinates: the deviation of the estimate is 6 %.
  EXPECT_EQ(repeats.length_degrees_of_freedom, 126);
  EXPECT_EQ(repeats.rotation_degrees_of_freedom, 126);
  EXPECT_NEAR(repeats.length, kSigma, 0.2 * kSigma);
  EXPECT_NEAR(repeats.rotation, kRotationSigma, 0.2 * kRotationSigma);
}

TEST(KindsTest, AParameterStopsAtItsBoundAndTheReportSaysSo) {
  const Arm real = RealArm();
  const Eigen::MatrixXd q = DrawJointValues(real, 100, 5);
  JobConfig job = JobOf(Bench(real, q).Positions(0).data());
  const ParameterLayout layout(job.arm);
  const int column = *layout.Find("d3");
  const double nominal = layout.Values(job.arm)[column];
  // Half of the way that the data ask for.
  const double limit = 0.5 * (nominal + real.joints[2].d);
  ASSERT_GT(std::abs(real.joints[2].d - nominal), 1e-4);
  job.options.bounds = {{layout.parameter(column).name,
                         std::min(limit, nominal), std::max(limit, nominal)}};
  const CalibrationResult outcome = RunJob(job, "test");
  ASSERT_EQ(outcome.status, CalibrationStatus::kDone) << outcome.message;
  EXPECT_NEAR(outcome.arm.joints[2].d, limit, 1e-12);
  bool is_told = false;
  for (const std::string& warning : outcome.warnings) {
    is_told = is_told || warning.find("at a bound: d3") != std::string::npos;
  }
  EXPECT_TRUE(is_told);
}

}  // namespace
}  // namespace alidade::internal::kinds_test
