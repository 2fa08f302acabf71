#include "src/serialization/job_options.h"

#include <algorithm>
#include <string>
#include <vector>

namespace alidade::internal {

bool HasUnknownReferences(const References& references) {
  const auto is_unknown = [](const auto& reference) {
    return !reference.is_known;
  };
  return std::any_of(references.points.begin(), references.points.end(),
                     is_unknown) ||
         std::any_of(references.planes.begin(), references.planes.end(),
                     is_unknown);
}

void CheckLoss(const YamlMap& map, const JobConfig& job) {
  if (job.options.loss == LossKind::kNone ||
      job.options.solver == SolverName::kCeres) {
    return;
  }
  map.Required("loss").Fail(
      "the pseudo-inverse is least squares: a robust loss goes with "
      "`solver: {name: ceres}`");
}

void CheckCompareWith(const YamlMap& map, const JobConfig& job) {
  const std::vector<SolverName>& others = job.options.compare_with;
  const auto same = std::find(others.begin(), others.end(), job.options.solver);
  if (same == others.end()) return;
  const YamlValue item =
      map.Required("compare_with").List()[same - others.begin()];
  item.Fail("solver " + Quote(item.Text()) +
            " runs already, expected each solver once");
}

// The published rules know joint parameters alone.
void CheckMethod(const YamlMap& map, const JobConfig& job) {
  if (job.options.identifiability.method == IdentifiabilityMethod::kRules &&
      HasUnknownReferences(job.data.references)) {
    map.Fail(
        "method: rules identifies no points and planes, and some of these "
        "are not known: expected `method: rank`");
  }
}

void RefuseForMany(const YamlMap& map, const JobConfig& job) {
  const int num_ranks = job.communicator->size();
  if (num_ranks == 1) return;
  const auto refuse = [&](const YamlValue& value, const std::string& what) {
    value.Fail(what + " needs all data in one process, and this job runs in " +
               std::to_string(num_ranks) +
               ": leave it out, or run without mpirun");
  };
  if (const auto compared = map.Optional("compare_with")) {
    refuse(*compared, "compare_with");
  }
  if (job.options.solver == SolverName::kPseudoInverse) {
    refuse(map.Required("solver"), "the pseudo-inverse");
  }
  if (job.options.solver_options.evaluation == Evaluation::kAutodiff) {
    refuse(map.Required("solver"), "evaluation: autodiff");
  }
  if (const auto validation = map.Optional("validation")) {
    if (validation->Find("folds")) refuse(*validation, "cross-validation");
  }
}

}  // namespace alidade::internal
