#ifndef ALIDADE_SRC_DATAIO_DATASET_ROWS_H_
#define ALIDADE_SRC_DATAIO_DATASET_ROWS_H_

#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "alidade/references.h"
#include "src/dataio/data_format.h"
#include "src/dataio/data_table.h"
#include "src/dataio/dataset_columns.h"
#include "src/dataio/observation_table.h"

namespace alidade::internal {

/// Turns the rows of a table into poses and observations.
class DatasetRows {
 public:
  /// The arguments must outlive the object.
  DatasetRows(const DataTable& table, const DatasetColumns& columns,
              const MeasuredGroups& groups, const DataFile& file);

  /// Threads may read different rows at the same time. @throws InputError.
  void Read(const TableRow& row);

  /// To be called once, when all rows are read. Points and planes are looked up
  /// in `references`, in the order of rows; those that are not there are
  /// appended. @throws InputError.
  LoadedData Finish(References* references);

 private:
  using Reader = void (DatasetRows::*)(const TableRow&, ObservationTable*);

  void AddGroup(MeasurementKind kind, Eigen::Index per_row, int sigma,
                Reader read);
  void ReadPositions(const TableRow& row, ObservationTable* table);
  void ReadTargetPositions(const TableRow& row, ObservationTable* table);
  void ReadDistance(const TableRow& row, ObservationTable* table);
  void ReadFixedPoint(const TableRow& row, ObservationTable* table);
  void ReadPlane(const TableRow& row, ObservationTable* table);
  void ReadDifference(const TableRow& row, ObservationTable* table);

  int ReadTriple(const TableRow& row, int first, int sigma,
                 StatedObservation* stated) const;
  int ReadPosition(const TableRow& row, int first,
                   StatedObservation* stated) const;
  void ReadOrientation(const TableRow& row, StatedObservation* stated) const;
  double SigmaOr(const TableRow& row, int spec, double otherwise) const;
  int ReadTarget(const TableRow& row) const;
  int FindTarget(std::string_view name, int spec, const TableRow& row) const;
  std::string ReadPoint(const TableRow& row) const;
  std::string StationOf(const TableRow& row) const;

  std::vector<bool> FindPoses() const;
  std::vector<ObservationBlock> MakeBlocks(RowNumbers numbers,
                                           Eigen::Index num_poses,
                                           References* references);

  const TableHeader& header_;
  const DataTable& table_;
  const DatasetColumns& columns_;
  const Arm& arm_;
  const DataFormat& format_;
  const MeasuredGroups groups_;
  const double rotation_sigma_;
  std::deque<ObservationTable> tables_;  // in the order of a row
  std::vector<Reader> readers_;          // of each
  MatrixBuilder motors_;
  std::vector<int> lines_;  // 0: the filter leaves the row out
  MatrixBuilder covariates_;
  std::vector<std::string> sets_;      // empty: no column
  std::vector<std::string> stations_;  // likewise
  std::vector<std::string> points_;    // names by row; empty: no such kinds
  std::vector<std::string> planes_;
  std::vector<int> links_;         // rows that differences are to, from 1
  std::vector<int> link_columns_;  // where they are named
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_DATASET_ROWS_H_
