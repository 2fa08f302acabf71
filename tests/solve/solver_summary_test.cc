#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <map>
#include <set>
#include <string>

#include "alidade/solver.h"
#include "src/solve/solver_fields.h"

namespace alidade::internal {
namespace {

constexpr std::array<SolverStatus, 6> kAllStatuses = {
    SolverStatus::kNotRun,         SolverStatus::kConverged,
    SolverStatus::kPrecisionLimit, SolverStatus::kIterationLimit,
    SolverStatus::kFailed,         SolverStatus::kUnusable};

// Every number differs from every other, so that a mixed-up line shows.
SolverSummary MakeSummary() {
  SolverSummary summary;
  summary.solver = "ceres";
  summary.status = SolverStatus::kPrecisionLimit;
  summary.message = "The next step is below rounding.";
  summary.num_poses = 56;
  summary.num_residuals = 168;
  summary.num_parameters = 37;
  summary.num_free = 17;
  summary.initial_cost = 1234.5;
  summary.final_cost = 6.25e-20;
  summary.accepted_steps = 7;
  summary.rejected_steps = 2;
  summary.threads_given = 8;
  summary.threads_used = 3;
  summary.precision_limit = 1.5e-16;
  summary.setup_time_s = 0.125;
  summary.solve_time_s = 0.75;
  return summary;
}

// The line of `report` that begins with `title`.
std::string Line(const std::string& report, const std::string& title) {
  const std::size_t begin = report.find(title);
  if (begin == std::string::npos) return "no line '" + title + "'";
  return report.substr(begin, report.find('\n', begin) - begin);
}

void ExpectLine(const SolverSummary& summary, const std::string& title,
                const std::string& end) {
  const std::string line = Line(summary.FullReport(), title);
  ASSERT_GE(line.size(), end.size()) << line;
  EXPECT_EQ(line.substr(line.size() - end.size()), end) << line;
}

TEST(SolverStatusTest, EveryStatusHasANameOfItsOwn) {
  std::set<std::string> names;
  for (const SolverStatus status : kAllStatuses) {
    names.insert(ToString(status));
  }
  EXPECT_EQ(names.size(), kAllStatuses.size());
  EXPECT_EQ(names.count("unknown"), 0U);
}

TEST(SolverSummaryTest, BeginsAsNotRun) {
  const SolverSummary summary;
  EXPECT_EQ(summary.status, SolverStatus::kNotRun);
  EXPECT_EQ(summary.initial_cost, -1.0);
  EXPECT_EQ(summary.final_cost, -1.0);
  EXPECT_EQ(summary.first_step_rank, -1);
  EXPECT_TRUE(summary.iterations.empty());
  EXPECT_FALSE(summary.IsSolutionUsable());
}

TEST(SolverSummaryTest, UsableByStatus) {
  SolverSummary summary = MakeSummary();
  for (const SolverStatus status : kAllStatuses) {
    summary.status = status;
    const bool usable = status == SolverStatus::kConverged ||
                        status == SolverStatus::kPrecisionLimit ||
                        status == SolverStatus::kIterationLimit;
    EXPECT_EQ(summary.IsSolutionUsable(), usable) << ToString(status);
  }
}

TEST(SolverSummaryTest, AtTheIterationLimitTheCostDecides) {
  SolverSummary summary = MakeSummary();
  summary.status = SolverStatus::kIterationLimit;
  summary.final_cost = summary.initial_cost;
  EXPECT_TRUE(summary.IsSolutionUsable());
  for (const double cost : {summary.initial_cost * (1.0 + 1e-15),
                            std::numeric_limits<double>::infinity(),
                            -std::numeric_limits<double>::infinity(),
                            std::numeric_limits<double>::quiet_NaN()}) {
    summary.final_cost = cost;
    EXPECT_FALSE(summary.IsSolutionUsable()) << cost;
  }
}

TEST(SolverSummaryTest, BriefReportIsOneLineWithTheOutcome) {
  const std::string report = MakeSummary().BriefReport();
  EXPECT_EQ(report.find('\n'), std::string::npos);
  for (const char* part : {"ceres", "stopped at the numerical precision limit",
                           "7", "1234.5", "6.25e-20"}) {
    EXPECT_NE(report.find(part), std::string::npos) << part << "\n" << report;
  }
}

TEST(SolverSummaryTest, FullReportHasALineForEverything) {
  const SolverSummary summary = MakeSummary();
  ExpectLine(summary, "Solver", "  ceres");
  ExpectLine(summary, "Status", "  stopped at the numerical precision limit");
  ExpectLine(summary, "Message", "  The next step is below rounding.");
  ExpectLine(summary, "Poses, residuals", "  56, 168");
  ExpectLine(summary, "Parameters, free", "  37, 17");
  ExpectLine(summary, "Chi-square", "  1234.5 -> 6.25e-20");
  ExpectLine(summary, "Steps accepted, rejected", "  7, 2");
  ExpectLine(summary, "Threads given, used", "  8, 3");
  ExpectLine(summary, "Numerical precision limit", "  1.5e-16 m");
  ExpectLine(summary, "Time to set up, solve", "  0.125 s, 0.75 s");
}

TEST(SolverSummaryTest, TrustRegionIsShownAsGivenAndUsed) {
  SolverSummary summary = MakeSummary();
  EXPECT_EQ(summary.FullReport().find("Trust region"), std::string::npos);
  summary.trust_region_used = 1e10;
  ExpectLine(summary, "Trust region given, used", "  automatic, 1e+10");
  summary.trust_region_given = 5000.0;
  ExpectLine(summary, "Trust region given, used", "  5000, 1e+10");
}

TEST(SolverSummaryTest, PseudoInverseToleranceIsShownAsGivenAndUsed) {
  SolverSummary summary = MakeSummary();
  EXPECT_EQ(summary.FullReport().find("Pseudo-inverse"), std::string::npos);
  summary.pseudo_inverse_tolerance_used = 1e-9;
  ExpectLine(summary, "Pseudo-inverse tolerance",
             "  automatic, 1e-09 (given, used)");
  summary.pseudo_inverse_tolerance_given = 2e-7;
  ExpectLine(summary, "Pseudo-inverse tolerance",
             "  2e-07, 1e-09 (given, used)");
}

// What files state beside the members.
struct ComputedFields {
  static constexpr bool kReads = false;
  template <typename Member>
  void Field(const char*, const Member&) {}
  template <typename Member>
  void Later(const char*, const Member&) {}
  void Computed(const std::string& key, double value) { values[key] = value; }

  std::map<std::string, double> values;
};

TEST(SolverSummaryFieldsTest, HaveTheLastIterationAndTheWholeTime) {
  SolverSummary summary = MakeSummary();
  ComputedFields none;
  VisitFields(none, summary);
  EXPECT_EQ(none.values["iterations"], 0.0);
  EXPECT_EQ(none.values["time_s"], 0.875);
  summary.iterations.resize(3);
  summary.iterations[2].iteration = 2;
  ComputedFields some;
  VisitFields(some, summary);
  EXPECT_EQ(some.values["iterations"], 2.0);
}

}  // namespace
}  // namespace alidade::internal
