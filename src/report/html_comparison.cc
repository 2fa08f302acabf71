#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "alidade/comparison.h"
#include "src/common/text.h"
#include "src/report/html_json.h"
#include "src/report/html_page.h"
#include "src/report/html_report.h"

namespace alidade::internal {
namespace {

constexpr std::size_t kMostResults = 2000;
constexpr std::size_t kMostChanges = 500;
constexpr int kErrorDigits = 5;
constexpr int kParameterDigits = 9;
constexpr int kStdDigits = 4;

std::string AccuracyJson(const Accuracy& accuracy) {
  return "{\"mean\":" + JsonNumber(accuracy.mean, kErrorDigits) +
         ",\"rms\":" + JsonNumber(accuracy.rms, kErrorDigits) +
         ",\"max\":" + JsonNumber(accuracy.max, kErrorDigits) +
         ",\"n\":" + std::to_string(accuracy.n) + "}";
}

std::string SetJson(const EvaluatedSet& set) {
  return "{\"before\":" + AccuracyJson(set.before) +
         ",\"after\":" + AccuracyJson(set.after) + "}";
}

std::string Integer(const std::string& name, std::int64_t value) {
  return ",\"" + name + "\":" + std::to_string(value);
}

std::string UnitJson(Dimension dimension) {
  return dimension == Dimension::kAngle ? ",\"unit\":\"rad\""
                                        : ",\"unit\":\"m\"";
}

std::string VerdictJson(FindingLevel level, const std::string& title,
                        const std::string& sentence) {
  return "{\"level\":" + JsonText(ToString(level)) +
         ",\"title\":" + JsonText(title) +
         ",\"sentence\":" + JsonText(sentence) + "}";
}

// Why an arm is an outlier.
std::string ReasonsJson(const FleetArm& arm) {
  std::string json = "[";
  for (const Finding& finding : arm.findings) {
    if (finding.level != FindingLevel::kAttention) continue;
    json += (json.back() == '[' ? "" : ",") + JsonText(finding.sentence);
  }
  return json + "]";
}

std::string RunsJson(const std::vector<SolverRun>& runs) {
  std::string json = "[";
  for (const SolverRun& run : runs) {
    const SolverSummary& summary = run.summary;
    if (json.back() != '[') json += ",";
    json +=
        "{\"name\":" + JsonText(summary.solver) +
        ",\"status\":" + JsonText(ToString(summary.status)) +
        Integer("iterations", summary.iterations.empty()
                                  ? 0
                                  : summary.iterations.back().iteration) +
        ",\"cost\":" + JsonNumber(summary.final_cost, kErrorDigits) +
        ",\"time_s\":" +
        JsonNumber(summary.setup_time_s + summary.solve_time_s, kStdDigits) +
        ",\"train\":" + AccuracyJson(run.train) + "}";
  }
  return json + "]";
}

// The same for results of the same measurements of the same arm: the job's own
// file, the first, may differ.
std::string DataKey(const CalibrationResult& result) {
  std::vector<std::string> hashes;
  for (std::size_t i = 1; i < result.inputs.size(); ++i) {
    hashes.push_back(result.inputs[i].sha256);
  }
  std::sort(hashes.begin(), hashes.end());
  std::string key = result.arm_name;
  for (const std::string& hash : hashes) key += " " + hash;
  return key;
}

// `item` makes JSON of each.
template <typename Items, typename Item>
std::string ListJson(const Items& items, const Item& item) {
  std::string json = "[";
  for (const auto& each : items) {
    if (json.back() != '[') json += ",";
    json += item(each);
  }
  return json + "]";
}

// Results and arms have lines of their own.
std::string LineOf(const std::string& json) { return "\n" + json; }

std::string NumbersJson(const std::vector<double>& numbers, int digits) {
  return ListJson(
      numbers, [digits](double number) { return JsonNumber(number, digits); });
}

template <typename Summary>
std::string VerdictJson(const Summary& summary) {
  return "{\"threshold\":" + JsonNumber(Summary::kThreshold, kStdDigits) +
         ",\"verdict\":" +
         VerdictJson(summary.level, summary.title, summary.sentence);
}

// One column of a table of arms and parameters.
std::vector<double> ValuesOf(const FleetSummary& fleet, std::size_t result,
                             std::vector<double> RobustScores::*values) {
  std::vector<double> row;
  for (const FleetParameter& parameter : fleet.parameters) {
    row.push_back((parameter.deviations.*values)[result]);
  }
  return row;
}

std::string ArmJson(const FleetSummary& fleet, const FleetArm& arm) {
  const std::size_t i = arm.result;
  return "{\"result\":" + std::to_string(i) +
         ",\"outlier\":" + (arm.is_outlier ? "true" : "false") +
         ",\"scores\":" +
         NumbersJson({fleet.before.scores[i], fleet.after.scores[i],
                      fleet.geometry.scores[i]},
                     kStdDigits) +
         ",\"reasons\":" + ReasonsJson(arm) + ",\"most\":" +
         (arm.most_different ? std::to_string(*arm.most_different) : "null") +
         ",\"deviations\":" +
         NumbersJson(ValuesOf(fleet, i, &RobustScores::values), kErrorDigits) +
         ",\"parameter_scores\":" +
         NumbersJson(ValuesOf(fleet, i, &RobustScores::scores), kStdDigits) +
         "}";
}

std::string FleetJson(const FleetSummary& fleet) {
  return VerdictJson(fleet) +
         ",\"small\":" + (fleet.is_small ? "true" : "false") +
         ",\"parameters\":" +
         ListJson(fleet.parameters,
                  [](const FleetParameter& parameter) {
                    return "{\"name\":" + JsonText(parameter.name) +
                           UnitJson(parameter.dimension) + "}";
                  }) +
         ",\"arms\":" +
         ListJson(fleet.arms,
                  [&fleet](const FleetArm& arm) {
                    return LineOf(ArmJson(fleet, arm));
                  }) +
         "}";
}

std::string ChangeJson(const ParameterChange& change) {
  return LineOf(
      "{\"name\":" + JsonText(change.name) + UnitJson(change.dimension) +
      ",\"from\":" + std::to_string(change.from) +
      ",\"before\":" + JsonNumber(change.before, kParameterDigits) +
      ",\"after\":" + JsonNumber(change.after, kParameterDigits) +
      ",\"difference\":" + JsonNumber(change.difference(), kErrorDigits) +
      ",\"std\":" + JsonNumber(change.std, kStdDigits) +
      ",\"score\":" + JsonNumber(change.score(), kErrorDigits) +
      ",\"significant\":" + (change.is_significant ? "true" : "false") + "}");
}

std::string DriftJson(DriftSummary drift) {
  const std::size_t all = drift.changes.size();
  if (all > kMostChanges) drift.changes.resize(kMostChanges);
  return VerdictJson(drift) + ",\"total\":" + std::to_string(all) +
         ",\"changes\":" + ListJson(drift.changes, ChangeJson) + "}";
}

std::string MethodsJson(const MethodSummary& methods) {
  return "{\"verdict\":" +
         VerdictJson(methods.level, methods.title, methods.sentence) +
         ",\"ranking\":" +
         ListJson(methods.ranking,
                  [](std::size_t place) { return std::to_string(place); }) +
         "}";
}

const char* ComparisonKey(ComparisonKind kind) {
  switch (kind) {
    case ComparisonKind::kFleet:
      return "fleet";
    case ComparisonKind::kTime:
      return "time";
    case ComparisonKind::kMethods:
      return "methods";
  }
  return "fleet";
}

}  // namespace

ComparisonItem MakeComparisonItem(const std::string& label,
                                  const CalibrationResult& result,
                                  const std::string& link) {
  const auto missed =
      std::count_if(result.acceptance.begin(), result.acceptance.end(),
                    [](const AcceptanceCheck& check) { return !check.met(); });
  ComparisonItem item;
  item.values = DescribeForComparison(label, result);
  item.version = result.version;
  item.data = DataKey(result);
  item.json =
      "{\"label\":" + JsonText(label) + ",\"title\":" + JsonText(result.title) +
      ",\"arm\":" + JsonText(result.arm_name) +
      (link.empty() ? "" : ",\"href\":" + JsonText(link)) +
      Integer("limits", static_cast<std::int64_t>(result.acceptance.size())) +
      Integer("missed", missed) +
      Integer("warnings", static_cast<std::int64_t>(result.warnings.size())) +
      Integer("num_free", result.identifiability.num_free) +
      ",\"runs\":" + RunsJson(result.runs) +
      ",\"train\":" + SetJson(result.train);
  if (result.heldout && result.heldout->after.n > 0) {
    item.json += ",\"heldout\":" + SetJson(*result.heldout);
  }
  item.json += "}";
  return item;
}

void ComparisonPage::Add(ComparisonItem item) {
  version_ = item.version;
  data_.push_back(std::move(item.data));
  if (results_.size() >= kMostResults) {
    ++left_out_;
    return;
  }
  results_.push_back(std::move(item.json));
  values_.push_back(std::move(item.values));
}

void ComparisonPage::AddFailure(const std::string& label,
                                const std::string& message) {
  failures_.push_back("{\"label\":" + JsonText(label) +
                      ",\"message\":" + JsonText(message) + "}");
}

ComparisonKind ComparisonPage::GuessKind() const {
  const bool same_data =
      data_.size() > 1 &&
      std::all_of(data_.begin(), data_.end(), [this](const std::string& key) {
        return key == data_.front();
      });
  return same_data ? ComparisonKind::kMethods : ComparisonKind::kFleet;
}

std::string ComparisonPage::Sentence(ComparisonKind kind) const {
  switch (kind) {
    case ComparisonKind::kFleet:
      return CompareFleet(values_, static_cast<std::int64_t>(failures_.size()))
          .sentence;
    case ComparisonKind::kTime:
      return CompareOverTime(values_).sentence;
    case ComparisonKind::kMethods:
      return CompareMethods(values_).sentence;
  }
  return "";
}

std::string ComparisonPage::Render(ComparisonKind kind) const {
  const FleetSummary fleet =
      CompareFleet(values_, static_cast<std::int64_t>(failures_.size()));
  const DriftSummary drift = CompareOverTime(values_);
  const MethodSummary methods = CompareMethods(values_);
  const std::string data =
      "{\"format\":\"alidade-page-1\",\"page\":\"comparison\","
      "\"comparison\":{\"kind\":\"" +
      std::string(ComparisonKey(kind)) +
      "\",\"version\":" + JsonText(version_) +
      ",\"left_out\":" + std::to_string(left_out_) +
      ",\"fleet\":" + FleetJson(fleet) + ",\"time\":" + DriftJson(drift) +
      ",\"methods\":" + MethodsJson(methods) +
      ",\"failures\":" + ListJson(failures_, LineOf) +
      ",\"results\":" + ListJson(results_, LineOf) + "}}";
  const std::string text = Paragraph(Sentence(kind)) +
                           "The report.txt of each result holds its numbers.\n";
  return FillPage("Alidade: results compared", data, text);
}

}  // namespace alidade::internal
