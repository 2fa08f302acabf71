// Arms with error terms, all the way through a calibration.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "alidade/arm_file.h"
#include "alidade/calibration.h"
#include "alidade/error.h"
#include "alidade/forward_kinematics.h"
#include "alidade/units.h"
#include "src/calibration/calibration_task.h"
#include "src/kernel/partition.h"
#include "tests/support/io_test_util.h"
#include "tests/support/noisy_positions.h"
#include "tests/support/rv2aj_arms.h"

namespace alidade::internal::flexible_test {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

constexpr double kSigma = 2e-5;  // m

Arm NominalArm() {
  Arm arm = testing::Rv2ajFlange();
  arm.last_from_target().translation() = Eigen::Vector3d(0.03, -0.02, 0.05);
  return arm;
}

// The assumed real arm, which bends by up to some tenths of a millimetre.
Arm FlexibleArm() {
  Arm arm = testing::WithRv2ajDeviations(NominalArm());
  arm.errors.joints.resize(5);
  for (int j = 0; j < 5; ++j) {
    arm.errors.joints[j].compliance =
        Eigen::Vector3d(2e-5, -1e-5, j < 3 ? 8e-5 : 3e-5);
    arm.errors.joints[j].harmonics = {{2.0, 3e-4, -2e-4}};
  }
  return arm;
}

CalibrationData DataOf(const Arm& real, int poses, std::uint64_t seed = 1) {
  CalibrationData data(testing::NoisyPositions(real, poses, kSigma, seed));
  data.validation = testing::NoisyPositions(real, 100, kSigma, seed + 100);
  return data;
}

CalibrationOptions With(ErrorTermSelection selection) {
  CalibrationOptions options;
  options.errors.selection = selection;
  options.errors.elasticity = true;
  options.errors.function_length = 1.0;
  return options;
}

CalibrationOptions With(ErrorTermSelection selection, int threads) {
  CalibrationOptions options = With(selection);
  options.num_threads = threads;
  return options;
}

TEST(FlexibleTest, StatedTermsLeaveTheNoise) {
  const CalibrationData data = DataOf(FlexibleArm(), 100);
  const CalibrationResult rigid = Calibrate(NominalArm(), data);
  const CalibrationResult result =
      Calibrate(NominalArm(), data, With(ErrorTermSelection::kStated));
  ASSERT_TRUE(result.IsUsable()) << result.message;
  ASSERT_TRUE(result.error_terms.has_value());
  EXPECT_EQ(result.error_terms->share, 1.0);
  EXPECT_FALSE(rigid.error_terms.has_value());
  EXPECT_TRUE(rigid.arm.errors.empty());
  // Noise of three coordinates, and the error of some hundred coefficients.
  EXPECT_LT(result.validation->after.rms, 1.8 * std::sqrt(3.0) * kSigma);
  EXPECT_LT(result.validation->after.rms, 0.3 * rigid.validation->after.rms);
  const ErrorTermsResult& terms = *result.error_terms;
  ASSERT_EQ(terms.rungs.size(), 2U);
  EXPECT_NEAR(terms.rungs[0].validation.rms, rigid.validation->after.rms,
              1e-3 * rigid.validation->after.rms);
  EXPECT_NEAR(terms.rungs[1].validation.rms, result.validation->after.rms,
              0.05 * result.validation->after.rms);
  EXPECT_GT(terms.effective_terms, 20.0);
  EXPECT_THAT(terms.sentence, HasSubstr("asked for"));
}

TEST(FlexibleTest, ArmOfTheResultMakesTheErrorsOfTheResult) {
  const CalibrationResult result =
      Calibrate(NominalArm(), DataOf(FlexibleArm(), 60),
                With(ErrorTermSelection::kStated));
  ASSERT_EQ(result.arm.errors.joints.size(), 5U);
  EXPECT_EQ(result.arm.errors.load_geometry.size(), 0);
  const EvaluatedSet& set = *result.validation;
  for (Eigen::Index i = 0; i < set.joint_values.cols(); ++i) {
    const Eigen::VectorXd q = set.joint_values.col(i);
    const Eigen::Vector3d expected =
        testing::MatrixPosition(result.arm, q.data()).cast<double>() -
        set.positions.col(i);
    // Moments are of the arm's own geometry in both.
    EXPECT_LT((set.residual_after.col(i) - expected).norm(), 1e-13) << i;
  }
}

TEST(FlexibleTest, ArmFileHoldsTheArmToTheBit) {
  const CalibrationResult result =
      Calibrate(NominalArm(), DataOf(FlexibleArm(), 60),
                With(ErrorTermSelection::kStated));
  const TestDirectory directory;
  const Arm loaded =
      LoadArm(directory.Write("arm.yaml", FormatArm(result.arm, "test")));
  ASSERT_EQ(loaded.errors.joints.size(), 5U);
  for (int j = 0; j < 5; ++j) {
    const JointErrors& before = result.arm.errors.joints[j];
    const JointErrors& after = loaded.errors.joints[j];
    EXPECT_EQ(after.compliance, before.compliance);
    EXPECT_EQ(after.function.first, before.function.first);
    EXPECT_EQ(after.function.spacing, before.function.spacing);
    EXPECT_EQ(after.function.values, before.function.values);
    EXPECT_EQ(after.function.deviations, before.function.deviations);
  }
  // And what validates it finds the same errors.
  CalibrationOptions frozen;
  const EvaluatedSet& set = *result.validation;
  for (Eigen::Index i = 0; i < set.joint_values.cols(); ++i) {
    const Eigen::VectorXd q = set.joint_values.col(i);
    EXPECT_LT((TargetPose(loaded, q).translation() - set.positions.col(i) -
               set.residual_after.col(i))
                  .norm(),
              1e-13);
  }
}

TEST(FlexibleTest, AutomaticTermsAreFoundAndTold) {
  const CalibrationData data = DataOf(FlexibleArm(), 150);
  const CalibrationResult result =
      Calibrate(NominalArm(), data, With(ErrorTermSelection::kAuto));
  const CalibrationResult rigid = Calibrate(NominalArm(), data);
  ASSERT_TRUE(result.error_terms.has_value());
  const ErrorTermsResult& terms = *result.error_terms;
  EXPECT_GT(terms.share, 0.9);
  ASSERT_GE(terms.rungs.size(), 5U);
  EXPECT_EQ(terms.rungs[0].name, "geometry");
  EXPECT_EQ(terms.rungs[0].num_terms, 0);
  EXPECT_EQ(terms.rungs[1].num_terms, 15);
  double weights = 0.0;
  for (const ErrorRung& rung : terms.rungs) weights += rung.weight;
  EXPECT_NEAR(weights, 1.0, 1e-12);
  EXPECT_GT(terms.rungs[1].compliance_std, 0.0);
  EXPECT_EQ(terms.rungs[1].function_std, 0.0);
  EXPECT_GT(terms.rungs[4].function_std, 0.0);
  EXPECT_LT(result.validation->after.mean, 0.4 * rigid.validation->after.mean);
  EXPECT_THAT(terms.sentence, HasSubstr("times smaller"));
  // What is predicted is what is seen.
  const PredictionParts& parts = result.uncertainty->validation->parts;
  const double predicted =
      std::sqrt(parts.from_parameters * parts.from_parameters +
                parts.from_model * parts.from_model +
                parts.from_measurement * parts.from_measurement);
  EXPECT_NEAR(predicted / result.validation->after.rms, 1.0, 0.25);
}

// Each fold is calibrated as all data are: the errors of what it leaves out are
// those of poses that no fit has seen, with as many poses.
TEST(FlexibleTest, FoldsHaveTheErrorTermsOfTheCalibration) {
  CalibrationOptions options = With(ErrorTermSelection::kStated);
  options.folds = FoldsOptions{4, 1};
  const CalibrationResult result =
      Calibrate(NominalArm(), DataOf(FlexibleArm(), 120), options);
  const CalibrationResult unseen =
      Calibrate(NominalArm(), DataOf(FlexibleArm(), 90),
                With(ErrorTermSelection::kStated));
  ASSERT_TRUE(result.cross_validation.has_value());
  EXPECT_EQ(result.cross_validation->position.n, 120);
  // Of two draws of poses; rigid folds leave more than three times as much.
  EXPECT_NEAR(
      result.cross_validation->position.rms / unseen.validation->after.rms, 1.0,
      0.35);
}

TEST(FlexibleTest, RigidArmsStayAsTheyAre) {
  int none = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const CalibrationData data =
        DataOf(testing::WithRv2ajDeviations(NominalArm()), 80, seed);
    const CalibrationResult result =
        Calibrate(NominalArm(), data, With(ErrorTermSelection::kAuto));
    const CalibrationResult rigid = Calibrate(NominalArm(), data);
    EXPECT_LT(result.validation->after.mean,
              1.02 * rigid.validation->after.mean);
    if (result.error_terms->share > 0.0) continue;
    ++none;
    EXPECT_THAT(result.error_terms->sentence, HasSubstr("no error terms"));
    EXPECT_TRUE(result.arm.errors.empty());
    EXPECT_EQ(result.validation->residual_after,
              rigid.validation->residual_after);
    for (std::size_t k = 0; k < rigid.parameters.size(); ++k) {
      EXPECT_EQ(result.parameters[k].value, rigid.parameters[k].value);
    }
  }
  EXPECT_GE(none, 3);
}

