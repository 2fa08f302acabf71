#include "src/fleet/batch_places.h"

#include <system_error>

namespace alidade::internal {
namespace {

namespace fs = std::filesystem;

}  // namespace

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
