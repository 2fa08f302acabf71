#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "src/report/html_json.h"
#include "src/report/html_page.h"
#include "src/report/html_report.h"

namespace alidade::internal {
namespace {

constexpr std::size_t kMostResults = 2000;
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

// Which parameters there are: shared by results of the same nominal arm.
// Nominal values of base and tool are where frames alone put them, and no two
// results agree in them.
std::string LayoutJson(const std::vector<ParameterResult>& parameters) {
  std::string names, units, kinds, nominals;
  for (const ParameterResult& parameter : parameters) {
    const std::string comma = names.empty() ? "" : ",";
    const std::string& kind = parameter.kind;
    const bool is_joint = kind == "beta" || kind == "alpha" || kind == "d" ||
                          kind == "theta" || kind == "r";
    names += comma + JsonText(parameter.name);
    units += comma +
             (parameter.dimension == Dimension::kAngle ? "\"rad\"" : "\"m\"");
    kinds += comma + JsonText(kind);
    nominals +=
        comma +
        (is_joint ? JsonNumber(parameter.nominal, kParameterDigits) : "null");
  }
  return "{\"names\":[" + names + "],\"units\":[" + units + "],\"kinds\":[" +
         kinds + "],\"nominal\":[" + nominals + "]}";
}

// What is known of the standard deviation of parameter `i`.
double StdOf(const CalibrationResult& result, std::size_t i) {
  const ParameterResult& parameter = result.parameters[i];
  if (result.uncertainty) {
    for (const ParameterUncertainty& known : result.uncertainty->parameters) {
      if (known.name == parameter.name) return known.std;
    }
  }
  return std::isfinite(parameter.std) ? parameter.std
                                      : parameter.decision.predicted_std;
}

std::string ParametersJson(const CalibrationResult& result) {
  std::string deviations, stds, states;
  for (std::size_t i = 0; i < result.parameters.size(); ++i) {
    const ParameterResult& parameter = result.parameters[i];
    const std::string comma = i > 0 ? "," : "";
    deviations += comma + JsonNumber(parameter.deviation(), kParameterDigits);
    stds += comma + JsonNumber(StdOf(result, i), kStdDigits);
    states += parameter.decision.state == ParameterState::kFree     ? 'f'
              : parameter.decision.state == ParameterState::kFrozen ? 'h'
                                                                    : 'g';
  }
  return ",\"deviation\":[" + deviations + "],\"std\":[" + stds +
         "],\"states\":\"" + states + "\"";
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

std::string ListJson(const std::vector<std::string>& items) {
  std::string json = "[";
  for (const std::string& item : items) {
    if (json.back() != '[') json += ",\n";
    json += item;
  }
  return json + "]";
}

const char* KeyOf(ComparisonKind kind) {
  switch (kind) {
    case ComparisonKind::kFleet:
      return "fleet";
    case ComparisonKind::kTime:
      return "time";
    case ComparisonKind::kWays:
      return "ways";
  }
  return "fleet";
}

}  // namespace

ComparisonItem DescribeForComparison(const std::string& label,
                                     const CalibrationResult& result,
                                     const std::string& link) {
  const auto missed =
      std::count_if(result.acceptance.begin(), result.acceptance.end(),
                    [](const AcceptanceCheck& check) { return !check.met(); });
  ComparisonItem item;
  item.version = result.version;
  item.data = DataKey(result);
  item.layout = LayoutJson(result.parameters);
  item.head = "{\"label\":" + JsonText(label) +
              ",\"title\":" + JsonText(result.title) +
              ",\"arm\":" + JsonText(result.arm_name) +
              (link.empty() ? "" : ",\"href\":" + JsonText(link));
  item.tail =
      Integer("limits", static_cast<std::int64_t>(result.acceptance.size())) +
      Integer("missed", missed) +
      Integer("warnings", static_cast<std::int64_t>(result.warnings.size())) +
      Integer("num_free", result.identifiability.num_free) +
      ",\"runs\":" + RunsJson(result.runs) +
      ",\"train\":" + SetJson(result.train);
  if (result.heldout && result.heldout->after.n > 0) {
    item.tail += ",\"heldout\":" + SetJson(*result.heldout);
  }
  item.tail += ParametersJson(result) + "}";
  return item;
}

void ComparisonPage::Add(const ComparisonItem& item) {
  version_ = item.version;
  data_.push_back(item.data);
  if (results_.size() >= kMostResults) {
    ++left_out_;
    return;
  }
  const auto found = std::find(layouts_.begin(), layouts_.end(), item.layout);
  results_.push_back(item.head + Integer("layout", found - layouts_.begin()) +
                     item.tail);
  if (found == layouts_.end()) layouts_.push_back(item.layout);
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
  return same_data ? ComparisonKind::kWays : ComparisonKind::kFleet;
}

std::string ComparisonPage::Render(ComparisonKind kind) const {
  const std::string data =
      "{\"format\":\"alidade-page-1\",\"page\":\"comparison\","
      "\"comparison\":{\"kind\":\"" +
      std::string(KeyOf(kind)) + "\",\"version\":" + JsonText(version_) +
      ",\"left_out\":" + std::to_string(left_out_) +
      ",\"layouts\":" + ListJson(layouts_) +
      ",\"failures\":" + ListJson(failures_) +
      ",\"results\":" + ListJson(results_) + "}}";
  return FillPage("Alidade: results compared", data,
                  "Several results, compared. summary.csv and each result's "
                  "report.txt hold the numbers.\n");
}

}  // namespace alidade::internal
