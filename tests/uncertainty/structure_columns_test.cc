// Columns of the table in structure_columns.h, each from the arm's derivatives
// by joint values and by lengths.

#include "src/uncertainty/structure_columns.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "alidade/forward_kinematics.h"
#include "alidade/units.h"
#include "src/common/random.h"
#include "tests/support/random_arms.h"

namespace alidade::internal::structure_columns_test {
namespace {

constexpr int kPoses = 30;
constexpr double kSigma = 1e-4;

// Two turns, a slide and a turn. Joint 2 stands still at every third pose; the
// first covariate goes up and down, the second does not change.
class StructureColumnsTest : public ::testing::Test {
 protected:
  StructureColumnsTest() : arm_(MakeArm()), model_(arm_) {
    Eigen::MatrixXd q = testing::RandomJointValues(arm_, kPoses, &random_);
    for (int i = 1; i < kPoses; ++i) {
      if (i % 3 == 0) q(1, i) = q(1, i - 1);
    }
    data_ = MakePositions(q, Eigen::Matrix3Xd::Zero(3, kPoses), kSigma);
    data_.covariate_names = {"t_c", "still"};
    Eigen::MatrixXd covariates = Eigen::MatrixXd::Constant(2, kPoses, 7.0);
    for (int i = 0; i < kPoses; ++i) covariates(0, i) = 20.0 + (i * i) % 17;
    data_.covariates = covariates;
  }

  Arm MakeArm() {
    testing::RandomArmOptions options;
    options.prismatic_fraction = 0.0;
    Arm arm = testing::RandomArm(4, &random_, options);
    arm.joints[2].type = JointType::kPrismatic;
    arm.joints[2].lower = -0.3;
    arm.joints[2].upper = 0.3;
    return arm;
  }

  // All columns: three rows a pose.
  Eigen::MatrixXd Filled(const StructureColumns& columns) const {
    Linearization rows;
    model_.Linearize(model_.NominalValues(), data_, columns.directions(),
                     &rows);
    Eigen::MatrixXd filled(3 * kPoses, columns.size());
    for (int i = 0; i < kPoses; ++i) {
      columns.Fill(i, 0, rows.jacobian.middleRows(3 * i, 3),
                   filled.middleRows(3 * i, 3));
    }
    return filled;
  }

  // Derivatives by the value of a joint, which are those by its zero.
  Eigen::VectorXd ByJoint(int joint) const {
    const bool turns = arm_.joints[joint].type == JointType::kRevolute;
    return ByColumn(model_.layout().Column(
        turns ? ParameterKind::kTheta : ParameterKind::kR, joint));
  }

  Eigen::VectorXd ByColumn(int column) const {
    Linearization rows;
    model_.Linearize(model_.NominalValues(), data_, {column}, &rows);
    return rows.jacobian;
  }

  // By the growth of all lengths of the chain, travels among them.
  Eigen::VectorXd ByGrowth() const {
    const auto grown = [&](double factor) {
      Arm arm = arm_;
      Eigen::MatrixXd q = data_.joint_values.map();
      for (int j = 0; j < arm.num_joints(); ++j) {
        arm.joints[j].d *= factor;
        arm.joints[j].r *= factor;
        if (arm.joints[j].type == JointType::kPrismatic) q.row(j) *= factor;
      }
      return TargetPositions(arm, q);
    };
    // The positions are linear in the lengths.
    const Eigen::Matrix3Xd slope = (grown(1.5) - grown(0.5)) / kSigma;
    return slope.reshaped();
  }

  // `factor` of each pose, for its three rows.
  template <typename Factor>
  static Eigen::VectorXd OfPoses(const Factor& factor) {
    Eigen::VectorXd all(3 * kPoses);
    for (int i = 0; i < kPoses; ++i)
      all.segment(3 * i, 3).setConstant(factor(i));
    return all;
  }

