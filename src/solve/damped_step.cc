#include "src/solve/damped_step.h"

#include <cmath>

namespace alidade::internal {

// H = I - v v^T / (v_0 alpha) takes column k, whose top is upper_(k, k), to
// (alpha, 0).
void DampedStep::ClearColumn(Eigen::Index k) {
  const Eigen::Index rows = k + 1;
  const auto below = lower_.col(k).head(rows);
  const double top = upper_(k, k);
  const double squares = below.squaredNorm();
  if (squares == 0.0) return;
  const double alpha = -std::copysign(std::sqrt(top * top + squares), top);
  const double first = top - alpha;
  const double weight = -1.0 / (first * alpha);
  upper_(k, k) = alpha;
  for (Eigen::Index j = k + 1; j < upper_.cols(); ++j) {
    auto column = lower_.col(j).head(rows);
    const double w = weight * (first * upper_(k, j) + below.dot(column));
    upper_(k, j) -= w * first;
    column -= w * below;
  }
  auto right = rest_.head(rows);
  const double w = weight * (first * rotated_[k] + below.dot(right));
  rotated_[k] -= w * first;
  right -= w * below;
}

const Eigen::VectorXd& DampedStep::Solve(const Eigen::MatrixXd& factor,
                                         const Eigen::VectorXd& projected,
                                         const Diagonal& known,
                                         const Eigen::VectorXd& damping) {
  const Eigen::Index p = factor.cols();
  upper_ = factor;
  rotated_ = projected;
  lower_.setZero(p, p);
  rest_.setZero(p);
  for (Eigen::Index k = 0; k < p; ++k) {
    // The two rows of a parameter become one; what the other keeps does not
    // depend on the step.
    const double both = std::hypot(known.weights[k], damping[k]);
    lower_(k, k) = both;
    if (both > 0.0) {
      rest_[k] = known.weights[k] / both * known.residuals[k];
    }
  }
  for (Eigen::Index k = 0; k < p; ++k) ClearColumn(k);
  step_ = -rotated_;
  for (Eigen::Index k = p - 1; k >= 0; --k) {
    step_[k] /= upper_(k, k);
    step_.head(k) -= step_[k] * upper_.col(k).head(k);
  }
  return step_;
}

}  // namespace alidade::internal
