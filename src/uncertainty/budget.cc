#include "src/uncertainty/budget.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "src/common/constants.h"
#include "src/common/distributions.h"
#include "src/common/format.h"
#include "src/common/number_text.h"
#include "src/model/joint_draw.h"
#include "src/uncertainty/lack_of_fit.h"
#include "src/uncertainty/prediction.h"

namespace alidade::internal {
namespace {

constexpr double kAxes = 3.0;
constexpr double kSignificant = 0.05;
// Draws for each configuration of the region before it counts as out of reach.
constexpr int kDrawsEach = 200;
// Of a sorted list this many even quantiles stand for all, which moves the
// coverage by less than 0.1 %.
constexpr std::size_t kQuantiles = 50;

double Square(double x) { return x * x; }

// Configurations whose target is in the region: as many as are asked for, or
// those that are found.
Eigen::MatrixXd DrawInRegion(const BudgetInput& input) {
  const UncertaintyOptions& options = input.options;
  const Arm& arm = input.model.nominal();
  const int count = options.region_configurations;
  if (options.region.empty()) return DrawJointValues(arm, count, options.seed);
  const Arm calibrated = input.model.layout().WithValues(arm, input.values);
  const Eigen::Isometry3d base_from_instrument =
      calibrated.instrument_from_base.inverse();
  Eigen::MatrixXd inside(arm.num_joints(), count);
  int found = 0;
  for (int round = 0; round < kDrawsEach && found < count; ++round) {
    const Eigen::MatrixXd drawn = DrawJointValues(
        arm, count, options.seed + static_cast<std::uint64_t>(round));
    const Eigen::Matrix3Xd points = input.model.Predict(input.values, drawn);
    for (int i = 0; i < count && found < count; ++i) {
      if (!IsInside(options.region, base_from_instrument * points.col(i))) {
        continue;
      }
      inside.col(found++) = drawn.col(i);
    }
  }
  return inside.leftCols(found);
}

std::vector<double> EvenQuantiles(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  if (values.size() <= kQuantiles) return values;
  std::vector<double> chosen;
  for (std::size_t k = 0; k < kQuantiles; ++k) {
    chosen.push_back(values[(2 * k + 1) * values.size() / (2 * kQuantiles)]);
  }
  return chosen;
}

// The bound that is exceeded at a rate; `exceeded` falls with it. `guess` > 0.
double BoundExceededAt(double rate, double guess,
                       const std::function<double(double)>& exceeded) {
  double lower = 0.0;
  double upper = guess;
  while (exceeded(upper) > rate) {
    lower = upper;
    upper *= 2.0;
  }
  constexpr double kPrecision = 1e-6;
  while (upper - lower > kPrecision * upper) {
    const double middle = 0.5 * (lower + upper);
    (exceeded(middle) > rate ? lower : upper) = middle;
  }
  return 0.5 * (lower + upper);
}

class BudgetMaker {
 public:
  explicit BudgetMaker(const BudgetInput& input) : input_(input) {}

  std::optional<UncertaintyBudget> Make() {
    joints_ = DrawInRegion(input_);
    if (joints_.cols() == 0) return std::nullopt;
    budget_.region = input_.options.region;
    budget_.configurations = joints_.cols();
    budget_.confidence = input_.options.confidence;
    AddParameters();
    AddUnexplained();
    budget_.position = Combine(budget_.contributions);
    budget_.worst_std = worst_;
    std::vector<BudgetContribution> with_instrument = budget_.contributions;
    if (input_.measurement.stated_sigma) {
      with_instrument.push_back({BudgetSource::kMeasurement, EvaluationType::kB,
                                 *input_.measurement.stated_sigma, kInfinity,
                                 "sigma of the instrument as stated"});
    }
    budget_.measured = Combine(with_instrument);
    budget_.contributions = std::move(with_instrument);
    return std::move(budget_);
  }

 private:
  void Add(BudgetSource source, double variance, double freedom,
           std::string basis) {
    budget_.contributions.push_back({source, EvaluationType::kA,
                                     std::sqrt(std::max(0.0, variance)),
                                     freedom, std::move(basis)});
  }

