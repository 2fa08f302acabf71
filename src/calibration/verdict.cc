#include "src/calibration/verdict.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "alidade/units.h"
#include "src/calibration/acceptance.h"
#include "src/calibration/advice.h"
#include "src/calibration/guidance.h"
#include "src/calibration/improvement.h"
#include "src/calibration/outliers.h"
#include "src/calibration/parameter_assessment.h"
#include "src/common/format.h"
#include "src/common/text.h"
#include "src/solve/solver_names.h"
#include "src/uncertainty/assessment.h"

namespace alidade::internal {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// A mean error of more than this part of what it was is hardly a gain.
constexpr double kHardlyBetter = 0.9;

// Errors of so few rounding errors of the model are at the limit of precision.
constexpr double kRoundingErrors = 1e4;

// The part of the error that measurement noise must explain to be worth a word,
// and the part beyond which the stated sigma cannot be right.
constexpr double kSmallPart = 0.5;
constexpr double kImpossiblePart = 1.5;

std::string FormatAngle(double radians, int digits) {
  return FormatSignificant(radians / kDegree, digits) + " deg";
}

std::string FormatQuantity(double value, Dimension dimension) {
  return dimension == Dimension::kLength ? FormatLength(value, 3)
                                         : FormatAngle(value, 3);
}

// As the job states it, without the zeros that digits would add.
std::string LimitText(double limit) {
  return ShortestNumber(NumberOrNan(FormatSignificant(limit, 6)));
}

// "p = 0.031".
std::string PValue(double p) {
  return p < 1e-16 ? "p < 1e-16" : "p = " + FormatSignificant(p, 2);
}

// "largest orientation error at validation poses" of "validation_rotation_max".
std::string QuantityTitle(const std::string& key, const char* length_error) {
  const auto has = [&key](const char* part) {
    return key.find(part) != std::string::npos;
  };
  return std::string(has("_max") ? "largest " : "RMS ") +
         (has("_rotation") ? "orientation error" : length_error) + " at " +
         (has("train") ? "training" : "validation") + " poses";
}

// ", without 2 rejected observations".
std::string WithoutRejected(std::int64_t count) {
  return count == 0 ? "" : ", without " + Count(count, "rejected observation");
}

class Judge {
 public:
  explicit Judge(const CalibrationResult& result)
      : result_(result), improvement_(result) {}

  Verdict Decide() {
    if (result_.runs.empty()) return NotCalibrated();
    if (!JudgeSolver()) return NotUsable();
    if (result_.IsRejected()) {
      Add("rejected", kNone, kNone, result_.message, FindingLevel::kFailed);
    }
    JudgeImprovement();
    JudgeAcceptance();
    ListWarnings();
    JudgeRank();
    JudgeOutliers();
    JudgeValidationOutliers();
    JudgeNoise();
    JudgeResiduals();
    JudgePrediction();
    JudgeCrossValidation();
    for (Finding& finding : GuidanceOf(result_)) Add(std::move(finding));
    Sort();
    if (verdict_.level == FindingLevel::kNote) {
      verdict_.level = FindingLevel::kPassed;
    }
    verdict_.title = Title();
    return std::move(verdict_);
  }

 private:
  void Add(const std::string& key, double statistic, double threshold,
           const std::string& sentence, FindingLevel level) {
    Add({key, statistic, threshold, sentence, level});
  }

  void Add(Finding finding) {
    verdict_.level = std::max(verdict_.level, finding.level);
    verdict_.findings.push_back(WithAdvice(std::move(finding)));
  }

  // In the order of their weight; of one level, as they were judged.
  void Sort() {
    std::stable_sort(
        verdict_.findings.begin(), verdict_.findings.end(),
        [](const Finding& a, const Finding& b) { return a.level > b.level; });
  }

  // A note where `is_noted`.
  void AddNote(const std::string& key, double statistic, double threshold,
               const std::string& sentence, bool is_noted = true) {
    Add(key, statistic, threshold, sentence,
        is_noted ? FindingLevel::kNote : FindingLevel::kPassed);
  }

