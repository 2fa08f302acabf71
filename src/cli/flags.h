#ifndef ALIDADE_SRC_CLI_FLAGS_H_
#define ALIDADE_SRC_CLI_FLAGS_H_

#include <optional>
#include <string>
#include <vector>

#include "src/cli/command.h"

namespace alidade::internal {

/// A flag as --help, completions and manual pages show it.
struct FlagHelp {
  std::string name;   ///< "out"
  std::string value;  ///< "PATH"; empty where it is a switch
  std::string text;   ///< what it does
};

/// The flags that a command takes, its own first.
std::vector<FlagHelp> FlagsOf(const Command& command);

/// What the user wrote after the command's name, with its flags checked; memory
/// and verbosity are set. None where help is asked for.
///
/// Throws InputError for wrong flags and wrong numbers of files.
std::optional<CommandLine> ParseArguments(
    const Command& command, const std::vector<std::string>& arguments);

/// Throws the InputError for a command that was called wrongly.
[[noreturn]] void ThrowUsage(const Command& command,
                             const std::string& problem);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CLI_FLAGS_H_
