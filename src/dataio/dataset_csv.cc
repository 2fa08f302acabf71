#include "src/dataio/dataset_csv.h"

#include <utility>

#include "alidade/error.h"
#include "src/common/names.h"
#include "src/dataio/csv_columns.h"
#include "src/dataio/dataset_npy.h"
#include "src/dataio/dataset_reader.h"
#include "src/dataio/npy_data.h"
#include "src/dataio/row_reader.h"

namespace alidade::internal {
namespace {

Eigen::MatrixXd ReadJointValues(MappedFile file, const Arm& arm) {
  RowReader rows(std::move(file), arm, JointColumns(arm), true);
  std::vector<double> motors;
  while (rows.Next()) {
    for (int j = 0; j < arm.num_joints(); ++j) motors.push_back(rows.Number(j));
  }
  if (rows.row() == 0) {
    rows.Fail("no rows behind the header, expected one for every pose");
  }
  return JointsFromMotors(
      arm, Eigen::Map<const Eigen::MatrixXd>(motors.data(), arm.num_joints(),
                                             rows.row()));
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
  if (IsNpy(file.path)) return LoadNpy(file, references, options);
  DatasetReader reader(MappedFile(file.path), file.arm, file.format,
                       references);
  return reader.Read(options);
}

Eigen::MatrixXd LoadJointValues(const std::string& path, const Arm& arm) {
  if (!IsNpy(path)) return ReadJointValues(MappedFile(path), arm);
  MappedFile text(path, NpyAsCsv(path));
  try {
    return ReadJointValues(std::move(text), arm);
  } catch (const InputError& error) {
    throw InArray(error);
  }
}

}  // namespace alidade::internal
