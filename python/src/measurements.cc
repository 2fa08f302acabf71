#include <utility>

#include "alidade/dataset_file.h"
#include "alidade/run_file.h"
#include "src/core.h"

namespace alidade::python {
namespace {

constexpr std::array kKinds = {
    MeasurementKind::kPosition,      MeasurementKind::kPose,
    MeasurementKind::kDistance,      MeasurementKind::kFixedPoint,
    MeasurementKind::kPlane,         MeasurementKind::kDifference,
    MeasurementKind::kPointDistance,
};

MeasurementKind KindOf(const std::string& name) {
  for (const MeasurementKind kind : kKinds) {
    if (name == NameOf(kind)) return kind;
  }
  return MeasurementKind::kPosition;
}

// Blocks of a kind come one after the other as they were added.
void AddBlock(Measurements* measurements, const std::string& kind,
              const Rows& measured, const Rows& sigmas, std::vector<int> poses,
              std::vector<int> targets, std::vector<int> references,
              std::vector<int> seconds) {
  ObservationBlock block;
  block.kind = KindOf(kind);
  block.measured = Share(measured);
  block.sigmas =
      sigmas.shape(0) == 1 && measured.shape(0) != 1
          ? SharedMatrix::Repeated(AsMatrix(sigmas).col(0), measured.shape(0))
          : Share(sigmas);
  block.poses = std::move(poses);
  block.targets = std::move(targets);
  block.references = std::move(references);
  block.seconds = std::move(seconds);
  DropTrivialPoses(measurements->data.num_poses(), &block);
  measurements->data.blocks.push_back(std::move(block));
}

py::list Blocks(const Measurements& measurements) {
  py::list blocks;
  for (const ObservationBlock& block : measurements.data.blocks) {
    py::dict dict;
    dict["kind"] = NameOf(block.kind);
    dict["measured"] = ViewOf(block.measured);
    dict["sigmas"] = ViewOf(block.sigmas);
    dict["poses"] = block.poses;
    dict["targets"] = block.targets;
    dict["references"] = block.references;
    dict["seconds"] = block.seconds;
    blocks.append(dict);
  }
  return blocks;
}

void AddPoint(Measurements* measurements, const std::string& name,
              const std::array<double, 3>& position, bool is_known) {
  measurements->references.points.push_back(
      {name, Eigen::Vector3d(position.data()), is_known});
}

void AddPlane(Measurements* measurements, const std::string& name,
              const std::array<double, 3>& normal, double offset,
              bool is_known) {
  measurements->references.planes.push_back(
      {name, Eigen::Vector3d(normal.data()).normalized(), offset, is_known});
}

py::list ListReferences(const Measurements& measurements) {
  py::list references;
  const auto as_tuple = [](const Eigen::Vector3d& v) {
    return py::make_tuple(v[0], v[1], v[2]);
  };
  for (const ReferencePoint& point : measurements.references.points) {
    references.append(py::make_tuple(
        "point", point.name, as_tuple(point.position), 0.0, point.is_known));
  }
  for (const ReferencePlane& plane : measurements.references.planes) {
    references.append(py::make_tuple("plane", plane.name,
                                     as_tuple(plane.normal), plane.offset,
                                     plane.is_known));
  }
  return references;
}

Measurements Load(const std::string& path, const Arm& arm, double sigma,
                  int threads) {
  Measurements measurements;
  measurements.data =
      RunUnlocked([&] { return LoadDataset(path, arm, sigma, threads); });
  return measurements;
}

Measurements Make(const Rows& joints) {
  Measurements measurements;
  measurements.data.joint_values = Share(joints);
  return measurements;
}

void SetCovariates(Measurements* measurements, std::vector<std::string> names,
                   const Rows& values) {
  measurements->data.covariate_names = std::move(names);
  measurements->data.covariates = Share(values);
}

py::dict Simulate(const std::string& path) {
  SimulatedMeasurements simulated =
      RunUnlocked([&] { return RunSimulationFile(path); });
  py::dict dict;
  Measurements measurements;
  measurements.data = std::move(simulated.data);
  measurements.sigmas_are_stated = simulated.sigma > 0.0;
  dict["data"] = py::cast(std::move(measurements));
  dict["arm"] = py::cast(std::move(simulated.arm));
  dict["real"] = py::cast(std::move(simulated.real));
  dict["sigma"] = simulated.sigma;
  dict["seed"] = simulated.seed;
  dict["output"] = simulated.output;
  return dict;
}

Measurements SimulateAt(const Arm& real, const Rows& joints, double sigma,
                        std::uint64_t seed) {
  const Eigen::MatrixXd values = AsMatrix(joints);
  Measurements measurements;
  measurements.data =
      RunUnlocked([&] { return SimulatePositions(real, values, sigma, seed); });
  measurements.sigmas_are_stated = sigma > 0.0;
  return measurements;
}

}  // namespace

void DefineMeasurements(py::module_* m) {
  py::class_<Measurements>(*m, "Measurements")
      .def(py::init(&Make))
      .def_static("load", Load)
      .def("add_block", AddBlock, py::arg("kind"), py::arg("measured"),
           py::arg("sigmas"), py::arg("poses"), py::arg("targets"),
           py::arg("references"), py::arg("seconds"))
      .def("add_point", AddPoint)
      .def("add_plane", AddPlane)
      .def("blocks", Blocks)
      .def("references", ListReferences)
      .def("set_covariates", SetCovariates)
      .def("covariate_names",
           [](const Measurements& all) { return all.data.covariate_names; })
      .def("covariates",
           [](const Measurements& all) { return ViewOf(all.data.covariates); })
      .def(
          "joint_values",
          [](const Measurements& all) { return ViewOf(all.data.joint_values); })
      .def_property(
          "name", [](const Measurements& all) { return all.data.name; },
          [](Measurements* all, const std::string& name) {
            all->data.name = name;
          })
      .def_readwrite("sigmas_are_stated", &Measurements::sigmas_are_stated)
      .def("num_observations",
           [](const Measurements& all) { return all.data.num_observations(); })
      .def("num_equations",
           [](const Measurements& all) { return all.data.num_equations(); })
      .def("copy", [](const Measurements& all) { return all; })
      .def("source", [](const Measurements& all,
                        int pose) { return SourceOf(all.data, pose); })
      .def("save",
           [](const Measurements& all, const Arm& arm,
              const std::string& path) { SaveDataset(all.data, arm, path); });
  m->def("simulate_file", Simulate);
  m->def("simulate_at", SimulateAt);
}

}  // namespace alidade::python
