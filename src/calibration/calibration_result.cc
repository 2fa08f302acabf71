#include "alidade/calibration_result.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>

#include "src/common/format.h"
#include "src/common/text.h"
#include "src/common/text_table.h"

namespace alidade {

using internal::Count;
using internal::FormatAccuracy;
using internal::FormatLength;
using internal::FormatParameter;
using internal::FormatSignificant;
using internal::TextTable;
using internal::UnitForPeople;

const char* ToString(FindingLevel level) {
  switch (level) {
    case FindingLevel::kPassed:
      return "passed";
    case FindingLevel::kNote:
      return "note";
    case FindingLevel::kAttention:
      return "attention";
    case FindingLevel::kFailed:
      return "failed";
  }
  return "unknown";
}

SharedVector EvaluatedSet::ErrorBefore() const {
  return residual_before.map().colwise().norm().transpose();
}

SharedVector EvaluatedSet::ErrorAfter() const {
  return residual_after.map().colwise().norm().transpose();
}

VerdictDecision Verdict::decision() const {
  if (level == FindingLevel::kFailed) return VerdictDecision::kRejected;
  return level == FindingLevel::kAttention
             ? VerdictDecision::kAcceptedWithWarnings
             : VerdictDecision::kAccepted;
}

KeptErrors EvaluatedSet::Judged() const {
  if (kept) return *kept;
  return {0, before, after, rotation_before, rotation_after, change_t};
}

bool CalibrationResult::accepted() const {
  return std::all_of(acceptance.begin(), acceptance.end(),
                     [](const AcceptanceCheck& check) { return check.met(); });
}

bool CalibrationResult::IsUsable() const {
  return status == CalibrationStatus::kDone ||
         status == CalibrationStatus::kMissedLimits;
}

bool CalibrationResult::IsRejected() const {
  return status == CalibrationStatus::kFailed && !runs.empty() &&
         runs.front().summary.IsSolutionUsable();
}

const ParameterResult& CalibrationResult::Parameter(
    const std::string& name) const {
  const auto found = std::find_if(
      parameters.begin(), parameters.end(),
      [&name](const ParameterResult& one) { return one.name == name; });
  CHECK(found != parameters.end()) << "no parameter \"" << name << '"';
  return *found;
}

namespace {

// The worst, a line each.
std::string DescribeOutliers(const std::vector<Outlier>& outliers) {
  constexpr std::size_t kMost = 10;
  std::string text;
  for (std::size_t k = 0; k < std::min(kMost, outliers.size()); ++k) {
    const Outlier& one = outliers[k];
    const std::string where =
        one.label.where.empty() ? "" : " (" + one.label.where + ")";
    text += "outlier: pose " + std::to_string(one.label.pose + 1) + where +
            ", " + FormatLength(one.error) + ", weight " +
            FormatSignificant(one.weight, 2) + "\n";
  }
  if (outliers.size() > kMost) {
    text +=
        "and " +
        Count(static_cast<std::int64_t>(outliers.size() - kMost), "outlier") +
        " more\n";
  }
  return text;
}

// Every set of error terms: its weight, and its mean and largest error.
std::string DescribeRungs(const CalibrationResult& result) {
  if (!result.error_terms) return "";
  const ErrorTermsResult& errors = *result.error_terms;
  std::string text = errors.sentence + "\n";
  if (errors.rungs.empty()) return text;
  using Align = TextTable::Align;
  TextTable table(
      {{"model"},
       {"terms", Align::kRight},
       {"weight", Align::kRight},
       {"left-out regions mm", Align::kRight},
       {result.validation ? "validation mean mm" : "training mean mm",
        Align::kRight},
       {"max mm", Align::kRight}});
  const auto add = [&](const std::string& name, const std::string& terms,
                       const std::string& weight, double region,
                       const Accuracy& accuracy) {
    const auto shown = [](double metres) {
      return metres > 0.0 ? FormatSignificant(metres / kMillimetre, 3) : "-";
    };
    table.AddRow({name, terms, weight, shown(region), shown(accuracy.mean),
                  shown(accuracy.max)});
  };
  for (const ErrorRung& rung : errors.rungs) {
    add(rung.name, std::to_string(rung.num_terms),
        FormatSignificant(rung.weight, 2), rung.region_error,
        result.validation ? rung.validation : rung.train);
  }
  add("delivered", "", "", errors.region_error,
      (result.validation ? *result.validation : result.train).after);
  return text + table.ToString();
}

}  // namespace

ConfidenceInterval CalibrationResult::Interval(const std::string& name) const {
  if (!uncertainty) return {};
  const auto& all = uncertainty->parameters;
  const auto found = std::find_if(
      all.begin(), all.end(),
      [&name](const ParameterUncertainty& one) { return one.name == name; });
  return found == all.end() ? ConfidenceInterval() : found->interval;
}

std::string CalibrationResult::BriefReport() const {
  std::string text = arm_name.empty() ? "" : arm_name + ": ";
  text += ToString(status);
  if (!message.empty()) text += ": " + message;
  if (!IsUsable()) return text;
  const KeptErrors set = (validation ? *validation : train).Judged();
  return text + "; rms error at " + (validation ? "validation" : "training") +
         " poses " + FormatLength(set.before.rms) + " before, " +
         FormatLength(set.after.rms) + " after" +
         (set.num_rejected == 0
              ? ""
              : ", without " + Count(set.num_rejected, "rejected observation"));
}

std::string CalibrationResult::FullReport() const {
  std::string text = BriefReport() + "\n";
  if (!IsUsable()) return text;
  text += verdict.title + ": " + verdict.sentence + "\n";
  const auto add = [&text](const char* set, const EvaluatedSet& errors) {
    text += std::string(set) + " before: " + FormatAccuracy(errors.before) +
            "\n" + set + " after:  " + FormatAccuracy(errors.after) + "\n";
  };
  add("training poses", train);
  if (validation) add("validation poses", *validation);
  using Align = TextTable::Align;
  TextTable table({{"parameter"},
                   {"nominal", Align::kRight},
                   {"value", Align::kRight},
                   {"std", Align::kRight},
                   {"unit"}});
  constexpr int kDecimals = 6;
  for (const ParameterResult& one : parameters) {
    if (one.decision.state != ParameterState::kFree) continue;
    const auto format = [&one](double value) {
      return FormatParameter(value, one.dimension, kDecimals);
    };
    table.AddRow({one.name, format(one.nominal), format(one.value),
                  format(one.std), UnitForPeople(one.dimension)});
  }
  text += table.ToString();
  text += DescribeRungs(*this);
  text += DescribeOutliers(outliers);
  for (const std::string& warning : warnings) {
    text += "warning: " + warning + "\n";
  }
  return text;
}

const char* ToString(CalibrationStatus status) {
  switch (status) {
    case CalibrationStatus::kNotRun:
      return "not run";
    case CalibrationStatus::kDone:
      return "calibrated";
    case CalibrationStatus::kMissedLimits:
      return "calibrated, but not within the acceptance limits";
    case CalibrationStatus::kRefused:
      return "refused";
    case CalibrationStatus::kFailed:
      return "failed";
  }
  return "";
}

}  // namespace alidade
