#include "src/cli/flags.h"

#include <gflags/gflags.h>
#include <glog/logging.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <utility>

#include "alidade/error.h"
#include "src/cli/launch.h"
#include "src/common/memory.h"
#include "src/common/names.h"
#include "src/serialization/described_formats.h"
#include "src/serialization/job_config.h"
#include "src/serialization/robot_files.h"

// The help of a command shows these texts; the first word of one in capitals
// stands for the flag's value.
DEFINE_string(as, "",
              "FORMAT dh, mdh (Denavit-Hartenberg, standard and modified), "
              "offsets, ur, urdf, json or frames");
DEFINE_string(arm, "", "ARM.yaml the arm that the data are of");
DEFINE_bool(calibrated_tool, false,
            "the tool itself was calibrated, and the controller's is wrong");
DEFINE_bool(check, false,
            "a few poses that show whether an arm is as it was calibrated");
DEFINE_bool(corrected, false,
            "with --check: the joint values are those asked for, and the robot "
            "was given what `correct` makes of them");
DEFINE_bool(dry_run, false, "print what would run, a line a job");
DEFINE_string(
    exclude, "",
    "ROWS left out, with commas between: lines of the file (12, "
    "40-45, 130-; of two files points.txt:12) and conditions ('status = "
    "lost')");
DEFINE_bool(fail_fast, false, "start no more jobs once one is not done");
DEFINE_string(
    frames, "",
    "FILE.csv tools and bases that a program refers to and does not "
    "state: columns name, x_mm, y_mm, z_mm and an orientation; the rows "
    "tool and base hold where it sets none");
DEFINE_string(from, "",
              "WHAT targets are, where a table has both: poses (joint values "
              "are their posture), the default, or joints");
DEFINE_bool(inverse, false, "undo a correction");
DEFINE_bool(keep_rejected, false,
            "write a result that must not be used, its arm as "
            "arm.rejected.yaml");
DEFINE_bool(keep_going, false,
            "run all jobs whatever becomes of one, the default");
DEFINE_string(list, "",
              "FILE jobs and folders, one a line, from the list's folder");
DEFINE_string(match, "",
              "COLUMN of two files that names the points, or one of each, "
              "Point,Name: rows of the same point are put together; A::P1 is "
              "P1");
DEFINE_string(nominal, "",
              "ARM.yaml the arm that the controller believes in; of a result, "
              "the one that it was calibrated from by default");
DEFINE_string(out, "", "PATH where results are written");
DEFINE_string(read_as, "",
              "WHAT fleet (arms), time (one arm, in order) or methods (of one "
              "calibration); chosen by the data otherwise");
DEFINE_string(rotation, "",
              "CONVENTION of the columns rx, ry, rz: intrinsic_zyx, "
              "extrinsic_xyz, rotation_vector ...");
DEFINE_int32(poses, 10, "N poses of a check, from 3 to 50; 10 by default");
DEFINE_string(table, "", "FORMAT of tables: csv (the default), yaml, latex");
DEFINE_string(target, "", "NAME of the arm's target, where it has several");
DEFINE_string(
    units, "",
    "UNITS of columns whose names state none: mm,deg, or mm,rad,deg of "
    "lengths, joints and orientations; found by the arm otherwise");
DEFINE_string(refit, "",
              "PARTS found anew from the data before errors are taken: base, "
              "tool, references, with commas between them; of a check base, "
              "tool or both");
DEFINE_bool(report, false, "also write report.html");
DEFINE_string(outputs, "", "WHAT ");  // as a job's `outputs`
DEFINE_uint64(seed, 0, "N seed of all that is drawn, instead of the file's");
DEFINE_int32(threads, 1,
             "N threads to work with, 1 by default; results do not depend on "
             "it");
DEFINE_uint64(memory, 0,
              "MB memory for data and results, half of all by default; what is "
              "more goes to temporary files in $TMPDIR, or /var/tmp");
DEFINE_int32(verbosity, 0,
             "N 0: warnings, 1: what is done, 2: details; on standard error");

