#ifndef ALIDADE_SRC_REPORT_FIGURES_H_
#define ALIDADE_SRC_REPORT_FIGURES_H_

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/calibration_result.h"
#include "src/report/svg_chart.h"

namespace alidade::internal {

/// The figures of a result, which its directory has as files and its page
/// shows. They refer to what they are made of, which must stay as long as they
/// are used.

/// Of the two states that a set was evaluated in.
enum class CalibrationState { kBefore, kAfter };

/// The error of a set by observation: of positions, or of orientations where
/// nothing else was measured. `pose` is what an observation is called.
Figure ErrorFigure(const EvaluatedSet& set, CalibrationState state,
                   const std::string& pose);

/// The same of validation poses: a map where they lie in a plane that is
/// horizontal in the frame of the arm's base.
Figure ValidationFigure(const EvaluatedSet& set, CalibrationState state,
                        const Arm& arm);

/// Errors before and after against the value of joint `joint`, from 0.
Figure JointFigure(const EvaluatedSet& set, Eigen::Index joint);

/// Those of every result by the names of their files, without ".svg".
std::vector<std::pair<std::string, Figure>> ResultFigures(
    const CalibrationResult& result);

/// Largest error by iteration of each solver.
Figure ConvergenceFigure(const std::vector<SolverRun>& runs);

Figure SingularValuesFigure(const IdentifiabilityResult& result);

/// Mean error by what was calibrated: frames, geometry, every set of error
/// terms and what is delivered of them; validation poses, and regions of joint
/// space that were left out. @pre error terms were weighed.
Figure ErrorStagesFigure(const CalibrationResult& result);

/// How far the terms of each joint move the target.
Figure ErrorEffectsFigure(const ErrorTermsResult& errors);

/// The error function of joint `joint`, from 0, with its band and the residuals
/// about it. Nothing where the joint has none.
std::optional<LineChart> JointFunctionChart(const CalibrationResult& result,
                                            int joint);

/// Residuals along joint `joint` against its value, before and after. Nothing
/// where there are none.
std::optional<LineChart> JointResidualChart(const CalibrationResult& result,
                                            int joint);

/// Standardised values beside the standard normal distribution.
Figure HistogramFigure(const std::string& title, const Histogram& histogram);

/// What maps are drawn around: the arm at a pose, in the frame of its base.
struct ArmOutline {
  Eigen::Isometry3d base_from_instrument = Eigen::Isometry3d::Identity();
  Eigen::Matrix3Xd corners;  ///< from the base to the target (m); may be empty

  /// Columns of three coordinates, to the nanometre, so that a page is the same
  /// whether the base was computed or read.
  Eigen::Matrix3Xd InBase(
      const Eigen::Ref<const Eigen::MatrixXd>& positions) const {
    constexpr double kNanometres = 1e9;
    const Eigen::Matrix3Xd places =
        base_from_instrument * positions.topRows<3>();
    return (kNanometres * places).array().round() / kNanometres;
  }
};

/// At the first pose of `set`, where it has the joint values of this arm.
ArmOutline OutlineOf(const Arm& arm, const EvaluatedSet& set);
/// Of the calibrated arm at a training pose.
ArmOutline OutlineOf(const CalibrationResult& result);

/// The predicted standard deviation by distance and height, in the frame of the
/// base.
Figure PredictedMapFigure(const PredictedMap& map, const ArmOutline& arm);

/// Whether a histogram counts nothing.
bool HasNothing(const Histogram& histogram);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_FIGURES_H_