  void AddParameters() {
    ParameterCovariance parameters = input_.prediction;
    parameters.excess = {};
    predicted_ =
        PredictCovariances(input_.model, input_.values, parameters, joints_);
    double sum = 0.0;
    for (const PoseCovariance& pose : predicted_) sum += pose.position.trace();
    Add(BudgetSource::kParameters,
        sum / (kAxes * static_cast<double>(predicted_.size())),
        parameters.degrees_of_freedom,
        "covariance of the fit" +
            std::string(parameters.terms ? " and its error terms" : ""));
    ListParameters(parameters);
  }

  void ListParameters(const ParameterCovariance& parameters) {
    const Dataset positions =
        MakePositions(joints_, Eigen::Matrix3Xd::Zero(3, joints_.cols()), 1.0);
    Linearization rows;
    input_.model.Linearize(input_.values, positions, parameters.columns, &rows);
    const Eigen::VectorXd deviations = parameters.Deviations();
    const ParameterLayout& layout = input_.model.layout();
    for (int k = 0; k < parameters.size(); ++k) {
      const Parameter& parameter = layout.parameter(parameters.columns[k]);
      budget_.parameters.push_back(
          {parameter.name, parameter.dimension, deviations[k],
           rows.jacobian.col(k).norm() /
               std::sqrt(static_cast<double>(rows.jacobian.rows()))});
    }
    std::stable_sort(
        budget_.parameters.begin(), budget_.parameters.end(),
        [](const ParameterContribution& a, const ParameterContribution& b) {
          return a.contribution() > b.contribution();
        });
  }

  // What positions are off by beyond parameters: the model and the arm's
  // repeatability, or what of the residuals cannot be separated.
  void AddUnexplained() {
    const LackOfFit& lack = input_.lack;
    const MeasurementKnowledge& known = input_.measurement;
    const bool has_repeats = known.repeat_freedom >= kFewestRepeats;
    const double spread = Square(known.repeat_std);
    const double stated =
        known.stated_sigma ? Square(*known.stated_sigma) : 0.0;
    // A spread that the instrument explains says nothing of the arm, and the
    // degrees of freedom of so small a difference would be hardly any.
    const bool is_larger =
        has_repeats &&
        (stated == 0.0 || FisherSurvival(spread / stated, known.repeat_freedom,
                                         kInfinity) < kSignificant);
    const double repeat = is_larger ? spread - stated : 0.0;
    double model = lack.excess_variance / kAxes;
    const bool holds_repeatability = lack.source == NoiseSource::kStated;
    if (holds_repeatability) model = std::max(0.0, model - repeat);
    Add(BudgetSource::kModel, model,
        model > 0.0 ? lack.excess_degrees_of_freedom : kInfinity,
        ModelBasis(model));
    if (has_repeats && !is_larger) {
      Add(BudgetSource::kRepeatability, 0.0, kInfinity,
          "unknown: repeated configurations differ by no more than the "
          "instrument explains (part of the model's)");
    } else if (has_repeats) {
      const double part = spread > 0.0 ? Square(repeat / spread) : 1.0;
      Add(BudgetSource::kRepeatability, repeat,
          repeat > 0.0 ? known.repeat_freedom * part : kInfinity,
          "spread of repeated configurations (" +
              FormatLength(known.repeat_std, 2) + "; " +
              FixedNumber(known.repeat_freedom, 0) + " degrees of freedom)" +
              (known.stated_sigma ? " less the stated sigma"
                                  : " with the instrument"));
    } else {
      Add(BudgetSource::kRepeatability, 0.0, kInfinity,
          std::string("unknown: too few configurations were measured more "
                      "than once (part of the ") +
              (known.stated_sigma ? "model's)" : "residuals)"));
    }
    if (known.stated_sigma || lack.source == NoiseSource::kRepeats) return;
    const bool is_split = lack.source == NoiseSource::kStructure;
    const double residual = Square(is_split ? lack.noise : lack.residual);
    Add(BudgetSource::kResiduals, residual - repeat, lack.degrees_of_freedom,
        "residuals: noise and errors of the model cannot be separated. State "
        "the instrument's sigma or measure some poses several times");
  }

