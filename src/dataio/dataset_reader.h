#ifndef ALIDADE_SRC_DATAIO_DATASET_READER_H_
#define ALIDADE_SRC_DATAIO_DATASET_READER_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "alidade/arm.h"
#include "alidade/error.h"
#include "alidade/references.h"
#include "src/common/mapped_file.h"
#include "src/dataio/covariance.h"
#include "src/dataio/data_format.h"
#include "src/dataio/dataset_builder.h"
#include "src/dataio/dataset_columns.h"
#include "src/dataio/plain_layout.h"
#include "src/dataio/read_options.h"
#include "src/dataio/row_reader.h"

namespace alidade::internal {

/// Turns the rows of a data set's file into poses and observations.
class DatasetReader {
 public:
  /// Reads the header. The arguments must outlive the reader.
  DatasetReader(MappedFile file, const Arm& arm, const DataFormat& format,
                References* references);

  /// To be called once.
  LoadedData Read(const ReadOptions& options);

  const RowReader& rows() const { return rows_; }
  /// The layout of the file where it is plain, so that it can be read fast.
  std::optional<PlainLayout> Layout() const;

 private:
  // Three numbers of one row, as far as they were measured.
  struct Triple {
    Eigen::Vector3d value = Eigen::Vector3d::Zero();
    std::vector<bool> is_measured = std::vector<bool>(3, false);
    int count = 0;
  };

  // A row that was read; it becomes a pose unless nothing hangs on it.
  struct Row {
    int number = 0;  // in the file, from 1
    int line = 0;
    bool is_measured = false;
    std::string set;
  };

  // A difference's other row, which may be further down.
  struct Link {
    std::size_t observation = 0;
    int row = 0;  // its number in the file
    SourceLocation named_at;
  };

  LoadedData ReadRows();
  void ReadRow();
  void ReadPositions();
  void ReadTargetPositions();
  void ReadDistance();
  void ReadFixedPoint();
  void ReadPlane();
  void ReadDifference();

  Triple ReadTriple(int first) const;
  bool HasOrientation(int first, int count) const;
  Eigen::Matrix3d ReadOrientation() const;
  Eigen::Matrix3d ReadQuaternion() const;
  Noise PositionNoise(const Triple& position) const;
  Noise TripleNoise(const Triple& triple, int sigma) const;
  Noise OrientationNoise() const;
  double SigmaOr(int spec, double otherwise) const;
  int ReadTarget() const;
  std::optional<int> ReadPoint();
  int FindPoint(const std::string& name);
  int FindPlane(const std::string& name);
  int FindTarget(std::string_view name, int spec) const;

  void Add(MeasurementKind kind, int target, int reference,
           const Observation::Rows& measured, const Noise& noise);
  std::vector<int> KeepRows(LoadedData* loaded) const;
  void Connect(const std::vector<int>& pose_of_row);
  std::size_t FindRow(const Link& link) const;

  const Arm& arm_;
  const DataFormat& format_;
  References* references_;
  const DatasetColumns columns_;
  RowReader rows_;
  const MeasuredGroups groups_;
  const double rotation_sigma_;
  std::vector<Row> read_;
  std::vector<double> motors_;             // joint after joint, row after row
  std::vector<Observation> observations_;  // their poses are rows, at first
  std::vector<Link> links_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_DATASET_READER_H_
