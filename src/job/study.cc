#include "src/job/study.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "alidade/units.h"
#include "src/calibration/evaluate.h"
#include "src/calibration/preparation.h"
#include "src/common/format.h"

namespace alidade::internal {
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
  if (ratio < 1000.0) return FormatSignificant(ratio, 3);
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
  Study(const PublishedStudy& published, const CalibrationTask& task,
        const CalibrationResult& result)
      : task_(task),
        published_(published),
        model_(task.arm, task.data.references, task.options.num_threads),
        problem_(ProblemOf(task, model_, result.identifiability)),
        layout_(model_.layout()),
        result_(result),
        values_(result.runs.front().values) {}

  StudyResult Compare() {
    study_.source = published_.source;
    study_.angle_decimals = published_.angle_decimals;
    study_.length_decimals = published_.length_decimals;
    study_.published_s = published_.baseline_time_s;
    TimeBaseline();
    ListParameters();
    FindAbsorptions();
    study_.as_printed = EvaluateRounded(published_.length_decimals);
    study_.three_more_decimals =
        EvaluateRounded(published_.length_decimals + 3);
    for (const PublishedFigure& figure : published_.figures) {
      study_.rows.push_back({DescribeQuantity(figure.quantity),
                             figure.published, Obtained(figure.quantity)});
    }
    return study_;
  }

 private:
  // The study's fixed number of iterations, past the rounding floor and all.
  void TimeBaseline() {
    SolverOptions options = task_.options.solver_options;
    options.max_iterations = published_.baseline_iterations;
    options.function_tolerance = 0.0;
    options.rounding_floor_factor = 0.0;
    options.wanted_precision = 0.0;
    std::array<double, 3> seconds{};
    for (double& time : seconds) {
      Eigen::VectorXd values = model_.NominalValues();
      baseline_ = SolvePseudoInverse(problem_, options, &values);
      time = baseline_.solve_time_s;
    }
    std::sort(seconds.begin(), seconds.end());
    study_.timed_iterations = published_.baseline_iterations;
    study_.timed_s = seconds[1];
  }

  Eigen::VectorXd TrueValues() const {
    return task_.options.true_values ? *task_.options.true_values
                                     : model_.NominalValues();
  }

  void ListParameters() {
    const Eigen::VectorXd nominal = model_.NominalValues();
    const Eigen::VectorXd truth = TrueValues();
    for (int c = 0; c < layout_.size(); ++c) {
      const Parameter& parameter = layout_.parameter(c);
      if (!ParameterLayout::IsJointKind(parameter.kind)) continue;
      StudyParameter entry;
      entry.name = parameter.name;
      entry.dimension = parameter.dimension;
      entry.identified =
          result_.parameters[c].decision.state == ParameterState::kFree;
      entry.nominal = nominal[c];
      entry.assumed = truth[c] - nominal[c];
      entry.published = published_.deviations[c];
      entry.obtained = values_[c] - nominal[c];
      study_.parameters.push_back(entry);
    }
  }

  // d(free) = -J_free^+ J_frozen d(frozen): the least-squares answer of the
  // free parameters to a frozen one that is off, at the identified geometry.
  void FindAbsorptions() {
    if (!task_.options.true_values) return;
    const Eigen::VectorXd deviation =
        *task_.options.true_values - model_.NominalValues();
    std::vector<int> frozen;
    for (int c = 0; c < layout_.size(); ++c) {
      const bool is_frozen =
          result_.parameters[c].decision.state == ParameterState::kFrozen;
      if (is_frozen && deviation[c] != 0.0) frozen.push_back(c);
    }
    if (frozen.empty()) return;
    Linearization free_part;
    Linearization frozen_part;
    model_.Linearize(values_, problem_.data, problem_.free_columns, &free_part);
    model_.Linearize(values_, problem_.data, frozen, &frozen_part);
    const Eigen::MatrixXd answers =
        free_part.jacobian.colPivHouseholderQr().solve(frozen_part.jacobian);
    for (Eigen::Index k = 0; k < answers.rows(); ++k) {
      AddAbsorptions(problem_.free_columns[k], frozen, answers.row(k),
                     deviation);
    }
  }

  // What several frozen parameters add and take away again is left out.
  void AddAbsorptions(int free, const std::vector<int>& frozen,
                      const Eigen::RowVectorXd& coefficients,
                      const Eigen::VectorXd& deviation) {
    double total = 0.0;
    for (std::size_t i = 0; i < frozen.size(); ++i) {
      total +=
          coefficients[static_cast<Eigen::Index>(i)] * deviation[frozen[i]];
    }
    if (std::abs(total) < 100.0 * kNegligibleAmount) return;
    for (std::size_t i = 0; i < frozen.size(); ++i) {
      const double coefficient = coefficients[static_cast<Eigen::Index>(i)];
      const double amount = coefficient * deviation[frozen[i]];
      if (std::abs(amount) < kNegligibleAmount) continue;
      study_.absorptions.push_back(
          {layout_.parameter(frozen[i]).name, deviation[frozen[i]],
           layout_.parameter(free).name, layout_.parameter(free).dimension,
           coefficient, amount});
    }
  }

