#ifndef ALIDADE_SRC_CLI_TARGETS_H_
#define ALIDADE_SRC_CLI_TARGETS_H_

#include <optional>
#include <string>
#include <vector>

#include "src/cli/command.h"
#include "src/dataio/rotation_convention.h"
#include "src/dataio/target_table.h"

namespace alidade::internal {

// What fk, ik and correct share.

/// Of --rotation; nothing where it is not given. @throws InputError.
std::optional<RotationConvention> RotationFlag(const CommandLine& line);

/// The number of the target that --target names, 0 without. @throws InputError.
int TargetFlag(const CommandLine& line, const Arm& arm);

/// To --out, or to standard output. @throws InputError where it is one of
/// `inputs`.
void WriteTable(const CommandLine& line, const std::string& text,
                const std::vector<std::string>& inputs);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CLI_TARGETS_H_