  // Half turns over the range of a slide.
  double Phase(int joint, int pose) const {
    const auto q = data_.joint_values.map().row(joint);
    if (arm_.joints[joint].type == JointType::kRevolute) return q[pose];
    return kPi * (q[pose] - q.minCoeff()) / (q.maxCoeff() - q.minCoeff());
  }

  // Of the last movement.
  double Approach(int joint, int pose) const {
    for (int i = pose; i > 0; --i) {
      const double moved =
          data_.joint_values(joint, i) - data_.joint_values(joint, i - 1);
      if (moved != 0.0) return moved > 0.0 ? 1.0 : -1.0;
    }
    return 0.0;
  }

  static void ExpectColumn(const Eigen::VectorXd& actual,
                           const Eigen::VectorXd& expected) {
    EXPECT_LT((actual - expected).cwiseAbs().maxCoeff(),
              1e-11 * (1.0 + expected.cwiseAbs().maxCoeff()));
  }

  // Growth, base and zeros, as `change` goes.
  template <typename Change>
  void ExpectSlowChanges(const std::vector<StructureFamily>& families,
                         const Eigen::MatrixXd& filled, int most_powers,
                         const Change& change) const {
    ASSERT_EQ(families.size(), 3U);
    const Eigen::VectorXd by_pose = OfPoses(change);
    ASSERT_EQ(static_cast<int>(families[0].columns.size()), most_powers);
    for (int power = 1; power <= most_powers; ++power) {
      ExpectColumn(
          filled.col(families[0].columns[power - 1]),
          ByGrowth().cwiseProduct(by_pose.array().pow(power).matrix()));
    }
    ASSERT_EQ(families[1].columns.size(), 6U);
    for (int k = 0; k < 6; ++k) {
      const int column =
          model_.layout().Column(k < 3 ? ParameterKind::kBaseTranslation
                                       : ParameterKind::kBaseRotation,
                                 k % 3);
      ExpectColumn(filled.col(families[1].columns[k]),
                   ByColumn(column).cwiseProduct(by_pose));
    }
    ASSERT_EQ(families[2].columns.size(), 4U);
    for (int j = 0; j < 4; ++j) {
      ExpectColumn(filled.col(families[2].columns[j]),
                   ByJoint(j).cwiseProduct(by_pose));
    }
  }

  static std::vector<StructureFamily> OfKind(const StructureColumns& columns,
                                             StructureKind kind) {
    std::vector<StructureFamily> found;
    for (const StructureFamily& family : columns.families()) {
      if (family.kind == kind) found.push_back(family);
    }
    return found;
  }

