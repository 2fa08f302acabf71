#include "src/planning/plan_problem.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "alidade/error.h"
#include "src/calibration/frame_fit.h"
#include "src/calibration/preparation.h"
#include "src/calibration/sigma_estimation.h"
#include "src/common/constants.h"
#include "src/common/format.h"
#include "src/data/merge.h"
#include "src/identifiability/analysis.h"
#include "src/identifiability/factor.h"
#include "src/identifiability/rules.h"
#include "src/kernel/reduction.h"
#include "src/planning/candidates.h"

namespace alidade::internal {
namespace {

constexpr int kRegionPoses = 10000;
constexpr int kCoarseRegionPoses = 2000;
constexpr int kRandomPoses = 5000;

// Candidates, region and random poses are drawn from seeds of their own.
constexpr std::uint64_t kRegionSeed = 0x9e3779b97f4a7c15;
constexpr std::uint64_t kRandomSeed = 0xd1b54a32d192ed03;

// Otherwise only ten million draws without a hit would show it.
void RefuseOutOfReach(const Arm& arm, const std::vector<WorkspaceBox>& boxes,
                      const std::string& key) {
  if (!AreOutOfReach(arm, boxes)) return;
  throw InputError({"", 0, 0, key},
                   "all boxes are farther from the base than the arm can "
                   "reach, which is at most " +
                       FormatLength(ArmReach(arm), 3) +
                       ": state them in the base's frame, and look at units "
                       "and signs");
}

Eigen::MatrixXd FindCandidates(const PlanTask& config, const Arm& arm,
                               std::int64_t* looked_at) {
  Eigen::MatrixXd found;
  if (config.given_candidates) {
    *looked_at = config.given_candidates->cols();
    found = SelectColumns(
        *config.given_candidates,
        AllowedPoses(arm, config.constraints, *config.given_candidates));
  } else {
    CandidateOptions options = config.candidates;
    options.seed = config.seed;
    Candidates candidates = DrawCandidates(arm, config.constraints, options);
    *looked_at = candidates.draws;
    found = std::move(candidates.joint_values);
  }
  if (found.cols() == 0) {
    throw InputError({"", 0, 0, "candidates"},
                     "none of " + std::to_string(*looked_at) +
                         " poses satisfies boxes, floor, walls and "
                         "visibility: loosen some of them");
  }
  return found;
}

Arm RegionArm(const PlanTask& config, Arm arm) {
  for (std::size_t j = 0; j < config.region.joint_limits.size(); ++j) {
    arm.joints[j].lower = config.region.joint_limits[j].first;
    arm.joints[j].upper = config.region.joint_limits[j].second;
    // A joint that is held has limits, too: equal ones would be none.
    if (arm.joints[j].upper == arm.joints[j].lower) {
      arm.joints[j].upper = std::nextafter(arm.joints[j].upper, kInfinity);
    }
  }
  return arm;
}

Eigen::MatrixXd DrawRegion(const PlanTask& config, const Arm& arm) {
  PoseConstraints constraints;
  constraints.boxes = config.region.boxes;
  CandidateOptions options = config.candidates;
  options.seed = config.seed ^ kRegionSeed;
  options.count = kRegionPoses;
  options.limit_faces = true;
  Candidates drawn =
      DrawCandidates(RegionArm(config, arm), constraints, options);
  if (drawn.joint_values.cols() == 0) {
    throw InputError({"", 0, 0, "region"},
                     "no pose within these joint limits has its target in one "
                     "of the boxes: enlarge them");
  }
  return std::move(drawn.joint_values);
}

// Positions of the first target in m.
PoseMeasurement PositionInMetres() {
  PoseMeasurement measurement;
  measurement.sigma = 1.0;
  return measurement;
}

PoseRows FirstPoses(const PoseRows& rows, int count) {
  PoseRows first;
  first.rows_each = rows.rows_each;
  first.transposed = rows.transposed.leftCols(Eigen::Index{rows.rows_each} *
                                              std::min(count, rows.size()));
  return first;
}

class ProblemMaker {
 public:
  ProblemMaker(const PlanTask& config, const MeasurementModel& model)
      : config_(config), model_(model), values_(model.NominalValues()) {}

