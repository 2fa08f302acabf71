#include "src/calibration/job.h"

#include <glog/logging.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/error.h"
#include "alidade/version.h"
#include "src/calibration/evaluate.h"
#include "src/calibration/fit_report.h"
#include "src/calibration/fit_uncertainty.h"
#include "src/calibration/frame_fit.h"
#include "src/calibration/identifiability_cache.h"
#include "src/calibration/input_doubt.h"
#include "src/calibration/preparation.h"
#include "src/calibration/same_data.h"
#include "src/calibration/study.h"
#include "src/common/files.h"
#include "src/common/format.h"
#include "src/identifiability/analysis.h"
#include "src/identifiability/rules.h"
#include "src/kernel/partition.h"
#include "src/solve/solver.h"

namespace alidade::internal {
namespace {

double SecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start)
      .count();
}

SolverRun Solve(SolverName name, const CalibrationProblem& problem,
                LossKind loss, const SolverOptions& options) {
  SolverRun run;
  run.values = problem.model.NominalValues();
  run.summary = name == SolverName::kCeres
                    ? SolveRobust(problem, loss, options, &run.values)
                    : SolvePseudoInverse(problem, options, &run.values);
  run.train = EvaluateAccuracy(problem.model, problem.data, run.values);
  return run;
}

// Residuals of so many sigmas in the root mean square are no chance: with ten
// degrees of freedom the odds are below 1e-6.
constexpr double kLargeResiduals = 2.5;

// A limit on what was not measured is not met.
double OrInfinity(const Accuracy& accuracy, double value) {
  return accuracy.n > 0 ? value : std::numeric_limits<double>::infinity();
}

// Of the poses held out of the fit, or of each fold.
struct HeldOutErrors {
  Accuracy lengths;
  Accuracy rotations;
};

HeldOutErrors HeldOutErrorsOf(const CalibrationResult& result) {
  if (result.heldout) {
    return {result.heldout->after, result.heldout->rotation_after};
  }
  if (result.cross_validation) {
    return {result.cross_validation->position,
            result.cross_validation->rotation};
  }
  return {};
}

std::vector<AcceptanceCheck> CheckAcceptance(const AcceptanceLimits& limits,
                                             const CalibrationResult& result) {
  std::vector<AcceptanceCheck> checks;
  const auto add = [&](const std::string& quantity,
                       const std::optional<double>& limit, double obtained,
                       Dimension dimension) {
    if (limit) checks.push_back({quantity, *limit, obtained, dimension});
  };
  const auto add_lengths = [&](const std::string& set, const Accuracy& accuracy,
                               const std::optional<double>& rms,
                               const std::optional<double>& max) {
    add(set + "_rms", rms, OrInfinity(accuracy, accuracy.rms),
        Dimension::kLength);
    add(set + "_max", max, OrInfinity(accuracy, accuracy.max),
        Dimension::kLength);
  };
  const auto add_rotations =
      [&](const std::string& set, const Accuracy& accuracy,
          const std::optional<double>& rms, const std::optional<double>& max) {
        add(set + "_rotation_rms", rms, OrInfinity(accuracy, accuracy.rms),
            Dimension::kAngle);
        add(set + "_rotation_max", max, OrInfinity(accuracy, accuracy.max),
            Dimension::kAngle);
      };
  add_lengths("train", result.train.after, limits.train_rms, limits.train_max);
  add_rotations("train", result.train.rotation_after, limits.train_rotation_rms,
                limits.train_rotation_max);
  const HeldOutErrors heldout = HeldOutErrorsOf(result);
  add_lengths("heldout", heldout.lengths, limits.heldout_rms,
              limits.heldout_max);
  add_rotations("heldout", heldout.rotations, limits.heldout_rotation_rms,
                limits.heldout_rotation_max);
  return checks;
}

// Data that fit nowhere, and would if one slip were mended, are an error of the
// input, before anything is fitted. Returns what speaks against others.
std::string RefuseSlips(const JobConfig& config, Communicator* communicator) {
  InputDoubt doubt = DoubtInput(config.arm, config.data, communicator);
  if (!doubt.is_explained) return doubt.text;
  SourceLocation location;
  location.file = config.data.name;
  throw InputError(location, doubt.text);
}

