#ifndef ALIDADE_SRC_CLI_COMMAND_H_
#define ALIDADE_SRC_CLI_COMMAND_H_

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace alidade::internal {

/// Exit statuses of the program (docs/files.md).
enum ExitStatus {
  kExitDone = 0,
  kExitMissedLimits = 1,  ///< the job ran and missed an acceptance limit
  kExitBadInput = 2,      ///< bad usage or input
  kExitNumerical = 3,     ///< a numerical failure, or a solve that is refused
};

/// Of --seed where it is not given.
inline constexpr std::uint64_t kDefaultSeed = 1;

/// What the user wrote after the command's name.
struct CommandLine {
  std::vector<std::string> files;
  std::string out;             ///< --out; empty = not given
  std::string arm;             ///< --arm; empty = not given
  std::string read_as;         ///< --read-as; empty = not given
  bool report = false;         ///< --report
  bool keep_rejected = false;  ///< --keep-rejected
  std::string list;            ///< --list; empty = not given
  std::string outputs;         ///< --outputs; empty = not given
  bool dry_run = false;
  bool fail_fast = false;
  int threads = 1;
  std::optional<std::uint64_t> seed;
  std::string text;              ///< the whole command line, for the result
  std::string nominal;           ///< --nominal; empty = not given
  std::string rotation;          ///< --rotation; empty = not given
  std::string target;            ///< --target; empty = the first
  std::string from;              ///< --from; empty = not given
  bool inverse = false;          ///< --inverse
  bool calibrated_tool = false;  ///< --calibrated-tool
  std::string as;                ///< --as; empty = not given
  std::string table;             ///< --table; empty = not given
  std::string frames;            ///< --frames; empty = not given
  bool check = false;            ///< --check
  bool corrected = false;        ///< --corrected
  std::string refit;             ///< --refit; empty = not given
  int poses = 0;                 ///< --poses
  std::string units;             ///< --units; empty = not given
  std::string exclude;           ///< --exclude; empty = not given
  std::string match;             ///< --match; empty = not given
};

/// The texts of a command.
struct CommandText {
  const char* name;
  const char* arguments;  ///< "JOB.yaml"
  const char* summary;    ///< one line
  const char* help;       ///< what it reads, does and prints: paragraphs
};

/// One command of the program: a row of the table in command.cc.
struct Command : CommandText {
  using Run = ExitStatus (*)(const CommandLine& line);

  Command(const CommandText& text, std::vector<std::string> own_flags,
          int least_files, int most_files, Run function, bool several = false)
      : CommandText(text),
        flags(std::move(own_flags)),
        min_files(least_files),
        max_files(most_files),
        run(function),
        runs_on_several(several) {}

  /// Flags it takes, besides --help, --threads and --verbosity.
  std::vector<std::string> flags;
  int min_files;
  int max_files;
  Run run;
  /// Whether mpirun may start several processes of it.
  bool runs_on_several;
};

const std::vector<Command>& Commands();

// One file each. All throw InputError for wrong input.
ExitStatus RunRobots(const CommandLine& line);
ExitStatus RunShow(const CommandLine& line);
ExitStatus RunCheck(const CommandLine& line);
ExitStatus RunKeys(const CommandLine& line);
ExitStatus RunConvert(const CommandLine& line);
ExitStatus RunImport(const CommandLine& line);
ExitStatus RunSimulate(const CommandLine& line);
ExitStatus RunPlanCommand(const CommandLine& line);
ExitStatus RunIdentify(const CommandLine& line);
ExitStatus RunCalibrate(const CommandLine& line);
ExitStatus RunCompare(const CommandLine& line);
ExitStatus RunMonteCarlo(const CommandLine& line);
ExitStatus RunValidate(const CommandLine& line);
ExitStatus RunCheckPlan(const CommandLine& line);  ///< plan --check
ExitStatus RunArmCheck(const CommandLine& line);   ///< validate --check
ExitStatus RunFk(const CommandLine& line);
ExitStatus RunIk(const CommandLine& line);
ExitStatus RunExport(const CommandLine& line);
ExitStatus RunCorrect(const CommandLine& line);
ExitStatus RunReport(const CommandLine& line);
ExitStatus RunBatchCommand(const CommandLine& line);
ExitStatus RunCompletion(const CommandLine& line);

/// Prints what has been written, a path a line.
void PrintResults(const std::vector<std::string>& paths);

/// Where a command writes its results: --out, or results/ and the file's name.
/// Of a file job.yaml, whose name says nothing, `result` beside it.
std::string OutputDirectory(const CommandLine& line);

/// Prints "alidade: MESSAGE" on standard error.
void PrintError(const std::string& message);

/// True for names of data sets: they end in ".csv", ".npy" or, as other
/// programs name theirs, ".txt", ".tsv", ".dat" or ".asc", whatever their case.
bool IsDataFile(const std::string& path);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CLI_COMMAND_H_
