#ifndef ALIDADE_SRC_CALIBRATION_POSITION_SAMPLE_H_
#define ALIDADE_SRC_CALIBRATION_POSITION_SAMPLE_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "alidade/communicator.h"
#include "alidade/dataset.h"

namespace alidade::internal {

/// Joint values and the positions measured there, a column each. The joint
/// values of the rows before and after are what a reader that is one row off
/// would have taken.
struct PositionSample {
  Eigen::MatrixXd joint_values;
  Eigen::MatrixXd joint_values_before;
  Eigen::MatrixXd joint_values_after;
  Eigen::Matrix3Xd points;            ///< (m)
  std::vector<Eigen::Index> numbers;  ///< among all that could be taken

  Eigen::Index size() const { return points.cols(); }
};

/// At most 60 fully measured positions of the first target, evenly taken from
/// those of all ranks, the same on all of them. Nothing where there are fewer
/// than twelve, or one that is not finite. Those are taken whose neighbours are
/// the lines before and after in their file, where there are twelve of them.
/// Collective.
std::optional<PositionSample> SamplePositions(const Dataset& data,
                                              Communicator* communicator);

/// The positions of the first target of two data sets that a hold-out has
/// parted, in the order of their rows; nothing where that is not known, or of
/// more than 100 000, or of a part.
std::optional<Dataset> PositionsInRowOrder(const Dataset& training,
                                           const Dataset& held_out);

/// Where position `number` of those that can be taken was read, "file:line";
/// empty where this rank does not know.
std::string PlaceOfPosition(const Dataset& data, Eigen::Index number);

/// Measured poses inverted: where the instrument is in the frame of the target.
Dataset WithInversePoses(const Dataset& data);

/// How far the positions lie apart: the root mean square about their mean (m).
double ExtentOf(const Eigen::Matrix3Xd& points);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_POSITION_SAMPLE_H_