  Verdict NotCalibrated() const {
    const std::string& refusal = result_.identifiability.refusal;
    return {FindingLevel::kFailed,
            "Not calibrated",
            "Nothing was calibrated: " +
                (refusal.empty() ? "no solver has run." : refusal),
            {}};
  }

  Verdict NotUsable() {
    verdict_.level = FindingLevel::kFailed;
    verdict_.title = "Not usable";
    verdict_.sentence = verdict_.findings.front().sentence +
                        " These values are not to be used.";
    return std::move(verdict_);
  }

  bool JudgeSolver() {
    const SolverSummary& summary = result_.runs.front().summary;
    const bool is_usable = summary.IsSolutionUsable();
    std::string text =
        SolverTitle(summary.solver) + " " + ToString(summary.status) +
        " after " +
        Count(summary.accepted_steps + summary.rejected_steps, "iteration");
    if (!is_usable && !summary.message.empty()) text += ": " + summary.message;
    Add("solver", kNone, kNone, AsSentence(text),
        is_usable ? FindingLevel::kPassed : FindingLevel::kFailed);
    return is_usable;
  }

  void JudgeImprovement() {
    const Improvement& by = improvement_;
    if (by.after.n == 0) return;
    const bool is_worse = by.is_worse;
    const std::string what = by.dimension == Dimension::kLength
                                 ? LengthErrorName(result_)
                                 : "orientation error";
    if (by.is_of_frames) {
      verdict_.sentence = "With the frames that were found the mean " + what +
                          " at " + Count(by.after.n, ObservationName(result_)) +
                          WithoutRejected(by.num_rejected) + " is " +
                          FormatQuantity(by.after.mean, by.dimension) + ".";
      Add("improvement", by.ratio(), 1.0, verdict_.sentence,
          FindingLevel::kPassed);
      return;
    }
    std::string text = "The mean " + what + " at " +
                       Count(by.after.n, ObservationName(result_)) +
                       WithoutRejected(by.num_rejected) +
                       (by.num_rejected > 0 ? "," : "") +
                       (by.ratio() > 1.0 ? " grows" : " falls") + " from " +
                       FormatQuantity(by.before.mean, by.dimension) + " to " +
                       FormatQuantity(by.after.mean, by.dimension);
    const double floor = result_.runs.front().summary.precision_limit;
    if (by.after.max < kRoundingErrors * floor) {
      text += ", the numerical precision limit";
    }
    if (result_.cross_validation && !result_.validation) {
      const ValidationErrors left_out = ValidationErrorsOf(result_);
      text += "; where they are left out of the fit in turn, it is " +
              FormatQuantity(by.dimension == Dimension::kLength
                                 ? left_out.lengths.mean
                                 : left_out.rotations.mean,
                             by.dimension);
    }
    verdict_.sentence = text + ".";
    Add("improvement", by.ratio(), is_worse ? 1.0 : kHardlyBetter,
        verdict_.sentence,
        is_worse                     ? FindingLevel::kFailed
        : by.ratio() > kHardlyBetter ? FindingLevel::kAttention
                                     : FindingLevel::kPassed);
  }

