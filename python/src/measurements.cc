#include <algorithm>
#include <utility>

#include "alidade/option_text.h"
#include "alidade/run_file.h"
#include "alidade/stated_poses.h"
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
              std::vector<int> seconds,
              std::vector<Eigen::MatrixXd> whiteners) {
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
  block.whiteners = std::move(whiteners);
  DropTrivialPoses(measurements->data.num_poses(), &block);
  measurements->data.blocks.push_back(std::move(block));
}

py::dict AsDict(const ObservationBlock& block) {
  py::dict dict;
  dict["kind"] = NameOf(block.kind);
  dict["measured"] = ViewOf(block.measured);
  dict["sigmas"] = ViewOf(block.sigmas);
  dict["poses"] = block.poses;
  dict["targets"] = block.targets;
  dict["references"] = block.references;
  dict["seconds"] = block.seconds;
  dict["whiteners"] = block.whiteners;
  return dict;
}

py::list Blocks(const Measurements& measurements) {
  py::list blocks;
  for (const ObservationBlock& block : measurements.data.blocks) {
    blocks.append(AsDict(block));
  }
  return blocks;
}

// A block of poses, or of positions, for AddBlock; what is None or empty is not
// stated.
py::dict Observe(const Rows& positions, const Rows& orientations,
                 const std::string& convention, const py::dict& noise,
                 bool is_inverse) {
  StatedPoses stated;
  stated.positions = AsMatrix(positions);
  if (orientations.size() > 0) stated.orientations = AsMatrix(orientations);
  stated.convention = convention;
  const auto matrix = [&noise](const char* name) -> Eigen::MatrixXd {
    if (!noise.contains(name)) return {};
    return AsMatrix(noise[name].cast<Rows>());
  };
  stated.sigmas = matrix("sigmas");
  stated.rotation_sigmas = matrix("rotation_sigmas");
  stated.angle_sigmas = matrix("angle_sigmas");
  stated.covariances = matrix("covariances");
  stated.is_inverse = is_inverse;
  return AsDict(RunUnlocked([&] { return MakeObservations(stated); }));
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

Measurements Load(const std::string& text, const Arm& arm, int threads) {
  LoadedMeasurements loaded =
      RunUnlocked([&] { return LoadMeasurements(text, arm, threads); });
  Measurements measurements;
  measurements.data = std::move(loaded.data);
  measurements.references = std::move(loaded.references);
  measurements.uses = std::move(loaded.uses);
  measurements.sets = std::move(loaded.sets);
  measurements.first_station = std::move(loaded.first_station);
  measurements.sigmas_are_stated = loaded.are_sigmas_stated;
  for (const RejectedRow& row : loaded.rejected) {
    measurements.rejected.emplace_back(row.file, row.line, row.reason);
  }
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

// name, moves_base, moves_target, joints, what it is: "", "approach",
// "payload", "station".
using UseTuple =
    std::tuple<std::string, bool, bool, std::vector<int>, std::string>;

std::vector<UseTuple> ListUses(const Measurements& measurements) {
  std::vector<UseTuple> uses;
  for (const CovariateUse& use : measurements.uses) {
    uses.emplace_back(use.name, use.moves_base, use.moves_target, use.joints,
                      use.is_approach  ? "approach"
                      : use.is_payload ? "payload"
                      : use.is_station ? "station"
                                       : "");
  }
  return uses;
}

void SetUses(Measurements* measurements, const std::vector<UseTuple>& uses) {
  measurements->uses.clear();
  for (const auto& [name, base, target, joints, what] : uses) {
    measurements->uses.push_back({name, base, target, joints,
                                  what == "approach", what == "payload",
                                  what == "station"});
  }
}

// Targets by the arm's numbers: `numbers` are those of the named ones.
Measurements NameTargets(Measurements measurements,
                         const std::vector<int>& numbers) {
  for (ObservationBlock& block : measurements.data.blocks) {
    for (int& target : block.targets) {
      if (target < kNamedTargets) continue;
      target = numbers[static_cast<std::size_t>(target - kNamedTargets)];
    }
    if (std::all_of(block.targets.begin(), block.targets.end(),
                    [](int target) { return target == 0; })) {
      block.targets.clear();
    }
  }
  measurements.target_names.clear();
  return measurements;
}

// Files, and what sums are made of: bits depend on it.
py::tuple OriginOf(const Measurements& measurements) {
  const Dataset& data = measurements.data;
  py::list runs, shards;
  for (const PoseSources::Run& run : data.sources.runs()) {
    runs.append(
        py::make_tuple(run.first_pose, run.source.file, run.source.line));
  }
  for (const Shard& shard : data.shards) {
    shards.append(py::make_tuple(shard.first_pose, shard.first_observations));
  }
  return py::make_tuple(data.files, runs, data.sources.size(), shards);
}

void SetOrigin(Measurements* measurements, const py::tuple& origin) {
  Dataset* const data = &measurements->data;
  data->files = origin[0].cast<std::vector<std::string>>();
  const auto runs =
      origin[1].cast<std::vector<std::tuple<std::size_t, int, int>>>();
  const auto size = origin[2].cast<std::size_t>();
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const auto& [first, file, line] = runs[k];
    const std::size_t end =
        k + 1 < runs.size() ? std::get<0>(runs[k + 1]) : size;
    data->sources.Append({file, line}, end - first);
  }
  for (const py::handle item : origin[3]) {
    const auto shard = item.cast<py::tuple>();
    data->shards.push_back({shard[0].cast<Eigen::Index>(),
                            shard[1].cast<std::vector<Eigen::Index>>()});
  }
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
           py::arg("references"), py::arg("seconds"), py::arg("whiteners"))
      .def_readwrite("sets", &Measurements::sets)
      .def_readwrite("first_station", &Measurements::first_station)
      .def_readwrite("target_names", &Measurements::target_names)
      .def_readwrite("rejected", &Measurements::rejected)
      .def("name_targets", NameTargets)
      .def("uses", ListUses)
      .def("set_uses", SetUses)
      .def("origin", OriginOf)
      .def("set_origin", SetOrigin)
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
  m->attr("NAMED_TARGETS") = kNamedTargets;
  m->def("observe", Observe);
  m->def("simulate_file", Simulate);
  m->def("simulate_at", SimulateAt);
}

}  // namespace alidade::python