  std::string ModelBasis(double variance) const {
    if (variance > 0.0) {
      return "residuals beyond " +
             std::string(input_.lack.source == NoiseSource::kRepeats
                             ? "the repeatability"
                         : input_.lack.source == NoiseSource::kStated
                             ? "the stated sigma"
                             : "what is left without their structure");
    }
    return input_.lack.source == NoiseSource::kNone
               ? "cannot be separated from noise"
               : "no significant lack of fit";
  }

  CombinedUncertainty Combine(
      const std::vector<BudgetContribution>& contributions) {
    double common = 0.0;
    double sum = 0.0;
    for (const BudgetContribution& one : contributions) {
      sum += Square(one.std);
      if (one.source != BudgetSource::kParameters) common += Square(one.std);
    }
    CombinedUncertainty combined;
    combined.std = std::sqrt(sum);
    combined.degrees_of_freedom = WelchSatterthwaite(contributions);
    Expand(common, &combined);
    return combined;
  }

  void Expand(double common, CombinedUncertainty* combined) {
    std::vector<double> axes;
    // Of squared distances their mean, and twice the square of it over their
    // variance: the degrees of freedom of a chi-square of that shape.
    std::vector<std::pair<double, double>> distances;
    for (const PoseCovariance& pose : predicted_) {
      Eigen::Matrix3d covariance = pose.position;
      covariance.diagonal().array() += common;
      for (const double variance : covariance.diagonal()) {
        axes.push_back(std::sqrt(variance));
      }
      distances.emplace_back(covariance.trace(), Square(covariance.trace()) /
                                                     covariance.squaredNorm());
    }
    worst_ = *std::max_element(axes.begin(), axes.end());
    if (!std::isfinite(worst_) || !(worst_ > 0.0)) {
      combined->coverage_factor = StudentTQuantile(
          0.5 + 0.5 * budget_.confidence, combined->degrees_of_freedom);
      combined->expanded = combined->coverage_factor * combined->std;
      combined->expanded_distance = combined->expanded;
      return;
    }
    const double rate = 1.0 - budget_.confidence;
    const double freedom = combined->degrees_of_freedom;
    const std::vector<double> stds = EvenQuantiles(axes);
    combined->expanded =
        BoundExceededAt(rate, combined->std, [&](double bound) {
          double exceeded = 0.0;
          for (const double std : stds) {
            exceeded += FisherSurvival(Square(bound / std), 1.0, freedom);
          }
          return exceeded / static_cast<double>(stds.size());
        });
    combined->coverage_factor = combined->expanded / combined->std;
    std::sort(distances.begin(), distances.end());
    const std::size_t step =
        std::max<std::size_t>(1, distances.size() / kQuantiles);
    combined->expanded_distance =
        BoundExceededAt(rate, combined->expanded, [&](double radius) {
          double exceeded = 0.0;
          double count = 0.0;
          for (std::size_t i = step / 2; i < distances.size(); i += step) {
            const auto& [mean, shape] = distances[i];
            exceeded += FisherSurvival(Square(radius) / mean, shape, freedom);
            count += 1.0;
          }
          return exceeded / count;
        });
  }

  const BudgetInput& input_;
  UncertaintyBudget budget_;
  Eigen::MatrixXd joints_;
  std::vector<PoseCovariance> predicted_;
  double worst_ = 0.0;  // of the last that was expanded
};

}  // namespace

double WelchSatterthwaite(
    const std::vector<BudgetContribution>& contributions) {
  double variance = 0.0;
  double squares = 0.0;
  for (const BudgetContribution& one : contributions) {
    variance += Square(one.std);
    if (one.std > 0.0) {
      squares += Square(Square(one.std)) / one.degrees_of_freedom;
    }
  }
  return squares > 0.0 ? Square(variance) / squares : kInfinity;
}

std::optional<UncertaintyBudget> MakeBudget(const BudgetInput& input) {
  return BudgetMaker(input).Make();
}

}  // namespace alidade::internal