  void JudgeAcceptance() {
    std::int64_t missed = 0;
    for (const AcceptanceCheck& check : result_.acceptance) {
      const double unit =
          check.dimension == Dimension::kLength ? kMillimetre : kDegree;
      Add("acceptance." + check.quantity, check.obtained, check.limit,
          AsSentence(QuantityTitle(check.quantity, LengthErrorName(result_)) +
                     ": " + FormatQuantity(check.obtained, check.dimension) +
                     WithoutRejected(check.num_rejected) + ", limit " +
                     LimitText(check.limit / unit) + " " +
                     UnitForPeople(check.dimension)),
          check.met() ? FindingLevel::kPassed : FindingLevel::kFailed);
      if (!check.met()) ++missed;
    }
    const auto all = static_cast<std::int64_t>(result_.acceptance.size());
    if (all == 0) {
      const bool is_validated =
          result_.cross_validation || &JudgedSet(result_) != &result_.train;
      AddNote("acceptance", kNone, kNone,
              is_validated
                  ? "No acceptance limits were set."
                  : "No acceptance limits were set, and there are no "
                    "validation poses: these errors do not show how accurate "
                    "the arm is at other poses.");
      return;
    }
    verdict_.sentence +=
        missed == 0 ? " All acceptance limits are met."
                    : " " + std::to_string(missed) + " of " +
                          Count(all, "acceptance limit") +
                          (missed == 1 ? " is missed." : " are missed.");
  }

  // Those of the result are reasons to look twice; what the analyses alone
  // warned of is a note.
  void ListWarnings() {
    std::set<std::string> listed;
    for (const Finding& finding : result_.plausibility) {
      listed.insert(finding.sentence);
      Add(finding);
    }
    const auto list = [&](const std::vector<std::string>& warnings,
                          FindingLevel level) {
      for (const std::string& warning : warnings) {
        if (!listed.insert(warning).second) continue;
        Add("warning", kNone, kNone, warning, level);
      }
    };
    list(result_.warnings, FindingLevel::kAttention);
    list(result_.identifiability.warnings, FindingLevel::kNote);
    if (result_.uncertainty) {
      list(result_.uncertainty->warnings, FindingLevel::kNote);
    }
  }

  // A fit of nearly as many parameters as equations leaves next to nothing.
  void JudgeCrossValidation() {
    constexpr double kOverfitted = 3.0;
    if (!result_.cross_validation) return;
    const double fitted = result_.train.Judged().after.rms;
    const CrossValidation& folds = *result_.cross_validation;
    const double validated =
        folds.kept ? folds.kept->position.rms : folds.position.rms;
    const double ratio = validated / fitted;
    if (!(ratio > 0.0)) return;
    const bool is_overfitted = ratio > kOverfitted;
    Add("cross_validation", ratio, kOverfitted,
        "Cross-validation finds an RMS error of " + FormatLength(validated, 3) +
            ", the fit leaves " + FormatLength(fitted, 3) +
            (is_overfitted
                 ? ": the parameters follow the noise of too few poses. The "
                   "former is what to expect at other poses."
                 : "."),
        is_overfitted ? FindingLevel::kAttention : FindingLevel::kPassed);
  }

  void JudgeRank() {
    const IdentifiabilityResult& found = result_.identifiability;
    if (found.nominal_rank.singular_values.size() == 0) return;
    const int rank = found.nominal_rank.rank;
    std::string text =
        "The numerical rank of these poses at the nominal "
        "geometry is " +
        std::to_string(rank) + " of " + std::to_string(found.num_free);
    if (rank >= found.num_free) {
      text += ": all estimated parameters are identifiable";
    } else if (!found.weak.empty()) {
      text += ": " + Join(found.weak, ", ") +
              (found.weak.size() == 1 ? " depends" : " depend") +
              " on others but for effects of second order";
    }
    AddNote("rank", rank, found.num_free, text + ".", rank < found.num_free);
  }

  void JudgeOutliers() {
    if (!(result_.outlier_limit > 0.0)) return;
    const std::string limit = FormatSignificant(result_.outlier_limit, 3);
    const std::string chance =
        ", which one of all exceeds by chance in 5 % of calibrations";
    if (result_.outliers.empty()) {
      AddNote("outliers", kNone, result_.outlier_limit,
              "No outliers: no standardised residual exceeds " + limit +
                  chance + ".",
              false);
      return;
    }
    const Outlier& worst = result_.outliers.front();
    AddNote(
        "outliers", worst.standardised, result_.outlier_limit,
        Count(static_cast<std::int64_t>(result_.outliers.size()), "outlier") +
            ": standardised residuals above " + limit + chance +
            "; the largest is " + FormatSignificant(worst.standardised, 3) +
            ".");
  }