  Random random_{450};
  const Arm arm_;
  const MeasurementModel model_;
  Dataset data_;
};

TEST_F(StructureColumnsTest, JointValuesAreHarmonics) {
  // 31 columns of 992 rows, two for each ripple.
  const StructureColumns columns(model_, model_.NominalValues(), data_, 992,
                                 true);
  const Eigen::MatrixXd filled = Filled(columns);
  const auto low = OfKind(columns, StructureKind::kJointValue);
  const auto high = OfKind(columns, StructureKind::kJointRipple);
  ASSERT_EQ(low.size(), 4U);
  ASSERT_EQ(high.size(), 4U);
  for (int j = 0; j < 4; ++j) {
    EXPECT_EQ(low[j].joint, j + 1);
    EXPECT_EQ(high[j].joint, j + 1);
    std::vector<int> all = low[j].columns;
    ASSERT_EQ(all.size(), 6U);
    all.insert(all.end(), high[j].columns.begin(), high[j].columns.end());
    ASSERT_EQ(all.size(), 36U);
    for (int k = 1; k <= 18; ++k) {
      const auto of = [&](double (*function)(double)) -> Eigen::VectorXd {
        return ByJoint(j).cwiseProduct(
            OfPoses([&](int i) { return function(k * Phase(j, i)); }));
      };
      ExpectColumn(filled.col(all[2 * k - 2]), of(std::sin));
      ExpectColumn(filled.col(all[2 * k - 1]), of(std::cos));
    }
  }
}

TEST_F(StructureColumnsTest, RipplesAreAtMostTwentyNineAndNoneOfFewRows) {
  const auto ripples = [&](Eigen::Index rows) {
    return OfKind(
        StructureColumns(model_, model_.NominalValues(), data_, rows, true),
        StructureKind::kJointRipple);
  };
  EXPECT_EQ(ripples(100000).front().columns.size(), 2U * 29U);
  EXPECT_EQ(ripples(64).front().columns.size(), 2U);
  EXPECT_TRUE(ripples(63).empty());
}

TEST_F(StructureColumnsTest, ApproachIsTheSignOfTheLastMovement) {
  const StructureColumns columns(model_, model_.NominalValues(), data_, 90,
                                 true);
  const Eigen::MatrixXd filled = Filled(columns);
  const auto found = OfKind(columns, StructureKind::kApproach);
  ASSERT_EQ(found.size(), 5U);
  for (int j = 0; j < 4; ++j) {
    EXPECT_EQ(found[j].joint, j + 1);
    ASSERT_EQ(found[j].columns.size(), 1U);
    ExpectColumn(filled.col(found[j].columns[0]),
                 ByJoint(j).cwiseProduct(
                     OfPoses([&](int i) { return Approach(j, i); })));
    EXPECT_EQ(found[4].columns[j], found[j].columns[0]);
  }
  EXPECT_EQ(found[4].joint, 0);
  const StructureColumns without(model_, model_.NominalValues(), data_, 90,
                                 false);
  EXPECT_TRUE(OfKind(without, StructureKind::kApproach).empty());
}

TEST_F(StructureColumnsTest, SlowChangesAreOfLengthsBaseAndZeros) {
  const StructureColumns columns(model_, model_.NominalValues(), data_, 90,
                                 true);
  const Eigen::MatrixXd filled = Filled(columns);
  ExpectSlowChanges(OfKind(columns, StructureKind::kRowOrder), filled, 2,
                    [](int i) { return 2.0 * i / (kPoses - 1) - 1.0; });
  const auto covariate = OfKind(columns, StructureKind::kCovariate);
  const Eigen::RowVectorXd t = data_.covariates.map().row(0);
  ExpectSlowChanges(covariate, filled, 1, [&](int i) {
    return 2.0 * (t[i] - t.minCoeff()) / (t.maxCoeff() - t.minCoeff()) - 1.0;
  });
  for (const StructureFamily& family : covariate) {
    EXPECT_EQ(family.covariate, "t_c");
  }
}

// Moments are of the three joints that turn, and of all at once.
TEST_F(StructureColumnsTest, SignsAreThoseOfMoments) {
  const StructureColumns columns(model_, model_.NominalValues(), data_, 90,
                                 true);
  const Eigen::MatrixXd filled = Filled(columns);
  const auto moments = OfKind(columns, StructureKind::kGravityMoment);
  const auto signs = OfKind(columns, StructureKind::kGravitySign);
  ASSERT_EQ(moments.size(), 4U);
  ASSERT_EQ(signs.size(), 3U);
  EXPECT_EQ(moments[3].joint, 0);
  EXPECT_EQ(moments[3].columns.size(), 3U);
  for (int k = 0; k < 3; ++k) {
    const int joint = moments[k].joint - 1;
    EXPECT_EQ(signs[k].joint, moments[k].joint);
    const Eigen::VectorXd by_joint = ByJoint(joint);
    for (int i = 0; i < kPoses; ++i) {
      const auto slope = by_joint.segment(3 * i, 3);
      const double moment =
          filled.col(moments[k].columns[0]).segment(3 * i, 3).dot(slope);
      EXPECT_LT((filled.col(signs[k].columns[0]).segment(3 * i, 3) -
                 (moment > 0.0 ? 1.0 : -1.0) * slope)
                    .norm(),
                1e-12 * slope.norm());
    }
  }
}

}  // namespace
}  // namespace alidade::internal::structure_columns_test
