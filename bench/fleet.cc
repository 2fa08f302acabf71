// Calibrates the arms of Universal Robots whose factory calibrations are known,
// on simulated measurements, each into a result directory with its page, and
// sets them beside one another on one page.
//
// Usage: fleet DATA_DIRECTORY OUT   (the folder ur_factory_calibrations)

#include <cctype>
#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

#include "alidade/error.h"
#include "bench/study_main.h"
#include "bench/ur_factory_arms.h"
#include "src/common/files.h"
#include "src/job/report_page.h"
#include "src/job/result_directory.h"
#include "src/job/run_job.h"

namespace alidade::internal {
namespace {

constexpr int kPoses = 60;
constexpr int kValidation = 40;
constexpr int kThreads = 2;
constexpr std::uint64_t kSeed = 301;
constexpr std::uint64_t kSeedsOfArm = 4;

// "UR5e pearl_ur5e": the model and the last part of the repository's name.
std::string LabelOf(const FactoryArm& arm) {
  const std::size_t slash = arm.repository.rfind('/');
  return arm.model + " " +
         (slash == std::string::npos ? arm.repository
                                     : arm.repository.substr(slash + 1));
}

std::string DirectoryName(const std::string& label) {
  std::string name;
  for (const char c : label) {
    const bool keep = std::isalnum(static_cast<unsigned char>(c)) || c == '-';
    name += keep ? c : '_';
  }
  return name;
}

JobConfig JobOf(const FactoryArm& arm, const std::string& label,
                std::uint64_t seed) {
  JobConfig job;
  job.title = label + ", simulated measurements";
  job.arm = arm.nominal;
  job.arm.name = arm.model;
  job.data.training =
      MeasureArm(arm.real, MeasurementKind::kPosition, kPoses, seed);
  job.data.training.name = "simulated, " + std::to_string(kPoses) + " poses";
  job.data.validation = MeasureArm(arm.real, MeasurementKind::kPosition,
                                   kValidation, seed + kSeedsOfArm / 2);
  job.data.validation->name =
      "simulated, " + std::to_string(kValidation) + " poses";
  job.options.identifiability.candidates = {true, true, true};
  job.options.num_threads = kThreads;
  return job;
}

bool Run(const std::vector<std::string>& arguments) {
  if (arguments.size() != 2) return false;
  const std::string& out = arguments[1];
  const std::string page_path = out + "/comparison.html";
  ComparisonPage page;
  std::uint64_t seed = kSeed;
  for (const FactoryArm& arm : LoadFactoryArms(arguments[0])) {
    const std::string label = LabelOf(arm);
    const std::string directory = out + "/" + DirectoryName(label);
    try {
      const CalibrationResult outcome =
          RunJob(JobOf(arm, label, seed), "scripts/fleet");
      if (!outcome.message.empty()) {
        page.AddFailure(label, outcome.message);
      } else {
        std::vector<ReportFile> files = RenderResult(outcome);
        files.insert(files.end() - 1, MakeResultPage(outcome));
        WriteResultDirectory(directory, files);
        AddToComparison(directory, label, page_path, &page);
      }
    } catch (const InputError& error) {
      page.AddFailure(label, error.what());
    }
    seed += kSeedsOfArm;
  }
  WriteFileAtomically(page_path, page.Render(ComparisonKind::kFleet));
  std::cout << page_path << std::endl;
  return true;
}

}  // namespace
}  // namespace alidade::internal

int main(int argc, char** argv) {
  return alidade::internal::bench::StudyMain(
      argc, argv, "fleet DATA_DIRECTORY OUT", alidade::internal::Run);
}
