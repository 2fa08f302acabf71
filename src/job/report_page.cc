#include "src/job/report_page.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "src/job/arm_shapes.h"
#include "src/job/result_directory.h"
#include "src/job/result_table.h"
#include "src/report/result_page.h"
#include "src/serialization/result_json.h"

namespace alidade::internal {
namespace {

namespace fs = std::filesystem;

fs::path DirectoryOf(const std::string& path) {
  return fs::absolute(fs::path(ResultJsonOf(path)))
      .lexically_normal()
      .parent_path();
}

// The directory of a result by its path alone: "a", "a/" and "a/result.json"
// name the same.
fs::path NamedDirectory(const std::string& path) {
  const fs::path whole = fs::absolute(path).lexically_normal();
  const bool is_inside = whole.extension() == ".json" || !whole.has_filename();
  return is_inside ? whole.parent_path() : whole;
}

}  // namespace

ReportFile MakeResultPage(const CalibrationResult& result,
                          const std::vector<PageSection>& further) {
  return {"report.html",
          RenderResultPage(result, FormatResultJson(result), further,
                           ShapesOf(result.inputs, result.arm))};
}

std::string ResultPageOf(const std::string& path,
                         const std::vector<PageSection>& further) {
  CalibrationResult result = LoadResultJson(ResultJsonOf(path));
  ReadResultTables(DirectoryOf(path).string(), &result);
  return RenderResultPage(result, FormatResultJson(result), further,
                          ShapesOf(result.inputs, result.arm));
}

void AddToComparison(const std::string& path, const std::string& label,
                     const std::string& page_path, ComparisonPage* page) {
  const fs::path report = DirectoryOf(path) / "report.html";
  std::string link;
  if (fs::exists(report)) {
    const fs::path from = fs::absolute(page_path).lexically_normal();
    link = report.lexically_relative(from.parent_path()).generic_string();
  }
  page->Add(label, LoadResultJson(ResultJsonOf(path)), link);
}

std::vector<std::string> ResultLabels(const std::vector<std::string>& paths) {
  std::vector<fs::path> rest;
  std::vector<std::string> labels;
  for (const std::string& path : paths) {
    const fs::path directory = NamedDirectory(path);
    labels.push_back(directory.filename().string());
    rest.push_back(directory.parent_path());
  }
  const auto all_differ = [&labels] {
    return std::set<std::string>(labels.begin(), labels.end()).size() ==
           labels.size();
  };
  // The same directory twice never differs: stop at the root.
  while (!all_differ() &&
         std::any_of(rest.begin(), rest.end(), [](const fs::path& left) {
           return left.has_relative_path();
         })) {
    for (std::size_t i = 0; i < labels.size(); ++i) {
      if (!rest[i].has_relative_path()) continue;
      labels[i] = rest[i].filename().string() + "/" + labels[i];
      rest[i] = rest[i].parent_path();
    }
  }
  return labels;
}

}  // namespace alidade::internal
