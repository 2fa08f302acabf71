#ifndef ALIDADE_SRC_KERNEL_OBSERVATION_ROWS_H_
#define ALIDADE_SRC_KERNEL_OBSERVATION_ROWS_H_

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "alidade/dataset.h"
#include "src/kernel/measurement_model.h"

namespace alidade::internal {

/// Parts that ForEachObservation cuts a data set into at most.
constexpr int kRowParts = 64;

/// Called with the number of a part, below kRowParts, the number of an
/// observation (counted block after block) and its whitened rows: one column
/// per derivative, the residual last. Rows that were not measured are zero.
using VisitRows =
    std::function<void(int part, Eigen::Index observation,
                       const Eigen::Ref<const Eigen::MatrixXd>& rows)>;

/// Calls `visit` once for every observation. Parts do not depend on the number
/// of threads, and neither does the order of the observations in one of them;
/// different parts are visited at the same time. So whoever keeps a sum for
/// each part and adds these up in order gets the same bits with any number of
/// threads. O(N columns) time, O(columns) memory beyond the data.
void ForEachObservation(const MeasurementModel& model,
                        const Eigen::VectorXd& values, const Dataset& data,
                        const std::vector<int>& columns,
                        const VisitRows& visit);

/// Number of the first observation of each block, and that behind the last.
std::vector<Eigen::Index> FirstObservations(const Dataset& data);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_KERNEL_OBSERVATION_ROWS_H_
