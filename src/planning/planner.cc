#include <glog/logging.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <utility>

#include "alidade/error.h"
#include "alidade/plan.h"
#include "alidade/version.h"
#include "src/common/constants.h"
#include "src/common/format.h"
#include "src/common/text.h"
#include "src/identifiability/factor.h"
#include "src/planning/link_capsules.h"
#include "src/planning/plan_evaluation.h"
#include "src/planning/plan_fields.h"
#include "src/planning/plan_problem.h"
#include "src/planning/travel.h"

namespace alidade::internal {
namespace {

double SecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start)
      .count();
}

// The plan is worse than this over the region than over its candidates where
// they do not cover it.
constexpr double kUncovered = 1.25;

void Check(bool holds, const char* key, const std::string& expected) {
  if (!holds) throw InputError({"", 0, 0, key}, "expected " + expected);
}

// The fields that depend on the arm. NaN fails every comparison.
void CheckAgainstArm(const Arm& arm, const PlanOptions& options) {
  std::string error;
  if (!options.design.IsValid(&error)) throw InputError({}, error);
  const Eigen::Index n = arm.num_joints();
  const std::string each = "none or one for each of " + Count(n, "joint");
  const auto fits = [n](Eigen::Index size) { return size == 0 || size == n; };
  Check(fits(static_cast<Eigen::Index>(options.region.joint_limits.size())),
        "region.joint_limits", each);
  Check(fits(options.minimum_motion.size()), "minimum_motion", each);
  Check(fits(options.speeds.size()) && (options.speeds.array() > 0.0).all(),
        "speeds", each + ", above 0");
  if (options.given_candidates) {
    Check(options.given_candidates->rows() == n &&
              options.given_candidates->allFinite(),
          "given_candidates", "finite values of " + Count(n, "joint"));
  }
  const PoseMeasurement& measurement = options.measurement;
  Check(measurement.sigma > 0.0 && std::isfinite(measurement.sigma),
        "measurement.sigma", "a finite number above 0");
  Check(measurement.rotation_sigma > 0.0, "measurement.rotation_sigma",
        "a number above 0");
  for (const auto* targets :
       {&measurement.targets, &options.constraints.targets}) {
    for (const int target : *targets) {
      Check(target >= 0 && target < arm.num_targets(), "measurement.targets",
            "targets that the arm has");
    }
  }
  Check(!options.wanted || *options.wanted > 0.0, "wanted", "above 0");
  Check(!options.link_radius || *options.link_radius >= 0.0, "link_radius",
        "0 or more");
}

class Planner {
 public:
  explicit Planner(PlanTask task)
      : config_([&] {
          task.job = PrepareMeasured(std::move(task.job));
          task.design.num_threads = task.job.options.num_threads;
          task.design.seed = task.seed;
          return std::move(task);
        }()),
        model_(config_.job.arm, config_.job.data.references,
               config_.job.options.num_threads) {}

  PlanResult Run() {
    Describe();
    const auto begin = std::chrono::steady_clock::now();
    problem_ = MakePlanProblem(config_, model_);
    if (!IsIdentifiable()) return std::move(result_);
    DesignOptions options = config_.design;
    if (config_.wanted && !FindNumber(&options.num_poses)) {
      return std::move(result_);
    }
    if (!Choose(&options)) return std::move(result_);
    result_.plan_time_s = SecondsSince(begin);
    if (!IsPlanned(options)) return std::move(result_);
    Order();
    const PlanEvaluator evaluator(config_, model_, problem_);
    evaluator.Evaluate(design_, &result_);
    WarnIfUncovered();
    evaluator.DrawCurve(design_, &result_);
    const Arm& arm = result_.planned_arm;
    result_.links =
        FindLinkOverlaps(arm, result_.joint_values,
                         config_.link_radius.value_or(TypicalLinkRadius(arm)));
    result_.status = PlanStatus::kDone;
    result_.total_time_s = SecondsSince(start_);
    return std::move(result_);
  }

 private:
  void Describe() {
    PlanResult& plan = result_;
    plan.version = Version();
    plan.arm = config_.job.arm.name;
    plan.seed = config_.seed;
    const PoseMeasurement& measurement = config_.measurement;
    plan.criterion = WordOf(config_.design.criterion);
    plan.measured = measurement.orientation ? "pose" : "position";
    plan.sigma = measurement.sigma;
    if (measurement.orientation) {
      plan.rotation_sigma = measurement.rotation_sigma;
    }
    plan.equations = measurement.num_equations();
    plan.measured_before =
        static_cast<int>(config_.job.data.training.num_poses());
    plan.allow_repeats = config_.design.allow_repeats;
    plan.wanted = config_.wanted.value_or(0.0);
  }