namespace alidade::internal {
namespace {

constexpr std::uint64_t kMostMemory = 1000000000;  // MB

// A flag as gflags knows it, which spells '-' as '_'.
gflags::CommandLineFlagInfo FlagNamed(std::string name) {
  std::replace(name.begin(), name.end(), '-', '_');
  gflags::CommandLineFlagInfo flag;
  gflags::GetCommandLineFlagInfo(name.c_str(), &flag);
  return flag;
}

// Those of every command first.
std::vector<std::string> NamesOf(const Command& command) {
  std::vector<std::string> flags = {"threads", "memory", "verbosity"};
  flags.insert(flags.begin(), command.flags.begin(), command.flags.end());
  return flags;
}

bool Accepts(const Command& command, const std::string& flag) {
  const std::vector<std::string> flags = NamesOf(command);
  return std::find(flags.begin(), flags.end(), flag) != flags.end();
}

// What a flag does. One that repeats a field of jobs has its words.
std::string DescriptionOf(const std::string& flag) {
  std::string text = FlagNamed(flag).description;
  if (text.back() != ' ') return text;
  for (const FieldRecord& field : JobFields()) {
    if (field.key.name == flag) text += field.text;
  }
  text.erase(std::remove(text.begin(), text.end(), '`'), text.end());
  return text;
}

// "-90" is a number.
bool IsFlag(const std::string& argument) {
  return argument.size() > 1 && argument[0] == '-' &&
         std::isdigit(static_cast<unsigned char>(argument[1])) == 0 &&
         argument[1] != '.';
}

// gflags' own parser ends the process with status 1 where a flag is wrong, and
// knows nothing of commands; so it is only asked to keep the values.
class ArgumentParser {
 public:
  ArgumentParser(const Command& command, std::vector<std::string> arguments)
      : command_(command), arguments_(std::move(arguments)) {}

  CommandLine Parse() {
    line_.text = std::string("alidade ") + command_.name;
    for (const std::string& argument : arguments_) line_.text += " " + argument;
    bool only_files = false;
    while (next_ < arguments_.size()) {
      const std::string argument = arguments_[next_++];
      if (only_files || !IsFlag(argument)) {
        line_.files.push_back(argument);
      } else if (argument == "--") {
        only_files = true;
      } else {
        SetFlag(argument);
      }
    }
    return line_;
  }

  bool wants_help() const { return wants_help_; }

 private:
  void SetFlag(const std::string& argument) {
    const std::size_t dashes = argument[1] == '-' ? 2 : 1;
    const std::size_t equals = argument.find('=');
    const std::string name = argument.substr(
        dashes, equals == std::string::npos ? equals : equals - dashes);
    if (name == "h" || name == "help") {
      wants_help_ = true;
      return;
    }
    if (!Accepts(command_, name)) {
      const auto nearest = NearestName(name, NamesOf(command_));
      ThrowUsage(command_,
                 "unknown flag " + argument +
                     (nearest ? ", did you mean --" + *nearest + "?" : ""));
    }
    const gflags::CommandLineFlagInfo flag = FlagNamed(name);
    const std::string value = equals != std::string::npos
                                  ? argument.substr(equals + 1)
                              : flag.type == "bool" ? "true"
                                                    : NextArgument(argument);
    if (gflags::SetCommandLineOption(flag.name.c_str(), value.c_str())
            .empty()) {
      ThrowUsage(command_, "--" + name + " = \"" + value +
                               "\" is not a value of this flag");
    }
    if (name == "seed") line_.seed = FLAGS_seed;
  }

  std::string NextArgument(const std::string& flag) {
    if (next_ == arguments_.size()) {
      ThrowUsage(command_, flag + " needs a value");
    }
    return arguments_[next_++];
  }

