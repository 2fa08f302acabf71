#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "alidade/arm_file.h"
#include "alidade/parameter_layout.h"
#include "tests/support/io_test_util.h"

namespace alidade::internal {
namespace {

TEST(LoadDeviationsTest, ReadsTheRealArmOfTheStudy) {
  const Arm arm = LoadArm(SourcePath("configs/robots/rv2aj_wrist.yaml"));
  const Eigen::VectorXd deviations =
      LoadDeviations(SourcePath("configs/robots/rv2aj_deviations.yaml"), arm);
  const ParameterLayout layout(5);
  ASSERT_EQ(deviations.size(), layout.size());
  const std::pair<const char*, double> expected[] = {
      {"beta1", 0.009}, {"beta3", -1e-4}, {"beta4", 0.004}, {"alpha1", 0.005},
      {"alpha2", 1e-4}, {"alpha3", 9e-4}, {"d2", -1e-4},    {"d3", -1e-3},
      {"d4", 1e-4},     {"r1", 1e-4},     {"r2", 1e-3},     {"r3", -1e-4},
      {"r4", 1e-4},     {"r5", 1e-4}};
  Eigen::VectorXd rest = deviations;
  for (const auto& [name, value] : expected) {
    EXPECT_EQ(deviations[layout.Find(name).value()], value) << name;
    rest[layout.Find(name).value()] = 0.0;
  }
  EXPECT_TRUE(rest.isZero(0.0));
}

void LoadDeviationsText(const std::string& entries) {
  const TestDirectory directory;
  const Arm arm = LoadArm(SourcePath("configs/robots/rv2aj_wrist.yaml"));
  LoadDeviations(directory.Write("deviations.yaml",
                                 "format: alidade-deviations-1\n"
                                 "units: {length: mm, angle: rad}\n" +
                                     entries),
                 arm);
}

TEST(LoadDeviationsTest, NamesAnUnknownParameterAndTheNearest) {
  ExpectInputError(
      [] { LoadDeviationsText("deviations: {r1: 1, beat2: 1}\n"); },
      {3, 21, "deviations.beat2",
       "unknown key \"beat2\", did you mean \"beta2\"?"});
  ExpectInputError([] { LoadDeviationsText("deviations: {beta6: 1}\n"); },
                   {3, 14, "deviations.beta6", "(37 in all)"});
}

TEST(LoadDeviationsTest, RefusesWhatIsNoNumber) {
  ExpectInputError([] { LoadDeviationsText("deviations: {r1: 1 mm}\n"); },
                   {3, 18, "deviations.r1", "state its unit in \"units\""});
  ExpectInputError([] { LoadDeviationsText("deviations:\n"); },
                   {3, 1, "deviations", "found nothing"});
}

TEST(LoadDeviationsTest, AcceptsNoDeviations) {
  LoadDeviationsText("deviations: {}\n");
}

}  // namespace
}  // namespace alidade::internal