  bool IsIdentifiable() {
    for (const std::string& text : problem_.identifiability.warnings) {
      Warn(text);
    }
    if (problem_.identifiability.exceeds_rank || problem_.columns.empty()) {
      result_.status = PlanStatus::kRefused;
      result_.message = problem_.identifiability.exceeds_rank
                            ? problem_.identifiability.refusal
                            : "no parameter is free";
      return false;
    }
    result_.num_candidates = problem_.design.candidates.size();
    result_.num_looked_at = problem_.num_looked_at;
    result_.has_priors = problem_.prior_stds.array().isFinite().any();
    const int wanted = config_.candidates.count;
    if (!config_.given_candidates && result_.num_candidates < wanted) {
      Warn("only " + std::to_string(result_.num_candidates) + " of " +
           std::to_string(result_.num_looked_at) +
           " draws satisfy the constraints, fewer than the " +
           std::to_string(wanted) + " candidates asked for");
    }
    return true;
  }

  bool IsPlanned(const DesignOptions& options) {
    result_.converged = design_.status == DesignStatus::kConverged;
    if (design_.status == DesignStatus::kTooFew) {
      return Fail("fewer than " + std::to_string(options.num_poses) +
                  " candidates may stand beside each other: allow repeats, "
                  "lower the minimum motion or add candidates");
    }
    if (design_.status == DesignStatus::kRankShort) {
      const std::size_t rank =
          static_cast<std::size_t>(problem_.identifiability.nominal_rank.rank);
      if (rank < problem_.columns.size()) {
        return Fail("all " + std::to_string(result_.num_candidates) +
                    " candidates together determine only " +
                    std::to_string(rank) + " of " +
                    std::to_string(problem_.columns.size()) +
                    " parameters, so that no number of poses is enough: "
                    "fix parameters, use `policy: freeze` or `policy: prior`, "
                    "measure more axes or targets, or give other candidates");
      }
      return Fail(std::to_string(options.num_poses) + " poses of " +
                  std::to_string(result_.equations) +
                  " measurements each do not determine " +
                  std::to_string(problem_.columns.size()) +
                  " parameters: plan more poses, fix parameters or use "
                  "`policy: prior`");
    }
    if (!result_.converged) {
      Warn("the exchange was stopped by max_passes before it came to an end");
    }
    return true;
  }

  bool Fail(const std::string& message) {
    result_.status = PlanStatus::kFailed;
    result_.message = message;
    return false;
  }

  void Warn(const std::string& warning) { result_.warnings.push_back(warning); }

  int threads() const { return model_.num_threads(); }

  // A plan of about as many poses as the wanted accuracy needs, and of enough
  // to determine all parameters.
  DesignResult FirstPlan(DesignOptions options) const {
    const int most = options.num_poses;
    const double equations = config_.measurement.num_equations();
    const double poses_each =
        static_cast<double>(problem_.columns.size()) / equations;
    const double ratio = config_.measurement.sigma / *config_.wanted;
    const double guess =
        std::max(std::ceil(poses_each) + 1.0, 3.0 * poses_each * ratio * ratio);
    options.num_poses =
        static_cast<int>(std::min(guess, static_cast<double>(most)));
    for (;;) {
      DesignResult plan = ChoosePoses(problem_.design, options);
      if (plan.status != DesignStatus::kRankShort ||
          options.num_poses == most) {
        return plan;
      }
      options.num_poses = std::min(2 * options.num_poses, most);
    }
  }

  // The smallest number of poses whose plan meets the wanted accuracy, at most
  // the number that is there. Plans of other sizes choose among the candidates
  // that a first one determines worst; the plan of the number found chooses
  // among all. Where no plan is found at all, the number stays.
  bool FindNumber(int* num_poses) {
    const int most = *num_poses;
    DesignOptions options = config_.design;
    const DesignResult first = FirstPlan(options);
    if (first.status == DesignStatus::kRankShort || first.chosen.empty()) {
      return true;
    }
    const DesignProblem part = WorstTold(problem_, first, threads());
    const PlanEvaluator evaluator(config_, model_, problem_);
    options.starts = 1;
    // Predicted over wanted.
    const auto ratio_of = [&](int number) {
      options.num_poses = number;
      const DesignResult plan = ChoosePoses(part, options);
      return plan.status == DesignStatus::kRankShort
                 ? kInfinity
                 : evaluator.WorstOverRegion(plan) / *config_.wanted;
    };
    int too_few = 0;
    int enough = static_cast<int>(first.chosen.size());
    double ratio = ratio_of(enough);
    while (ratio > 1.0) {
      if (enough == most) {
        return RefuseAccuracy();
      }
      too_few = enough;
      // A standard deviation falls as 1 / sqrt(n): what is far out of reach is
      // refused by the largest plan at once.
      const bool is_hopeless = enough * ratio * ratio > 4.0 * most;
      enough = is_hopeless ? most : std::min(most, enough + enough / 2 + 1);
      ratio = ratio_of(enough);
    }
    while (enough - too_few > 1) {
      const int middle = (too_few + enough) / 2;
      (ratio_of(middle) <= 1.0 ? enough : too_few) = middle;
    }
    *num_poses = enough;
    return true;
  }

