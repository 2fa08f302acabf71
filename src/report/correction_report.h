#ifndef ALIDADE_SRC_REPORT_CORRECTION_REPORT_H_
#define ALIDADE_SRC_REPORT_CORRECTION_REPORT_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "alidade/correction.h"
#include "src/report/svg_chart.h"

namespace alidade::internal {

/// A correction, and what is known of its targets. Must not outlive them.
struct CorrectionReport {
  const Correction& correction;
  std::string arm_name;
  /// Predicted standard deviation of each target's position (m); may be empty.
  Eigen::VectorXd position_std = {};
  /// Joints of each target that are outside what was measured, "q2 q5"; empty
  /// where that is not known.
  std::vector<std::string> outside = {};
  /// What each target is called: "line 12".
  std::vector<std::string> names = {};
};

/// How large the corrections are, how accurate the targets will be, and which
/// of them could not be corrected or lie outside what was measured.
std::string FormatCorrection(const CorrectionReport& report);

/// Shift of each target, and its predicted standard deviation.
Figure CorrectionFigure(const CorrectionReport& report);

/// One word for a target: "reached", "joint limit" ..., or "out of reach
/// (controller)" where the arm that it is stated for does not reach it either.
std::string StatusOf(const Correction& correction, Eigen::Index i);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_CORRECTION_REPORT_H_