  // The study prints deviations; angles in rad, lengths in mm.
  Accuracy EvaluateRounded(int length_decimals) const {
    if (!task_.data.validation) return {};
    Eigen::VectorXd values = model_.NominalValues();
    for (int c = 0; c < layout_.size(); ++c) {
      const double deviation = values_[c] - values[c];
      const bool angle = layout_.parameter(c).dimension == Dimension::kAngle;
      values[c] += angle
                       ? RoundTo(deviation, kRadian, published_.angle_decimals)
                       : RoundTo(deviation, kMillimetre, length_decimals);
    }
    return EvaluateAccuracy(model_, *task_.data.validation, values);
  }

  static std::string DescribeQuantity(const std::string& quantity) {
    static const std::map<std::string, std::string> kDescriptions = {
        {"before_range", "error before, training poses"},
        {"after_max", "largest error after, training poses"},
        {"error_at_iteration_4", "largest error at iteration 4"},
        {"error_at_iteration_100", "largest error at iteration 100"},
        {"time_100_iterations", "time of the baseline's iterations"},
        {"identified", "parameters identified"},
        {"not_identified", "deviations not identified"},
        {"validation_after", "error after, validation poses"},
        {"as_printed", "the same, with the values as printed"}};
    return kDescriptions.at(quantity);
  }

  std::string Obtained(const std::string& quantity) const {
    using Formatter = std::string (Study::*)() const;
    static const std::map<std::string, Formatter> kFormatters = {
        {"before_range", &Study::BeforeRange},
        {"after_max", &Study::AfterMax},
        {"error_at_iteration_4", &Study::ErrorAtIteration<4>},
        {"error_at_iteration_100", &Study::ErrorAtIteration<100>},
        {"time_100_iterations", &Study::Time},
        {"identified", &Study::Identified},
        {"not_identified", &Study::NotIdentified},
        {"validation_after", &Study::ValidationAfter},
        {"as_printed", &Study::AsPrinted}};
    return (this->*kFormatters.at(quantity))();
  }

  std::string BeforeRange() const {
    const Accuracy& before = result_.train.before;
    return FormatSignificant(before.min / kMillimetre, 3) + " to " +
           FormatLength(before.max, 3);
  }

  std::string AfterMax() const {
    std::string text;
    for (const SolverRun& run : result_.runs) {
      if (!text.empty()) text += "; ";
      text += FormatLength(run.train.max, 2) + " (" + run.summary.solver +
              ", " + std::to_string(run.summary.accepted_steps) +
              " iterations)";
    }
    return text;
  }

  template <int iteration>
  std::string ErrorAtIteration() const {
    if (iteration >= static_cast<int>(baseline_.iterations.size())) {
      return "not reached";
    }
    return FormatSignificant(baseline_.iterations[iteration].max_error, 2) +
           " m";
  }

  std::string Time() const {
    std::string time = FormatDuration(study_.timed_s);
    if (!(study_.published_s > 0.0 && study_.timed_s > 0.0)) return time;
    return time + ", " + FormatRatio(study_.published_s / study_.timed_s) +
           " times less";
  }

  std::string Identified() const {
    return std::to_string(result_.identifiability.num_free) + " of " +
           std::to_string(study_.parameters.size());
  }

  std::string NotIdentified() const {
    std::string text;
    for (const StudyParameter& parameter : study_.parameters) {
      if (parameter.identified || parameter.assumed == 0.0) continue;
      if (!text.empty()) text += ", ";
      text += parameter.name;
    }
    return text.empty() ? "none" : text;
  }

  std::string ValidationAfter() const {
    if (!result_.heldout) return "no validation poses";
    const Accuracy& after = result_.heldout->after;
    return "at most " + FormatLength(after.max, 2) + " at " +
           std::to_string(after.n) + " points";
  }

  std::string AsPrinted() const {
    const Accuracy& accuracy = study_.as_printed;
    if (accuracy.n == 0) return "no validation poses";
    return FormatSignificant(accuracy.min / kMillimetre, 5) + " to " +
           FormatLength(accuracy.max, 5);
  }

  const CalibrationTask& task_;
  const PublishedStudy& published_;
  const MeasurementModel model_;
  const CalibrationProblem problem_;
  const ParameterLayout& layout_;
  const CalibrationResult& result_;
  const Eigen::VectorXd& values_;
  SolverSummary baseline_;
  StudyResult study_;
};

}  // namespace

StudyResult CompareWithStudy(const PublishedStudy& published,
                             const CalibrationTask& task,
                             const CalibrationResult& result) {
  return Study(published, task, result).Compare();
}

}  // namespace alidade::internal
