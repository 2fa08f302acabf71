#include "src/job/run_job.h"

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "alidade/team.h"
#include "src/calibration/calibration_task.h"
#include "src/common/files.h"
#include "src/job/study.h"

namespace alidade::internal {
namespace {

// Every file by a member that has read it.
std::vector<InputFile> HashInputs(const JobConfig& job) {
  Team* const team = job.data.training.share.team;
  const int rank = team == nullptr ? 0 : team->rank();
  std::vector<InputFile> files;
  std::vector<std::string> mine;
  for (std::size_t k = 0; k < job.input_files.size(); ++k) {
    const bool is_mine = (job.readers.empty() ? 0 : job.readers[k]) == rank;
    files.push_back({job.input_files[k], ""});
    if (is_mine) files.back().sha256 = Sha256OfFile(files.back().path);
    mine.push_back(files.back().sha256);
  }
  if (team == nullptr) return files;
  ByteWriter writer;
  writer.PutTexts(mine);
  for (const std::string& bytes : team->Gather(writer.Take())) {
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
