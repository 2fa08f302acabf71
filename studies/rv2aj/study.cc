#include "studies/rv2aj/study.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "alidade/calibration.h"
#include "alidade/forward_kinematics.h"
#include "alidade/parameter_layout.h"
#include "studies/rv2aj/format.h"

namespace alidade::rv2aj {
namespace {

// Amounts below this (m or rad) are not worth a word: a tenth of the last of
// six decimals of a millimetre.
constexpr double kNegligibleAmount = 1e-10;

double RoundTo(double value, double unit, int decimals) {
  const double scale = std::pow(10.0, decimals) / unit;
  return std::round(value * scale) / scale;
}

// Three digits, thousands apart: "204 000".
std::string FormatRatio(double ratio) {
  if (ratio < 1000.0) return Significant(ratio, 3);
  const double unit = std::pow(10.0, std::floor(std::log10(ratio)) - 2.0);
  std::string digits =
      std::to_string(std::llround(ratio / unit) * std::llround(unit));
  for (int i = static_cast<int>(digits.size()) - 3; i > 0; i -= 3) {
    digits.insert(static_cast<std::size_t>(i), " ");
  }
  return digits;
}

class Study {
 public:
  Study(const Job& job, const CalibrationResult& result)
      : job_(job),
        published_(*job.published),
        result_(result),
        layout_(job.arm),
        nominal_(layout_.Values(job.arm)),
        truth_(*job.options.true_values),
        values_(result.runs.front().values) {}

  StudyResult Compare() {
    study_.source = published_.source;
    study_.angle_decimals = published_.angle_decimals;
    study_.length_decimals = published_.length_decimals;
    study_.published_s = published_.baseline_time_s;
    TimeBaseline();
    ListParameters();
    FindAbsorptions();
    study_.full_precision = result_.validation->after;
    study_.as_printed = EvaluateRounded(published_.length_decimals);
    study_.three_more_decimals =
        EvaluateRounded(published_.length_decimals + 3);
    const auto quantities = Quantities();
    for (const PublishedFigure& figure : published_.figures) {
      const auto& [quantity, obtained] = quantities.at(figure.quantity);
      study_.rows.push_back(
          {figure.quantity, quantity, figure.published, obtained});
    }
    return study_;
  }

 private:
  bool IsFree(int column) const {
    return result_.parameters[column].decision.state == ParameterState::kFree;
  }

  // The study's fixed number of iterations, past the numerical precision limit
  // and all.
  void TimeBaseline() {
    CalibrationOptions options = job_.options;
    options.solver = SolverName::kPseudoInverse;
    options.compare_with.clear();
    options.acceptance = {};
    options.uncertainty.intervals = IntervalMethod::kLinear;
    options.uncertainty.map_configurations = 0;
    options.solver_options.max_iterations = published_.baseline_iterations;
    options.solver_options.function_tolerance = 0.0;
    options.solver_options.precision_limit_factor = 0.0;
    options.solver_options.wanted_precision = 0.0;
    std::array<double, 3> seconds{};
    for (double& time : seconds) {
      baseline_ =
          Calibrate(job_.arm, job_.data.training, options).runs.at(0).summary;
      time = baseline_.solve_time_s;
    }
    std::sort(seconds.begin(), seconds.end());
    study_.timed_iterations = published_.baseline_iterations;
    study_.timed_s = seconds[1];
  }

  void ListParameters() {
    for (int c = 0; c < layout_.size(); ++c) {
      const Parameter& parameter = layout_.parameter(c);
      if (!ParameterLayout::IsJointKind(parameter.kind)) continue;
      study_.parameters.push_back(
          {parameter.name, parameter.dimension, IsFree(c), nominal_[c],
           truth_[c] - nominal_[c], published_.deviations[c],
           values_[c] - nominal_[c]});
    }
  }

  // d(free) = -J_free^+ J_fixed d(fixed): the least-squares answer of the
  // free parameters to a fixed one that is off, at the identified geometry.
  void FindAbsorptions() {
    std::vector<int> free;
    std::vector<int> fixed;
    for (int c = 0; c < layout_.size(); ++c) {
      if (IsFree(c)) {
        free.push_back(c);
      } else if (truth_[c] != nominal_[c]) {
        fixed.push_back(c);
      }
    }
    if (fixed.empty()) return;
    const Eigen::MatrixXd answers =
        Jacobian(free).colPivHouseholderQr().solve(Jacobian(fixed));
    for (std::size_t k = 0; k < free.size(); ++k) {
      AddAbsorptions(free[k], fixed, answers.row(static_cast<Eigen::Index>(k)));
    }
  }

  // Of the positions: central differences of fourth order.
  Eigen::MatrixXd Jacobian(const std::vector<int>& columns) const {
    constexpr double kStep = 1e-3;
    const Eigen::MatrixXd joints = job_.data.training.joint_values.map();
    Eigen::MatrixXd jacobian(3 * joints.cols(), columns.size());
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const auto at = [&](double step) -> Eigen::VectorXd {
        Eigen::VectorXd values = values_;
        values[columns[k]] += step;
        return TargetPositions(layout_.WithValues(job_.arm, values), joints)
            .reshaped();
      };
      jacobian.col(static_cast<Eigen::Index>(k)) =
          (8.0 * (at(kStep) - at(-kStep)) - at(2.0 * kStep) +
           at(-2.0 * kStep)) /
          (12.0 * kStep);
    }
    return jacobian;
  }

