// Validation data with points that the fit knows nothing of.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "alidade/error.h"
#include "tests/calibration/kinds_util.h"

namespace alidade::internal::own_references_test {
namespace {

// Positions for the fit; draw wires to an anchor of its own for the check.
JobConfig WireCheck(int num_wires) {
  const Arm real = RealArm();
  JobConfig job =
      WholeJobOf(Bench(real, DrawJointValues(real, 60, 5)).Positions(0).data());
  job.data.references.points = {{"anchor"}};
  job.data.validation = Bench(real, DrawJointValues(real, num_wires, 6))
                            .Distances(0, Eigen::Vector3d(3.0, -2.0, 0.4))
                            .data();
  return job;
}

TEST(OwnReferencesTest, AreFoundFromTheValidationDataAlone) {
  const CalibrationResult result = RunJob(WireCheck(40), "test");
  ASSERT_TRUE(result.IsUsable()) << result.message;
  ASSERT_EQ(result.references.size(), 1u);
  const Eigen::Vector3d anchor(3.0, -2.0, 0.4);
  EXPECT_LT((result.references[0].vector - anchor).norm(), 1e-3);
  // Forty wires of one sigma, three of them taken up; twice that on both sides.
  const double rms = result.validation->after.rms;
  EXPECT_GT(rms, 0.5 * kSigma);
  EXPECT_LT(rms, 2.0 * kSigma);
  EXPECT_GT(result.validation->before.rms, 5.0 * rms);
  bool is_said = false;
  for (const std::string& warning : result.warnings) {
    is_said = is_said || warning.find("anchor of the validation data alone") !=
                             std::string::npos;
  }
  EXPECT_TRUE(is_said);
  // They have no part in the fit.
  JobConfig alone = WireCheck(40);
  alone.data.validation.reset();
  alone.data.references = {};
  const CalibrationResult without = RunJob(alone, "test");
  for (const ParameterResult& parameter : without.parameters) {
    EXPECT_NEAR(result.Parameter(parameter.name).value, parameter.value, 1e-9)
        << parameter.name;
  }
}

TEST(OwnReferencesTest, TooFewMeasurementsAreRefused) {
  EXPECT_THROW(RunJob(WireCheck(2), "test"), InputError);
  // Three wires meet in a point whatever the arm does: no error is left.
  try {
    RunJob(WireCheck(3), "test");
    ADD_FAILURE() << "three wires to an anchor of their own are no check";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("any arm would fit"),
              std::string::npos)
        << error.what();
  }
  EXPECT_TRUE(RunJob(WireCheck(8), "test").IsUsable());
}

}  // namespace
}  // namespace alidade::internal::own_references_test
