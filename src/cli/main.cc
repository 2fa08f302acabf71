#include <glog/logging.h>

#include <algorithm>
#include <cctype>
#include <csignal>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "alidade/error.h"
#include "alidade/version.h"
#include "src/cli/command.h"
#include "src/cli/flags.h"
#include "src/cli/launch.h"
#include "src/common/names.h"
#include "src/common/text.h"
#include "src/serialization/described_formats.h"

namespace alidade::internal {
namespace {

// help2man takes lines of that many spaces for the text of the flag above.
constexpr std::size_t kHelpColumn = 20;
constexpr std::size_t kHelpWidth = 80;

void PrintFlag(const FlagHelp& flag) {
  std::string left = "  --" + flag.name;
  if (!flag.value.empty()) left += "=" + flag.value;
  // One that leaves no gap before the text has a line of its own, as help2man
  // knows it.
  if (left.size() + 2 > kHelpColumn) {
    std::cout << left << "\n";
    left.clear();
  }
  left.resize(kHelpColumn, ' ');
  std::string indent = left;
  for (const std::string& line :
       WrapText(flag.text, static_cast<int>(kHelpWidth - kHelpColumn))) {
    std::cout << indent << line << "\n";
    indent.assign(kHelpColumn, ' ');
  }
}

// Each line of the text wrapped, a paragraph of its own.
std::string Paragraphs(const std::string& text) {
  std::string wrapped;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    wrapped += (wrapped.empty() ? "" : "\n") +
               Join(WrapText(line, static_cast<int>(kHelpWidth) - 6), "\n") +
               "\n";
  }
  return wrapped;
}

// Of the installation that the program belongs to, wherever that has been
// moved; else of the source tree.
std::string DocumentationFolder() {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  for (const fs::path& folder :
       {program.parent_path() / ALIDADE_DOCS_FROM_PROGRAM,
        fs::path(ALIDADE_SOURCE_DOCS)}) {
    const fs::path found = fs::canonical(folder, error);
    if (!error && fs::exists(found / "docs/files.md", error)) {
      return found.string();
    }
  }
  return ALIDADE_INSTALLED_DOCS;
}

void PrintUsage(std::ostream& out) {
  out << "alidade " << Version()
      << ": the true geometry of a robot arm from measured poses\n\n"
         "usage: alidade COMMAND [flags] FILE...\n\n";
  for (const Command& command : Commands()) {
    out << "  " << command.name
        << std::string(12 - std::string(command.name).size(), ' ')
        << command.summary << "\n";
  }
  out << "\n'alidade COMMAND --help' says more of one; 'alidade --version' "
         "prints the version.\n"
         "Exit status: 0 done; 1 an acceptance limit is missed or a check "
         "failed; 2 bad\nusage or input; 3 a numerical failure.\n"
         "Documentation: "
      << DocumentationFolder() << "\n";
}

void PrintHelp(const Command& command) {
  std::cout << "usage: alidade " << command.name << " [flags] "
            << command.arguments << "\n\n"
            << Paragraphs(command.help) << "\n";
  for (const FlagHelp& flag : FlagsOf(command)) PrintFlag(flag);
  for (const DescribedFormat& format : DescribeFormats()) {
    std::string file = format.name + ".yaml";
    std::transform(file.begin(), file.end() - 5, file.begin(),
                   [](unsigned char c) { return std::toupper(c); });
    if (std::string(command.arguments).find(file) == std::string::npos) {
      continue;
    }
    std::cout << "\n'alidade keys " << format.name
              << "' lists all that the file " << file << " may say.\n";
  }
  std::cout << "\nPages that are named here are in " << DocumentationFolder()
            << "\n";
}

const Command& FindCommand(const std::string& name) {
  for (const Command& command : Commands()) {
    if (command.name == name) return command;
  }
  std::vector<std::string> names;
  for (const Command& command : Commands()) names.emplace_back(command.name);
  const std::optional<std::string> nearest = NearestName(name, names);
  throw InputError({}, "unknown command \"" + name + "\"" +
                           (nearest ? ", did you mean \"" + *nearest + "\"?"
                                    : std::string(";")) +
                           " 'alidade --help' lists the commands");
}

ExitStatus RunCommand(const std::string& name,
                      const std::vector<std::string>& arguments) {
  const Command& command = FindCommand(name);
  const std::optional<CommandLine> line = ParseArguments(command, arguments);
  if (!line) {
    PrintHelp(command);
    return kExitDone;
  }
  if (const Launch launch = FindLaunch();
      launch.are_several() && !command.runs_on_several) {
    ThrowUsage(command, "runs as one process, and " +
                            std::to_string(launch.size) +
                            " were started together");
  }
  return command.run(*line);
}

ExitStatus Main(const std::vector<std::string>& arguments) {
  if (arguments.empty()) {
    PrintUsage(std::cerr);
    return kExitBadInput;
  }
  const std::string& first = arguments.front();
  if (first == "--help" || first == "-h" || first == "help") {
    if (arguments.size() > 1) {
      PrintHelp(FindCommand(arguments[1]));
    } else {
      PrintUsage(std::cout);
    }
    return kExitDone;
  }
  if (first == "--version") {
    std::cout << "alidade " << Version() << "\n" << BuildDescription() << "\n";
    return kExitDone;
  }
  return RunCommand(first, {arguments.begin() + 1, arguments.end()});
}

// Where the environment contradicts itself Run says so.
bool IsFirst() {
  try {
    return FindLaunch().rank == 0;
  } catch (const InputError&) {
    return true;
  }
}

// What every way out of the program comes to.
ExitStatus Run(const std::vector<std::string>& arguments) {
  try {
    const ExitStatus status = Main(arguments);
    std::cout.flush();
    if (!std::cout) {
      PrintError("standard output cannot be written");
      return kExitBadInput;
    }
    return status;
  } catch (const InputError& error) {
    PrintError(error.what());
    return kExitBadInput;
  } catch (const std::filesystem::filesystem_error& error) {
    PrintError(error.path1().string() + ": " + error.code().message());
    return kExitBadInput;
  } catch (const std::bad_alloc&) {
    PrintError("out of memory");
    return kExitNumerical;
  } catch (const std::exception& error) {
    PrintError(std::string("internal error: ") + error.what());
    return kExitNumerical;
  }
}

}  // namespace
}  // namespace alidade::internal

int main(int argc, char** argv) {
  // A file that may not grow further (ulimit -f) is reported as a full disk is.
  std::signal(SIGXFSZ, SIG_IGN);
  FLAGS_logtostderr = true;
  FLAGS_log_prefix = false;
  google::InitGoogleLogging(argv[0]);
  const bool is_first = alidade::internal::IsFirst();
  if (!is_first) alidade::internal::Mute();
  const alidade::internal::ExitStatus status =
      alidade::internal::Run({argv + 1, argv + argc});
  // Processes that were started together end with the status of the first:
  // another one's, if it came earlier, would have the first killed before it
  // has said why.
  return is_first ? status : alidade::internal::kExitDone;
}