// "heldout_max 0.071 mm, at most 0.01 mm", and so on.
std::string Missed(const CalibrationResult& result) {
  std::string text;
  for (const AcceptanceCheck& check : result.acceptance) {
    if (check.met()) continue;
    const bool length = check.dimension == Dimension::kLength;
    const double unit = length ? kMillimetre : kDegree;
    const std::string name = std::string(" ") + UnitForPeople(check.dimension);
    text += (text.empty() ? "" : "; ") + check.quantity + " " +
            FormatSignificant(check.obtained / unit, 3) + name + ", at most " +
            FormatSignificant(check.limit / unit, 3) + name;
  }
  return text;
}

// Balls in sockets and contacts with planes whose places are all unknown: an
// arm twice as large would touch points twice as far.
bool LeavesSizeOpen(const JobConfig& config) {
  for (std::size_t k = 0; k < config.data.blocks.size(); ++k) {
    if (config.data.global_observations(k) == 0) continue;
    const MeasurementKind kind = config.data.blocks[k].kind;
    if (kind != MeasurementKind::kFixedPoint &&
        kind != MeasurementKind::kPlane) {
      return false;
    }
  }
  const auto is_known = [](const auto& reference) {
    return reference.is_known;
  };
  const References& references = config.references;
  return std::count_if(references.points.begin(), references.points.end(),
                       is_known) +
             std::count_if(references.planes.begin(), references.planes.end(),
                           is_known) <
         2;
}

// Every file by a rank that has read it.
std::vector<InputFile> HashInputs(const JobConfig& config,
                                  Communicator* communicator) {
  Communicator* const holders = HoldersOf(communicator, config.data);
  std::vector<InputFile> files;
  std::vector<std::string> mine;
  for (std::size_t k = 0; k < config.input_files.size(); ++k) {
    const bool is_mine =
        (config.readers.empty() ? 0 : config.readers[k]) == holders->rank();
    files.push_back({config.input_files[k], ""});
    if (is_mine) files.back().sha256 = Sha256OfFile(files.back().path);
    mine.push_back(files.back().sha256);
  }
  ByteWriter writer;
  writer.PutTexts(mine);
  for (const std::string& bytes : holders->Gather(writer.Take())) {
    const std::vector<std::string> hashes = ByteReader(bytes).GetTexts();
    for (std::size_t k = 0; k < files.size(); ++k) {
      if (!hashes[k].empty()) files[k].sha256 = hashes[k];
    }
  }
  return files;
}

class JobRunner {
 public:
  /// `doubt`: what was said against the input; empty: nothing.
  JobRunner(JobConfig config, const Execution& execution,
            IdentifiabilityCache* cache, std::string doubt)
      : config_(std::move(config)),
        cache_(cache),
        input_doubt_(std::move(doubt)),
        frames_fitted_(FitFrames(&config_, execution)),
        sigmas_(config_.estimate_sigma ? EstimateSigmas(&config_, execution)
                                       : EstimatedSigmas()),
        model_(config_.arm, config_.references, execution) {
    outcome_.calibrated = config_.arm;
  }

  /// `as_read`: the job before frames were fitted, for what repeats all of it;
  /// may be null where there are no folds.
  JobOutcome Run(const std::string& command, const JobConfig* as_read) {
    DescribeInputs(command);
    DescribeData();
    if (!input_doubt_.empty()) Warn(input_doubt_);
    if (config_.estimate_sigma && !(sigmas_.length > 0.0)) {
      outcome_.status = JobStatus::kRefused;
      outcome_.message =
          "sigma cannot be estimated: these poses leave no degree of freedom, "
          "or the data are exact, or no fit succeeded. State `measurement: "
          "{sigma: ...}`";
      return std::move(outcome_);
    }
    if (frames_fitted_) {
      result().before_note =
          std::string("before: base and tool") +
          (config_.references.num_points() + config_.references.num_planes() > 0
               ? ", points and planes"
               : "") +
          " fitted to the training poses, the geometry of the joints nominal";
    }
    RefuseOrientations();
    if (Identify() && SolveAll()) Evaluate(as_read);
    outcome_.result.total_time_s = SecondsSince(start_);
    return std::move(outcome_);
  }

 private:
  CalibrationResult& result() { return outcome_.result; }

  void DescribeInputs(const std::string& command) {
    result().version = Version();
    result().command = command;
    result().title = config_.title;
    result().arm = config_.arm.name;
    result().seed = config_.identifiability.seed;
    result().inputs = HashInputs(config_, model_.communicator());
  }

