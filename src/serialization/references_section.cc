#include "src/serialization/references_section.h"

#include <string>
#include <vector>

#include "src/common/names.h"
#include "src/dataio/dataset_builder.h"
#include "src/kernel/partition.h"

namespace alidade::internal {
namespace {

Observation ReadDistance(const StatedDistance& stated, double default_sigma,
                         const References& references) {
  std::vector<std::string> names;
  for (const ReferencePoint& point : references.points) {
    names.push_back(point.name);
  }
  const std::vector<YamlValue> ends =
      stated.between->List(2, "names of points");
  Observation observation;
  observation.kind = MeasurementKind::kPointDistance;
  observation.reference =
      references.FindPoint(ends[0].Choice("reference point", names));
  observation.second =
      references.FindPoint(ends[1].Choice("reference point", names));
  if (observation.reference == observation.second) {
    stated.between->Fail("found " + Quote(ends[0].Text()) +
                         " twice, expected two different points");
  }
  const double sigma = stated.sigma.value_or(default_sigma);
  if (!(sigma > 0.0)) {
    stated.map->Fail(
        "the sigma of measurements is estimated, that of a known distance "
        "cannot be: expected `sigma`");
  }
  observation.measured = Observation::Rows::Constant(1, stated.distance);
  observation.sigmas = Observation::Rows::Constant(1, sigma);
  return observation;
}

}  // namespace

void AppendDistances(const std::vector<StatedDistance>& distances,
                     double default_sigma, JobConfig* job) {
  std::vector<Observation> observations;
  for (const StatedDistance& stated : distances) {
    observations.push_back(
        ReadDistance(stated, default_sigma, job->data.references));
  }
  for (const ObservationBlock& block :
       MakeBlocks(observations, job->data.training.num_poses())) {
    AppendGlobal(job->communicator, block, &job->data.training);
  }
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