TEST(FlexibleTest, FewPosesAreSaidToDecideNothing) {
  const CalibrationResult result = Calibrate(
      NominalArm(), DataOf(FlexibleArm(), 9), With(ErrorTermSelection::kAuto));
  ASSERT_TRUE(result.error_terms.has_value());
  EXPECT_EQ(result.error_terms->share, 0.0);
  EXPECT_TRUE(result.error_terms->rungs.empty());
  EXPECT_THAT(result.error_terms->sentence, HasSubstr("fewer than 10"));
  EXPECT_TRUE(result.arm.errors.empty());
}

TEST(FlexibleTest, ThreadsDoNotChangeBits) {
  const CalibrationData data = DataOf(FlexibleArm(), 80);
  const CalibrationResult one =
      Calibrate(NominalArm(), data, With(ErrorTermSelection::kAuto, 1));
  const CalibrationResult two =
      Calibrate(NominalArm(), data, With(ErrorTermSelection::kAuto, 2));
  EXPECT_GT(one.error_terms->share, 0.0);
  EXPECT_EQ(FormatArm(one.arm, ""), FormatArm(two.arm, ""));
  EXPECT_EQ(one.validation->residual_after, two.validation->residual_after);
  for (std::size_t k = 0; k < one.parameters.size(); ++k) {
    EXPECT_EQ(one.parameters[k].value, two.parameters[k].value);
    if (std::isnan(one.parameters[k].std)) continue;
    EXPECT_EQ(one.parameters[k].std, two.parameters[k].std);
  }
}