  void JudgeValidationOutliers() {
    const std::vector<Outlier>& outliers = result_.validation_outliers;
    if (outliers.empty()) return;
    const auto count = static_cast<std::int64_t>(outliers.size());
    std::string text = Count(count, "outlier") + " among the validation poses" +
                       PlacesOf(outliers) + ", the largest " +
                       FormatSignificant(outliers.front().standardised, 3) +
                       " predicted standard deviations off";
    const bool is_left_out = result_.uncertainty &&
                             result_.uncertainty->validation &&
                             result_.uncertainty->validation->num_outliers > 0;
    if (!is_left_out) {
      text +=
          ": too many for mistakes of measurement, so that none is left out. "
          "The fit does not describe these poses";
    } else if (!result_.validation->kept) {
      text += ". The errors contain them";
    }
    // Those near the limit are there by chance at times.
    constexpr double kFarBeyond = 1.5;
    const double largest = outliers.front().standardised;
    Add("validation_outliers", largest, result_.outlier_limit, text,
        is_left_out && largest < kFarBeyond * result_.outlier_limit
            ? FindingLevel::kNote
            : FindingLevel::kAttention);
  }

  // How much of the error the instrument alone would show. A sigma that comes
  // from the residuals says nothing of it, and one that they are far from is
  // wrong. Of positions measured whole the mean length of noise with standard
  // deviation 1 is sqrt(8 / pi).
  void JudgeNoise() {
    constexpr int kRowsEach =
        3;  // of a parameter: fewer say nothing of the arm
    const SolverSummary& summary = result_.runs.front().summary;
    if (!result_.train.labels.empty() || result_.train.rotation_after.n > 0 ||
        summary.num_residuals != 3 * result_.train.after.n ||
        !(result_.sigma > 0.0) || result_.estimated_sigma > 0.0 ||
        kRowsEach * summary.num_free > summary.num_residuals) {
      return;
    }
    const double noise = std::sqrt(8.0 / kPi) * result_.sigma;
    const double error = improvement_.after.mean;
    if (noise < kSmallPart * error || noise > kImpossiblePart * error) return;
    AddNote("measurement_noise", noise, error,
            "Measurement noise alone, " + FormatLength(result_.sigma, 3) +
                " in each coordinate, would show a mean error of " +
                FormatLength(noise, 3) +
                ": the arm itself is more accurate than these errors.");
  }

  void JudgeResiduals() {
    if (result_.estimated_sigma > 0.0) {
      std::string text =
          "The standard deviation of a coordinate, estimated from the "
          "residuals, is " +
          FormatLength(result_.estimated_sigma, 3);
      if (result_.estimated_rotation_sigma > 0.0) {
        text += ", that of an orientation about each axis " +
                FormatAngle(result_.estimated_rotation_sigma, 3);
      }
      AddNote("sigma", result_.estimated_sigma, kNone, text + ".");
    }
    if (result_.uncertainty) {
      JudgeTests(result_.uncertainty->residuals);
    } else if (result_.reduced_chi_square > 0.0) {
      AddNote("chi_square", result_.reduced_chi_square, 1.0,
              "The reduced chi-square" + AmongKept() + " is " +
                  FormatSignificant(result_.reduced_chi_square, 3) +
                  "; 1 where the residuals are as large as the sigmas say.",
              false);
    }
  }

  std::string AmongKept() const {
    const std::string text =
        WithoutRejected(result_.train.Judged().num_rejected);
    return text.empty() ? "" : text + ",";
  }

