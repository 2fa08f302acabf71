#include "src/planning/check_poses.h"

#include <algorithm>
#include <cmath>

#include "src/identifiability/factor.h"
#include "src/planning/candidates.h"
#include "src/planning/exchange.h"
#include "src/planning/travel.h"
#include "src/uncertainty/prediction.h"

namespace alidade::internal {
namespace {

// How far an arm in use may drift: what a check is to see.
constexpr double kAngleChange = 5e-4;   // rad
constexpr double kLengthChange = 2e-4;  // m
// Nothing is known of what is refitted.
constexpr double kUnknown = 1.0;  // rad, m

// Those that the calibration moves most.
Eigen::MatrixXd MovedMost(const MeasurementModel& calibrated,
                          const MeasurementModel& uncalibrated,
                          const Eigen::MatrixXd& joint_values) {
  const Eigen::VectorXd moves =
      (calibrated.Predict(calibrated.NominalValues(), joint_values) -
       uncalibrated.Predict(uncalibrated.NominalValues(), joint_values))
          .colwise()
          .norm();
  std::vector<double> sorted(moves.begin(), moves.end());
  const auto middle = sorted.begin() + sorted.size() / 2;
  std::nth_element(sorted.begin(), middle, sorted.end());
  std::vector<int> kept;
  for (Eigen::Index k = 0; k < moves.size(); ++k) {
    if (moves[k] >= *middle) kept.push_back(static_cast<int>(k));
  }
  return joint_values(Eigen::all, kept);
}

std::vector<int> ChangingColumns(const ParameterLayout& layout,
                                 const std::vector<int>& refitted) {
  std::vector<int> columns;
  for (int column = 0; column < layout.size(); ++column) {
    if (ParameterLayout::IsJointKind(layout.parameter(column).kind)) {
      columns.push_back(column);
    }
  }
  columns.insert(columns.end(), refitted.begin(), refitted.end());
  return columns;
}

DesignProblem MakeProblem(const MeasurementModel& model,
                          const ParameterCovariance& covariance,
                          const CheckPoseOptions& options,
                          const Eigen::MatrixXd& joint_values) {
  const std::vector<int> columns =
      ChangingColumns(model.layout(), options.refitted);
  PoseMeasurement metres;
  metres.sigma = 1.0;
  DesignProblem problem;
  problem.joint_values = joint_values;
  problem.candidates =
      MakePoseRows(model, model.NominalValues(),
                   MakePlannedData(model, joint_values, metres), columns);
  const std::vector<PoseCovariance> predicted = PredictCovariances(
      model, model.NominalValues(), covariance, joint_values);
  for (int k = 0; k < problem.candidates.size(); ++k) {
    const double of_fit = predicted[k].position.trace() / 3.0;
    const double variance =
        options.noise * options.noise + (std::isfinite(of_fit) ? of_fit : 0.0);
    problem.candidates.transposed.middleCols(Eigen::Index{3} * k, 3) /=
        std::sqrt(variance);
  }
  const auto p = static_cast<Eigen::Index>(columns.size());
  problem.known = Eigen::MatrixXd::Zero(p, p);
  for (Eigen::Index i = 0; i < p; ++i) {
    const Parameter& parameter = model.layout().parameter(columns[i]);
    const double change =
        !ParameterLayout::IsJointKind(parameter.kind) ? kUnknown
        : parameter.dimension == Dimension::kAngle    ? kAngleChange
                                                      : kLengthChange;
    problem.known(i, i) =
        std::pow(change * ColumnScale(model, columns[i]), -2.0);
  }
  return problem;
}

}  // namespace

Eigen::MatrixXd ChooseCheckPoses(const MeasurementModel& calibrated,
                                 const MeasurementModel& uncalibrated,
                                 const ParameterCovariance& covariance,
                                 const CheckPoseOptions& options) {
  CandidateOptions drawn;
  drawn.count = options.num_candidates;
  drawn.seed = options.seed;
  drawn.limit_faces = false;
  drawn.joint_decimals = options.joint_decimals;
  const Eigen::MatrixXd candidates =
      MovedMost(calibrated, uncalibrated,
                DrawCandidates(calibrated.nominal(), {}, drawn).joint_values);
  DesignOptions design;
  design.num_poses = options.num_poses;
  design.allow_repeats = false;
  design.starts = 1;
  design.seed = options.seed;
  design.num_threads = options.num_threads;
  const DesignResult plan = ChoosePoses(
      MakeProblem(calibrated, covariance, options, candidates), design);
  const Eigen::MatrixXd chosen = candidates(Eigen::all, plan.chosen);
  return chosen(Eigen::all,
                ShortOrder(chosen, Eigen::VectorXd::Ones(chosen.rows())));
}

}  // namespace alidade::internal
