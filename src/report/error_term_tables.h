#ifndef ALIDADE_SRC_REPORT_ERROR_TERM_TABLES_H_
#define ALIDADE_SRC_REPORT_ERROR_TERM_TABLES_H_

#include <string>
#include <vector>

#include "alidade/calibration_result.h"
#include "src/report/table.h"

namespace alidade::internal {

/// Errors that are not rigid geometry, of an arm or of a result, as tables.
/// Angles in mrad, since they are small, compliances in mrad/(N m); empty where
/// there is nothing to show.

/// k_x k_y k_z of each joint, with standard deviations where `terms` has them.
Table ComplianceTable(const Arm& arm,
                      const std::vector<ErrorTermEstimate>& terms);
/// The function of each joint: range, size, standard deviation; within
/// `measured` or, where that is empty, wherever it has knots.
Table FunctionTable(const Arm& arm, const std::vector<MeasuredRange>& measured);
/// Harmonics, backlash, scale and coupling.
Table OtherTermTable(const Arm& arm,
                     const std::vector<ErrorTermEstimate>& terms);
/// All of these; nothing for a rigid arm.
std::string FormatArmErrors(const Arm& arm);

/// Every set of terms that was weighed, what it brought and what it cost, the
/// delivered one last.
Table RungTable(const ErrorTermsResult& errors,
                const CalibrationResult& result);
/// The prior standard deviations of each.
Table PriorTable(const ErrorTermsResult& errors);
/// How far the terms of each joint move the target, in mm.
Table EffectTable(const ErrorTermsResult& errors);

/// The delivered arm beside geometry alone, in one paragraph.
std::string DescribeErrorTerms(const CalibrationResult& result);
/// The section of report.txt; empty where none were asked for.
std::string ErrorTermsSection(const CalibrationResult& result);

/// Value of the error functions and harmonics of a joint at `joint_value`.
double JointErrorAt(const JointErrors& joint, double joint_value);
/// Whether `joint_value` was measured of that joint, from 1.
bool IsMeasured(const std::vector<MeasuredRange>& measured, int joint,
                double joint_value);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_ERROR_TERM_TABLES_H_
