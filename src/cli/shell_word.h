#ifndef ALIDADE_SRC_CLI_SHELL_WORD_H_
#define ALIDADE_SRC_CLI_SHELL_WORD_H_

#include <string>

namespace alidade::internal {

/// A path in a command that people copy: in single quotes where a shell would
/// read it as something else than one word.
std::string ShellWord(const std::string& path);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CLI_SHELL_WORD_H_
