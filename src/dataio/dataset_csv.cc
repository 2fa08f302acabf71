#include "src/dataio/dataset_csv.h"

#include <glog/logging.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include "src/common/parallel.h"
#include "src/dataio/csv_columns.h"
#include "src/dataio/csv_table.h"
#include "src/dataio/data_table.h"
#include "src/dataio/dataset_npy.h"
#include "src/dataio/dataset_rows.h"
#include "src/dataio/npy_table.h"
#include "src/model/motors.h"

namespace alidade::internal {
namespace {

// The header is read.
std::unique_ptr<DataTable> OpenTable(MappedFile file, TableContent content,
                                     const ReadOptions& options) {
  if (IsNpy(file.path())) {
    return std::make_unique<NpyTable>(std::move(file), std::move(content),
                                      options);
  }
  return std::make_unique<CsvTable>(std::move(file), std::move(content),
                                    options);
}

// Positions whose numbers are used where they are: those of an array in SI
// that holds nothing else and of which all are finite.
std::optional<LoadedData> ReadInPlace(const DataTable& table,
                                      const DatasetColumns& columns,
                                      const DataFile& file, int num_threads) {
  const bool is_first_target =
      file.format.target.empty() ||
      file.format.target == file.arm.targets.front().name;
  if (!is_first_target || HasMotorMap(file.arm)) return std::nullopt;
  const std::optional<SharedMatrix> joints =
      table.InPlace(0, file.arm.num_joints());
  const std::optional<SharedMatrix> positions =
      table.InPlace(columns.position, 3);
  const std::optional<SharedMatrix> sigmas =
      table.header().Has(columns.position_sigma)
          ? table.InPlace(columns.position_sigma, 3)
          : SharedMatrix::Repeated(Eigen::Vector3d::Constant(file.format.sigma),
                                   table.num_rows());
  if (!joints || !positions || !sigmas) return std::nullopt;
  constexpr std::int64_t kRowsAtOnce = 1 << 14;
  std::atomic<bool> is_suspect{false};
  ParallelFor(
      num_threads, table.num_rows(), kRowsAtOnce,
      [&](std::int64_t begin, std::int64_t end) {
        const auto rows = [&](const SharedMatrix& all) {
          return all.map().middleCols(begin, end - begin).array();
        };
        if (!(rows(*joints).isFinite().all() &&
              rows(*positions).isFinite().all() &&
              rows(*sigmas).isFinite().all() && (rows(*sigmas) > 0.0).all())) {
          is_suspect = true;
        }
      });
  if (is_suspect) return std::nullopt;
  LoadedData loaded;
  loaded.data = MakePositions(*joints, *positions, *sigmas);
  loaded.data.name = file.path;
  loaded.data.files = {file.path};
  loaded.data.sources.Append({0, 1},
                             static_cast<std::size_t>(table.num_rows()));
  return loaded;
}

// What the file and the job do not state but was found.
void SayWhatWasFound(const DataTable& table, const DataFormat& format) {
  std::string notes = table.Notes();
  const ColumnMapping& mapping = format.columns;
  const std::string units =
      mapping.length_unit == nullptr && mapping.angle_unit == nullptr
          ? table.header().DescribeDefaultUnits()
          : "";
  if (!units.empty()) {
    notes += (notes.empty() ? "" : "; ") + units + ", the units of the job";
  }
  if (notes.empty()) return;
  LOG(WARNING) << "note: " << table.header().path() << ": " << notes;
}

}  // namespace

LoadedData LoadData(const std::string& path, const Arm& arm,
                    const DataFormat& format, References* references,
                    int num_threads) {
  ReadOptions options;
  options.num_threads = num_threads;
  return LoadDataWith({path, arm, format}, references, options);
}

LoadedData LoadDataWith(const DataFile& file, References* references,
                        const ReadOptions& options) {
  return ReadData(MappedFile(file.path), file, references, options);
}

LoadedData ReadData(MappedFile content, const DataFile& file,
                    References* references, const ReadOptions& options) {
  const DatasetColumns columns = MakeDatasetColumns(file.arm, file.format);
  const auto table =
      OpenTable(std::move(content),
                {file.arm, columns.specs, file.format.ignore_others,
                 file.format.where, file.format.exclude, file.format.dialect},
                options);
  if (file.format.logs_findings) SayWhatWasFound(*table, file.format);
  const MeasuredGroups groups =
      CheckColumns(columns, file.format, file.arm, table->header());
  if (groups.positions_alone() && columns.target_positions.empty()) {
    std::optional<LoadedData> loaded =
        ReadInPlace(*table, columns, file, options.num_threads);
    if (loaded) return *std::move(loaded);
  }
  DatasetRows rows(*table, columns, groups, file);
  table->VisitRows(options.num_threads,
                   [&](const TableRow& row) { rows.Read(row); });
  return rows.Finish(references);
}

Eigen::MatrixXd LoadJointValues(const std::string& path, const Arm& arm) {
  const auto table =
      OpenTable(MappedFile(path), {arm, JointColumns(arm), true}, {});
  if (table->num_rows() == 0) {
    table->FailAtEnd("no rows after the header, expected one for every pose");
  }
  Eigen::MatrixXd motors(NumMotors(arm), table->num_rows());
  table->VisitRows(1, [&](const TableRow& row) {
    for (int j = 0; j < motors.rows(); ++j) {
      motors(j, row.index()) = row.Number(j);
    }
  });
  return JointsFromMotors(arm, motors);
}

}  // namespace alidade::internal
