#ifndef ALIDADE_SRC_CALIBRATION_ERROR_TERM_REPORT_H_
#define ALIDADE_SRC_CALIBRATION_ERROR_TERM_REPORT_H_

#include <Eigen/Core>
#include <vector>

#include "alidade/calibration_result.h"
#include "src/calibration/fit_report.h"

namespace alidade::internal {

/// Fills in what follows `rungs` in the error terms of `result`, whose arm has
/// them. `rigid` and `fit` are solutions of one task, without and with them.
void DescribeErrorTerms(const CalibrationSolution& rigid,
                        const CalibrationSolution& fit,
                        CalibrationResult* result);

/// The coefficients of `arm` that were estimated, functions apart.
std::vector<ErrorTermEstimate> ListErrorTerms(const TermCovariance& covariance,
                                              const Arm& arm);

/// What the terms of `arm` do at `joint_values` (n x poses): of each joint each
/// kind that it has, then "all" of the joint; joint 0 first.
std::vector<ErrorTermEffect> MeasureEffects(const Arm& arm,
                                            const Eigen::MatrixXd& joint_values,
                                            int num_threads);

/// Values of each joint, cut where a twentieth of its range and 0.1 rad (20 mm)
/// were left out.
std::vector<MeasuredRange> MeasuredRanges(const Arm& arm,
                                          const Eigen::MatrixXd& joint_values);

/// Of the training data, by least squares of the whitened residuals of each
/// pose along one joint. Empty where differences of poses were measured.
JointResiduals ProjectResiduals(const CalibrationSolution& rigid,
                                const CalibrationSolution& fit);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_ERROR_TERM_REPORT_H_