  const Command& command_;
  std::vector<std::string> arguments_;
  std::size_t next_ = 0;
  bool wants_help_ = false;
  CommandLine line_;
};

// A folder where a file is to say what to do.
void RefuseFolder(const Command& command, const CommandLine& line) {
  namespace fs = std::filesystem;
  const std::string arguments = command.arguments;
  std::error_code error;
  if (line.files.empty() || FLAGS_check ||
      arguments.find("DIR") != std::string::npos ||
      !fs::is_directory(line.files.front(), error)) {
    return;
  }
  for (const char* kind : {"job", "plan", "simulation"}) {
    std::string upper = kind;
    for (char& c : upper) c = static_cast<char>(c - 'a' + 'A');
    if (arguments.rfind(upper + ".yaml", 0) != 0) continue;
    const fs::path file =
        fs::path(line.files.front()) / (std::string(kind) + ".yaml");
    ThrowUsage(command,
               line.files.front() + " is a folder, expected a " + kind +
                   ", which is a YAML file" +
                   (fs::exists(file, error) ? ": " + file.string() : ""));
  }
}

void CheckLine(const Command& command, const CommandLine& line) {
  const auto count = static_cast<int>(line.files.size());
  if (count < command.min_files) {
    ThrowUsage(command, std::string("expected ") + command.arguments);
  }
  if (count > command.max_files) {
    ThrowUsage(command, command.max_files == 0
                            ? "takes no files"
                            : "too many files, expected " +
                                  std::string(command.arguments));
  }
  if (std::string(command.arguments).rfind("JOB.yaml", 0) == 0 && count > 0 &&
      IsDataFile(line.files.front())) {
    ThrowUsage(command, line.files.front() +
                            " is a table of measurements, expected a job: "
                            "'alidade import' makes one of it");
  }
  RefuseFolder(command, line);
  if (FLAGS_threads < 1 || FLAGS_threads > 1024) {
    ThrowUsage(command, "--threads = " + std::to_string(FLAGS_threads) +
                            ", must be between 1 and 1024");
  }
  if (FLAGS_verbosity < 0 || FLAGS_verbosity > 2) {
    ThrowUsage(command, "--verbosity = " + std::to_string(FLAGS_verbosity) +
                            ", must be 0, 1 or 2");
  }
  if (FLAGS_memory > kMostMemory) {
    ThrowUsage(command, "--memory = " + std::to_string(FLAGS_memory) +
                            ", must be a number of MB up to " +
                            std::to_string(kMostMemory));
  }
  if (FLAGS_keep_going && FLAGS_fail_fast) {
    ThrowUsage(command, "--keep-going and --fail-fast, expected one of both");
  }
}

void SetVerbosity() {
  if (FindLaunch().rank != 0) return;
  FLAGS_minloglevel =
      FLAGS_verbosity > 0 ? google::GLOG_INFO : google::GLOG_WARNING;
  FLAGS_v = FLAGS_verbosity > 1 ? 1 : 0;
}

// Wherever a command takes an arm file it takes the name of one, too.
std::string FileOf(const std::string& argument) {
  return ArmPath(argument, argument, {});
}

}  // namespace

void ThrowUsage(const Command& command, const std::string& problem) {
  throw InputError({}, std::string(command.name) + ": " + problem +
                           "; 'alidade " + command.name + " --help' says more");
}

std::vector<FlagHelp> FlagsOf(const Command& command) {
  std::vector<FlagHelp> flags;
  for (const std::string& name : NamesOf(command)) {
    FlagHelp flag = {name, "", DescriptionOf(name)};
    if (FlagNamed(name).type != "bool") {
      const std::size_t space = flag.text.find(' ');
      flag.value = flag.text.substr(0, space);
      flag.text.erase(0, space + 1);
    }
    flags.push_back(std::move(flag));
  }
  flags.push_back({"help", "", "this text"});
  return flags;
}

std::optional<CommandLine> ParseArguments(
    const Command& command, const std::vector<std::string>& arguments) {
  ArgumentParser parser(command, arguments);
  CommandLine line = parser.Parse();
  if (parser.wants_help()) return std::nullopt;
  CheckLine(command, line);
  for (std::string& file : line.files) file = FileOf(file);
  SetVerbosity();
  if (FLAGS_memory > 0) SetMemoryLimit(FLAGS_memory * 1000000);
  return CommandLine{line.files,
                     FLAGS_out,
                     FileOf(FLAGS_arm),
                     FLAGS_read_as,
                     FLAGS_report,
                     FLAGS_keep_rejected,
                     FLAGS_list,
                     FLAGS_outputs,
                     FLAGS_dry_run,
                     FLAGS_fail_fast,
                     FLAGS_threads,
                     line.seed,
                     line.text,
                     FileOf(FLAGS_nominal),
                     FLAGS_rotation,
                     FLAGS_target,
                     FLAGS_from,
                     FLAGS_inverse,
                     FLAGS_calibrated_tool,
                     FLAGS_as,
                     FLAGS_table,
                     FLAGS_frames,
                     FLAGS_check,
                     FLAGS_corrected,
                     FLAGS_refit,
                     FLAGS_poses,
                     FLAGS_units,
                     FLAGS_exclude,
                     FLAGS_match};
}
}  // namespace alidade::internal
