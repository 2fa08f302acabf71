#include "src/fleet/batch_plan.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <unordered_map>

#include "alidade/error.h"
#include "src/serialization/config_file.h"

namespace alidade::internal {

namespace {

namespace fs = std::filesystem;

bool MayBeJob(const fs::path& path) {
  const std::string name = path.filename().string();
  const std::string ending = path.extension().string();
  return (ending == ".yaml" || ending == ".yml") && name.front() != '_' &&
         name.front() != '.';
}

// A file that cannot be recognised is kept: its error is to be seen.
bool IsOtherFormat(const std::string& path) {
  try {
    return DetectFormat(path) != FileFormat::kJob;
  } catch (const InputError&) {
    return false;
  }
}

std::vector<std::string> JobsOfFolder(const std::string& folder) {
  std::vector<std::string> jobs;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (!MayBeJob(entry.path()) || entry.is_directory()) continue;
    const std::string path = entry.path().string();
    if (!IsOtherFormat(path)) jobs.push_back(path);
  }
  if (error) {
    throw InputError({folder, 0, 0, ""}, "cannot be read: " + error.message());
  }
  if (jobs.empty()) {
    throw InputError({folder, 0, 0, ""},
                     "no job in this folder, expected files of the format "
                     "alidade-job-2 that end in .yaml");
  }
  std::sort(jobs.begin(), jobs.end());
  return jobs;
}

void AddFile(const std::string& path, BatchPlan* plan) {
  try {
    plan->matrices.emplace_back(path);
  } catch (const InputError& error) {
    plan->jobs.push_back(
        {JobMatrix::NameOfFile(path), path, -1, 0, error.what()});
    return;
  }
  const JobMatrix& matrix = plan->matrices.back();
  const int number = static_cast<int>(plan->matrices.size()) - 1;
  for (std::int64_t job = 0; job < matrix.size(); ++job) {
    plan->jobs.push_back({matrix.NameOf(job), path, number, job, ""});
  }
}

// Names are directories: none may be another's, or below it.
void CheckNames(const BatchPlan& plan) {
  std::unordered_map<std::string, const PlannedJob*> jobs;
  for (const PlannedJob& job : plan.jobs) {
    const auto [other, is_new] = jobs.emplace(job.name, &job);
    if (is_new) continue;
    throw InputError({job.file, 0, 0, ""},
                     "a second job is called " + job.name +
                         ", the first is of " + other->second->file +
                         ": rename one of the files, or run them with "
                         "different --out");
  }
  for (const PlannedJob& job : plan.jobs) {
    const auto other = jobs.find(job.name.substr(0, job.name.find('/')));
    if (other == jobs.end() || other->second == &job) continue;
    throw InputError({job.file, 0, 0, ""},
                     "its jobs would be written below that of " +
                         other->second->file + ": rename one of the files");
  }
}

}  // namespace

BatchPlan PlanBatch(const std::vector<std::string>& paths) {
  BatchPlan plan;
  for (const std::string& path : paths) {
    if (!fs::is_directory(path)) {
      AddFile(path, &plan);
      continue;
    }
    for (const std::string& job : JobsOfFolder(path)) AddFile(job, &plan);
  }
  CheckNames(plan);
  return plan;
}

BatchPlaces::BatchPlaces(const BatchPlan& plan, const std::string& directory)
    : directory_(fs::weakly_canonical(fs::absolute(directory))) {
  for (const PlannedJob& job : plan.jobs) names_.insert(job.name);
}

void BatchPlaces::Refuse(const std::string& input) const {
  std::error_code error;
  const fs::path file = fs::canonical(input, error);
  if (error) return;
  fs::path place;
  for (const fs::path& part : file.lexically_relative(directory_)) {
    if (part == "..") return;
    place /= part;
    if (names_.count(place.string()) == 0) continue;
    throw OutputConflict(
        {input, 0, 0, ""},
        "is read by this batch, which would replace it by a result: choose "
        "another --out");
  }
}

void BatchPlaces::RefuseArmsAndData(const BatchPlan& plan) const {
  std::unordered_set<std::string> seen;
  for (const PlannedJob& job : plan.jobs) {
    if (job.matrix < 0) continue;
    const JobOutline outline = plan.matrices[job.matrix].OutlineOf(job.number);
    for (const std::string& path : {outline.arm, outline.data}) {
      if (seen.insert(path).second) Refuse(path);
    }
  }
}

}  // namespace alidade::internal
