#include "src/serialization/references_section.h"

#include <string>
#include <utility>
#include <vector>

#include "src/common/names.h"
#include "src/kernel/partition.h"

namespace alidade::internal {
namespace {

// Appends the distance to a block.
void AddDistance(const StatedDistance& stated, const References& references,
                 ObservationBlock* block) {
  std::vector<std::string> names;
  for (const ReferencePoint& point : references.points) {
    names.push_back(point.name);
  }
  const std::vector<YamlValue> ends =
      stated.between->List(2, "names of points");
  block->references.push_back(
      references.FindPoint(ends[0].Choice("reference point", names)));
  block->seconds.push_back(
      references.FindPoint(ends[1].Choice("reference point", names)));
  if (block->references.back() == block->seconds.back()) {
    stated.between->Fail("found " + Quote(ends[0].Text()) +
                         " twice, expected two different points");
  }
}

}  // namespace

void AppendDistances(const std::vector<StatedDistance>& distances,
                     double default_sigma, JobConfig* job) {
  if (distances.empty()) return;
  ObservationBlock block;
  block.kind = MeasurementKind::kPointDistance;
  const auto size = static_cast<Eigen::Index>(distances.size());
  Eigen::MatrixXd measured(1, size);
  Eigen::MatrixXd sigmas(1, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    const StatedDistance& stated = distances[i];
    AddDistance(stated, job->data.references, &block);
    measured(i) = stated.distance;
    sigmas(i) = stated.sigma.value_or(default_sigma);
    if (sigmas(i) > 0.0) continue;
    stated.map->Fail(
        "the sigma of measurements is estimated, that of a known distance "
        "cannot be: expected `sigma`");
  }
  block.measured = std::move(measured);
  block.sigmas = std::move(sigmas);
  AppendGlobal(job->communicator, block, &job->data.training);
}

ParameterLayout LayoutOf(const Arm& arm, const References& references) {
  return ParameterLayout(LayoutShape{arm.num_joints(), arm.num_targets(),
                                     references.num_points(),
                                     references.num_planes()});
}

Eigen::VectorXd NominalValues(const Arm& arm, const References& references) {
  const ParameterLayout layout = LayoutOf(arm, references);
  Eigen::VectorXd values = layout.Values(arm);
  for (int i = 0; i < references.num_points(); ++i) {
    values.segment<3>(layout.Column(ParameterKind::kPoint, 0, i)) =
        references.points[i].position;
  }
  for (int i = 0; i < references.num_planes(); ++i) {
    values[layout.Column(ParameterKind::kPlaneOffset, 0, i)] =
        references.planes[i].offset;
  }
  return values;
}

}  // namespace alidade::internal
