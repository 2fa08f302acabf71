#include "src/cli/command.h"

#include <filesystem>
#include <iostream>
#include <limits>

#include "src/common/characters.h"
#include "src/common/utf8.h"
#include "src/dataio/dataset_npy.h"

namespace alidade::internal {
namespace {

constexpr int kAnyNumber = std::numeric_limits<int>::max();

// Summaries are one line; help is wrapped where it is printed.
// Tables of texts, as long as there are commands.
// NOLINTBEGIN(readability-function-size)

std::vector<Command> InputCommands() {
  return {
      Command(
          {"robots", "[NAME]", "list the arm files that come with the program",
           "Prints the names by which jobs and commands take them, "
           "'robots/ur10e' for one, and the folders that they are in; with "
           "NAME those that have it in theirs. Folders of your own go "
           "first: ALIDADE_ROBOTS=DIR:DIR..."},
          {}, 0, 1, RunRobots),
      Command(
          {"show", "ARM.yaml [DATA.csv] | JOB.yaml | RESULT.json",
           "print an arm, a data set, a job or a result as a table",
           "Prints what a file says, in mm and deg. A data set is read with "
           "the arm named before it. RESULT.json may also be a result "
           "directory."},
          {}, 1, 2, RunShow),
      Command({"check", "FILE...",
               "validate YAML and data files without running anything",
               "Reads every file, and the files that jobs and simulations "
               "name, and prints one line each. Data are read with the arm "
               "named before it. All files are looked at; the exit status is 2 "
               "where one is wrong."},
              {}, 1, kAnyNumber, RunCheck),
      Command({"keys", "[FORMAT[.SECTION]]",
               "list what files may say: keys, units, defaults, meaning",
               "FORMAT is arm, deviations, job, plan or simulation, or data, "
               "errors or simulate, parts of these; SECTION a map in it, as in "
               "'job.uncertainty'. Without any, their names."},
              {}, 0, 1, RunKeys),
      Command(
          {"convert", "IN OUT --arm=ARM.yaml",
           "turn a data set from CSV into a NumPy array, or back",
           "The names' endings, .csv and .npy, say which way. Arrays are read "
           "several times faster. Numbers are kept to the last bit, "
           "orientations, as rotation vectors, to rounding. Several targets, "
           "sets and other kinds of measurement than positions and "
           "orientations are refused."},
          {"arm"}, 2, 2, RunConvert),
      Command(
          {"import", "FILE [FILE --match=COLUMN] --arm=ARM.yaml",
           "read another program's measurements; write data set and job",
           "FILE is a text of any form that is certain: separators, decimal "
           "commas, encodings, titles, rows of units and words for what is "
           "missing are found (docs/files.md, \"Files of other programs\"), "
           "joints and position by the names of columns, units that these do "
           "not state by the arm. Shows a table of what it understood, and "
           "writes data.csv and job.yaml, ready for `calibrate`, below "
           "--out=DIR (default: results/ and the file's name). What is not "
           "certain is refused, and said what to state; footers and other "
           "lines of no measurement are left out by --exclude. A job.yaml that "
           "is there and says something else is kept as job.yaml.old.\n"
           "Two files are put together by the points' names in their rows, a "
           "controller's log of joint values and an instrument's list of "
           "positions, say: --match names the column."},
          {"arm", "out", "units", "rotation", "exclude", "match"}, 1, 2,
          RunImport),
      Command(
          {"simulate", "SIMULATION.yaml",
           "write a data set from an arm, its deviations, poses and noise",
           "Plans the poses with the nominal arm, measures them with the real "
           "one and writes them to the simulation's output, or to --out=FILE: "
           "a NumPy array where the name ends in .npy, else a CSV. The same "
           "seed gives the same bytes."},
          {"out", "seed"}, 1, 1, RunSimulate),
      Command(
          {"plan", "PLAN.yaml | --check RESULT",
           "choose the poses to measure next",
           "Chooses the poses with most information, of candidates drawn "
           "within joint limits and the plan's constraints or read from a "
           "file, beside "
           "those measured already. Prints the accuracy to expect by the "
           "number of poses and writes to --out=DIR (default: results/ and the "
           "plan's name): poses.csv for the robot, `simulate` and what will be "
           "measured, plan.txt, accuracy.svg, curve.csv, plan.html, "
           "plan.json.\n"
           "With --check and a result of `calibrate`: the --poses that show "
           "best whether the arm is as calibrated and its correction works, "
           "what they can show, and a data set to be filled in and given to "
           "`validate --check` (--out=FILE.csv; default: results/ and its name "
           "with _check)."},
          {"out", "seed", "check", "poses", "refit", "nominal"}, 1, 1,
          RunPlanCommand),
  };
}

std::vector<Command> CalibrationCommands() {
  return {
      Command(
          {"identify", "JOB.yaml | ARM.yaml [DATA.csv]",
           "show which parameters these poses can identify, and why",
           "Prints the decision for each parameter, the ranks it rests on and "
           "what to look out for. Nothing is solved or written. Of an arm "
           "alone it says what positions of its target at random poses would "
           "identify, with base and tool unknown."},
          {"seed"}, 1, 2, RunIdentify),
      Command(
          {"calibrate", "JOB.yaml",
           "run a whole calibration job and write its results",
           "Identifies, solves, validates, and writes the result directory "
           "--out=DIR (default: results/ and the job's name; of a file called "
           "job.yaml, `result` beside it): arm.yaml, "
           "result.json, report.txt, CSV files and SVG figures, and with "
           "--report report.html, a page that holds all of it.\n"
           "Exit status 1: an acceptance limit of the job is missed; 3: there "
           "is no solution, or one that must not be used. Of the latter "
           "nothing is written, but with --keep-rejected all, its arm as "
           "arm.rejected.yaml.\n"
           "Under 'mpirun -n K' every process reads some of the data's files, "
           "and the result has the same bits (docs/cluster.md)."},
          {"out", "seed", "report", "keep-rejected"}, 1, 1, RunCalibrate, true),
      Command(
          {"compare", "JOB.yaml",
           "run the same job by every solver, side by side",
           "Prints cost and error per iteration, times and where the solutions "
           "differ. With --out=DIR the curves are written as CSV and figures. "
           "A job with a `noise_study` is also calibrated many times with "
           "fresh noise, by the published procedure and by Alidade's own."},
          {"out", "seed"}, 1, 1, RunCompare),
      Command(
          {"montecarlo", "JOB.yaml",
           "calibrate simulated measurements many times: bias, spread, "
           "coverage",
           "Simulates the job's poses with its sigmas, as the job's "
           "`montecarlo` says, and calibrates each time: by default 1000 "
           "times, the real arm being the job's `truth` or, without one, the "
           "arm that the job identifies (a parametric bootstrap). Prints how "
           "far estimates stray, how often their intervals hold the truth, and "
           "how accurate the arm becomes over its workspace. With --out=DIR "
           "also as CSV, figures and a page, montecarlo.html."},
          {"out", "seed"}, 1, 1, RunMonteCarlo),
  };
}

std::vector<Command> ResultCommands() {
  return {
      Command(
          {"validate",
           "ARM.yaml | RESULT  DATA.csv... | JOB.yaml | REFERENCE.yaml",
           "accuracy of an arm on data, or against another arm",
           "With data sets: errors of the arm's predictions at their poses; a "
           "job names them by its `data` where more is to be said of them "
           "(columns, angles, targets, contacts). --refit=base,tool,references "
           "finds these anew from each set, where the instrument or the tool "
           "stood elsewhere; points and planes that nobody knows are found in "
           "any case. "
           "With a second arm: distance between the two over 10 000 joint "
           "values drawn within the limits of the first (--seed), as they "
           "stand and with base and tool aligned. With a "
           "result directory of `calibrate` instead of an arm: also whether "
           "errors are as large as predicted, by the share that lies within "
           "its intervals, and the predicted accuracy over the workspace; "
           "--out=DIR writes the map and a histogram of errors over their "
           "predictions.\n"
           "With --check, a result and one data set of a few poses: PASSED or "
           "FAILED, whether errors are as predicted for the arm as it was "
           "calibrated, with the changes that these poses would show. Exit "
           "status 1 where it failed."},
          {"seed", "out", "check", "corrected", "refit", "nominal"}, 2,
          kAnyNumber, RunValidate),
      Command(
          {"correct", "RESULT | ARM.yaml  TARGETS.csv | PROGRAM",
           "targets and programs for a controller that believes in the nominal "
           "arm",
           "Reads poses (columns as data sets have them) or joint values and "
           "writes the same file with columns added: the pose and the joint "
           "values to command so that the real arm reaches the target, the "
           "size of the correction, what remains and whether it is reached. "
           "Prints a summary; --out=FILE names the table (default: its name "
           "in results/corrected), a figure stands beside it. "
           "--inverse takes corrected targets and restores what they were.\n"
           "Poses are those that the nominal arm gives, of its tool in its "
           "base frame: what the controller shows.\n"
           "Programs are known by their endings: .script (URScript), .src and "
           ".dat (KUKA), .mod (ABB), .ls (Fanuc). Their positions are "
           "rewritten in place, of a .src together with the .dat beside it; "
           "what is computed at run time is listed and not "
           "touched, a tool that the program sets nowhere is assumed and "
           "listed, and where a position is not understood nothing is "
           "written (docs/robot.md)."},
          {"nominal", "inverse", "from", "frames", "rotation", "target",
           "calibrated-tool", "out", "seed"},
          2, 2, RunCorrect),
      Command(
          {"export", "RESULT | ARM.yaml  --as=FORMAT",
           "the calibrated arm as other programs and controllers take it",
           "dh, mdh: Denavit-Hartenberg tables (--table); offsets: zeros of "
           "the "
           "joints alone; ur: the kinematics file of Universal Robots' ROS "
           "driver; urdf: the URDF of the nominal arm with new origins, every "
           "other byte as it is; json: the arm file in JSON; frames: base and "
           "targets with their standard deviations, as --frames of `correct` "
           "reads them (angles by --rotation). What a format "
           "lacks is made up for by the numbers that it has, and it is said "
           "what is lost and what that costs over the workspace. The text goes "
           "to standard output or --out=FILE (docs/robot.md)."},
          {"as", "table", "nominal", "rotation", "out"}, 1, 1, RunExport),
      Command(
          {"fk", "ARM.yaml | RESULT  JOINTS.csv", "poses of joint values",
           "Adds to each row of joint values the pose of the arm's target in "
           "the instrument's frame, with all that the arm file holds: x_mm, "
           "y_mm, z_mm and the rotation vector wx_deg ..., or with --rotation "
           "angles rx_deg .... The table goes to standard output or "
           "--out=FILE."},
          {"rotation", "target", "out"}, 2, 2, RunFk),
      Command(
          {"ik", "ARM.yaml | RESULT  POSES.csv", "joint values of poses",
           "Adds to each row of a pose the joint values that bring the arm's "
           "target there, what remains, and whether it is reached. Joint "
           "values in the table are where each solution starts, and so choose "
           "its posture; without, each starts at the one before. The table "
           "goes to standard output or --out=FILE."},
          {"rotation", "target", "out", "seed"}, 2, 2, RunIk),
      Command(
          {"report", "RESULT...",
           "make an HTML page of a result, or one that compares several",
           "RESULT is a result directory or its result.json. One makes its "
           "report.html, several make comparison.html, or what --out names: a "
           "page (.html) or a folder. A page needs no network and no server. "
           "It prints its path."},
          {"out", "read-as"}, 1, kAnyNumber, RunReport),
      Command(
          {"batch", "JOB.yaml... | DIR | --list=FILE",
           "run many jobs, a matrix of each, resumable",
           "Runs every job named, every job of a folder, and every combination "
           "of a job's `matrix`, --threads of them at a time, and writes each "
           "result directory below --out=DIR (default: results/batch), and "
           "summary.csv, summary.json and comparison.html, a page of all "
           "results. The same command again runs only what is missing or "
           "changed. Under mpirun, which starts several processes, the first "
           "hands out jobs as others become free. Exit status: the highest of "
           "all jobs."},
          {"out", "list", "dry-run", "keep-going", "fail-fast", "outputs"}, 0,
          kAnyNumber, RunBatchCommand, true),
      Command({"completion", "bash | zsh | fish",
               "what a shell needs to complete commands and flags",
               "Prints a script. Packages install it; without one, "
               "'source <(alidade completion bash)' in ~/.bashrc, or what the "
               "shell's manual says."},
              {}, 1, 1, RunCompletion),
  };
}

// NOLINTEND(readability-function-size)

}  // namespace

const std::vector<Command>& Commands() {
  static const std::vector<Command> kCommands = [] {
    std::vector<Command> all = InputCommands();
    for (const auto& more : {CalibrationCommands(), ResultCommands()}) {
      all.insert(all.end(), more.begin(), more.end());
    }
    return all;
  }();
  return kCommands;
}

void PrintResults(const std::vector<std::string>& paths) {
  std::cout << "\nResults\n";
  for (const std::string& path : paths) std::cout << "  " << path << "\n";
}

std::string OutputDirectory(const CommandLine& line) {
  if (!line.out.empty()) return line.out;
  const std::filesystem::path file = line.files.front();
  if (file.filename() == "job.yaml") {
    return (file.parent_path() / "result").string();
  }
  return "results/" + file.stem().string();
}

void PrintError(const std::string& message) {
  std::cerr << "alidade: " << OnOneLine(message) << std::endl;
}

bool IsDataFile(const std::string& path) {
  if (IsNpy(path)) return true;
  if (path.size() < 4) return false;
  const std::string ending = LowerCase(path.substr(path.size() - 4));
  for (const char* known : {".csv", ".txt", ".tsv", ".dat", ".asc"}) {
    if (ending == known) return true;
  }
  return false;
}

}  // namespace alidade::internal
