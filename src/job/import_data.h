#ifndef ALIDADE_SRC_JOB_IMPORT_DATA_H_
#define ALIDADE_SRC_JOB_IMPORT_DATA_H_

#include <string>
#include <vector>

#include "src/dataio/data_format.h"
#include "src/job/import_request.h"
#include "src/job/imported_column.h"

namespace alidade::internal {

/// A file of measurements as it was understood.
struct ImportedData {
  std::vector<ImportedColumn> columns;
  std::vector<std::string> notes;  ///< how it is written, what was left out
  LoadedData loaded;
  /// Of the file: those that are read, and those of which a note says why they
  /// are not.
  int num_rows = 0;
  /// Where each pose stands in the file: "Point 17 (line 21)" by the first
  /// column, where that is passed over, or "line 21".
  std::vector<std::string> places;
};

/// Reads positions or poses from a text file of any form that is certain
/// (csv_layout.h, column_roles.h). Units that neither names nor the request
/// state are those under which the positions fit the nominal arm, where only
/// one does so; angles of an orientation beyond a turn are in degrees. Rows of
/// a lost target (lost_targets.h) are left out.
/// @throws InputError where something is not certain; the message says what to
/// state.
ImportedData ImportData(const ImportRequest& request);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_IMPORT_DATA_H_
