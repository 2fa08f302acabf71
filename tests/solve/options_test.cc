#include <gtest/gtest.h>

#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "alidade/solver.h"
#include "src/common/constants.h"

namespace alidade::internal {
namespace {

void ExpectNamed(const SolverOptions& options, const std::string& field,
                 const std::string& value) {
  std::string error;
  EXPECT_FALSE(options.IsValid(&error)) << field << " = " << value;
  EXPECT_EQ(error.find(field + " = " + value + ", must be "), 0U) << error;
}

struct RealFieldCase {
  std::string name;
  double SolverOptions::*field;
  std::vector<double> valid;
  std::vector<double> invalid;
};

std::string NameOfReal(const ::testing::TestParamInfo<RealFieldCase>& info) {
  return info.param.name;
}

class SolverOptionsRealFieldTest
    : public ::testing::TestWithParam<RealFieldCase> {};

TEST_P(SolverOptionsRealFieldTest, AcceptsItsRange) {
  for (const double value : GetParam().valid) {
    SolverOptions options;
    options.*GetParam().field = value;
    std::string error;
    EXPECT_TRUE(options.IsValid(&error)) << value << ": " << error;
    EXPECT_EQ(error, "");
  }
}

TEST_P(SolverOptionsRealFieldTest, NamesFieldAndConstraint) {
  for (const double value : GetParam().invalid) {
    SolverOptions options;
    options.*GetParam().field = value;
    std::ostringstream text;
    text << value;
    ExpectNamed(options, GetParam().name, text.str());
  }
}

INSTANTIATE_TEST_SUITE_P(
    Fields, SolverOptionsRealFieldTest,
    ::testing::Values(RealFieldCase{"function_tolerance",
                                    &SolverOptions::function_tolerance,
                                    {0.0, 1e-15, 1.0},
                                    {-1e-15, kInfinity, -kInfinity, kNan}},
                      RealFieldCase{"precision_limit_factor",
                                    &SolverOptions::precision_limit_factor,
                                    {0.0, 4.0, 1e6},
                                    {-1.0, kInfinity, -kInfinity, kNan}},
                      RealFieldCase{"wanted_precision",
                                    &SolverOptions::wanted_precision,
                                    {0.0, 1e-9, 1.0},
                                    {-1e-9, kInfinity, -kInfinity, kNan}},
                      RealFieldCase{"initial_trust_region_radius",
                                    &SolverOptions::initial_trust_region_radius,
                                    {0.0, 1e-3, 1e16},
                                    {-1.0, kInfinity, -kInfinity, kNan}},
                      RealFieldCase{"pseudo_inverse_tolerance",
                                    &SolverOptions::pseudo_inverse_tolerance,
                                    {0.0, 1e-9, 0.999},
                                    {-1e-9, 1.0, kInfinity, -kInfinity, kNan}}),
    NameOfReal);

struct IntFieldCase {
  std::string name;
  int SolverOptions::*field;
};

std::string NameOfInt(const ::testing::TestParamInfo<IntFieldCase>& info) {
  return info.param.name;
}

class SolverOptionsIntFieldTest
    : public ::testing::TestWithParam<IntFieldCase> {};

TEST_P(SolverOptionsIntFieldTest, IsOneOrMore) {
  for (const int value : {1, 2, 1000}) {
    SolverOptions options;
    options.*GetParam().field = value;
    std::string error;
    EXPECT_TRUE(options.IsValid(&error)) << value << ": " << error;
  }
  for (const int value : {0, -1, std::numeric_limits<int>::min()}) {
    SolverOptions options;
    options.*GetParam().field = value;
    ExpectNamed(options, GetParam().name, std::to_string(value));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Fields, SolverOptionsIntFieldTest,
    ::testing::Values(IntFieldCase{"max_iterations",
                                   &SolverOptions::max_iterations},
                      IntFieldCase{"num_threads", &SolverOptions::num_threads}),
    NameOfInt);

TEST(SolverOptionsTest, DefaultsAreValid) {
  std::string error;
  EXPECT_TRUE(SolverOptions().IsValid(&error)) << error;
}

TEST(SolverOptionsTest, MessageHoldsValueAndConstraint) {
  SolverOptions options;
  options.pseudo_inverse_tolerance = 1.5;
  std::string error;
  EXPECT_FALSE(options.IsValid(&error));
  EXPECT_EQ(error,
            "pseudo_inverse_tolerance = 1.5, must be at least 0 and below 1");
}

}  // namespace
}  // namespace alidade::internal
