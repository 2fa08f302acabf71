#ifndef ALIDADE_SRC_REPORT_HTML_TABLE_H_
#define ALIDADE_SRC_REPORT_HTML_TABLE_H_

#include <string>

#include "src/report/html_report.h"

namespace alidade::internal {

/// {"total": rows of the table, "index": those that are here, from 1,
/// "columns": {name: [values]}}: numbers with the digits that a figure needs,
/// empty cells as null.
std::string TableJson(const ResultTable& table);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_HTML_TABLE_H_