TEST(FlexibleTest, JointsThatTheArmDoesNotHaveAreRefused) {
  const CalibrationData data = DataOf(FlexibleArm(), 20);
  CalibrationOptions options = With(ErrorTermSelection::kStated);
  options.errors.coupling = {{1, 5}};
  EXPECT_THROW(Calibrate(NominalArm(), data, options), InputError);
  options.errors.coupling.clear();
  options.errors.uses = {{"temperature", false, false, {-1}}};
  EXPECT_THROW(Calibrate(NominalArm(), data, options), InputError);
}

TEST(FlexibleTest, SeveralProcessesAreRefusedWithASentence) {
  RunOnThreads(2, [](Communicator* communicator) {
    CalibrationTask task;
    task.arm = NominalArm();
    task.data.training = testing::NoisyPositions(
        FlexibleArm(), 40, kSigma,
        static_cast<std::uint64_t>(communicator->rank()) + 5);
    MakePartition(communicator, &task.data.training);
    task.options = With(ErrorTermSelection::kAuto);
    task.communicator = communicator;
    const CalibrationResult result = Calibrate(task);
    EXPECT_TRUE(result.arm.errors.empty());
    ASSERT_TRUE(result.error_terms.has_value());
    EXPECT_THAT(result.error_terms->sentence, HasSubstr("without mpirun"));
    EXPECT_THAT(result.warnings, Contains(HasSubstr("in one process")));
  });
}

TEST(FlexibleTest, TermsOfTheArmStayWhereNoneAreAskedFor) {
  Arm nominal = NominalArm();
  nominal.errors = FlexibleArm().errors;
  const CalibrationData data = DataOf(FlexibleArm(), 60);
  const CalibrationResult result = Calibrate(nominal, data);
  ASSERT_EQ(result.arm.errors.joints.size(), 5U);
  EXPECT_EQ(result.arm.errors.joints[1].compliance,
            nominal.errors.joints[1].compliance);
  EXPECT_LT(result.validation->after.rms, 1.3 * std::sqrt(3.0) * kSigma);
  // Asked for, they are estimated anew.
  nominal.errors.joints[1].compliance.z() = 1.0;
  const CalibrationResult anew =
      Calibrate(nominal, data, With(ErrorTermSelection::kStated));
  EXPECT_LT(anew.validation->after.rms, 1.8 * std::sqrt(3.0) * kSigma);
}

TEST(FlexibleTest, EstimatedSigmaIsThatOfTheFullModel) {
  CalibrationOptions options = With(ErrorTermSelection::kStated);
  options.estimate_sigma = true;
  CalibrationData data = DataOf(FlexibleArm(), 150);
  data.training.sigmas() = SharedMatrix::Repeated(
      Eigen::Vector3d::Constant(1e-3), data.training.num_poses());
  const CalibrationResult result = Calibrate(NominalArm(), data, options);
  EXPECT_NEAR(result.estimated_sigma, kSigma, 0.15 * kSigma);
  EXPECT_EQ(result.sigma, result.estimated_sigma);
}

}  // namespace
}  // namespace alidade::internal::flexible_test
