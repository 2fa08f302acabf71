#include "alidade/references.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "src/common/random.h"
#include "src/kernel/measurement_model.h"
#include "tests/support/measurement_oracle.h"
#include "tests/support/random_arms.h"

namespace alidade::internal {
namespace {

// Random ones; along the axes; and within 1e-9 of z and -z, and on both sides
// of the equator, where the formula changes its sign.
std::vector<Eigen::Vector3d> Normals() {
  Random random(31);
  std::vector<Eigen::Vector3d> normals;
  for (int i = 0; i < 100; ++i) {
    normals.push_back(testing::RandomDirection(&random));
  }
  for (int axis = 0; axis < 3; ++axis) {
    normals.push_back(Eigen::Vector3d::Unit(axis));
    normals.push_back(-Eigen::Vector3d::Unit(axis));
  }
  normals.emplace_back(0.6, 0.8, -0.0);
  for (const double tilt : {1e-300, 1e-16, 1e-9, 1e-4}) {
    normals.push_back(Eigen::Vector3d(tilt, -tilt, 1.0).normalized());
    normals.push_back(Eigen::Vector3d(-tilt, tilt, -1.0).normalized());
    normals.push_back(Eigen::Vector3d(0.6, 0.8, tilt).normalized());
    normals.push_back(Eigen::Vector3d(0.6, 0.8, -tilt).normalized());
  }
  return normals;
}

TEST(TangentBasisTest, IsOrthonormalAndRightHanded) {
  for (const Eigen::Vector3d& normal : Normals()) {
    Eigen::Matrix3d frame;
    Eigen::Vector3d t1;
    Eigen::Vector3d t2;
    TangentBasis(normal, &t1, &t2);
    frame << t1, t2, normal;
    // A few units of eps, the rounding of the normal's length included.
    EXPECT_LT((frame.transpose() * frame - Eigen::Matrix3d::Identity())
                  .cwiseAbs()
                  .maxCoeff(),
              2e-15)
        << normal.transpose();
    EXPECT_NEAR(frame.determinant(), 1.0, 2e-15) << normal.transpose();
  }
}

TEST(TangentBasisTest, IsTheSmallestTurnFromTheNearerPole) {
  for (const Eigen::Vector3d& normal : Normals()) {
    Eigen::Vector3d t1;
    Eigen::Vector3d t2;
    TangentBasis(normal, &t1, &t2);
    testing::Vector3l exact1;
    testing::Vector3l exact2;
    testing::TangentsOf(normal.cast<long double>(), &exact1, &exact2);
    EXPECT_LT((t1 - exact1.cast<double>()).norm(), 2e-15) << normal.transpose();
    EXPECT_LT((t2 - exact2.cast<double>()).norm(), 2e-15) << normal.transpose();
  }
}

TEST(TangentBasisTest, AtThePolesTheAxesThemselves) {
  Eigen::Vector3d t1;
  Eigen::Vector3d t2;
  TangentBasis(Eigen::Vector3d::UnitZ(), &t1, &t2);
  EXPECT_EQ(t1, Eigen::Vector3d::UnitX());
  EXPECT_EQ(t2, Eigen::Vector3d::UnitY());
  TangentBasis(-Eigen::Vector3d::UnitZ(), &t1, &t2);
  EXPECT_EQ(t1, Eigen::Vector3d::UnitX());
  EXPECT_EQ(t2, -Eigen::Vector3d::UnitY());
}

TEST(ReferencesTest, AreFoundByName) {
  References references;
  references.points = {{"anchor"}, {"socket"}};
  references.planes = {{"table"}};
  EXPECT_EQ(references.num_points(), 2);
  EXPECT_EQ(references.num_planes(), 1);
  EXPECT_EQ(references.FindPoint("socket"), 1);
  EXPECT_EQ(references.FindPoint("table"), -1);
  EXPECT_EQ(references.FindPlane("table"), 0);
  EXPECT_EQ(references.FindPlane(""), -1);
}

TEST(ReferencesTest, NominalValuesAreThoseOfTheReferences) {
  Random random(32);
  const Arm arm = testing::RandomArm(2, &random);
  References references;
  references.points = {{"a", {1.0, 2.0, 3.0}}, {"b", {4.0, 5.0, 6.0}}};
  references.planes = {{"p", {0.6, 0.0, -0.8}, 0.7}};
  const MeasurementModel model(arm, references, 1);
  const ParameterLayout& layout = model.layout();
  const Eigen::VectorXd values = model.NominalValues();
  ASSERT_EQ(values.size(), 5 * 2 + 12 + 9);
  EXPECT_EQ(values.head(22), ParameterLayout(2).Values(arm));
  Eigen::VectorXd expected(9);
  expected << 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 0.0, 0.0, 0.7;
  EXPECT_EQ(values.tail(9), expected);
  EXPECT_EQ(layout.Find("point2_z"), 27);
  EXPECT_EQ(layout.Find("plane1_c"), 30);
  const References again = model.ReferencesAt(values);
  for (int k = 0; k < 2; ++k) {
    EXPECT_EQ(again.points[k].name, references.points[k].name);
    EXPECT_EQ(again.points[k].position, references.points[k].position);
  }
  EXPECT_EQ(again.planes[0].normal, references.planes[0].normal);
  EXPECT_EQ(again.planes[0].offset, 0.7);
}

TEST(ReferencesTest, TiltsTurnTheNormalTowardsTheTangents) {
  for (const Eigen::Vector3d& normal : Normals()) {
    References references;
    references.planes = {{"p", normal}};
    Arm arm;
    arm.joints.resize(1);
    const MeasurementModel model(arm, references, 1);
    Eigen::VectorXd values = model.NominalValues();
    values[model.layout().Column(ParameterKind::kPlaneTilt, 0)] = 0.5;
    values[model.layout().Column(ParameterKind::kPlaneTilt, 1)] = -0.25;
    const Eigen::Vector3d tilted = model.ReferencesAt(values).planes[0].normal;
    Eigen::Vector3d t1;
    Eigen::Vector3d t2;
    TangentBasis(normal, &t1, &t2);
    EXPECT_NEAR(tilted.norm(), 1.0, 1e-15);
    EXPECT_NEAR(tilted.dot(t1) / tilted.dot(normal), 0.5, 2e-15);
    EXPECT_NEAR(tilted.dot(t2) / tilted.dot(normal), -0.25, 2e-15);
  }
}

}  // namespace
}  // namespace alidade::internal
