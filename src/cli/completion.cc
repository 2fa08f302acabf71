#include <iostream>
#include <string>

#include "alidade/error.h"
#include "src/cli/command.h"
#include "src/cli/flags.h"

namespace alidade::internal {
namespace {

// For between single quotes of a shell, with a backslash before each of
// `special`.
std::string Escaped(const std::string& text, const std::string& special) {
  std::string escaped;
  for (const char c : text) {
    if (special.find(c) != std::string::npos) escaped += '\\';
    escaped += c == '\'' ? "'\\''" : std::string(1, c);
  }
  return escaped;
}

std::string Bash() {
  std::string commands;
  std::string cases;
  for (const Command& command : Commands()) {
    commands += (commands.empty() ? "" : " ") + std::string(command.name);
    cases += "      " + std::string(command.name) + ") words=\"";
    std::string separator;
    for (const FlagHelp& flag : FlagsOf(command)) {
      cases += separator + "--" + flag.name + (flag.value.empty() ? "" : "=");
      separator = " ";
    }
    cases += "\" ;;\n";
  }
  return "_alidade() {\n"
         "  local current=${COMP_WORDS[COMP_CWORD]} words=\n"
         "  if ((COMP_CWORD == 1)); then\n"
         "    words=\"" +
         commands +
         " --help --version\"\n"
         "  elif [[ $current == -* ]]; then\n"
         "    case ${COMP_WORDS[1]} in\n" +
         cases +
         "    esac\n"
         "  fi\n"
         "  COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n"
         "  [[ ${COMPREPLY[0]-} != *= ]] || compopt -o nospace\n"
         "}\n"
         "complete -o default -F _alidade alidade\n";
}

std::string Zsh() {
  std::string commands;
  std::string cases;
  for (const Command& command : Commands()) {
    commands += "    '" + std::string(command.name) + ":" +
                Escaped(command.summary, ":\\") + "'\n";
    cases += "    " + std::string(command.name) + ") _arguments";
    for (const FlagHelp& flag : FlagsOf(command)) {
      const std::string value =
          flag.value.empty() ? "" : ":" + flag.value + ":_files";
      cases += " \\\n      '--" + flag.name + (value.empty() ? "[" : "=[") +
               Escaped(flag.text, "[]:\\") + "]" + value + "'";
    }
    cases += " \\\n      '*:file:_files' ;;\n";
  }
  return "#compdef alidade\n"
         "_alidade() {\n"
         "  local -a commands=(\n" +
         commands +
         "  )\n"
         "  if ((CURRENT == 2)); then\n"
         "    _describe command commands\n"
         "    return\n"
         "  fi\n"
         "  shift words\n"
         "  ((CURRENT--))\n"
         "  case $words[1] in\n" +
         cases +
         "  esac\n"
         "}\n"
         "_alidade \"$@\"\n";
}

std::string Fish() {
  std::string text;
  for (const Command& command : Commands()) {
    text += "complete -c alidade -n __fish_use_subcommand -f -a " +
            std::string(command.name) + " -d '" +
            Escaped(command.summary, "\\") + "'\n";
    for (const FlagHelp& flag : FlagsOf(command)) {
      text += "complete -c alidade -n '__fish_seen_subcommand_from " +
              std::string(command.name) + "' -l " + flag.name +
              (flag.value.empty() ? "" : " -r") + " -d '" +
              Escaped(flag.text, "\\") + "'\n";
    }
  }
  return text;
}

}  // namespace

ExitStatus RunCompletion(const CommandLine& line) {
  const std::string& shell = line.files.front();
  if (shell == "bash") {
    std::cout << Bash();
  } else if (shell == "zsh") {
    std::cout << Zsh();
  } else if (shell == "fish") {
    std::cout << Fish();
  } else {
    throw InputError({}, "completion: unknown shell \"" + shell +
                             "\", expected bash, zsh or fish");
  }
  return kExitDone;
}

}  // namespace alidade::internal
