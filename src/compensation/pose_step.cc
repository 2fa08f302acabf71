#include "src/compensation/pose_step.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace alidade::internal {
namespace {

// Singular values of the first part below this are rounding.
constexpr double kRounding = 1e-9;
constexpr double kFirstDamping = 1e-8;
constexpr double kMostDamping = 1e4;

using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic,
                                  Eigen::ColMajor, 6, 6>;

}  // namespace

PoseStep::PoseStep(int num_joints)
    : projector_(num_joints, num_joints),
      projected_(6, num_joints),
      row_(num_joints),
      rest_(num_joints) {}

void PoseStep::Newton(const Matrix6Xd& jacobian, const Vector6d& error,
                      double longest, double* mu, Eigen::VectorXd* step) {
  const Matrix6d square = jacobian;
  Vector6d found;
  if (*mu == 0.0) {
    found = square.partialPivLu().solve(error);
    if (found.cwiseAbs().maxCoeff() <= longest) {
      *step = found;
      return;
    }
    *mu = kFirstDamping;
  }
  const Matrix6d product = square * square.transpose();
  for (; *mu < kMostDamping; *mu *= 10.0) {
    Matrix6d damped = product;
    damped.diagonal().array() += *mu;
    found = square.transpose() * damped.llt().solve(error);
    if (found.cwiseAbs().maxCoeff() <= longest) break;
  }
  *step = found;
}

void PoseStep::Prioritised(const std::vector<TaskLevel>& levels,
                           std::size_t count, double mu,
                           const std::vector<bool>& locked,
                           const Eigen::VectorXd& home, Eigen::VectorXd* step) {
  projector_.setIdentity();
  for (Eigen::Index j = 0; j < projector_.cols(); ++j) {
    if (locked[j]) projector_(j, j) = 0.0;
  }
  step->setZero();
  for (std::size_t k = 0; k < count; ++k) {
    const TaskLevel& level = levels[k];
    const Eigen::Index m = level.error.size();
    auto projected = projected_.topRows(m);
    projected.noalias() = level.jacobian * projector_;
    const SmallMatrix gram = projected * projected.transpose();
    const Eigen::SelfAdjointEigenSolver<SmallMatrix> solver(gram);
    const double least = k == 0 ? kRounding : kLeastMotion;
    const Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 6, 1>
        error = level.error - level.jacobian * *step;
    for (Eigen::Index i = 0; i < m; ++i) {
      const double square = solver.eigenvalues()[i];
      if (square < least * least) continue;
      const auto direction = solver.eigenvectors().col(i);
      row_.noalias() = projected.transpose() * direction;
      const double damping = k == 0 ? mu : 0.0;
      *step += row_ * (direction.dot(error) / (square + damping));
      projector_.noalias() -= row_ * (row_.transpose() / square);
    }
  }
  rest_ = home - *step;
  step->noalias() += projector_ * rest_;
}

}  // namespace alidade::internal
