#include "src/serialization/arm_errors.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <string>

#include "alidade/arm_file.h"
#include "alidade/units.h"
#include "src/common/random.h"
#include "src/serialization/job_config.h"
#include "tests/support/config_files.h"
#include "tests/support/io_test_util.h"
#include "tests/support/random_arms.h"
#include "tests/support/random_errors.h"

namespace alidade::internal {
namespace {

Arm LoadText(const std::string& text) {
  const TestDirectory directory;
  return LoadArm(directory.Write("arm.yaml", text));
}

// A revolute and a prismatic joint; the errors begin in line 7.
Arm LoadErrors(const std::string& errors) {
  return LoadText(std::string(kArmText) + errors);
}

TEST(ArmErrorsTest, AreReadInTheFilesUnits) {
  const Arm arm = LoadErrors(
      "errors:\n"
      "  gravity: [0, 0, 1]\n"
      "  links:\n"
      "    - {mass: 4, centre: [10, 20, 30]}\n"
      "    - {mass: 2}\n"
      "  payload: {mass: 0.5, centre: [0, 0, 100]}\n"
      "  joints:\n"
      "    - compliance: [0.1, 0.2, 0.3]\n"
      "      function: {first: -90, spacing: 45, values: [0.1, 0.2, 0.3],\n"
      "                 deviations: [1, 2, 3]}\n"
      "      harmonics: [[1, 0.5, -0.5], [2.5, 0, 1]]\n"
      "      backlash: 0.25\n"
      "    - function: {first: 100, spacing: 50, values: [1, 2]}\n"
      "  coupling: [[0.001, 0.5], [0.25, 0]]\n");
  const ErrorTerms& errors = arm.errors;
  EXPECT_EQ(errors.gravity, Eigen::Vector3d::UnitZ());
  ASSERT_EQ(errors.links.size(), 2U);
  EXPECT_EQ(errors.links[0].mass, 4.0);
  EXPECT_TRUE(errors.links[0].centre.isApprox(Eigen::Vector3d(.01, .02, .03)));
  EXPECT_EQ(errors.links[1].centre, Eigen::Vector3d::Zero());
  EXPECT_EQ(errors.payload.mass, 0.5);
  EXPECT_DOUBLE_EQ(errors.payload.centre.z(), 0.1);
  ASSERT_EQ(errors.joints.size(), 2U);
  const JointErrors& first = errors.joints[0];
  EXPECT_TRUE(
      first.compliance.isApprox(kDegree * Eigen::Vector3d(0.1, 0.2, 0.3)));
  EXPECT_DOUBLE_EQ(first.function.first, -90.0 * kDegree);
  EXPECT_DOUBLE_EQ(first.function.spacing, 45.0 * kDegree);
  EXPECT_DOUBLE_EQ(first.function.At(0.0), 0.3 * kDegree);
  EXPECT_DOUBLE_EQ(first.function.DeviationAt(0.0), 3.0 * kDegree);
  ASSERT_EQ(first.harmonics.size(), 2U);
  EXPECT_EQ(first.harmonics[1].cycles, 2.5);
  EXPECT_DOUBLE_EQ(first.harmonics[0].sine, -0.5 * kDegree);
  EXPECT_DOUBLE_EQ(first.backlash, 0.25 * kDegree);
  // Of a prismatic joint in mm by mm.
  EXPECT_DOUBLE_EQ(errors.joints[1].function.At(0.15), 0.002);
  // deg per mm and mm per deg.
  EXPECT_DOUBLE_EQ(errors.coupling(0, 0), 0.001);
  EXPECT_DOUBLE_EQ(errors.coupling(0, 1), 0.5 * kDegree / kMillimetre);
  EXPECT_DOUBLE_EQ(errors.coupling(1, 0), 0.25 * kMillimetre / kDegree);
}

TEST(ArmErrorsTest, DirectionOfGravityMayHaveAnyLength) {
  const Arm arm =
      LoadErrors("errors: {gravity: [0, 3, -4], joints: [{}, {}]}\n");
  EXPECT_TRUE(arm.errors.gravity.isApprox(Eigen::Vector3d(0.0, 0.6, -0.8)));
}

TEST(ArmErrorsTest, ComeBackToTheBit) {
  for (int stream = 0; stream < 6; ++stream) {
    Random random(170, stream);
    Arm arm = testing::RandomArm(4, &random);
    arm.errors = testing::RandomErrors(arm, &random);
    arm.errors.load_geometry.resize(0, 0);
    arm.errors.joints[1].function.deviations = Eigen::VectorXd::Random(11);
    arm.errors.joints[2].function = JointFunction();
    arm.errors.joints[3].harmonics.clear();
    if (stream == 1) arm.errors.coupling.resize(0, 0);
    if (stream == 2) arm.errors.links.clear();
    if (stream == 3) arm.errors.joints.clear();
    const ErrorTerms read = LoadText(FormatArm(arm, "a test")).errors;
    // Directions are made of length 1 again.
    EXPECT_TRUE(read.gravity.isApprox(arm.errors.gravity, 1e-15));
    EXPECT_EQ(read.coupling, arm.errors.coupling);
    ASSERT_EQ(read.links.size(), arm.errors.links.size());
    for (std::size_t k = 0; k < read.links.size(); ++k) {
      EXPECT_EQ(read.links[k].mass, arm.errors.links[k].mass);
      EXPECT_EQ(read.links[k].centre, arm.errors.links[k].centre);
    }
    EXPECT_EQ(read.payload.mass, arm.errors.payload.mass);
    EXPECT_EQ(read.payload.centre, arm.errors.payload.centre);
    ASSERT_EQ(read.joints.size(), arm.errors.joints.size());
    for (std::size_t k = 0; k < read.joints.size(); ++k) {
      const JointErrors& expected = arm.errors.joints[k];
      EXPECT_EQ(read.joints[k].compliance, expected.compliance);
      EXPECT_EQ(read.joints[k].backlash, expected.backlash);
      EXPECT_EQ(read.joints[k].function.first, expected.function.first);
      EXPECT_EQ(read.joints[k].function.spacing, expected.function.spacing);
      EXPECT_EQ(read.joints[k].function.values, expected.function.values);
      EXPECT_EQ(read.joints[k].function.is_periodic,
                expected.function.is_periodic);
      EXPECT_EQ(read.joints[k].function.deviations,
                expected.function.deviations);
      ASSERT_EQ(read.joints[k].harmonics.size(), expected.harmonics.size());
      for (std::size_t i = 0; i < expected.harmonics.size(); ++i) {
        EXPECT_EQ(read.joints[k].harmonics[i].cycles,
                  expected.harmonics[i].cycles);
        EXPECT_EQ(read.joints[k].harmonics[i].cosine,
                  expected.harmonics[i].cosine);
        EXPECT_EQ(read.joints[k].harmonics[i].sine, expected.harmonics[i].sine);
      }
    }
  }
}

TEST(ArmErrorsTest, CovariatesComeBackToTheBit) {
  Random random(172);
  Arm arm = testing::RandomArm(3, &random);
  for (const char* name : {"tilt", "mass"}) {
    CovariateEffect effect;
    effect.name = name;
    effect.reference = random.Normal();
    for (double& value : effect.base) value = random.Normal();
    if (effect.name == "mass") {
      effect.joints = Eigen::Vector3d(0.1, -0.2, 0.3);
      for (double& value : effect.target) value = random.Normal();
      effect.payload = 1.0;
    }
    arm.errors.covariates.push_back(effect);
  }
  const ErrorTerms read = LoadText(FormatArm(arm, "a test")).errors;
  ASSERT_EQ(read.covariates.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    const CovariateEffect& expected = arm.errors.covariates[k];
    EXPECT_EQ(read.covariates[k].name, expected.name);
    EXPECT_EQ(read.covariates[k].reference, expected.reference);
    EXPECT_EQ(read.covariates[k].base, expected.base);
    EXPECT_EQ(read.covariates[k].joints, expected.joints);
    EXPECT_EQ(read.covariates[k].target, expected.target);
    EXPECT_EQ(read.covariates[k].payload, expected.payload);
  }
}

TEST(ArmErrorsTest, RigidArmHasNoneInItsFileButLoadsThatAreKnown) {
  Random random(171);
  Arm arm = testing::RandomArm(3, &random);
  EXPECT_EQ(FormatArm(arm, "").find("errors"), std::string::npos);
  arm.errors.payload.mass = 2.5;
  const Arm loaded = LoadText(FormatArm(arm, ""));
  EXPECT_EQ(loaded.errors.payload.mass, 2.5);
  EXPECT_TRUE(loaded.errors.empty());
}

struct ErrorsCase {
  const char* name;
  const char* text;
  ExpectedError expected;
};

void PrintTo(const ErrorsCase& one, std::ostream* out) { *out << one.name; }

class BadArmErrorsTest : public ::testing::TestWithParam<ErrorsCase> {};

TEST_P(BadArmErrorsTest, AreRefusedWithTheirPlace) {
  ExpectInputError([&] { LoadErrors(GetParam().text); }, GetParam().expected);
}

INSTANTIATE_TEST_SUITE_P(
    Arms, BadArmErrorsTest,
    ::testing::Values(
        ErrorsCase{
            "OneJointOfTwo",
            "errors:\n  joints:\n    - {backlash: 1}\n",
            {9, 5, "errors.joints", "expected one per joint, 2, found 1"}},
        ErrorsCase{
            "ThreeLinksOfTwo",
            "errors:\n  links: [{}, {}, {}]\n",
            {8, 10, "errors.links", "expected one per joint, 2, found 3"}},
        ErrorsCase{"NoSpacing",
                   "errors:\n  joints:\n    - {}\n"
                   "    - function: {first: 0, spacing: 0, values: [1]}\n",
                   {10, 7, "errors.joints[2]", "must be above 0"}},
        ErrorsCase{"NegativeSpacing",
                   "errors:\n  joints:\n"
                   "    - function: {first: 0, spacing: -1, values: [1]}\n"
                   "    - {}\n",
                   {9, 7, "errors.joints[1]", "must be above 0"}},
        ErrorsCase{"OtherCountOfDeviations",
                   "errors:\n  joints:\n    - {}\n"
                   "    - function: {first: 0, spacing: 1, values: [1, 2], "
                   "deviations: [1]}\n",
                   {10, 7, "errors.joints[2]", "2 values and 1 deviations"}},
        ErrorsCase{"NoValues",
                   "errors:\n  joints:\n"
                   "    - function: {first: 0, spacing: 1}\n    - {}\n",
                   {9, 17, "errors.joints[1].function.values", "missing"}},
        ErrorsCase{"NotANumber",
                   "errors:\n  joints:\n"
                   "    - {compliance: [.nan, 0, 0]}\n    - {}\n",
                   {9, 21, "errors.joints[1].compliance[1]", "expected a"}},
        ErrorsCase{
            "InfiniteValue",
            "errors:\n  joints:\n"
            "    - function: {first: 0, spacing: 1, values: [1, .inf]}\n"
            "    - {}\n",
            {9, 52, "errors.joints[1].function.values[2]", "expected a"}},
        ErrorsCase{"UnknownKey",
                   "errors:\n  stiffness: 3\n",
                   {8, 3, "errors.stiffness", "unknown key \"stiffness\""}},
        ErrorsCase{"UnknownKeyOfAJoint",
                   "errors:\n  joints:\n    - {}\n    - {compliances: 1}\n",
                   {10, 8, "errors.joints[2].compliances",
                    "unknown key \"compliances\""}},
        ErrorsCase{"NegativeMass",
                   "errors:\n  payload: {mass: -1}\n",
                   {8, 19, "errors.payload.mass", "0 or more"}},
        ErrorsCase{
            "HarmonicOfTwoNumbers",
            "errors:\n  joints:\n    - {harmonics: [[1, 2]]}\n    - {}\n",
            {9, 20, "errors.joints[1].harmonics[1]", "cycles per turn"}},
        ErrorsCase{
            "HarmonicOfNoCycles",
            "errors:\n  joints:\n    - {harmonics: [[0, 2, 1]]}\n    - {}\n",
            {9, 21, "errors.joints[1].harmonics[1][1]", "above 0"}},
        ErrorsCase{"CouplingOfOneRow",
                   "errors:\n  coupling: [[1, 2]]\n",
                   {8, 13, "errors.coupling", "one row per joint"}},
        ErrorsCase{"PeriodOfLessThanATurn",
                   "errors:\n  joints:\n    - function: {first: 0, spacing: "
                   "100, values: [1, 2, 3], periodic: true}\n    - {}\n",
                   {9, 7, "errors.joints[1]", "is a turn"}},
        ErrorsCase{"PeriodOfAPrismaticJoint",
                   "errors:\n  joints:\n    - {}\n    - function: {first: 0, "
                   "spacing: 120, values: [1, 2, 3], periodic: true}\n",
                   {10, 7, "errors.joints[2]", "of a revolute joint"}},
        ErrorsCase{"CouplingOfAShortRow",
                   "errors:\n  coupling: [[1, 2], [1]]\n",
                   {8, 22, "errors.coupling[2]", "one entry per joint"}},
        ErrorsCase{"NoDirection",
                   "errors:\n  gravity: [0, 0, 0]\n",
                   {8, 12, "errors.gravity", "direction"}}),
    [](const auto& bad) { return std::string(bad.param.name); });

// Line 6 of the job's text is that of the measurement.
ErrorTermOptions LoadJobErrors(const std::string& errors) {
  const ConfigFiles files({"measurement: {sigma: 0.02}\n",
                           "measurement: {sigma: 0.02}\n" + errors});
  return LoadJob(files.job()).options.errors;
}

TEST(JobErrorsTest, AreNoneByDefault) {
  EXPECT_EQ(LoadJobErrors("").selection, ErrorTermSelection::kNone);
  EXPECT_EQ(LoadJobErrors("errors: none\n").selection,
            ErrorTermSelection::kNone);
}

TEST(JobErrorsTest, AreAutomaticOrStated) {
  EXPECT_EQ(LoadJobErrors("errors: auto\n").selection,
            ErrorTermSelection::kAuto);
  const ErrorTermOptions stated = LoadJobErrors(
      "errors: {elasticity: true, functions: 300, harmonics: [1, 2.5], "
      "scale: true, backlash: true, coupling: [[2, 1]]}\n");
  EXPECT_EQ(stated.selection, ErrorTermSelection::kStated);
  EXPECT_TRUE(stated.elasticity);
  EXPECT_DOUBLE_EQ(stated.function_length, 0.3);  // the job's mrad
  EXPECT_EQ(stated.harmonics, (std::vector<double>{1.0, 2.5}));
  EXPECT_TRUE(stated.scale);
  EXPECT_TRUE(stated.backlash);
  ASSERT_EQ(stated.coupling.size(), 1U);
  EXPECT_EQ(stated.coupling[0], (std::pair{1, 0}));
}

class BadJobErrorsTest : public ::testing::TestWithParam<ErrorsCase> {};

TEST_P(BadJobErrorsTest, AreRefusedWithTheirPlace) {
  ExpectInputError([&] { LoadJobErrors(GetParam().text); },
                   GetParam().expected);
}

INSTANTIATE_TEST_SUITE_P(
    Jobs, BadJobErrorsTest,
    ::testing::Values(
        ErrorsCase{"UnknownWord", "errors: all\n", {7, 9, "errors", "\"all\""}},
        ErrorsCase{"NoTerm",
                   "errors: {elasticity: false}\n",
                   {7, 9, "errors", "asks for no term"}},
        ErrorsCase{"UnknownKey",
                   "errors: {compliance: true}\n",
                   {7, 10, "errors.compliance", "unknown key \"compliance\""}},
        ErrorsCase{"NegativeLength",
                   "errors: {functions: -1}\n",
                   {7, 21, "errors.functions", "0 or more"}},
        ErrorsCase{"NoSuchJoint",
                   "errors: {coupling: [[3, 1]]}\n",
                   {7, 22, "errors.coupling[1][1]", "from 1 to 2"}},
        ErrorsCase{"JointWithItself",
                   "errors: {coupling: [[2, 2]]}\n",
                   {7, 21, "errors.coupling[1]", "`scale` is of its own"}},
        ErrorsCase{"NoCycles",
                   "errors: {harmonics: [0]}\n",
                   {7, 22, "errors.harmonics[1]", "above 0"}}),
    [](const auto& bad) { return std::string(bad.param.name); });

}  // namespace
}  // namespace alidade::internal
