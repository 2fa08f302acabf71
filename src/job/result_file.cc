#include "alidade/result_file.h"

#include <filesystem>
#include <utility>

#include "src/job/report_page.h"
#include "src/job/result_directory.h"
#include "src/job/result_table.h"
#include "src/job/run_job.h"
#include "src/report/report.h"
#include "src/serialization/result_json.h"

namespace alidade {
namespace {

std::vector<NamedFile> AsNamed(const std::vector<internal::ReportFile>& files) {
  std::vector<NamedFile> named;
  for (const internal::ReportFile& file : files) {
    named.push_back({file.name, file.Text()});
  }
  return named;
}

}  // namespace

CalibrationResult LoadResult(const std::string& path) {
  const std::string json = internal::ResultJsonOf(path);
  CalibrationResult result = internal::LoadResultJson(json);
  internal::ReadResultTables(std::filesystem::path(json).parent_path().string(),
                             &result);
  // Only of these are results written that are neither accepted nor rejected.
  result.status = CalibrationStatus::kDone;
  for (const AcceptanceCheck& check : result.acceptance) {
    if (!check.met()) result.status = CalibrationStatus::kMissedLimits;
  }
  if (result.verdict.decision() == VerdictDecision::kRejected &&
      result.status == CalibrationStatus::kDone) {
    result.status = CalibrationStatus::kFailed;
  }
  return result;
}

std::string FormatResult(const CalibrationResult& result) {
  return internal::FormatResultJson(result);
}

CalibrationResult ParseResult(const std::string& text) {
  return internal::ParseResultJson(text, "result.json");
}

std::string ReportText(const CalibrationResult& result) {
  return internal::FormatReport(result);
}

std::string ReportPage(const CalibrationResult& result) {
  return internal::MakeResultPage(result).Text();
}

std::string FormatResult(const IdentifiabilityResult& result) {
  return internal::FormatIdentifiabilityJson(result);
}

std::string ReportText(const IdentifiabilityResult& result) {
  return internal::FormatIdentifiability(result);
}

std::string FormatResult(const PlanResult& result) {
  return internal::FormatPlanJson(result);
}

std::string ReportText(const PlanResult& result) {
  return internal::FormatPlanSummary(result);
}

std::vector<NamedFile> FilesOf(const PlanResult& result) {
  return AsNamed(internal::RenderPlan(result));
}

std::string ReportText(const MonteCarloResult& result) {
  return internal::FormatMonteCarlo(result);
}

std::vector<NamedFile> FilesOf(const MonteCarloResult& result) {
  return AsNamed(internal::MakeMonteCarloFiles(result));
}

std::vector<std::string> SaveFiles(const std::vector<NamedFile>& files,
                                   const std::string& directory) {
  std::vector<internal::ReportFile> written;
  for (const NamedFile& file : files) {
    written.emplace_back(file.name, file.content);
  }
  return internal::WriteResultDirectory(directory, written);
}

}  // namespace alidade
