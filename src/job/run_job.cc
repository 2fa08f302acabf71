#include "src/job/run_job.h"

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "src/calibration/calibration_task.h"
#include "src/common/bytes.h"
#include "src/common/files.h"
#include "src/job/study.h"

namespace alidade::internal {
namespace {

// Every file by a rank that has read it.
std::vector<InputFile> HashInputs(const JobConfig& job) {
  std::vector<InputFile> files;
  std::vector<std::string> mine;
  for (std::size_t k = 0; k < job.input_files.size(); ++k) {
    const bool is_mine =
        (job.readers.empty() ? 0 : job.readers[k]) == job.communicator->rank();
    files.push_back({job.input_files[k], ""});
    if (is_mine) files.back().sha256 = Sha256OfFile(files.back().path);
    mine.push_back(files.back().sha256);
  }
  ByteWriter writer;
  writer.PutTexts(mine);
  for (const std::string& bytes : job.communicator->Gather(writer.Take())) {
    const std::vector<std::string> hashes = ByteReader(bytes).GetTexts();
    for (std::size_t k = 0; k < files.size(); ++k) {
      if (!hashes[k].empty()) files[k].sha256 = hashes[k];
    }
  }
  return files;
}

}  // namespace

CalibrationResult RunJob(JobConfig job, const std::string& command,
                         IdentifiabilityCache* cache) {
  std::vector<InputFile> inputs = HashInputs(job);
  std::optional<CalibrationTask> studied;
  if (job.published) studied = job;
  CalibrationResult result =
      Calibrate(static_cast<CalibrationTask&&>(job), cache);
  result.command = command;
  result.title = job.title;
  result.inputs = std::move(inputs);
  result.rejected = std::move(job.rejected);
  if (studied && result.IsUsable()) {
    result.study = CompareWithStudy(*job.published, *studied, result);
  }
  return result;
}

}  // namespace alidade::internal