  void DescribeData() {
    result().sigma = MedianLengthSigma(config_.data, model_.communicator());
    result().estimated_sigma = sigmas_.length;
    result().estimated_rotation_sigma = sigmas_.rotation;
    result().repeats = MeasureRepeats(config_.data, model_.communicator());
    result().rejected = config_.rejected;
    const auto add = [&](const std::string& block, const std::string& name) {
      if (!name.empty()) result().aliases.emplace_back(block, name);
    };
    int number = 0;
    for (const Target& target : config_.arm.targets) {
      ++number;
      add(number == 1 ? "tool" : "tool" + std::to_string(number), target.name);
    }
    number = 0;
    for (const ReferencePoint& point : config_.references.points) {
      add("point" + std::to_string(++number), point.name);
    }
    number = 0;
    for (const ReferencePlane& plane : config_.references.planes) {
      add("plane" + std::to_string(++number), plane.name);
    }
  }

  bool Identify() {
    const auto begin = std::chrono::steady_clock::now();
    result().identifiability =
        cache_ == nullptr
            ? AnalyzeIdentifiability(model_, config_.data,
                                     config_.identifiability)
            : cache_->Analyze(model_, config_.data, config_.identifiability);
    result().identify_time_s = SecondsSince(begin);
    for (const std::string& warning : result().identifiability.warnings) {
      LOG(WARNING) << "warning: " << warning;
    }
    if (result().identifiability.exceeds_rank &&
        !config_.identifiability.proceed_beyond_rank) {
      outcome_.status = JobStatus::kRefused;
      outcome_.message = result().identifiability.refusal;
      return false;
    }
    return true;
  }

  bool SolveAll() {
    SolverOptions options = config_.solver_options;
    options.num_threads = model_.num_threads();
    problem_.emplace(ProblemOf(config_, model_, result().identifiability));
    result().runs.push_back(
        Solve(config_.solver, *problem_, config_.loss, options));
    const SolverSummary& summary = result().runs.front().summary;
    if (!summary.IsSolutionUsable()) {
      outcome_.status = JobStatus::kFailed;
      outcome_.message = "the solver " + summary.solver + " " +
                         ToString(summary.status) + ": " + summary.message;
      return false;
    }
    for (const SolverName other : config_.compare_with) {
      if (other == config_.solver) continue;
      result().runs.push_back(
          Solve(other, *problem_, LossKind::kNone, options));
    }
    return true;
  }

  void Evaluate(const JobConfig* as_read) {
    const Eigen::VectorXd nominal = model_.NominalValues();
    const Eigen::VectorXd& values = result().runs.front().values;
    outcome_.calibrated = model_.layout().WithValues(config_.arm, values);
    ListParameters(nominal, values);
    ListReferences(model_.ReferencesAt(values));
    result().train = EvaluateSet(model_, config_.data, nominal, values);
    if (config_.validation) {
      result().heldout =
          EvaluateSet(model_, *config_.validation, nominal, values);
    }
    // Without orientations in the fit nothing tells the target's own.
    if (result().heldout && !config_.data.Has(MeasurementKind::kPose)) {
      result().heldout->rotation_before = {};
      result().heldout->rotation_after = {};
    }
    if (config_.published) {
      result().study = CompareWithStudy({config_, *problem_, result()});
    }
    const FinishedFit fit{config_, *problem_, values};
    if (frames_fitted_) {
      result().stages = ListStages(fit, result().identifiability.num_free);
    }
    if (config_.folds) {
      result().cross_validation = CrossValidate(*as_read, model_.execution());
      if (!result().cross_validation) {
        Warn(
            "cross-validation found no usable fit of one of its folds, or one "
            "that leaves no pose to a point, plane or target: other folds "
            "leave "
            "more");
      }
    }
    result().outliers = ListOutliers(fit, &result().outlier_limit);
    DoubtResult(fit);
    Assess(fit);
    result().acceptance = CheckAcceptance(config_.acceptance, result());
    outcome_.status = JobStatus::kDone;
    if (IsStoppedAndWorse()) {
      outcome_.status = JobStatus::kFailed;
      outcome_.message =
          "the solver was stopped by the number of iterations, and the poses "
          "held out are further off than before: the data do not tell this "
          "many parameters apart, or do not fit this arm. Identify fewer, "
          "measure more poses, or look for what is wrong with the data";
      return;
    }
    if (!result().accepted()) {
      outcome_.status = JobStatus::kMissedLimits;
      outcome_.message = "acceptance limits missed: " + Missed(result());
    }
  }

