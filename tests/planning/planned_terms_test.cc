#include "src/planning/planned_terms.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <optional>
#include <set>
#include <string>

#include "src/model/joint_draw.h"
#include "tests/support/matrix_kinematics.h"
#include "tests/support/rv2aj_arms.h"

namespace alidade::internal {
namespace {

constexpr double kSigma = 1e-4;  // m

Arm NominalArm() {
  Arm arm = testing::Rv2ajFlange();
  arm.last_from_target().translation() = Eigen::Vector3d(0.03, -0.02, 0.05);
  return arm;
}

ErrorTermOptions Stated() {
  ErrorTermOptions options;
  options.selection = ErrorTermSelection::kStated;
  options.elasticity = true;
  options.harmonics = {2.0};
  options.coupling = {{1, 2}};
  return options;
}

// The arm with one of the terms at `value` (SI).
Arm WithTerm(const std::string& name, double value) {
  Arm arm = NominalArm();
  arm.errors.joints.resize(5);
  JointErrors& joint = arm.errors.joints[name[1] - '1'];
  if (name[0] == 'k') {
    joint.compliance[name.back() - 'x'] = value;
  } else if (name.substr(0, 1) == "h") {
    const bool is_cosine = name[3] == 'c';
    joint.harmonics = {{2.0, is_cosine ? value : 0.0, is_cosine ? 0.0 : value}};
  } else {
    arm.errors.coupling.setZero(5, 5);
    arm.errors.coupling(1, 2) = value;
  }
  return arm;
}

TEST(PlannedTermsTest, NoneAreAskedForByDefault) {
  const MeasurementModel model(NominalArm());
  const Eigen::MatrixXd q = DrawJointValues(NominalArm(), 50, 1);
  EXPECT_FALSE(PlannedTerms::Of(model, ErrorTermOptions(), q).has_value());
  ErrorTermOptions empty;
  empty.selection = ErrorTermSelection::kStated;
  EXPECT_FALSE(PlannedTerms::Of(model, empty, q).has_value());
}

TEST(PlannedTermsTest, RowsAreWhatTheTermsMoveInTheirUnits) {
  const Arm arm = NominalArm();
  const MeasurementModel model(arm);
  const Eigen::MatrixXd q = DrawJointValues(arm, 200, 2);
  const std::optional<PlannedTerms> terms =
      PlannedTerms::Of(model, Stated(), q);
  ASSERT_TRUE(terms.has_value());
  // Three compliances a joint, two of a harmonic, one coupling.
  ASSERT_EQ(terms->size(), 26);
  ASSERT_EQ(terms->entries().size(), 26U);
  PoseMeasurement measurement;
  measurement.sigma = kSigma;
  const Eigen::MatrixXd some = q.leftCols(20);
  const Dataset data = MakePlannedData(model, some, measurement);
  PoseRows rows = MakePoseRows(model, model.NominalValues(), data, {0, 1});
  const Eigen::MatrixXd before = rows.transposed;
  terms->Append(model, model.NominalValues(), data, &rows);
  ASSERT_EQ(rows.transposed.rows(), 28);
  EXPECT_EQ(rows.transposed.topRows(2), before);
  for (const PlannedTerms::Entry& entry : terms->entries()) {
    ASSERT_EQ(entry.count, 1);
    EXPECT_EQ(entry.unit, entry.name[0] == 'k' ? "rad/(N m)" : "rad");
    const double unit = entry.prior_std / PlannedTerms::kPrior;
    // Turns by 1e-4 rad and less: of second order is as much of them.
    const double step = 1e-4 * unit;
    const Arm moved = WithTerm(entry.name, step);
    for (Eigen::Index i = 0; i < some.cols(); ++i) {
      const Eigen::Vector3d expected =
          (testing::MatrixPosition(moved, some.col(i).data()) -
           testing::MatrixPosition(arm, some.col(i).data()))
              .cast<double>() /
          (1e-4 * kSigma);
      const Eigen::Vector3d row =
          rows.transposed.block(2 + entry.first, 3 * i, 1, 3).transpose();
      EXPECT_LT((row - expected).norm(), 1e-3 / kSigma) << entry.name;
    }
  }
}

TEST(PlannedTermsTest, AUnitMovesTheEndOfTheReachByAMetre) {
  const Arm arm = NominalArm();
  const MeasurementModel model(arm);
  const Eigen::MatrixXd q = DrawJointValues(arm, 500, 3);
  const std::optional<PlannedTerms> terms =
      PlannedTerms::Of(model, Stated(), q);
  ASSERT_TRUE(terms.has_value());
  for (const PlannedTerms::Entry& entry : terms->entries()) {
    if (entry.name[0] != 'h') continue;
    // The root mean square of a cosine over poses is some 0.7.
    const double turn = entry.prior_std / PlannedTerms::kPrior;
    EXPECT_NEAR(0.707 * turn * ArmReach(arm), 1.0, 0.25) << entry.name;
  }
  EXPECT_EQ(terms->known().rows(), terms->size());
  EXPECT_NEAR(terms->known()(0, 0),
              1.0 / (PlannedTerms::kPrior * PlannedTerms::kPrior), 1e-6);
}

TEST(PlannedTermsTest, AutoIsElasticityAndAFunctionOfEachJoint) {
  Arm arm = NominalArm();
  arm.joints[1].type = JointType::kPrismatic;
  const MeasurementModel model(arm);
  ErrorTermOptions options;
  options.selection = ErrorTermSelection::kAuto;
  const std::optional<PlannedTerms> terms =
      PlannedTerms::Of(model, options, DrawJointValues(arm, 100, 4));
  ASSERT_TRUE(terms.has_value());
  std::set<std::string> names;
  int count = 0;
  for (const PlannedTerms::Entry& entry : terms->entries()) {
    names.insert(entry.name);
    EXPECT_EQ(entry.first, count) << entry.name;
    count += entry.count;
    if (entry.name[0] != 'e') continue;
    EXPECT_EQ(entry.unit, entry.name == "e2" ? "m" : "rad");
    EXPECT_GE(entry.count, 2);
  }
  EXPECT_EQ(count, terms->size());
  for (const char* name : {"e1", "e2", "e3", "e4", "e5", "k1_z", "k2_x"}) {
    EXPECT_EQ(names.count(name), 1U) << name;
  }
  EXPECT_EQ(names.count("k2_z"), 0U);
}

}  // namespace
}  // namespace alidade::internal
