#ifndef ALIDADE_SRC_JOB_RESULT_TABLE_H_
#define ALIDADE_SRC_JOB_RESULT_TABLE_H_

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "alidade/calibration_result.h"
#include "src/common/mapped_file.h"

namespace alidade::internal {

/// A table as a result directory holds it, by columns.
struct ResultTable {
  std::vector<std::string> columns;
  /// One list per column; NaN where a cell holds no number.
  std::vector<std::vector<double>> numbers;
  /// The cells of columns that were asked for as text, else empty.
  std::vector<std::vector<std::string>> texts;
  std::size_t num_rows = 0;

  /// -1 where there is no such column.
  int Column(const std::string& name) const;
  /// Of the column of this name; NaN where there is none.
  double Number(std::size_t row, const std::string& name) const;
};

/// Reads a CSV that Alidade wrote, the header first. Short rows are filled with
/// empty cells, long ones cut. @throws InputError where a quote is not closed.
ResultTable ReadResultTable(const MappedFile& file,
                            const std::set<std::string>& text_columns);

/// Fills in what residuals.csv or validation.csv hold of a set: joint values,
/// labels, positions and residuals; of orientations their angles alone.
void ReadObservations(const ResultTable& table, EvaluatedSet* set);

/// Fills in what joint_residuals.csv holds.
void ReadJointResiduals(const ResultTable& table, JointResiduals* residuals);

/// Fills in all that the tables of a result directory hold besides its
/// result.json, and the calibrated arm. Files that are missing are left out.
/// @throws InputError.
void ReadResultTables(const std::string& directory, CalibrationResult* result);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_RESULT_TABLE_H_