  // No minimum was reached, and where it stopped is no better elsewhere.
  bool IsStoppedAndWorse() {
    // Every pose is held out of one fold: before, folds are the training poses.
    const Accuracy& before =
        result().heldout ? result().heldout->before : result().train.before;
    return result().runs.front().summary.status ==
               SolverStatus::kIterationLimit &&
           HeldOutErrorsOf(result()).lengths.rms > before.rms;
  }

  void Warn(const std::string& warning) {
    result().warnings.push_back(warning);
    LOG(WARNING) << "warning: " << warning;
  }

  // A solver's minimum may be a bad one: of wrong data, of a wrong arm, or not
  // reached at all.
  void DoubtResult(const FinishedFit& fit) {
    const SolverSummary& summary = result().runs.front().summary;
    const std::string zeros = DoubtZeros(config_.data, model_.communicator());
    if (!zeros.empty()) Warn(zeros);
    if (summary.status == SolverStatus::kIterationLimit) {
      Warn("the solver " + summary.solver +
           " was stopped by the number of iterations and may be far from the "
           "minimum");
    }
    for (const std::string& doubt : DoubtSameData(config_)) Warn(doubt);
    const double freedom = DegreesOfFreedom(*problem_, fit.values);
    if (freedom >= 1.0) {
      const SharedVector squared =
          SquaredNorms(model_.Errors(fit.values, config_.data), config_.data);
      result().reduced_chi_square =
          SumInOrder(model_.communicator(), config_.data, squared) / freedom;
    }
    // Where the loss expects outliers, they are not held against the fit.
    const double ratio =
        config_.loss == LossKind::kNone
            ? std::sqrt(result().reduced_chi_square)
            : TypicalResidual(model_, config_.data, fit.values);
    if (ratio > kLargeResiduals) {
      Warn("the residuals are " + FormatSignificant(ratio, 3) +
           " times as large as the sigmas say: look for wrong units, columns, "
           "rotation convention, outliers, sigmas or a wrong arm");
    }
    DoubtFrames();
    DoubtWorst();
    if (sigmas_.is_bound) {
      Warn(
          "too few measurements to tell sigma from the residuals: it is taken "
          "as what the nominal geometry leaves, so that parameters stay near "
          "nominal. Measure more poses or state sigma");
    }
    if (freedom < 1.0) {
      Warn(
          "these poses leave no degree of freedom: small residuals say nothing "
          "of the arm's accuracy. Measure more poses");
    }
    if (result().train.after.rms > result().train.before.rms) {
      Warn(
          "the calibration made the error at the training poses larger: do not "
          "use it, and look for what is wrong with the data or the arm");
    }
    if (LeavesSizeOpen(config_)) {
      Warn(
          "these contacts leave the size of the arm open, which the priors "
          "alone tell: state a known distance between two points (`references: "
          "{distances: ...}`), or measure one");
    }
    if (const std::string names = FarFromPriors(fit); !names.empty()) {
      Warn(
          "further from nominal than the priors allow, in standard "
          "deviations: " +
          names +
          "; correct the nominal arm, widen the priors or use another policy");
    }
    if (const std::string names = AtBounds(fit); !names.empty()) {
      Warn("at a bound: " + names +
           "; the data ask for values beyond, which the bounds do not allow");
    }
  }

  void Assess(const FinishedFit& fit) {
    result().uncertainty = AssessFit(fit, result().identifiability,
                                     result().runs.front().summary.final_cost);
    for (const ParameterUncertainty& one : result().uncertainty->parameters) {
      result().parameters[*model_.layout().Find(one.name)].std = one.std;
    }
    for (const std::string& warning : result().uncertainty->warnings) {
      Warn(warning);
    }
  }

  // Orientations that fit nowhere, whatever base and target, are misread.
  void RefuseOrientations() {
    constexpr double kTolerated = 0.3;  // rad
    if (!frames_fitted_ || !config_.data.Has(MeasurementKind::kPose)) return;
    const Accuracy before =
        EvaluateRotations(model_, config_.data, model_.NominalValues());
    if (before.median < kTolerated) return;
    SourceLocation location;
    location.file = config_.data.name;
    throw InputError(
        location,
        "the measured orientations do not fit this arm, whatever its base and "
        "target: half of them are more than " +
            FormatSignificant(before.median / kDegree, 3) +
            " deg off. Look at the convention of the angles (`rotation`), "
            "their unit, and the order of a quaternion's components");
  }

