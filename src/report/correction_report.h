#ifndef ALIDADE_SRC_REPORT_CORRECTION_REPORT_H_
#define ALIDADE_SRC_REPORT_CORRECTION_REPORT_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "alidade/accuracy.h"
#include "alidade/correction.h"
#include "src/report/svg_chart.h"

namespace alidade::internal {

/// A correction, and what is known of its targets. Must not outlive them.
struct CorrectionReport {
  const Correction& correction;
  std::string arm_name;
  /// The arm that the controller is taken to compute with.
  std::string nominal_name = {};
  /// Predicted standard deviation of each target's position (m); may be empty.
  Eigen::VectorXd position_std = {};
  /// Joints of each target that are outside what was measured, "q2 q5"; empty
  /// where that is not known.
  std::vector<std::string> outside = {};
  /// The same with their values: "q5 = 88.1, measured -145.2 to 5.0 deg".
  std::vector<std::string> outside_values = {};
  /// What each target is called: "line 12".
  std::vector<std::string> names = {};
  /// Of the calibration: errors at its validation poses, and those of the
  /// nominal arm at the training poses; n = 0 where it has none.
  Accuracy validation = {};
  Accuracy before = {};
  bool is_result = false;  ///< of a calibration, not of arm files
  /// Of a program: motions that it goes on without a correction.
  std::string uncorrected = {};
};

/// How large the corrections are, how accurate the targets will be, and which
/// of them could not be corrected or lie outside what was measured.
std::string FormatCorrection(const CorrectionReport& report);

/// A warning where corrections are far larger than the errors that the
/// calibration found: the nominal arm is not the one that was calibrated, or
/// units are wrong. Else empty.
std::string LargeCorrectionWarning(const CorrectionReport& report);

/// Shift of each target, and its predicted standard deviation.
Figure CorrectionFigure(const CorrectionReport& report);

/// One word for a target: "reached", "joint limit" ..., or "out of reach
/// (controller)" where the arm that it is stated for does not reach it either.
std::string StatusOf(const Correction& correction, Eigen::Index i);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_CORRECTION_REPORT_H_