  // Chooses among all candidates. A wanted accuracy that was met by a choice
  // among part of them may be missed by a little then, since neither choice is
  // made by the worst over the region: so many more poses that it is met.
  bool Choose(DesignOptions* options) {
    design_ = ChoosePoses(problem_.design, *options);
    if (!config_.wanted) return true;
    const PlanEvaluator evaluator(config_, model_, problem_);
    const int most = config_.design.num_poses;
    while (design_.status != DesignStatus::kTooFew &&
           design_.status != DesignStatus::kRankShort) {
      const double ratio = evaluator.WorstOverRegion(design_) / *config_.wanted;
      if (ratio <= 1.0) return true;
      if (options->num_poses == most) return RefuseAccuracy();
      // A standard deviation falls as 1 / sqrt(n).
      const double needed = options->num_poses * std::min(ratio * ratio, 2.0);
      options->num_poses =
          std::min(most, std::max(options->num_poses + 1,
                                  static_cast<int>(std::lround(needed))));
      design_ = ChoosePoses(problem_.design, *options);
    }
    return true;
  }

  bool RefuseAccuracy() {
    result_.status = PlanStatus::kRefused;
    result_.message = "an accuracy of " + FormatLength(*config_.wanted) +
                      " needs more than " +
                      std::to_string(config_.design.num_poses) +
                      " poses of these candidates: measure better, or allow "
                      "more (`most`)";
    return false;
  }

  void Order() {
    PlanResult& plan = result_;
    const Eigen::MatrixXd chosen =
        SelectColumns(problem_.design.joint_values, design_.chosen);
    const Eigen::Index n = chosen.rows();
    plan.travel_in_seconds = config_.speeds.size() > 0;
    const Eigen::VectorXd weights =
        plan.travel_in_seconds ? Eigen::VectorXd(config_.speeds.cwiseInverse())
                               : Eigen::VectorXd::Ones(n);
    std::vector<int> as_drawn(chosen.cols());
    std::iota(as_drawn.begin(), as_drawn.end(), 0);
    const std::vector<int> order = ShortOrder(chosen, weights);
    plan.travel_before = TravelAlong(chosen, weights, as_drawn);
    plan.travel = TravelAlong(chosen, weights, order);
    plan.joint_values = SelectColumns(chosen, order);
    plan.joint_dimensions = model_.nominal().JointDimensions();
    const Eigen::VectorXd variances = PredictedVariances(
        problem_.candidate_positions, design_.information, threads());
    plan.pose_std.resize(chosen.cols());
    for (Eigen::Index k = 0; k < chosen.cols(); ++k) {
      plan.pose_std[k] = std::sqrt(variances[design_.chosen[order[k]]]);
    }
    std::vector<int> distinct = design_.chosen;
    plan.num_distinct = static_cast<int>(
        std::unique(distinct.begin(), distinct.end()) - distinct.begin());
    MakeSheet();
  }

  void MakeSheet() {
    result_.planned_arm = model_.nominal();
    result_.joint_decimals = config_.given_candidates
                                 ? kFewestDigits
                                 : config_.candidates.joint_decimals;
    result_.sheet =
        MakePlannedData(model_, result_.joint_values, config_.measurement);
    ObservationBlock& block = result_.sheet.blocks.front();
    block.measured = Eigen::MatrixXd::Zero(block.rows_each(), block.size());
    block.sigmas =
        Eigen::MatrixXd::Constant(block.rows_each(), block.size(), kInfinity);
  }

  void WarnIfUncovered() {
    const PlanEvaluation& planned = result_.evaluations.front();
    const double ratio = planned.region.worst / planned.candidates.worst;
    if (ratio > kUncovered) {
      Warn("the worst prediction over the region is " +
           FormatSignificant(ratio, 3) +
           " times that over the candidates: they do not cover it");
    }
  }

  const std::chrono::steady_clock::time_point start_ =
      std::chrono::steady_clock::now();
  const PlanTask config_;
  const MeasurementModel model_;
  PlanProblem problem_;
  DesignResult design_;
  PlanResult result_;
};

}  // namespace
}  // namespace alidade::internal

namespace alidade {

PlanResult PlanPoses(const Arm& arm, const CalibrationData& measured,
                     const CalibrationOptions& calibration,
                     const PlanOptions& options) {
  internal::CheckAgainstArm(arm, options);
  return internal::Planner({options, {arm, measured, calibration}}).Run();
}

}  // namespace alidade
