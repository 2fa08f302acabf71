#include "src/planning/plan.h"

#include <glog/logging.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "alidade/version.h"
#include "src/common/files.h"
#include "src/common/format.h"
#include "src/common/text.h"
#include "src/identifiability/factor.h"
#include "src/planning/plan_evaluation.h"
#include "src/planning/plan_problem.h"
#include "src/planning/travel.h"

namespace alidade::internal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double SecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start)
      .count();
}

// The plan is worse than this over the region than over its candidates where
// they do not cover it.
constexpr double kUncovered = 1.25;

class Planner {
 public:
  Planner(const PlanConfig& config, int num_threads)
      : config_([&] {
          PlanConfig prepared = config;
          prepared.job = PrepareMeasured(config, num_threads);
          prepared.design.num_threads = num_threads;
          prepared.design.seed = config.seed;
          return prepared;
        }()),
        model_(config_.job.arm, config_.job.data.references, num_threads) {}

  PlanOutcome Run(const std::string& command) {
    Describe(command);
    const auto begin = std::chrono::steady_clock::now();
    problem_ = MakePlanProblem(config_, model_);
    if (!IsIdentifiable()) return std::move(outcome_);
    DesignOptions options = config_.design;
    if (config_.wanted && !FindNumber(&options.num_poses)) {
      return std::move(outcome_);
    }
    if (!Choose(&options)) return std::move(outcome_);
    result().plan_time_s = SecondsSince(begin);
    if (!IsPlanned(options)) return std::move(outcome_);
    Order();
    const PlanEvaluator evaluator(config_, model_, problem_);
    evaluator.Evaluate(design_, &result());
    WarnIfUncovered();
    evaluator.DrawCurve(design_, &result());
    outcome_.status = PlanStatus::kDone;
    result().total_time_s = SecondsSince(start_);
    return std::move(outcome_);
  }

 private:
  PlanResult& result() { return outcome_.result; }

  void Describe(const std::string& command) {
    PlanResult& plan = result();
    plan.version = Version();
    plan.command = command;
    plan.title = config_.title;
    plan.arm = config_.job.arm.name;
    plan.seed = config_.seed;
    for (const std::string& path : config_.input_files) {
      plan.inputs.push_back({path, Sha256OfFile(path)});
    }
    const PoseMeasurement& measurement = config_.measurement;
    plan.criterion = NameOf(config_.design.criterion);
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
      outcome_.status = PlanStatus::kRefused;
      outcome_.message = problem_.identifiability.exceeds_rank
                             ? problem_.identifiability.refusal
                             : "no parameter is free";
      return false;
    }
    result().num_candidates = problem_.design.candidates.size();
    result().num_looked_at = problem_.num_looked_at;
    result().has_priors = problem_.prior_stds.array().isFinite().any();
    const int wanted = config_.candidates.count;
    if (!config_.given_candidates && result().num_candidates < wanted) {
      Warn("only " + std::to_string(result().num_candidates) + " of " +
           std::to_string(result().num_looked_at) +
           " draws satisfy the constraints, fewer than the " +
           std::to_string(wanted) + " candidates asked for");
    }
    return true;
  }

  bool IsPlanned(const DesignOptions& options) {
    result().converged = design_.status == DesignStatus::kConverged;
    if (design_.status == DesignStatus::kTooFew) {
      return Fail("fewer than " + std::to_string(options.num_poses) +
                  " candidates may stand beside each other: allow repeats, "
                  "lower the minimum motion or add candidates");
    }
    if (design_.status == DesignStatus::kRankShort) {
      const std::size_t told =
          static_cast<std::size_t>(problem_.identifiability.nominal_rank.rank);
      if (told < problem_.columns.size()) {
        return Fail("all " + std::to_string(result().num_candidates) +
                    " candidates together tell only " + std::to_string(told) +
                    " of " + std::to_string(problem_.columns.size()) +
                    " parameters apart, so that no number of poses is enough: "
                    "fix parameters, use `policy: freeze` or `policy: prior`, "
                    "measure more axes or targets, or give other candidates");
      }
      return Fail(std::to_string(options.num_poses) + " poses of " +
                  std::to_string(result().equations) +
                  " measurements each do not tell " +
                  std::to_string(problem_.columns.size()) +
                  " parameters apart: plan more poses, fix parameters or use "
                  "`policy: prior`");
    }
    if (!result().converged) {
      Warn("the exchange was stopped by max_passes before it came to an end");
    }
    return true;
  }

  bool Fail(const std::string& message) {
    outcome_.status = PlanStatus::kFailed;
    outcome_.message = message;
    return false;
  }

  void Warn(const std::string& warning) {
    result().warnings.push_back(warning);
    LOG(WARNING) << "warning: " << warning;
  }

  int threads() const { return model_.num_threads(); }

  // A plan of about as many poses as the wanted accuracy needs, and of enough
  // to tell all parameters.
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
  // that a first one tells worst; the plan of the number found chooses among
  // all. Where no plan is found at all, the number stays.
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
    const auto is_met = [&](int number) {
      options.num_poses = number;
      const DesignResult plan = ChoosePoses(part, options);
      return plan.status != DesignStatus::kRankShort &&
             evaluator.WorstOverRegion(plan) <= *config_.wanted;
    };
    int too_few = 0;
    int enough = static_cast<int>(first.chosen.size());
    while (!is_met(enough)) {
      if (enough == most) {
        return RefuseAccuracy();
      }
      too_few = enough;
      enough = std::min(most, enough + enough / 2 + 1);
    }
    while (enough - too_few > 1) {
      const int middle = (too_few + enough) / 2;
      (is_met(middle) ? enough : too_few) = middle;
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
    outcome_.status = PlanStatus::kRefused;
    outcome_.message = "an accuracy of " + FormatLength(*config_.wanted) +
                       " needs more than " +
                       std::to_string(config_.design.num_poses) +
                       " poses of these candidates: measure better, or allow "
                       "more (`most`)";
    return false;
  }

  void Order() {
    PlanResult& plan = result();
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
    for (const Joint& joint : model_.nominal().joints) {
      plan.joint_dimensions.push_back(joint.type == JointType::kRevolute
                                          ? Dimension::kAngle
                                          : Dimension::kLength);
    }
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
    outcome_.arm = model_.nominal();
    outcome_.joint_decimals = config_.given_candidates
                                  ? kFewestDigits
                                  : config_.candidates.joint_decimals;
    outcome_.sheet =
        MakePlannedData(model_, result().joint_values, config_.measurement);
    ObservationBlock& block = outcome_.sheet.blocks.front();
    block.measured = Eigen::MatrixXd::Zero(block.rows_each(), block.size());
    block.sigmas =
        Eigen::MatrixXd::Constant(block.rows_each(), block.size(), kInfinity);
  }

  void WarnIfUncovered() {
    const PlanEvaluation& planned = result().evaluations.front();
    const double ratio = planned.region.worst / planned.candidates.worst;
    if (ratio > kUncovered) {
      Warn("the worst prediction over the region is " +
           FormatSignificant(ratio, 3) +
           " times that over the candidates: they do not cover it");
    }
  }

  const std::chrono::steady_clock::time_point start_ =
      std::chrono::steady_clock::now();
  const PlanConfig config_;
  const MeasurementModel model_;
  PlanProblem problem_;
  DesignResult design_;
  PlanOutcome outcome_;
};

}  // namespace

PlanOutcome RunPlan(const PlanConfig& config, const std::string& command,
                    int num_threads) {
  return Planner(config, num_threads).Run(command);
}

}  // namespace alidade::internal
