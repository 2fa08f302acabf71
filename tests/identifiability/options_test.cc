#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "alidade/identifiability.h"
#include "src/common/constants.h"

namespace alidade::internal {
namespace {

struct FieldCase {
  std::string name;
  double IdentifiabilityOptions::*field;
  std::vector<double> valid;
  std::vector<double> invalid;
};

std::string NameOf(const ::testing::TestParamInfo<FieldCase>& info) {
  return info.param.name;
}

class IdentifiabilityOptionsFieldTest
    : public ::testing::TestWithParam<FieldCase> {};

TEST_P(IdentifiabilityOptionsFieldTest, AcceptsItsRange) {
  for (const double value : GetParam().valid) {
    IdentifiabilityOptions options;
    options.*GetParam().field = value;
    std::string error;
    EXPECT_TRUE(options.IsValid(&error)) << value << ": " << error;
    EXPECT_EQ(error, "");
  }
}

TEST_P(IdentifiabilityOptionsFieldTest, NamesFieldValueAndConstraint) {
  for (const double value : GetParam().invalid) {
    IdentifiabilityOptions options;
    options.*GetParam().field = value;
    std::string error;
    EXPECT_FALSE(options.IsValid(&error)) << value;
    EXPECT_EQ(error.find(GetParam().name + " = "), 0U) << error;
    EXPECT_NE(error.find(", must be above 0 and below "), std::string::npos)
        << error;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Fields, IdentifiabilityOptionsFieldTest,
    ::testing::Values(FieldCase{"angle_tolerance",
                                &IdentifiabilityOptions::angle_tolerance,
                                {1e-300, 1e-6, 0.0999},
                                {0.0, -1e-6, 0.1, kInfinity, -kInfinity, kNan}},
                      FieldCase{"relative_tolerance",
                                &IdentifiabilityOptions::relative_tolerance,
                                {1e-300, 1e-6, 0.999},
                                {0.0, -1e-6, 1.0, kInfinity, -kInfinity, kNan}},
                      FieldCase{
                          "perturbation",
                          &IdentifiabilityOptions::perturbation,
                          {1e-300, 1e-2, 0.499},
                          {0.0, -1e-6, 0.5, kInfinity, -kInfinity, kNan}}),
    NameOf);

TEST(IdentifiabilityOptionsTest, DefaultsAreValid) {
  std::string error;
  EXPECT_TRUE(IdentifiabilityOptions().IsValid(&error)) << error;
}

TEST(IdentifiabilityOptionsTest, MessageHoldsTheValue) {
  IdentifiabilityOptions options;
  options.perturbation = 0.75;
  std::string error;
  EXPECT_FALSE(options.IsValid(&error));
  EXPECT_EQ(error, "perturbation = 0.75, must be above 0 and below 0.5");
}

}  // namespace
}  // namespace alidade::internal
