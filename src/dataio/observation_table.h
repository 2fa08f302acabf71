#ifndef ALIDADE_SRC_DATAIO_OBSERVATION_TABLE_H_
#define ALIDADE_SRC_DATAIO_OBSERVATION_TABLE_H_

#include <Eigen/Core>
#include <array>
#include <mutex>
#include <optional>
#include <vector>

#include "alidade/dataset.h"

namespace alidade::internal {

/// Columns that stay; nothing: all do.
using KeptColumns = std::optional<std::vector<Eigen::Index>>;

/// One observation, as a row of a file states it.
struct StatedObservation {
  std::array<double, 6> measured = {};
  std::array<double, 6> sigmas = {};
  Eigen::MatrixXd whitener = {};  ///< empty: the sigmas say it all
  int target = 0;
};

/// What belongs to the rows of a table, an entry each.
struct RowNumbers {
  std::vector<int> poses = {};       ///< empty: every row is one
  std::vector<int> references = {};  ///< empty: the kind has none
  std::vector<int> seconds = {};     ///< empty: the kind has none
};

/// Observations of one kind while a table is read: some of each row, which are
/// columns of matrices of that size from the start, so that threads may set
/// those of different rows at the same time, and nothing is copied where all
/// are there in the end.
class ObservationTable {
 public:
  using Index = Eigen::Index;

  struct Shape {
    MeasurementKind kind = MeasurementKind::kPosition;
    Index num_rows = 0;
    Index per_row = 1;
    /// What nearly all observations have.
    Eigen::VectorXd default_sigmas;
    bool states_sigmas = false;
    bool states_targets = false;
    bool has_whiteners = false;
  };

  explicit ObservationTable(const Shape& shape);

  /// Sets observation i of i / per_row. In a table of poses the kind may be
  /// kPosition: a pose of which only the position was measured.
  void Set(Index i, MeasurementKind kind, const StatedObservation& stated);

  MeasurementKind kind() const { return shape_.kind; }
  bool IsRowMeasured(Index row) const;
  /// The row of the first observation of a kind, or nothing.
  std::optional<Index> FirstRow(MeasurementKind kind) const;

  /// The observations of a kind. May leave the table without its numbers.
  ObservationBlock Take(MeasurementKind kind, const RowNumbers& rows,
                        Index num_poses);

 private:
  enum State : char { kNothing, kWhole, kPositionAlone };

  State StateOf(MeasurementKind kind) const {
    return kind == shape_.kind ? kWhole : kPositionAlone;
  }
  double* SigmasOf(Index i);

  const Shape shape_;
  MatrixBuilder measured_;
  std::optional<MatrixBuilder> sigmas_;  // none: the default for all
  std::once_flag has_own_sigmas_;
  std::vector<State> state_;
  std::vector<int> targets_;                // empty: the first
  std::vector<Eigen::MatrixXd> whiteners_;  // empty: none
};

/// The columns `kept` of a matrix, in their order; of each the first `rows`.
/// Leaves the matrix as it is, or without its numbers.
SharedMatrix KeepColumns(const KeptColumns& kept, Eigen::Index rows,
                         MatrixBuilder* matrix);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_OBSERVATION_TABLE_H_
