#ifndef ALIDADE_SRC_IO_PLAIN_ROWS_H_
#define ALIDADE_SRC_IO_PLAIN_ROWS_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "alidade/io/dataset_csv.h"
#include "alidade/model/arm.h"
#include "src/io/plain_layout.h"

namespace alidade {

/// Why a row is rejected.
inline constexpr char kNothingMeasured[] = "nothing was measured";

/// A plain data set (plain_layout.h) while its rows are read, each into its own
/// column of the matrices. Threads may set different rows at the same time.
class PlainRows {
 public:
  enum class State {
    kKept,
    kNothing,   ///< the row measures nothing
    kDoubtful,  ///< not plain, or wrong: the careful reader is to look at it
  };

  /// `layout` must outlive the object.
  PlainRows(const PlainLayout& layout, Eigen::Index size);

  /// The numbers of row i by their slots; NaN is what was not measured. No
  /// cell is looked at for infinities or sigmas below zero.
  State Set(Eigen::Index i, const double* row);
  void SetLine(Eigen::Index i, int line) { sources_[i].line = line; }
  void SetTarget(Eigen::Index i, int target) { targets_[i] = target; }
  void SetSet(Eigen::Index i, std::string_view set) { sets_[i] = set; }

  /// The data set that DatasetReader makes of the same rows, but for those in
  /// `nothing` (ascending), which are rejected. Leaves the object empty.
  /// @pre some row is kept.
  LoadedData Finish(const std::string& path, const Arm& arm,
                    const std::vector<Eigen::Index>& nothing);

 private:
  bool SetOrientation(Eigen::Index i, const double* row);
  void Drop(const std::vector<Eigen::Index>& rows);

  const PlainLayout& layout_;
  Eigen::MatrixXd motors_;
  Eigen::MatrixXd measured_;
  Eigen::MatrixXd sigmas_;
  std::vector<int> targets_;       // empty: no column
  std::vector<std::string> sets_;  // empty: no column
  std::vector<PoseSource> sources_;
};

}  // namespace alidade

#endif  // ALIDADE_SRC_IO_PLAIN_ROWS_H_
