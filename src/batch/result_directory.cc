#include "alidade/batch/result_directory.h"

#include "alidade/io/arm_file.h"
#include "alidade/io/files.h"
#include "alidade/io/result_json.h"

namespace alidade {
namespace {

std::string ArmComment(const JobResult& result) {
  return "Calibrated by alidade " + result.version + ": " + result.title;
}

void Append(std::vector<ReportFile> more, std::vector<ReportFile>* files) {
  for (ReportFile& file : more) files->push_back(std::move(file));
}

ReportFile RenderArm(const JobOutcome& outcome) {
  return {"arm.yaml",
          FormatArm(outcome.calibrated, ArmComment(outcome.result))};
}

}  // namespace

std::vector<ReportFile> RenderResult(const JobOutcome& outcome) {
  const JobResult& result = outcome.result;
  std::vector<ReportFile> files;
  files.push_back(RenderArm(outcome));
  files.push_back({"report.txt", FormatReport(result)});
  Append(MakeCsvFiles(result), &files);
  Append(MakeFigures(result), &files);
  Append(MakeUncertaintyFiles(result), &files);
  Append(MakeIdentifiabilityFigures(result.identifiability), &files);
  files.push_back({"result.json", FormatResultJson(result)});
  return files;
}

std::vector<ReportFile> RenderResult(const JobOutcome& outcome,
                                     JobOutputs outputs) {
  if (outputs == JobOutputs::kFull) return RenderResult(outcome);
  return {RenderArm(outcome),
          {"result.json", FormatResultJson(outcome.result)}};
}

std::vector<std::string> WriteResultDirectory(
    const std::string& directory, const std::vector<ReportFile>& files) {
  MakeDirectories(directory);
  std::vector<std::string> paths;
  for (const ReportFile& file : files) {
    paths.push_back(directory + "/" + file.name);
    WriteFileAtomically(paths.back(), file.content);
  }
  return paths;
}

}  // namespace alidade
