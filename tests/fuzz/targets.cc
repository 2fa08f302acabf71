#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "alidade/arm_file.h"
#include "src/common/mapped_file.h"
#include "src/common/number_text.h"
#include "src/dataio/dataset_csv.h"
#include "src/dataio/dataset_npy.h"
#include "src/dataio/mesh_file.h"
#include "src/dataio/robot_program.h"
#include "src/dataio/urdf_file.h"
#include "src/serialization/config_file.h"
#include "src/serialization/job_config.h"
#include "src/serialization/job_list.h"
#include "src/serialization/job_matrix.h"
#include "src/serialization/plan_file.h"
#include "src/serialization/result_json.h"
#include "src/serialization/simulation_file.h"
#include "tests/fuzz/fuzz_target.h"

namespace alidade::internal::fuzz {
namespace {

// The arm that deviations and data sets are read for: five joints, one target.
const Arm& TestArm() {
  static const auto* const arm = new Arm(
      LoadArm(std::string(ALIDADE_SOURCE_DIR) + "/tests/fuzz/files/arm.yaml"));
  return *arm;
}

void CheckArm(const Arm& arm) {
  for (const Joint& joint : arm.joints) {
    Require(std::isfinite(joint.beta + joint.alpha + joint.d + joint.theta +
                          joint.r) &&
                joint.lower <= joint.upper,
            "a joint's numbers are not finite");
  }
  Require(arm.joints_from_motors.allFinite() && arm.motor_offsets.allFinite(),
          "the motor map is not finite");
  Require(arm.instrument_from_base.matrix().allFinite(),
          "the base is not finite");
  for (const Target& target : arm.targets) {
    Require(target.last_from_target.matrix().allFinite(),
            "a target is not finite");
  }
}

// All but frames, which are written as rotation vectors and rounded.
std::string ChainText(Arm arm) {
  arm.instrument_from_base.setIdentity();
  for (Target& target : arm.targets) target.last_from_target.setIdentity();
  return FormatArm(arm, "");
}

void ReadArm(const std::string& input, const std::string& path) {
  const Arm arm = ParseArm(input, path);
  CheckArm(arm);
  const Arm again =
      ReadBack(FormatArm(arm, "fuzzed"),
               [&](const std::string& text) { return ParseArm(text, path); });
  const std::string chain = ChainText(arm);
  Require(ChainText(again) == chain, "another arm is read back:\n" + chain);
}

void ReadDeviations(const std::string& input, const std::string& path) {
  Require(ParseDeviations(input, path, TestArm()).allFinite(),
          "deviations are not finite");
}

void CheckBlock(const ObservationBlock& block) {
  Require(block.sigmas.cols() == block.size(), "sigmas are not as many");
  for (Eigen::Index i = 0; i < block.size(); ++i) {
    for (Eigen::Index row = 0; row < block.sigmas.rows(); ++row) {
      const double sigma = block.sigmas(row, i);
      Require(sigma > 0.0, "a sigma is not above zero");
      Require(std::isinf(sigma) || row >= block.measured.rows() ||
                  std::isfinite(block.measured(row, i)),
              "a measured number is not finite");
    }
  }
}

void CheckData(const Dataset& data) {
  Require(data.joint_values.map().allFinite(), "joint values are not finite");
  for (const ObservationBlock& block : data.blocks) CheckBlock(block);
}

void ReadJobFile(const std::string& input, const std::string& path) {
  const JobConfig job = ReadJob(ParseConfig(input, path, FileFormat::kJob));
  std::string error;
  Require(job.options.IsValid(&error), error);
  CheckData(job.data.training);
  if (job.data.validation) CheckData(*job.data.validation);
}

void ReadPlanFile(const std::string& input, const std::string& path) {
  const PlanConfig plan = ReadPlan(ParseConfig(input, path, FileFormat::kPlan));
  std::string error;
  Require(plan.design.IsValid(&error), error);
  CheckData(plan.job.data.training);
}

void ReadSimulationFile(const std::string& input, const std::string& path) {
  const SimulationConfig simulation =
      ReadSimulation(ParseConfig(input, path, FileFormat::kSimulation));
  CheckArm(simulation.arm);
}

void ReadMatrix(const std::string& input, const std::string& path) {
  const JobMatrix matrix(ParseConfig(input, path, FileFormat::kJob));
  constexpr std::int64_t kMostJobs = 16;
  std::set<std::string> names;
  const std::int64_t num_jobs = std::min(matrix.size(), kMostJobs);
  for (std::int64_t job = 0; job < num_jobs; ++job) {
    const JobOutline outline = matrix.OutlineOf(job);
    Require(outline.name == matrix.NameOf(job), "two names of a job");
    Require(names.insert(outline.name).second, "two jobs of one name");
    matrix.FingerprintOf(job);
  }
}

void ReadList(const std::string& input, const std::string& path) {
  for (const std::string& job : ParseJobList(input, path)) {
    Require(!job.empty(), "a job without a name");
  }
}

// As written for Alidade, and, where that fails, as by another program.
std::vector<DataFormat> DataFormats() {
  DataFormat lenient;
  lenient.ignore_others = true;
  lenient.rotation = FindRotationConvention(RotationConventionNames().front());
  lenient.length_unit = FindUnit("mm");
  lenient.angle_unit = FindUnit("deg");
  return {{}, lenient};
}

LoadedData ReadTable(const std::string& text, const std::string& path,
                     const DataFormat& format) {
  References references;
  ReadOptions options;
  options.fewest_bytes_in_place = 0;
  return ReadData(MappedFile(path, text), {path, TestArm(), format},
                  &references, options);
}

// Whether it can be written: positions and poses of the only target.
bool IsPlain(const Dataset& data) {
  return data.covariate_names.empty() &&
         std::all_of(data.blocks.begin(), data.blocks.end(),
                     [](const ObservationBlock& block) {
                       return HoldsPosition(block.kind) &&
                              block.targets.empty() && block.whiteners.empty();
                     });
}

void CheckSamePositions(const Dataset& data, const Dataset& again) {
  Require(data.joint_values.map() == again.joint_values.map(),
          "other joint values are read back");
  Require(data.blocks.size() == again.blocks.size(),
          "other kinds are read back");
  for (std::size_t k = 0; k < data.blocks.size(); ++k) {
    const ObservationBlock& one = data.blocks[k];
    const ObservationBlock& other = again.blocks[k];
    Require(one.kind == other.kind && one.size() == other.size(),
            "other observations are read back");
    for (Eigen::Index i = 0; i < one.size(); ++i) {
      for (int row = 0; row < 3; ++row) {
        Require(one.sigmas(row, i) == other.sigmas(row, i),
                "another sigma is read back");
        Require(std::isinf(one.sigmas(row, i)) ||
                    one.measured(row, i) == other.measured(row, i),
                "another position is read back");
      }
    }
  }
}

void ReadTableAs(const std::string& input, const std::string& path,
                 const DataFormat& format) {
  const Dataset data = ReadTable(input, path, format).data;
  CheckData(data);
  if (!IsPlain(data) || data.blocks.empty()) return;
  const std::string written =
      IsNpy(path) ? FormatNpy(data, TestArm(), true)
                  : FormatDataset(data, TestArm(), kFewestDigits, true, {});
  DataFormat plain;
  plain.rotation = FindRotationConvention("rotation_vector");
  CheckSamePositions(data, ReadBack(written, [&](const std::string& text) {
                       return ReadTable(text, path, plain).data;
                     }));
}

void ReadTables(const std::string& input, const std::string& path) {
  static const auto* const formats = new std::vector<DataFormat>(DataFormats());
  try {
    ReadTableAs(input, path, formats->front());
  } catch (const InputError& error) {
    CheckMessage(error, input, path);
    ReadTableAs(input, path, formats->back());
  }
}

// The first line names the ends of the chain.
void ReadUrdf(const std::string& input, const std::string& path) {
  const std::size_t end = std::min(input.find('\n'), input.size());
  const std::size_t space = std::min(input.find(' '), end);
  const std::string base = input.substr(0, space);
  const std::string tip =
      space < end ? input.substr(space + 1, end - space - 1) : "";
  CheckArm(ParseUrdfArm(input.substr(end), path, base, tip));
}

void CheckMesh(const TriangleMesh& mesh) {
  const auto num_vertices = static_cast<int>(mesh.vertices.cols());
  for (const int vertex : mesh.triangles.reshaped()) {
    Require(vertex >= 0 && vertex < num_vertices, "a vertex that is not there");
    Require(mesh.vertices.col(vertex).allFinite(), "a corner is not finite");
  }
}

// An OBJ file behind an "o", else an STL file behind any byte.
void ReadMesh(const std::string& input, const std::string& path) {
  if (input.empty()) return;
  const TriangleMesh mesh =
      ParseMesh(input.substr(1), path + (input[0] == 'o' ? ".obj" : ".stl"));
  CheckMesh(mesh);
  constexpr int kMostTriangles = 20;
  const TriangleMesh simple = SimplifyMesh(mesh, kMostTriangles);
  CheckMesh(simple);
  Require(simple.triangles.cols() <= kMostTriangles, "too many triangles");
}

void CheckTargetOf(const RobotProgram& program, const ProgramTarget& target) {
  std::vector<NumberSpan> spans = target.numbers;
  std::sort(spans.begin(), spans.end(),
            [](const NumberSpan& a, const NumberSpan& b) {
              return a.begin < b.begin;
            });
  std::size_t last = 0;
  for (const NumberSpan& span : spans) {
    Require(last <= span.begin && span.begin < span.end &&
                span.end <= program.text.size(),
            "numbers of a target overlap");
    Require(std::isfinite(span.value), "a number is not finite");
    last = span.end;
  }
  Require(!target.uses.empty(), "a target without a line");
  if (target.is_joints) return;
  Require(PoseOf(program.language, target).matrix().allFinite(),
          "a pose is not finite");
}

// As far as they are written.
void CheckSameNumbers(const ProgramTarget& target, const ProgramTarget& again,
                      const std::string& text) {
  Require(again.numbers.size() == target.numbers.size() &&
              again.is_joints == target.is_joints &&
              again.tool == target.tool && again.frame == target.frame,
          "another target is read back: " + text);
  for (std::size_t k = 0; k < target.numbers.size(); ++k) {
    const NumberSpan& number = again.numbers[k];
    const double value = target.numbers[k].value;
    const double rounding =
        0.5001 * std::pow(10.0, -number.decimals) + 1e-12 * std::abs(value);
    Require(std::abs(number.value - value) <= rounding,
            "another number is read back: " + text);
  }
}

// The first byte chooses the language. What is understood can be written again,
// and is the same then.
void ReadRobotProgram(const std::string& input, const std::string& path) {
  static constexpr std::array kEndings = {".script", ".src", ".mod", ".ls"};
  if (input.empty()) return;
  const std::string file =
      path + kEndings[static_cast<unsigned char>(input[0]) % kEndings.size()];
  constexpr int kNumJoints = 6;
  const std::map<std::string, Eigen::Isometry3d> frames = {
      {"tool 1", Eigen::Isometry3d::Identity()}};
  const RobotProgram program =
      ParseProgram(input.substr(1), file, kNumJoints, frames);
  std::vector<ProgramValues> values;
  const Eigen::VectorXd zeros = Eigen::VectorXd::Zero(kNumJoints);
  for (const ProgramTarget& target : program.targets) {
    CheckTargetOf(program, target);
    PostureBounds(program.language, target, kNumJoints);
    values.push_back({{}, PostureOf(program.language, target, zeros)});
    for (const NumberSpan& span : target.numbers) {
      values.back().numbers.push_back(span.value);
    }
  }
  if (!program.refused.empty()) return;
  const RobotProgram again = ReadBack(
      RewriteProgram(program, values)[0], [&](const std::string& text) {
        return ParseProgram(text, file, kNumJoints, frames);
      });
  Require(again.targets.size() == program.targets.size(),
          std::to_string(again.targets.size()) + " targets instead of " +
              std::to_string(program.targets.size()) +
              " are read back: " + again.text);
  for (std::size_t i = 0; i < again.targets.size(); ++i) {
    CheckSameNumbers(program.targets[i], again.targets[i], again.text);
  }
}

// `read` and written again, twice: the second text is the first.
template <typename Read, typename Format>
void CheckRoundTrip(const std::string& input, const std::string& path,
                    const Read& read, const Format& format) {
  const std::string written = format(read(input, path));
  const std::string again = format(ReadBack(
      written, [&](const std::string& text) { return read(text, path); }));
  Require(again == written, "another result is read back:\n" + written);
}

void ReadResult(const std::string& input, const std::string& path) {
  if (const auto record = ParseBatchRecord(input)) {
    Require(ParseBatchRecord(FormatBatchRecord(*record)).has_value(),
            "a record is not read back");
  }
  if (input.find("alidade-batch-") != std::string::npos) {
    CheckRoundTrip(input, path, ParseBatchSummary, FormatBatchSummary);
  } else {
    CheckRoundTrip(input, path, ParseResultJson, FormatResultJson);
  }
}

}  // namespace

const std::vector<FuzzTarget>& FuzzTargets() {
  static const auto* const targets = new std::vector<FuzzTarget>{
      {"arm", "input.yaml", ReadArm},
      {"deviations", "input.yaml", ReadDeviations},
      {"job", "input.yaml", ReadJobFile},
      {"plan", "input.yaml", ReadPlanFile},
      {"simulation", "input.yaml", ReadSimulationFile},
      {"matrix", "input.yaml", ReadMatrix},
      {"list", "input.txt", ReadList},
      {"csv", "input.csv", ReadTables},
      {"npy", "input.npy", ReadTables},
      {"urdf", "input.urdf", ReadUrdf},
      {"mesh", "input", ReadMesh},
      {"program", "input", ReadRobotProgram},
      {"result", "input.json", ReadResult}};
  return *targets;
}

}  // namespace alidade::internal::fuzz
