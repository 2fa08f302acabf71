#ifndef ALIDADE_SRC_DATAIO_JOINT_TABLES_H_
#define ALIDADE_SRC_DATAIO_JOINT_TABLES_H_

#include <string>
#include <vector>

#include "alidade/arm.h"

namespace alidade::internal {

/// A table of one row per joint, lengths in mm and angles in deg.
struct JointTable {
  std::string name;        ///< of the arm
  std::string convention;  ///< "standard" or "craig"; empty: offsets alone
  std::vector<std::string> keys;  ///< "theta", "d", "a", "alpha"; "offset"
  std::vector<std::vector<double>> rows;  ///< in mm and deg
  std::vector<bool> is_prismatic;
};

/// Of an arm without beta: standard (distal) Denavit-Hartenberg, whose last row
/// has `last_a` and `last_alpha` (m, rad), or Craig's (proximal).
JointTable StandardTable(const Arm& arm, double last_a, double last_alpha);
JointTable CraigTable(const Arm& arm);
/// What `real` has more than `nominal` at each joint's zero.
JointTable OffsetTable(const Arm& nominal, const Arm& real);

std::string FormatCsv(const JointTable& table);
std::string FormatLatex(const JointTable& table);
/// An arm file, or of offsets a map. Base and tool are those of an arm whose
/// last frame is that behind the table.
std::string FormatYaml(const JointTable& table, const Arm& arm);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_JOINT_TABLES_H_
