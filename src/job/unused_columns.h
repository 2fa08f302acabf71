#ifndef ALIDADE_SRC_JOB_UNUSED_COLUMNS_H_
#define ALIDADE_SRC_JOB_UNUSED_COLUMNS_H_

#include <string>
#include <vector>

#include "src/dataio/column_roles.h"
#include "src/job/import_request.h"
#include "src/job/import_text.h"
#include "src/job/imported_column.h"

namespace alidade::internal {

/// A file that is imported, as far as it is understood.
struct ImportedTable {
  const ImportRequest& request;
  const ColumnRoles& roles;
  const ImportText& text;
  const LineRanges& excluded;  ///< also what was found to be lost
};

/// What is said of columns that are passed over and look as if they were of
/// use, and how a job uses them.
std::vector<std::string> NotesOnUnused(
    const std::vector<ImportedColumn>& columns, const ImportedTable& table);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_UNUSED_COLUMNS_H_
