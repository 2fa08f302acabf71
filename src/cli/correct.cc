#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <map>

#include "alidade/correction.h"
#include "alidade/error.h"
#include "alidade/units.h"
#include "src/cli/command.h"
#include "src/cli/targets.h"
#include "src/common/files.h"
#include "src/common/number_text.h"
#include "src/common/text.h"
#include "src/common/utf8.h"
#include "src/dataio/robot_program.h"
#include "src/job/arm_source.h"
#include "src/job/calibrated_arm.h"
#include "src/job/program_correction.h"
#include "src/job/program_notes.h"
#include "src/job/result_directory.h"
#include "src/kernel/measurement_model.h"
#include "src/report/correction_report.h"
#include "src/serialization/robot_files.h"
#include "src/uncertainty/prediction.h"

namespace alidade::internal {
namespace {

namespace fs = std::filesystem;

// results/corrected/welds.csv of parts/welds.csv, unless --out says otherwise.
// Controllers want a program's file named as the program.
std::string OutputFile(const CommandLine& line) {
  if (!line.out.empty()) return line.out;
  return "results/corrected/" + fs::path(line.files[1]).filename().string();
}

// The file of the declarations that are written with a program.
std::string DeclarationsOutput(const std::string& out,
                               const std::string& declarations) {
  const fs::path written =
      fs::path(out).replace_extension(fs::path(declarations).extension());
  if (written == out) {
    throw InputError({}, "--out=" + out + ", expected a name that ends in " +
                             ".src: " + declarations +
                             " is corrected, too, and written beside it");
  }
  return written.string();
}

// The result and the program, in this order.
void RequireOrder(const CommandLine& line) {
  const std::string& first = line.files[0];
  const std::string& second = line.files[1];
  if (!ProgramLanguageOf(first) && !IsResult(second)) return;
  throw InputError({},
                   "correct: expected the result first, then the program "
                   "or table: `alidade correct " +
                       second + " " + first + "`");
}

std::string FigureBeside(const std::string& path) {
  fs::path figure = path;
  return figure.replace_extension(".svg").string();
}

class CorrectCommand {
 public:
  explicit CorrectCommand(const CommandLine& line)
      : line_(line),
        source_(LoadArmSource(line.files[0], line.nominal)),
        out_(OutputFile(line)) {
    std::vector<std::string> inputs = source_.inputs;
    inputs.push_back(line.files[1]);
    outputs_ = {out_};
    const std::string beside = DeclarationsBeside(line.files[1]);
    if (!beside.empty()) {
      inputs.push_back(beside);
      outputs_.insert(outputs_.begin(), DeclarationsOutput(out_, beside));
    }
    if (!line.frames.empty()) inputs.push_back(line.frames);
    for (const std::string& path : outputs_) CheckOutputFile(path, inputs);
    CheckOutputFile(FigureBeside(out_), inputs);
    if (FigureBeside(out_) == out_) {
      throw InputError({}, "--out=" + out_ +
                               ", expected another ending: the figure that is "
                               "written beside it has this one");
    }
    target_ = TargetFlag(line, source_.nominal);
    if (target_ >= source_.real.num_targets()) target_ = 0;
    arms_ = MakeCorrectionArms(
        source_.nominal, source_.real, target_,
        line.calibrated_tool ? ToolSource::kCalibrated : ToolSource::kNominal);
    options_.inverse = line.inverse;
    options_.solver.num_threads = line.threads;
    // Programs state positions in up to 1e-12 m, and --inverse restores them.
    options_.solver.position_tolerance = 1e-12;
    options_.solver.rotation_tolerance = 1e-12;
    if (line.seed) options_.seed = *line.seed;
  }

  ExitStatus Run() {
    if (ProgramLanguageOf(line_.files[1])) return RunProgram();
    const TargetTable table =
        ReadTargets(line_.files[1], arms_.nominal, RotationFlag(line_));
    const Correction correction = Correct(table);
    const CorrectionReport report = ReportOf(correction, RowNames(table));
    WriteFileWithFolder(out_, WithColumns(table, Columns(table, report)));
    WriteFileWithFolder(FigureBeside(out_),
                        CorrectionFigure(report).render(FigureMedium::kFile));
    std::cout << FormatCorrection(report);
    PrintWarnings({}, report);
    if (!table.has_joints) PrintList("Assumed", {AssumedPosture(correction)});
    PrintResults({out_, FigureBeside(out_)});
    return kExitDone;
  }

 private:
  // Of poses without joint values.
  std::string AssumedPosture(const Correction& correction) const {
    const auto& status = correction.asked_status;
    const auto reached =
        std::find(status.begin(), status.end(), PoseStatus::kReached);
    const auto first = reached == status.end() ? 0 : reached - status.begin();
    return "no joint values beside the poses say in which posture they are: "
           "row " +
           std::to_string(first + 1) + " is taken in " +
           JointText(ProgramLanguage::kUrScript, arms_.nominal,
                     correction.asked_motors.col(first)) +
           ", the others near the row before. Where the robot is in another "
           "posture, the correction is wrong: state q1_deg ... beside the "
           "poses";
  }