  // An outlier far beyond all others spoils the fit of them all.
  void DoubtWorst() {
    constexpr double kFarBeyond = 3.0;
    if (result().outliers.empty()) return;
    const Outlier& worst = result().outliers.front();
    if (worst.standardised < kFarBeyond * result().outlier_limit) return;
    Warn((worst.label.where.empty() ? "" : worst.label.where + ": ") +
         "the measurement that fits worst is " + FormatLength(worst.error, 3) +
         " off, " + FormatSignificant(worst.standardised, 2) +
         " standard deviations (" + std::to_string(result().outliers.size()) +
         " are beyond chance): look at it, leave it out, or choose a `loss`");
  }

  // At the nominal geometry an arm is millimetres off, not a tenth of its size.
  void DoubtFrames() {
    if (!input_doubt_.empty()) return;  // which says more
    constexpr double kLargePart = 0.05;
    Arm at_origin = config_.arm;
    at_origin.instrument_from_base.setIdentity();
    const Accuracy& before = result().train.before;
    if (before.n == 0 || before.median < kLargePart * Reach(at_origin)) return;
    Warn(frames_fitted_
             ? "base, tool or references were not found: at the nominal "
               "geometry half of the measurements are more than " +
                   FormatLength(before.median, 3) +
                   " off. State a guess of base and tool in the arm file"
             : "half of the measurements are more than " +
                   FormatLength(before.median, 3) +
                   " off before calibration. If base or tool are not known, "
                   "identify them too (`parameters: [joints, base, tool]`)");
  }

  void ListReferences(const References& references) {
    int number = 0;
    for (const ReferencePoint& point : references.points) {
      ReferenceResult reference;
      reference.block = "point" + std::to_string(++number);
      reference.name = point.name;
      reference.is_known = point.is_known;
      reference.vector = point.position;
      result().references.push_back(reference);
    }
    number = 0;
    for (const ReferencePlane& plane : references.planes) {
      ReferenceResult reference;
      reference.block = "plane" + std::to_string(++number);
      reference.name = plane.name;
      reference.is_known = plane.is_known;
      reference.vector = plane.normal;
      reference.offset = plane.offset;
      result().references.push_back(reference);
    }
  }

  void ListParameters(const Eigen::VectorXd& nominal,
                      const Eigen::VectorXd& values) {
    const ParameterLayout& layout = model_.layout();
    for (const ParameterBlock& block : layout.blocks()) {
      for (int i = 0; i < block.size; ++i) {
        const int column = block.first_column + i;
        ParameterResult parameter;
        parameter.name = layout.parameter(column).name;
        parameter.kind = block.name;
        parameter.dimension = layout.parameter(column).dimension;
        parameter.nominal = nominal[column];
        parameter.value = values[column];
        const ParameterKind kind = layout.parameter(column).kind;
        if (config_.truth && !ParameterLayout::IsReferenceKind(kind)) {
          parameter.truth = (*config_.truth)[column];
        }
        parameter.decision = result().identifiability.decisions[column];
        result().parameters.push_back(std::move(parameter));
      }
    }
  }

  const std::chrono::steady_clock::time_point start_ =
      std::chrono::steady_clock::now();
  JobConfig config_;
  IdentifiabilityCache* const cache_;
  const std::string input_doubt_;
  const bool frames_fitted_;
  const EstimatedSigmas sigmas_;
  MeasurementModel model_;
  std::optional<CalibrationProblem> problem_;
  JobOutcome outcome_;
};

}  // namespace

JobOutcome RunJob(JobConfig config, const std::string& command,
                  const Execution& execution, IdentifiabilityCache* cache) {
  std::string doubt = RefuseSlips(config, execution.communicator);
  std::optional<JobConfig> as_read;
  if (config.folds) as_read = config;
  return JobRunner(std::move(config), execution, cache, std::move(doubt))
      .Run(command, as_read ? &*as_read : nullptr);
}

IdentifiabilityResult IdentifyJob(const JobConfig& config, int num_threads) {
  RefuseSlips(config, SingleProcess());
  JobConfig prepared = config;
  FitFrames(&prepared, num_threads);
  const MeasurementModel model(prepared.arm, prepared.references, num_threads);
  return AnalyzeIdentifiability(model, prepared.data, prepared.identifiability);
}

}  // namespace alidade::internal
