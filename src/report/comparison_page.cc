#include "src/report/comparison_page.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "src/common/text.h"
#include "src/report/markup.h"
#include "src/report/page.h"
#include "src/report/table.h"

namespace alidade::internal {
namespace {

constexpr std::size_t kMostResults = 2000;

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

template <typename Summary>
PageChoice MakeChoice(const std::string& title, const Summary& summary,
                      const std::string& view) {
  return {title,
          Element("h1", {}, title) +
              HtmlVerdict(summary.level, summary.title, summary.sentence) +
              view};
}

}  // namespace

ComparisonItem MakeComparisonItem(const std::string& label,
                                  const CalibrationResult& result,
                                  const std::string& link) {
  ComparisonItem item;
  item.values = DescribeForComparison(label, result);
  item.version = result.version;
  item.data = DataKey(result);
  item.link = link;
  item.num_free = result.identifiability.num_free;
  item.num_limits = static_cast<std::int64_t>(result.acceptance.size());
  item.num_missed =
      std::count_if(result.acceptance.begin(), result.acceptance.end(),
                    [](const AcceptanceCheck& check) { return !check.met(); });
  item.num_warnings = static_cast<std::int64_t>(result.warnings.size());
  for (const SolverRun& run : result.runs) {
    const SolverSummary& summary = run.summary;
    item.runs.push_back(
        {summary.solver, summary.status,
         summary.iterations.empty() ? 0 : summary.iterations.back().iteration,
         summary.final_cost, run.train.mean,
         summary.setup_time_s + summary.solve_time_s});
  }
  return item;
}

void ComparisonPage::Add(ComparisonItem item) {
  version_ = item.version;
  data_.push_back(std::move(item.data));
  if (items_.size() >= kMostResults) return;
  values_.push_back(std::move(item.values));
  items_.push_back(std::move(item));
}

void ComparisonPage::AddFailure(const std::string& label,
                                const std::string& message) {
  failures_.push_back({label, message});
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
  const ComparedItems all = {values_, items_};
  const FleetSummary fleet =
      CompareFleet(values_, static_cast<std::int64_t>(failures_.size()));
  const DriftSummary drift = CompareOverTime(values_);
  const MethodSummary methods = CompareMethods(values_);
  const bool is_empty = values_.empty();
  // In the order of ComparisonKind.
  const std::vector<PageChoice> choices = {
      MakeChoice("A fleet of arms", fleet,
                 is_empty ? "" : FleetView(all, fleet)),
      MakeChoice("One arm over time", drift,
                 is_empty ? "" : TimeView(all, drift)),
      MakeChoice(methods.are_runs() ? "Runs on the same data"
                                    : "Methods on the same data",
                 methods, is_empty ? "" : MethodsView(all, methods))};
  const auto shown = static_cast<std::size_t>(kind);
  std::string content = HtmlChoices("read-as", "Read as", choices, shown);
  Table failures("failures",
                 "Failed (" + std::to_string(failures_.size()) + ")",
                 {"job", "~message"});
  for (const auto& [label, message] : failures_) {
    failures.AddRow({label, message});
  }
  content += failures.ToHtml();
  const std::size_t left_out = data_.size() - items_.size();
  if (left_out > 0) {
    content +=
        HtmlNote(Count(static_cast<std::int64_t>(left_out), "further result") +
                 (left_out == 1 ? " is" : " are") + " not on this page.");
  }
  content += HtmlFooter(version_);
  return FillPage(choices[shown].label + " – Alidade", content, {});
}

}  // namespace alidade::internal