  static void PrintWarnings(std::vector<std::string> warnings,
                            const CorrectionReport& report) {
    const std::string large = LargeCorrectionWarning(report);
    if (!large.empty()) warnings.insert(warnings.begin(), large);
    PrintList("Warnings", warnings);
  }

  static void PrintList(const char* title,
                        const std::vector<std::string>& lines) {
    if (!lines.empty()) std::cout << title << "\n";
    for (const std::string& line : FirstOf(lines)) {
      std::cout << "  " << OnOneLine(line) << "\n";
    }
  }

  ExitStatus RunProgram() {
    std::map<std::string, Eigen::Isometry3d> frames;
    if (!line_.frames.empty()) {
      frames = LoadFrames(line_.frames, arms_.nominal, RotationFlag(line_));
    }
    const RobotProgram program =
        ReadProgram(line_.files[1], arms_.nominal.num_joints(), frames);
    const ProgramCorrection corrected =
        CorrectProgram(program, arms_, options_);
    if (corrected.refusal) return Refuse(program, corrected);
    CorrectionReport report = ReportOf(corrected.correction, corrected.names);
    report.uncorrected = UncorrectedMotions(program);
    std::vector<std::string> written = {FigureBeside(out_)};
    for (std::size_t k = 0; k < outputs_.size(); ++k) {
      const bool is_there = fs::exists(outputs_[k]);
      WriteFileWithFolder(outputs_[k], corrected.texts[k]);
      written.push_back(outputs_[k] +
                        (is_there ? " (in place of an earlier one)" : ""));
    }
    WriteFileWithFolder(FigureBeside(out_),
                        CorrectionFigure(report).render(FigureMedium::kFile));
    std::cout << FormatCorrection(report);
    PrintWarnings(corrected.warnings, report);
    PrintList("Assumed", Assumed(program, corrected));
    std::vector<std::string> left;
    for (const ProgramNote& note : program.left) {
      left.push_back(LineName(program, note.line) + ": " + note.text);
    }
    left.insert(left.end(), corrected.left.begin(), corrected.left.end());
    PrintList("Not touched", left);
    std::reverse(written.begin(), written.end());
    PrintResults(written);
    return kExitDone;
  }

  static void PrintErrorList(const std::vector<std::string>& lines) {
    for (const std::string& line : lines) {
      std::cerr << "  " << OnOneLine(line) << "\n";
    }
  }

  ExitStatus Refuse(const RobotProgram& program,
                    const ProgramCorrection& corrected) const {
    PrintError(corrected.refusal->opening);
    PrintErrorList(corrected.refusal->lines);
    const std::vector<std::string> assumed = Assumed(program, corrected);
    if (!assumed.empty()) std::cerr << "Assumed\n";
    PrintErrorList(FirstOf(assumed));
    return kExitBadInput;
  }

  std::vector<std::string> Assumed(const RobotProgram& program,
                                   const ProgramCorrection& corrected) const {
    std::vector<std::string> assumed = corrected.assumed;
    if (IsFactoryCalibrated(program)) {
      assumed.emplace_back(
          "the controller computes with the arm of the data sheet; those of "
          "Universal Robots compute with their factory's calibration: give it "
          "by --nominal (docs/controllers/universal_robots.md)");
    }
    return assumed;
  }

  // Whose controller has another arm than any file that comes with Alidade.
  bool IsFactoryCalibrated(const RobotProgram& program) const {
    return program.language == ProgramLanguage::kUrScript &&
           !RobotNameOf(source_.nominal_path).empty();
  }

  static void WriteFileWithFolder(const std::string& path,
                                  const std::string& text) {
    const fs::path folder = fs::path(path).parent_path();
    if (!folder.empty()) MakeDirectories(folder.string());
    WriteFileAtomically(path, text);
  }

  // Whole poses are targets, and joint values beside them their posture;
  // without orientations joint values are the targets.
  Correction Correct(const TargetTable& table) {
    const bool has_pose = table.format.form != OrientationForm::kNone;
    if (table.has_joints && (!has_pose || line_.from == "joints")) {
      return CorrectJoints(arms_, table.motors, options_);
    }
    if (!has_pose) {
      if (arms_.nominal.num_joints() > 5) {
        throw InputError({table.path, 0, 0, ""},
                         "positions without orientations, expected rx_deg ... "
                         "(with --rotation), qw ... or wx_deg ...: the "
                         "posture of six joints hangs on them");
      }
      options_.solver.task = PoseTask::kPosition;
    }
    return CorrectPoses(arms_, table.poses, table.motors, options_);
  }