  void JudgeTests(const ResidualDiagnostics& found) {
    const bool is_noise_free = found.reduced_chi_square < kMuchSmaller;
    std::string text = "Chi-square" + AmongKept() + " is " +
                       FormatSignificant(found.chi_square, 4) + " for " +
                       FormatSignificant(found.degrees_of_freedom, 4) +
                       " degrees of freedom, reduced " +
                       FormatSignificant(found.reduced_chi_square, 3);
    const double p = found.chi_square_p_value;
    text += std::isfinite(p) ? " (" + PValue(p) + ")."
                             : " (sigma is estimated from it).";
    if (is_noise_free) {
      text +=
          " The residuals are far below their sigmas, as in data without "
          "noise: they are not tested further.";
    }
    AddNote("chi_square", p, kUnlikely, text, p < kUnlikely);
    if (is_noise_free) return;
    const auto add = [this](const std::string& key, const TestResult& test,
                            const char* name, const std::string& passed,
                            const std::string& noted) {
      if (!std::isfinite(test.p_value)) return;
      const bool is_unlikely = test.p_value < kUnlikely;
      AddNote(key, test.p_value, kUnlikely,
              (is_unlikely ? noted : passed) + " (" + name + ", " +
                  PValue(test.p_value) + ").",
              is_unlikely);
    };
    add("normality", found.normality, "Anderson and Darling",
        "The residuals are compatible with a normal distribution",
        "The residuals are not normally distributed");
    add("whiteness", found.whiteness, "Ljung and Box",
        "The residuals are not autocorrelated along the order of measurement",
        "The residuals are autocorrelated along the order of measurement, as "
        "with a drift");
  }

  void JudgePrediction() {
    if (!result_.uncertainty || !result_.uncertainty->validation) return;
    const PredictionCheck& check = *result_.uncertainty->validation;
    const std::string text = DescribePrediction("Validation poses", check);
    if (text.empty()) return;
    const bool agrees = check.verdict == "agree";
    AddNote("prediction", check.axes.rate(),
            check.verdict == "smaller" ? check.axes.upper : check.axes.lower,
            text, !agrees);
  }

  std::string Title() const {
    if (improvement_.is_worse) return "Worse than before";
    if (result_.IsRejected()) return "Rejected";
    if (verdict_.level == FindingLevel::kFailed) return "Not accepted";
    std::string title = result_.acceptance.empty() ? "Usable" : "Accepted";
    if (verdict_.level == FindingLevel::kPassed) return title;
    const bool is_hardly_better =
        improvement_.ratio() > kHardlyBetter && !improvement_.is_of_frames;
    return title + (is_hardly_better ? ", hardly better than before"
                                     : ", with warnings");
  }

  const CalibrationResult& result_;
  const Improvement improvement_;
  Verdict verdict_{FindingLevel::kPassed, "", "", {}};
};

}  // namespace

void JudgeResult(CalibrationResult* result) {
  AssessParameters(result);
  result->verdict = Judge(*result).Decide();
}

std::string DescribePrediction(const std::string& where,
                               const PredictionCheck& check) {
  if (check.axes.n == 0) return "";
  std::string text = where + ": ";
  if (check.num_outliers > 0) {
    text += "without " + Count(check.num_outliers, "outlier") + ", ";
  }
  text += FixedPercent(check.axes.rate(), 1) + " of " +
          Count(check.axes.n, "coordinate") + " lie within their " +
          FixedPercent(check.confidence, 1) + " intervals (" +
          FixedPercent(check.axes.lower, 1) + " to " +
          FixedPercent(check.axes.upper, 1) + " by chance)";
  if (check.ellipsoids.n > 0) {
    text += ", " + FixedPercent(check.ellipsoids.rate(), 1) +
            " of positions within their ellipsoids";
  }
  return text + "; errors are " + FormatSignificant(check.rms_z, 3) +
         " times the predicted ones (root mean square): " +
         (check.verdict == "agree" ? "predicted and observed agree."
          : std::isfinite(check.rms_z)
              ? "observed errors are " + check.verdict + " than predicted."
              : "whether they agree cannot be determined.");
}

}  // namespace alidade::internal
