#ifndef ALIDADE_SRC_JOB_IMPORTED_COLUMN_H_
#define ALIDADE_SRC_JOB_IMPORTED_COLUMN_H_

#include <string>

namespace alidade::internal {

/// A column of a file that is imported, as it was understood.
struct ImportedColumn {
  std::string name;
  std::string use;  ///< "joint 1", "x"; empty: passed over
  std::string unit;
  std::string first;  ///< its first cell
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_IMPORTED_COLUMN_H_
