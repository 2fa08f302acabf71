#include "src/calibration/error_term_report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "alidade/calibration_options.h"
#include "src/calibration/calibration_task.h"
#include "src/kernel/measurement_model.h"
#include "src/model/joint_draw.h"
#include "src/solve/solve.h"
#include "tests/support/classic_arms.h"

namespace alidade::internal::error_term_report_test {
namespace {

constexpr double kLever = 0.4;  // m

Arm OneJoint() {
  Arm arm;
  arm.joints.resize(1);
  arm.targets.resize(1);
  arm.targets[0].last_from_target.translation() << kLever, 0.0, 0.0;
  return arm;
}

Eigen::MatrixXd Steps(double first, double last, int count) {
  return Eigen::RowVectorXd::LinSpaced(count, first, last);
}

const ErrorTermEffect* Find(const std::vector<ErrorTermEffect>& effects,
                            int joint, const std::string& term) {
  for (const ErrorTermEffect& effect : effects) {
    if (effect.joint == joint && effect.term == term) return &effect;
  }
  return nullptr;
}

// A turn by e moves a target at the end of a lever by its chord.
TEST(MeasureEffectsTest, AreChordsOfALever) {
  constexpr double kScale = 2e-3;
  constexpr double kCosine = 5e-3;
  Arm arm = OneJoint();
  arm.errors.joints.resize(1);
  arm.errors.joints[0].harmonics = {{1.0, kCosine, 0.0}};
  arm.errors.coupling = Eigen::MatrixXd::Constant(1, 1, kScale);
  const Eigen::MatrixXd values = Steps(-1.0, 2.0, 7);
  const std::vector<ErrorTermEffect> effects = MeasureEffects(arm, values, 1);
  ASSERT_EQ(effects.size(), 4U);
  const auto expect = [&](int joint, const char* term, auto error) {
    double sum = 0.0;
    double largest = 0.0;
    for (const double q : values.row(0)) {
      const double chord = 2.0 * kLever * std::abs(std::sin(0.5 * error(q)));
      sum += chord * chord;
      largest = std::max(largest, chord);
    }
    const ErrorTermEffect* const effect = Find(effects, joint, term);
    ASSERT_NE(effect, nullptr) << term;
    EXPECT_NEAR(effect->rms, std::sqrt(sum / 7.0), 1e-12) << term;
    EXPECT_NEAR(effect->max, largest, 1e-12) << term;
  };
  expect(1, "harmonics", [&](double q) { return kCosine * std::cos(q); });
  expect(1, "scale and coupling", [&](double q) { return kScale * q; });
  const auto both = [&](double q) {
    return kCosine * std::cos(q) + kScale * q;
  };
  expect(1, "all", both);
  expect(0, "all", both);
}

TEST(MeasuredRangesTest, AreCutAtGaps) {
  Eigen::MatrixXd values(1, 60);
  // In any order; steps of 0.05 rad are no gap, one of 1 rad is.
  values << Steps(0.5, 1.45, 20), Steps(-1.5, -0.55, 20), Steps(0.5, 1.45, 20);
  const std::vector<MeasuredRange> ranges = MeasuredRanges(OneJoint(), values);
  ASSERT_EQ(ranges.size(), 2U);
  EXPECT_EQ(ranges[0].joint, 1);
  EXPECT_EQ(ranges[0].lower, -1.5);
  EXPECT_NEAR(ranges[0].upper, -0.55, 1e-12);
  EXPECT_EQ(ranges[1].lower, 0.5);
  EXPECT_NEAR(ranges[1].upper, 1.45, 1e-12);
}

// Positions of an arm whose second joint alone has an error: along that joint
// the residuals are the error itself.
TEST(ProjectResidualsTest, FindTheErrorOfTheJointThatHasOne) {
  constexpr int kPoses = 1100;
  Arm rigid = testing::Planar3R();
  rigid.last_from_target().translation() << 0.0, 0.0, 0.1;
  Arm flexible = rigid;
  flexible.errors.joints.resize(3);
  flexible.errors.joints[1].harmonics = {{1.0, 1e-3, -2e-3}};
  const MeasurementModel true_model(flexible);
  const Eigen::MatrixXd joints = DrawJointValues(rigid, kPoses, 5);
  const Eigen::VectorXd values = true_model.NominalValues();
  CalibrationTask task{rigid, {}, {}};
  task.data.training =
      MakePositions(joints, true_model.Predict(values, joints),
                    Eigen::Matrix3Xd::Constant(3, kPoses, 1e-4));
  const MeasurementModel model(rigid);
  const CalibrationProblem before{model, task.data.training, {}};
  const CalibrationProblem after{true_model, task.data.training, {}};
  const JointResiduals found =
      ProjectResiduals({task, before, values}, {task, after, values});
  ASSERT_EQ(found.poses.size(), 367U);  // every third, at most 500
  EXPECT_EQ(found.poses[2], 6);
  int seen = 0;
  for (Eigen::Index k = 0; k < found.geometry.cols(); ++k) {
    EXPECT_EQ(found.joint_values(1, k), joints(1, found.poses[k]));
    // The target is on the axis of joint 3, which therefore moves nothing.
    EXPECT_TRUE(std::isnan(found.geometry(2, k)));
    if (std::isnan(found.geometry(1, k))) continue;
    ++seen;
    const double q = joints(1, found.poses[k]);
    // But for the square of the error.
    EXPECT_NEAR(found.geometry(1, k), 1e-3 * std::cos(q) - 2e-3 * std::sin(q),
                5e-6);
    EXPECT_NEAR(found.remaining(1, k), 0.0, 1e-12);
  }
  EXPECT_EQ(seen, 367);
}

}  // namespace
}  // namespace alidade::internal::error_term_report_test