  static std::vector<std::string> RowNames(const TargetTable& table) {
    std::vector<std::string> names;
    for (Eigen::Index i = 0; i < table.num_rows; ++i) {
      names.push_back("row " + std::to_string(i + 1));
    }
    return names;
  }

  CorrectionReport ReportOf(const Correction& correction,
                            std::vector<std::string> names) const {
    CorrectionReport report{correction, source_.real.name};
    report.nominal_name = NominalName(source_);
    report.validation = source_.validation;
    report.before = source_.before;
    report.is_result = IsResult(line_.files[0]);
    report.names = std::move(names);
    // What the real arm does.
    const Eigen::MatrixXd joints =
        JointsFromMotors(arms_.real, line_.inverse ? correction.asked_motors
                                                   : correction.motors);
    // Results keep the covariance of the parameters, which alone says too much
    // of an arm whose error terms were estimated with them.
    if (source_.calibrated && source_.calibrated->arm.errors.empty()) {
      report.position_std = Deviations(joints);
    }
    if (source_.measured.size() > 0) AddOutside(joints, &report);
    return report;
  }

  Eigen::VectorXd Deviations(const Eigen::MatrixXd& joints) const {
    const Arm& arm = source_.calibrated->arm;
    const MeasurementModel model(arm, line_.threads);
    const auto covariances =
        PredictCovariances(model, model.NominalValues(),
                           source_.calibrated->covariance, joints, target_);
    Eigen::VectorXd deviations(joints.cols());
    for (Eigen::Index i = 0; i < joints.cols(); ++i) {
      deviations[i] = std::sqrt(covariances[i].position.trace());
    }
    return deviations;
  }

  void AddOutside(const Eigen::MatrixXd& joints,
                  CorrectionReport* report) const {
    // Corrections themselves take joints a little out of it.
    constexpr double kMargin = 0.02;  // rad, m
    for (const auto& q : joints.colwise()) {
      std::vector<std::string> names;
      std::vector<std::string> values;
      for (Eigen::Index j = 0; j < q.size(); ++j) {
        if (q[j] >= source_.measured(j, 0) - kMargin &&
            q[j] <= source_.measured(j, 1) + kMargin) {
          continue;
        }
        const bool turns = arms_.real.joints[j].type == JointType::kRevolute;
        const double unit = turns ? kDegree : kMillimetre;
        const std::string name = "q" + std::to_string(j + 1);
        names.push_back(name);
        values.push_back(
            name + " = " + FixedNumber(q[j] / unit, 1) + ", measured " +
            FixedNumber(source_.measured(j, 0) / unit, 1) + " to " +
            FixedNumber(source_.measured(j, 1) / unit, 1) +
            (turns ? " deg" : " mm"));
      }
      report->outside.push_back(Join(names, " "));
      report->outside_values.push_back(Join(values, "; "));
    }
  }

  std::vector<AddedColumn> Columns(const TargetTable& table,
                                   const CorrectionReport& report) const {
    const Correction& correction = report.correction;
    const std::string prefix = line_.inverse ? "restored_" : "corrected_";
    PoseFormat format = table.format;
    if (!table.has_positions) format.form = OrientationForm::kVector;
    std::vector<AddedColumn> columns =
        PoseColumns(prefix, correction.poses, format, table.numbers);
    for (AddedColumn& column :
         MotorColumns(prefix, arms_.nominal, correction.motors)) {
      columns.push_back(std::move(column));
    }
    const PoseSolutions& solutions = correction.solutions;
    columns.push_back(
        NumberColumn("correction_mm", correction.shift, kMillimetre, 6));
    columns.push_back(
        NumberColumn("correction_deg", correction.turn, kDegree, 6));
    columns.push_back(
        NumberColumn("remaining_mm", solutions.position_error, kMillimetre, 9));
    columns.push_back(
        NumberColumn("remaining_deg", solutions.rotation_error, kDegree, 9));
    if (report.position_std.size() > 0) {
      columns.push_back(NumberColumn("predicted_std_mm", report.position_std,
                                     kMillimetre, 6));
    }
    if (!report.outside.empty()) {
      columns.push_back({"outside_measured", report.outside});
    }
    AddedColumn status{"status", {}};
    for (Eigen::Index i = 0; i < table.num_rows; ++i) {
      status.cells.push_back(StatusOf(correction, i));
    }
    columns.push_back(std::move(status));
    return columns;
  }

  const CommandLine& line_;
  const ArmSource source_;
  const std::string out_;
  std::vector<std::string> outputs_;  // as the program's files
  int target_ = 0;
  CorrectionArms arms_;
  CorrectionOptions options_;
};

}  // namespace

ExitStatus RunCorrect(const CommandLine& line) {
  if (!line.from.empty() && line.from != "joints" && line.from != "poses") {
    throw InputError({}, "--from=" + line.from + ", expected joints or poses");
  }
  RequireOrder(line);
  return CorrectCommand(line).Run();
}

}  // namespace alidade::internal
