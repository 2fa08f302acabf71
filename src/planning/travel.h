#ifndef ALIDADE_SRC_PLANNING_TRAVEL_H_
#define ALIDADE_SRC_PLANNING_TRAVEL_H_

#include <Eigen/Core>
#include <vector>

namespace alidade::internal {

/// How far an arm travels between two poses: the largest of the joints' ways,
/// which is the time that it takes where all joints are as fast. `weights` (n)
/// turn the ways of different joints into one unit (1 / speed; infinite speeds
/// are zero weights).
double Travel(const Eigen::VectorXd& from, const Eigen::VectorXd& to,
              const Eigen::VectorXd& weights);

/// Along all poses (n x N) in an order.
double TravelAlong(const Eigen::MatrixXd& joint_values,
                   const Eigen::VectorXd& weights,
                   const std::vector<int>& order);

/// An order of the poses (n x N) with little travel, its ends free: from
/// several first poses always to the nearest one left, the best of these made
/// shorter by turning pieces of the way round (2-opt: Croes 1958) and by moving
/// pieces of up to three poses elsewhere (Or 1976), until neither helps. Not
/// the shortest there is, but usually within some 5 %.
/// O(N^2) memory, O(N^2) time a round.
std::vector<int> ShortOrder(const Eigen::MatrixXd& joint_values,
                            const Eigen::VectorXd& weights);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_PLANNING_TRAVEL_H_
