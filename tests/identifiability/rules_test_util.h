#ifndef ALIDADE_TESTS_IDENTIFIABILITY_RULES_TEST_UTIL_H_
#define ALIDADE_TESTS_IDENTIFIABILITY_RULES_TEST_UTIL_H_

#include <gtest/gtest.h>

#include <regex>
#include <string>
#include <vector>

#include "src/identifiability/rules.h"
#include "tests/support/reference_solution.h"
#include "tests/support/study.h"

namespace alidade::internal::testing {

using Names = std::vector<std::string>;

inline const ParameterDecision& DecisionOn(const IdentifiabilityResult& result,
                                           const std::string& name) {
  for (const ParameterDecision& decision : result.decisions) {
    if (decision.name == name) return decision;
  }
  static const ParameterDecision missing;
  ADD_FAILURE() << "no decision on " << name;
  return missing;
}

inline Names FixedBy(const IdentifiabilityResult& result,
                     const std::string& rule) {
  Names names;
  for (const ParameterDecision& decision : result.decisions) {
    if (decision.state == ParameterState::kFixed && decision.rule == rule) {
      names.push_back(decision.name);
    }
  }
  return names;
}

/// Those that the rule applies to, whether or not another one came first.
inline Names WithReason(const IdentifiabilityResult& result,
                        const std::string& text) {
  Names names;
  for (const ParameterDecision& decision : result.decisions) {
    if (decision.reason.find(text) != std::string::npos) {
      names.push_back(decision.name);
    }
  }
  return names;
}

/// Joint parameters whose column of the reference is zero but for the rounding
/// of long double.
inline Names ZeroColumns(const Arm& arm, const Dataset& data) {
  const ParameterLayout layout(arm.num_joints());
  const std::vector<int> columns = JointColumns(layout);
  const MatrixXl jacobian =
      LinearizeReference(arm, MatrixValues(arm), data, columns).jacobian;
  const long double largest = jacobian.colwise().norm().maxCoeff();
  Names names;
  for (const int column : columns) {
    if (jacobian.col(column).norm() < 1e-15L * largest) {
      names.push_back(layout.parameter(column).name);
    }
  }
  return names;
}

/// The names between the brackets of "fix: [a, b]".
inline Names ProposedFix(const std::string& refusal) {
  std::smatch match;
  if (!std::regex_search(refusal, match, std::regex("fix: \\[([^\\]]*)\\]"))) {
    return {};
  }
  const std::string list = match[1];
  const std::regex name("[a-z_]+[0-9]*");
  return {std::sregex_token_iterator(list.begin(), list.end(), name),
          std::sregex_token_iterator()};
}

/// Fixing what a refusal proposes leaves as many parameters as can be told
/// apart, and no refusal.
inline void ExpectFollowingTheRefusalHelps(const MeasurementModel& model,
                                           const Dataset& data) {
  const IdentifiabilityResult refused = ApplyRules(model, data, {});
  EXPECT_EQ(refused.exceeds_rank,
            refused.perturbed_rank.rank < refused.num_free);
  EXPECT_EQ(refused.refusal.empty(), !refused.exceeds_rank);
  if (!refused.exceeds_rank) return;
  IdentifiabilityOptions options;
  options.fix = ProposedFix(refused.refusal);
  EXPECT_EQ(static_cast<int>(options.fix.size()),
            refused.num_free - refused.perturbed_rank.rank)
      << refused.refusal;
  const IdentifiabilityResult result = ApplyRules(model, data, options);
  EXPECT_FALSE(result.exceeds_rank) << result.refusal;
  EXPECT_EQ(result.num_free, refused.perturbed_rank.rank);
}

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_IDENTIFIABILITY_RULES_TEST_UTIL_H_
