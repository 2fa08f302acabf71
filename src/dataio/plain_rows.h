#ifndef ALIDADE_SRC_DATAIO_PLAIN_ROWS_H_
#define ALIDADE_SRC_DATAIO_PLAIN_ROWS_H_

#include <Eigen/Core>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "alidade/arm.h"
#include "src/dataio/data_format.h"
#include "src/dataio/plain_layout.h"

namespace alidade::internal {

/// Why a row is rejected.
inline constexpr char kNothingMeasured[] = "nothing was measured";

/// A plain data set (plain_layout.h) while its rows are read, each into its own
/// column of the matrices. Threads may set different rows at the same time.
class PlainRows {
 public:
  enum class State {
    kKept,
    kNothing,  ///< the row measures nothing
    kSuspect,  ///< not plain, or wrong: the careful reader is to look at it
  };

  /// `layout` must outlive the object. Rows are lines from 1, unless KeepLines
  /// is called, each with its own.
  PlainRows(const PlainLayout& layout, Eigen::Index size);

  /// The numbers of row i by their slots; NaN is what was not measured. No
  /// cell is looked at for infinities or sigmas below zero.
  State Set(Eigen::Index i, const double* row);
  void KeepLines() { lines_.resize(static_cast<std::size_t>(motors_.cols())); }
  void SetLine(Eigen::Index i, int line) { lines_[i] = line; }
  void SetTarget(Eigen::Index i, int target) { targets_[i] = target; }
  void SetSet(Eigen::Index i, std::string_view set) { sets_[i] = set; }

  /// The data set that DatasetReader makes of the same rows, but for those in
  /// `nothing` (ascending), which are rejected. Leaves the object empty.
  /// @pre some row is kept.
  LoadedData Finish(const std::string& path, const Arm& arm,
                    const std::vector<Eigen::Index>& nothing);

 private:
  bool SetOrientation(Eigen::Index i, const double* row);
  double* SigmasOf(Eigen::Index i);
  int LineOf(Eigen::Index i) const {
    return lines_.empty() ? static_cast<int>(i) + 1 : lines_[i];
  }
  void Drop(const std::vector<Eigen::Index>& rows);

  const PlainLayout& layout_;
  const int rows_each_;
  MatrixBuilder motors_;
  MatrixBuilder measured_;
  std::optional<MatrixBuilder> sigmas_;  // none: the same for all rows
  std::once_flag has_own_sigmas_;
  std::vector<int> targets_;       // empty: no column
  std::vector<std::string> sets_;  // empty: no column
  std::vector<int> lines_;         // empty: as KeepLines says
  PoseSources sources_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_PLAIN_ROWS_H_