  PlanProblem Make() {
    if (!config_.given_candidates) {
      RefuseOutOfReach(model_.nominal(), config_.constraints.boxes,
                       "candidates");
    }
    RefuseOutOfReach(RegionArm(config_, model_.nominal()), config_.region.boxes,
                     "region");
    DesignProblem& design = problem_.design;
    design.joint_values =
        FindCandidates(config_, model_.nominal(), &problem_.num_looked_at);
    const Dataset planned =
        MakePlannedData(model_, design.joint_values, config_.measurement);
    const Dataset& measured = config_.job.data.training;
    problem_.identifiability = AnalyzeIdentifiability(
        model_,
        measured.num_poses() > 0 ? MergeDatasets({planned, measured}) : planned,
        config_.job.options.identifiability);
    if (problem_.identifiability.exceeds_rank) return std::move(problem_);
    problem_.columns = FreeColumns(problem_.identifiability);
    problem_.terms = PlannedTerms::Of(model_, config_.job.options.errors,
                                      design.joint_values);
    design.candidates = RowsOf(planned);
    design.minimum_motion = config_.minimum_motion;
    SetKnown();
    SetPositions();
    return std::move(problem_);
  }

 private:
  PoseRows RowsOf(const Eigen::MatrixXd& joint_values,
                  const PoseMeasurement& measurement) const {
    return RowsOf(MakePlannedData(model_, joint_values, measurement));
  }

  PoseRows RowsOf(const Dataset& planned) const {
    PoseRows rows = MakePoseRows(model_, values_, planned, problem_.columns);
    if (problem_.terms) problem_.terms->Append(model_, values_, planned, &rows);
    return rows;
  }

  // M0: priors, and the poses that were measured already.
  void SetKnown() {
    const auto p = static_cast<Eigen::Index>(problem_.columns.size());
    const Eigen::VectorXd priors = PriorsOf(problem_.identifiability);
    problem_.prior_stds.setConstant(p, kInfinity);
    problem_.scales.resize(p);
    for (Eigen::Index i = 0; i < p; ++i) {
      const int column = problem_.columns[i];
      problem_.scales[i] = ColumnScale(model_, column);
      if (priors.size() > 0) problem_.prior_stds[i] = priors[column];
    }
    Eigen::MatrixXd& known = problem_.design.known;
    known = problem_.prior_stds.cwiseProduct(problem_.scales)
                .array()
                .square()
                .inverse()
                .matrix()
                .asDiagonal();
    AddTerms(&known);
    if (config_.job.data.training.num_poses() == 0) return;
    const Eigen::MatrixXd factor =
        ScaleColumns(model_, problem_.columns,
                     JacobianFactor(model_, values_, config_.job.data.training,
                                    problem_.columns));
    known.topLeftCorner(p, p) += factor.transpose() * factor;
  }

  // Earlier poses count for the parameters alone.
  void AddTerms(Eigen::MatrixXd* known) {
    if (!problem_.terms) return;
    const Eigen::Index p = known->rows();
    const Eigen::Index size = problem_.terms->size();
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(p + size, p + size);
    all.topLeftCorner(p, p) = *known;
    all.bottomRightCorner(size, size) = problem_.terms->known();
    *known = std::move(all);
    problem_.scales.conservativeResize(p + size);
    problem_.scales.tail(size).setConstant(PlannedTerms::kPrior);
  }

  void SetPositions() {
    const PoseMeasurement metres = PositionInMetres();
    const Arm& arm = model_.nominal();
    problem_.candidate_positions = RowsOf(problem_.design.joint_values, metres);
    problem_.region = RowsOf(DrawRegion(config_, arm), metres);
    problem_.coarse_region = FirstPoses(problem_.region, kCoarseRegionPoses);
    if (NeedsRegion(config_.design.criterion)) {
      problem_.design.region =
          FirstPoses(problem_.region, config_.region.count);
    }
    if (config_.given_candidates) {
      problem_.random = problem_.design.candidates;
      return;
    }
    CandidateOptions options = config_.candidates;
    options.seed = config_.seed ^ kRandomSeed;
    options.count = kRandomPoses;
    options.limit_faces = false;
    problem_.random =
        RowsOf(DrawCandidates(arm, config_.constraints, options).joint_values,
               config_.measurement);
  }

  const PlanTask& config_;
  const MeasurementModel& model_;
  const Eigen::VectorXd values_;
  PlanProblem problem_;
};

}  // namespace

CalibrationTask PrepareMeasured(CalibrationTask task) {
  if (task.data.training.num_poses() == 0) return task;
  CheckAndHoldOut(&task);
  FitFrames(&task);
  if (task.options.estimate_sigma) EstimateSigmas(&task);
  return task;
}

PlanProblem MakePlanProblem(const PlanTask& config,
                            const MeasurementModel& model) {
  return ProblemMaker(config, model).Make();
}

}  // namespace alidade::internal