  // What several fixed parameters add and take away again is left out.
  void AddAbsorptions(int free, const std::vector<int>& fixed,
                      const Eigen::RowVectorXd& coefficients) {
    const Parameter& by = layout_.parameter(free);
    std::vector<Absorption> absorptions;
    double total = 0.0;
    for (std::size_t i = 0; i < fixed.size(); ++i) {
      const Parameter& one = layout_.parameter(fixed[i]);
      const double deviation = truth_[fixed[i]] - nominal_[fixed[i]];
      const double coefficient = coefficients[static_cast<Eigen::Index>(i)];
      const double amount = coefficient * deviation;
      total += amount;
      if (std::abs(amount) < kNegligibleAmount) continue;
      absorptions.push_back({one.name, one.dimension, deviation, by.name,
                             by.dimension, coefficient, amount});
    }
    if (std::abs(total) < 100.0 * kNegligibleAmount) return;
    study_.absorptions.insert(study_.absorptions.end(), absorptions.begin(),
                              absorptions.end());
  }

  // The study prints deviations; angles in rad, lengths in mm.
  Accuracy EvaluateRounded(int length_decimals) const {
    const Dataset& poses = *job_.data.validation;
    Eigen::VectorXd values = nominal_;
    for (int c = 0; c < layout_.size(); ++c) {
      const double deviation = values_[c] - nominal_[c];
      const bool angle = layout_.parameter(c).dimension == Dimension::kAngle;
      values[c] += angle
                       ? RoundTo(deviation, kRadian, published_.angle_decimals)
                       : RoundTo(deviation, kMillimetre, length_decimals);
    }
    const Eigen::Matrix3Xd positions = TargetPositions(
        layout_.WithValues(job_.arm, values), poses.joint_values.map());
    return SummarizeErrors(
        (positions - poses.positions().map()).colwise().norm().transpose());
  }

  // By their keys in the job: each in words, and what we obtain.
  std::map<std::string, std::pair<std::string, std::string>> Quantities()
      const {
    const Accuracy& before = result_.train.before;
    const Accuracy& after = study_.full_precision;
    const Accuracy& printed = study_.as_printed;
    return {{"before_range",
             {"error before, training poses",
              Significant(before.min / kMillimetre, 3) + " to " +
                  Millimetres(before.max, 3)}},
            {"after_max", {"largest error after, training poses", AfterMax()}},
            {"error_at_iteration_4",
             {"largest error at iteration 4", ErrorAtIteration(4)}},
            {"error_at_iteration_100",
             {"largest error at iteration 100", ErrorAtIteration(100)}},
            {"time_100_iterations",
             {"time of the baseline's iterations",
              Duration(study_.timed_s) + ", " +
                  FormatRatio(study_.published_s / study_.timed_s) +
                  " times less"}},
            {"identified",
             {"parameters identified",
              std::to_string(result_.identifiability.num_free) + " of " +
                  std::to_string(study_.parameters.size())}},
            {"not_identified", {"deviations not identified", NotIdentified()}},
            {"validation_after",
             {"error after, validation poses",
              "at most " + Millimetres(after.max, 2) + " at " +
                  std::to_string(after.n) + " points"}},
            {"as_printed",
             {"the same, with the values as printed",
              Significant(printed.min / kMillimetre, 5) + " to " +
                  Millimetres(printed.max, 5)}}};
  }

  std::string AfterMax() const {
    std::vector<std::string> parts;
    for (const SolverRun& run : result_.runs) {
      parts.push_back(
          Millimetres(run.train.max, 2) + " (" + run.summary.solver + ", " +
          std::to_string(run.summary.accepted_steps) + " iterations)");
    }
    return Join(parts, "; ");
  }

  std::string ErrorAtIteration(std::size_t iteration) const {
    if (iteration >= baseline_.iterations.size()) return "not reached";
    return Significant(baseline_.iterations[iteration].max_error, 2) + " m";
  }

  std::string NotIdentified() const {
    std::vector<std::string> names;
    for (const StudyParameter& parameter : study_.parameters) {
      if (parameter.identified || parameter.assumed == 0.0) continue;
      names.push_back(parameter.name);
    }
    return names.empty() ? "none" : Join(names, ", ");
  }

  const Job& job_;
  const PublishedStudy& published_;
  const CalibrationResult& result_;
  const ParameterLayout layout_;
  const Eigen::VectorXd nominal_;
  const Eigen::VectorXd truth_;
  const Eigen::VectorXd& values_;
  SolverSummary baseline_;
  StudyResult study_;
};

}  // namespace

StudyResult CompareWithStudy(const Job& job, const CalibrationResult& result) {
  return Study(job, result).Compare();
}

}  // namespace alidade::rv2aj
