#include <optional>
#include <utility>

#include "alidade/arm_file.h"
#include "alidade/batched_kinematics.h"
#include "alidade/correction.h"
#include "alidade/inverse_kinematics.h"
#include "alidade/parameter_layout.h"
#include "alidade/run_file.h"
#include "src/core.h"

namespace alidade::python {
namespace {

py::array Geometry(const Arm& arm) {
  Eigen::MatrixXd table(5, arm.num_joints());
  for (int j = 0; j < arm.num_joints(); ++j) {
    const Joint& joint = arm.joints[j];
    table.col(j) << joint.beta, joint.alpha, joint.d, joint.theta, joint.r;
  }
  return Give(std::move(table));
}

py::array Limits(const Arm& arm) {
  Eigen::MatrixXd limits(2, arm.num_joints());
  for (int j = 0; j < arm.num_joints(); ++j) {
    limits.col(j) << arm.joints[j].lower, arm.joints[j].upper;
  }
  return Give(std::move(limits));
}

std::vector<bool> AreRevolute(const Arm& arm) {
  std::vector<bool> turn;
  for (const Joint& joint : arm.joints) {
    turn.push_back(joint.type == JointType::kRevolute);
  }
  return turn;
}

std::vector<std::string> TargetNames(const Arm& arm) {
  std::vector<std::string> names;
  for (const Target& target : arm.targets) names.push_back(target.name);
  return names;
}

py::list Parameters(const Arm& arm) {
  const ParameterLayout layout(arm);
  const Eigen::VectorXd values = layout.Values(arm);
  py::list parameters;
  for (int c = 0; c < layout.size(); ++c) {
    const Parameter& parameter = layout.parameter(c);
    parameters.append(py::make_tuple(
        parameter.name, parameter.dimension == Dimension::kLength ? "m" : "rad",
        values[c]));
  }
  return parameters;
}

Arm WithFrames(Arm arm, const py::array_t<double>& base,
               const py::array_t<double>& targets) {
  arm.instrument_from_base = AsTransform(base);
  const std::vector<Eigen::Isometry3d> frames = AsTransforms(targets);
  for (std::size_t i = 0; i < arm.targets.size() && i < frames.size(); ++i) {
    arm.targets[i].last_from_target = frames[i];
  }
  return arm;
}

py::array TargetFrames(const Arm& arm) {
  py::array_t<double> frames({arm.num_targets(), 4, 4});
  for (int i = 0; i < arm.num_targets(); ++i) {
    Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(
        frames.mutable_data(i, 0, 0)) = arm.last_from_target(i).matrix();
  }
  return frames;
}

py::array Positions(const Arm& arm, const Rows& joints, int target,
                    int threads) {
  const auto matrix = AsMatrix(joints);
  return Give(RunUnlocked([&]() -> Eigen::MatrixXd {
    return BatchedPositions(arm, matrix, target, threads);
  }));
}

py::array Transforms(const Arm& arm, const Rows& joints, int target,
                     int threads) {
  const auto matrix = AsMatrix(joints);
  return Give(RunUnlocked([&] {
                return BatchedTransforms(arm, matrix, target, threads);
              }),
              {joints.shape(0), 4, 4});
}

// N x columns x 6.
py::array Jacobians(const Arm& arm, const Rows& joints, bool of_parameters,
                    int target, int threads) {
  const auto matrix = AsMatrix(joints);
  Eigen::MatrixXd jacobians = RunUnlocked([&] {
    return of_parameters
               ? BatchedParameterJacobians(arm, matrix, target, threads)
               : BatchedJointJacobians(arm, matrix, target, threads);
  });
  const py::ssize_t columns = jacobians.rows() / 6;
  return Give(std::move(jacobians), {joints.shape(0), columns, 6});
}

PoseTask TaskOf(const std::string& word) {
  if (word == "pose") return PoseTask::kPose;
  if (word == "axis") return PoseTask::kAxis;
  if (word == "position") return PoseTask::kPosition;
  return PoseTask::kAutomatic;
}

py::dict AsDict(PoseSolutions solutions) {
  py::dict dict;
  std::vector<std::string> status;
  for (const PoseStatus one : solutions.status) status.push_back(ToString(one));
  dict["joint_values"] = Give(std::move(solutions.joint_values));
  dict["status"] = status;
  dict["position_error"] =
      Give(std::move(solutions.position_error),
           {static_cast<py::ssize_t>(solutions.status.size())});
  dict["rotation_error"] =
      Give(std::move(solutions.rotation_error),
           {static_cast<py::ssize_t>(solutions.status.size())});
  dict["iterations"] = solutions.iterations;
  return dict;
}

PoseSolverOptions SolverOptionsOf(const py::dict& options) {
  PoseSolverOptions solver;
  solver.task = TaskOf(options["task"].cast<std::string>());
  solver.target = options["target"].cast<int>();
  solver.max_joint_change = options["max_joint_change"].cast<double>();
  solver.num_threads = options["threads"].cast<int>();
  return solver;
}

py::dict InverseKinematics(const Arm& arm, const py::array_t<double>& poses,
                           const std::optional<Rows>& starts,
                           const py::dict& options) {
  const PoseSolverOptions solver = SolverOptionsOf(options);
  const auto targets = AsTransforms(poses);
  const auto trials = options["trials"].cast<int>();
  const auto seed = options["seed"].cast<std::uint64_t>();
  std::optional<Eigen::MatrixXd> start;
  if (starts) start = AsMatrix(*starts);
  return AsDict(RunUnlocked([&] {
    if (start && start->cols() == static_cast<int>(targets.size())) {
      return SolvePoses(arm, targets, *start, solver);
    }
    return FindPoses(
        arm, targets,
        start ? Eigen::VectorXd(start->col(0)) : MiddleOfLimits(arm), trials,
        seed, solver);
  }));
}

py::dict Correct(const Arm& nominal, const Arm& real,
                 const std::optional<py::array_t<double>>& poses,
                 const std::optional<Rows>& motors, const py::dict& options) {
  CorrectionOptions correction;
  correction.solver = SolverOptionsOf(options);
  const int target = std::exchange(correction.solver.target, 0);
  correction.inverse = options["inverse"].cast<bool>();
  correction.num_trials = options["trials"].cast<int>();
  correction.seed = options["seed"].cast<std::uint64_t>();
  const CorrectionArms arms = MakeCorrectionArms(
      nominal, real, target,
      options["calibrated_tool"].cast<bool>() ? ToolSource::kCalibrated
                                              : ToolSource::kNominal);
  std::vector<Eigen::Isometry3d> targets;
  if (poses) targets = AsTransforms(*poses);
  Eigen::MatrixXd starts;
  if (motors) starts = AsMatrix(*motors);
  Correction done = RunUnlocked([&] {
    return poses ? CorrectPoses(arms, targets, starts, correction)
                 : CorrectJoints(arms, starts, correction);
  });
  const auto count = static_cast<py::ssize_t>(done.targets.size());
  py::dict dict = AsDict(std::move(done.solutions));
  py::array_t<double> corrected({count, py::ssize_t{4}, py::ssize_t{4}});
  std::vector<std::string> asked;
  for (py::ssize_t i = 0; i < count; ++i) {
    Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(
        corrected.mutable_data(i, 0, 0)) = done.poses[i].matrix();
    asked.emplace_back(ToString(done.asked_status[i]));
  }
  dict["asked_status"] = asked;
  dict["asked_joints"] = Give(std::move(done.asked_motors));
  dict["joint_values"] = Give(std::move(done.motors));
  dict["poses"] = corrected;
  dict["shift"] = Give(std::move(done.shift), {count});
  dict["turn"] = Give(std::move(done.turn), {count});
  return dict;
}

py::dict Export(const Arm& nominal, const Arm& real, const std::string& format,
                const std::string& table, const std::string& nominal_path) {
  const ExportedArm exported = RunUnlocked(
      [&] { return ExportArm(nominal, real, format, table, nominal_path); });
  py::dict dict;
  dict["text"] = exported.text;
  dict["lost"] = exported.lost;
  dict["mean"] = exported.cost.mean;
  dict["p95"] = exported.cost.p95;
  dict["max"] = exported.cost.max;
  return dict;
}

}  // namespace

void DefineArm(py::module_* m) {
  py::class_<Arm>(*m, "Arm")
      .def_static("load", [](const std::string& path) { return LoadArm(path); })
      .def_static("parse", &ParseArm)
      .def("format", [](const Arm& arm) { return FormatArm(arm, ""); })
      .def_readonly("name", &Arm::name)
      .def("num_joints", &Arm::num_joints)
      .def("are_revolute", AreRevolute)
      .def("geometry", Geometry)
      .def("limits", Limits)
      .def("reach", [](const Arm& arm) { return ArmReach(arm); })
      .def("has_errors", [](const Arm& arm) { return !arm.errors.empty(); })
      .def("target_names", TargetNames)
      .def("base",
           [](const Arm& arm) { return AsArray(arm.instrument_from_base); })
      .def("target_frames", TargetFrames)
      .def("with_frames", WithFrames)
      .def("parameters", Parameters)
      .def("with_values",
           [](const Arm& arm, const py::array_t<double>& values) {
             return ParameterLayout(arm).WithValues(
                 arm, Eigen::Map<const Eigen::VectorXd>(values.data(),
                                                        values.size()));
           })
      .def("with_deviations",
           [](const Arm& arm, const std::string& path) {
             const ParameterLayout layout(arm);
             return layout.WithValues(
                 arm, layout.Values(arm) + LoadDeviations(path, arm));
           })
      .def("draw",
           [](const Arm& arm, int count, std::uint64_t seed) {
             return Give(RunUnlocked(
                 [&] { return DrawConfigurations(arm, count, seed); }));
           })
      .def("has_motor_map", &HasMotorMap)
      .def("num_motors",
           [](const Arm& arm) {
             return HasMotorMap(arm) && arm.joints_from_motors.size() > 0
                        ? arm.joints_from_motors.cols()
                        : Eigen::Index{arm.num_joints()};
           })
      .def("joints_from_motors",
           [](const Arm& arm, const Rows& motors) {
             return Give(
                 JointsFromMotors(arm, Eigen::MatrixXd(AsMatrix(motors))));
           })
      .def("motors_from_joints",
           [](const Arm& arm, const Rows& joints) {
             return Give(
                 MotorsFromJoints(arm, Eigen::MatrixXd(AsMatrix(joints))));
           })
      .def("positions", Positions)
      .def("transforms", Transforms)
      .def("jacobians", Jacobians)
      .def("inverse_kinematics", InverseKinematics);
  m->def("correct", Correct);
  m->def("export_arm", Export);
}

}  // namespace alidade::python
