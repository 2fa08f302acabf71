// Calibrates the Mitsubishi RV-2AJ as its published study does, and sets the
// study's tables and figures beside ours.

#include <glog/logging.h>

#include <exception>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include "alidade/error.h"
#include "alidade/job.h"
#include "studies/rv2aj/study.h"
#include "studies/rv2aj/study_report.h"

namespace alidade::rv2aj {
namespace {

constexpr char kUsage[] =
    "usage: rv2aj_study JOB.yaml [--out=DIR] [--threads=N] [--seed=N]";

// The exit status, as that of `alidade calibrate`.
int Run(const std::vector<std::string>& arguments) {
  std::string command = "rv2aj_study";
  std::string path;
  std::map<std::string, std::string> flags = {
      {"--out", "results/rv2aj_study"}, {"--threads", "1"}, {"--seed", ""}};
  for (const std::string& argument : arguments) {
    command += " " + argument;
    const std::size_t equals = argument.find('=');
    const auto flag = flags.find(argument.substr(0, equals));
    if (flag != flags.end() && equals != std::string::npos) {
      flag->second = argument.substr(equals + 1);
    } else if (path.empty() && argument[0] != '-') {
      path = argument;
    } else {
      throw InputError({}, kUsage);
    }
  }
  if (path.empty()) throw InputError({}, kUsage);
  Job job = LoadJob(path, std::stoi(flags["--threads"]));
  if (!flags["--seed"].empty()) {
    job.options.identifiability.seed = std::stoull(flags["--seed"]);
  }
  if (!job.published || !job.data.validation || !job.options.true_values) {
    throw InputError({path, 0, 0, ""},
                     "is not of a study: expected `published`, `validation` "
                     "and `truth`");
  }
  const CalibrationResult result = RunJob(job, command);
  if (!result.IsUsable()) {
    std::cerr << "rv2aj_study: " << path << ": " << result.message << "\n";
    return 3;
  }
  // The calibrations that are timed warn of the same as the first.
  FLAGS_minloglevel = google::GLOG_ERROR;
  const StudyResult study = CompareWithStudy(job, result);
  SaveOptions options;
  options.sections = {MakeStudySection(study, Figures(result))};
  options.files = {{"study.json", FormatStudyJson(study)}};
  options.report_page = true;
  const auto paths = Save(result, flags["--out"], options);
  std::cout << result.title << "\n\n"
            << AccuracyTable(result) << "\n"
            << FormatSection(options.sections[0]) << "\nResults\n";
  for (const std::string& written : paths) std::cout << "  " << written << "\n";
  if (result.status != CalibrationStatus::kMissedLimits) return 0;
  std::cerr << "rv2aj_study: " << path << ": " << result.message << "; "
            << flags["--out"] << "/report.txt says which\n";
  return 1;
}

}  // namespace
}  // namespace alidade::rv2aj

int main(int argc, char** argv) {
  FLAGS_logtostderr = true;
  FLAGS_log_prefix = false;
  FLAGS_minloglevel = google::GLOG_WARNING;
  google::InitGoogleLogging(argv[0]);
  try {
    return alidade::rv2aj::Run({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    std::cerr << "rv2aj_study: " << error.what() << "\n";
    return 2;
  }
}
