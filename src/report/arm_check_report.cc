#include "src/report/arm_check_report.h"

#include <cmath>

#include "src/common/format.h"
#include "src/common/number_text.h"
#include "src/common/text.h"
#include "src/report/table.h"

namespace alidade::internal {
namespace {

std::string Probability(double p) {
  return p > 0.9995 ? "above 0.999" : FormatSignificant(p, 3);
}

// "-" where no change is found.
std::string Change(double value, Dimension dimension) {
  return std::isfinite(value) ? InUnit(value, dimension, 3) : "-";
}

// What a check of these poses is able to find.
std::string FormatPower(const Arm& arm, const ArmCheckResult& check) {
  std::string text = Paragraph(
      "An arm without this calibration is off by " +
      FormatLength(check.uncalibrated_rms, 3) +
      " RMS at these poses, and is found with a probability " +
      (check.uncalibrated_found > 0.9995 ? "" : "of ") +
      Probability(check.uncalibrated_found) + ". With a probability of " +
      FormatPercent(check.power, 3) +
      " a change is found that moves every pose by " +
      FormatLength(check.found_move, 3) +
      ", each in a direction of its own, or one of a single joint's zero:");
  Table table({"joint", ">found from", "unit"});
  for (int j = 0; j < arm.num_joints(); ++j) {
    const Dimension dimension = arm.joints[j].type == JointType::kRevolute
                                    ? Dimension::kAngle
                                    : Dimension::kLength;
    table.AddRow({std::to_string(j + 1), Change(check.found_zero[j], dimension),
                  dimension == Dimension::kAngle ? "deg" : "mm"});
  }
  return text + "\n" + table.ToText();
}

}  // namespace

std::string FormatArmCheck(const Arm& arm, const ArmCheckResult& check) {
  const std::string limit =
      "T = " + FormatSignificant(check.statistic, 4) + ", limit " +
      FormatSignificant(check.limit, 4) + " of " +
      ShortestNumber(
          NumberOrNan(FormatSignificant(check.degrees_of_freedom, 6))) +
      " degrees of freedom (p = " + FormatSignificant(check.p_value, 2) + ")";
  return Paragraph(std::string(check.passes ? "PASSED: " : "FAILED: ") +
                   arm.name + (check.passes ? " is" : " is not") +
                   " as it was calibrated. The error at " +
                   Count(check.num_observations, "pose") + " is " +
                   FormatLength(check.rms_error, 3) + " RMS, " +
                   FormatLength(check.max_error, 3) +
                   " at most; predicted are " +
                   FormatLength(check.predicted_rms, 3) + " RMS. " + limit +
                   ". An arm that is as calibrated fails in " +
                   FormatPercent(check.significance, 3) + " of checks.") +
         (check.hint.empty() ? "" : "\n" + Paragraph(check.hint)) + "\n" +
         FormatPower(arm, check);
}

std::string FormatCheckPlan(const Arm& arm, const ArmCheckResult& planned,
                            const std::vector<ArmCheckResult>& by_number) {
  std::string text = Paragraph(
      Count(planned.num_observations, "pose") + " to check whether " +
      arm.name + " is as calibrated. Errors of " +
      FormatLength(planned.predicted_rms, 3) +
      " RMS are predicted there; an arm that is as calibrated fails in " +
      FormatPercent(planned.significance, 3) + " of checks.");
  text += "\n" + FormatPower(arm, planned) + "\n";
  Table table({">poses", ">arm without calibration found", ">move found [mm]"});
  for (const ArmCheckResult& one : by_number) {
    const bool is_empty = one.degrees_of_freedom < 1.0;
    table.AddRow({CountCell(one.num_observations),
                  is_empty ? "-" : Probability(one.uncalibrated_found),
                  is_empty ? "-" : Change(one.found_move, Dimension::kLength)});
  }
  return text + table.ToText();
}

}  // namespace alidade::internal
