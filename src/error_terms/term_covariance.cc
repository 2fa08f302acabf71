#include "src/error_terms/term_covariance.h"

#include <Eigen/Cholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <utility>

namespace alidade::internal {
namespace {

// Adds `own`, of geometry and coefficients, to a covariance of geometry and
// those coefficients that these become.
void AddWithin(const Eigen::MatrixXd& own,
               const Eigen::SparseMatrix<double>& from,
               Eigen::MatrixXd* covariance) {
  const Eigen::Index size = from.rows();
  const Eigen::Index p = own.rows() - from.cols();
  const Eigen::MatrixXd beside = from * own.bottomLeftCorner(from.cols(), p);
  covariance->topLeftCorner(p, p) += own.topLeftCorner(p, p);
  covariance->bottomLeftCorner(size, p) += beside;
  covariance->topRightCorner(p, size) += beside.transpose();
  const Eigen::MatrixXd half =
      from * own.bottomRightCorner(from.cols(), from.cols());
  covariance->bottomRightCorner(size, size) += half * from.transpose();
}

}  // namespace

Eigen::MatrixXd TermCovariance::Spread(const TermRows& rows,
                                       const TermRows::Observation& one) const {
  const Eigen::Index p = rows.num_columns();
  Eigen::MatrixXd spread = Eigen::MatrixXd::Zero(one.height, width());
  auto of_root = spread.leftCols(root.cols());
  of_root =
      rows.geometry.middleRows(one.first_row, one.height) * root.topRows(p);
  for (const bool second : {false, true}) {
    const int pose = second ? one.second_pose : one.pose;
    if (pose < 0) continue;
    const TermRows::RowMatrix& all = second ? rows.second_turns : rows.turns;
    const auto turns = all.middleRows(one.first_row, one.height);
    // What the terms do to each turn, in unit deviations.
    Eigen::MatrixXd sizes = Eigen::MatrixXd::Zero(turns.cols(), root.cols());
    columns.ForEachAt(rows.NumbersOf(pose),
                      [&](int column, int turn, double size) {
                        sizes.row(turn) += size * root.row(p + column);
                      });
    of_root += turns * sizes;
    Eigen::VectorXd variances = Eigen::VectorXd::Zero(turns.cols());
    for (const FunctionGaps& gap : gaps) {
      const int joint = gap.knots.joint;
      variances[3 * joint + 2] +=
          gap.VarianceAt(rows.joint_values(joint, pose));
    }
    Eigen::Index column = root.cols() + (second ? 1 : 0);
    for (const FunctionKnots& knots : columns.functions()) {
      const int turn = 3 * knots.joint + 2;
      spread.col(column) = std::sqrt(variances[turn]) * turns.col(turn);
      column += 2;
    }
  }
  return spread;
}

std::shared_ptr<const TermCovariance> CovarianceOfStack(
    const std::vector<RungEstimate>& rungs, double share,
    const TermColumns& all, const std::vector<int>& geometry) {
  constexpr double kRounding = 1e-10;
  const auto p = static_cast<Eigen::Index>(geometry.size());
  const Eigen::Index size = p + all.size();
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(size, size);
  auto result = std::make_shared<TermCovariance>();
  result->columns = all;
  result->geometry = geometry;
  Eigen::MatrixXd estimates =
      Eigen::MatrixXd::Zero(size, static_cast<Eigen::Index>(rungs.size()));
  Eigen::VectorXd stack = Eigen::VectorXd::Zero(size);
  for (std::size_t k = 0; k < rungs.size(); ++k) {
    const RungEstimate& rung = rungs[k];
    const double weight = share * rung.weight + (k == 0 ? 1.0 - share : 0.0);
    if (!(weight > 0.0)) continue;
    const Eigen::SparseMatrix<double> from = all.From(rung.columns);
    AddWithin(weight * rung.covariance, from, &covariance);
    auto estimate = estimates.col(static_cast<Eigen::Index>(k));
    estimate << rung.values.head(p), from * rung.values.tail(from.cols());
    stack += rung.weight * estimate;
    for (const FunctionKnots& knots : rung.columns.functions()) {
      result->gaps.push_back({knots, rung.columns.function_length(),
                              weight * rung.function_variance});
    }
  }
  for (std::size_t k = 0; k < rungs.size(); ++k) {
    double weight = share * rungs[k].weight;
    if (k == 0) weight += (1.0 - share) * std::min(share, 1.0 - share);
    if (!(weight > 0.0)) continue;
    const Eigen::VectorXd off =
        estimates.col(static_cast<Eigen::Index>(k)) - stack;
    covariance += weight * off * off.transpose();
  }
  covariance.diagonal() *= 1.0 + kRounding;
  covariance.diagonal().array() += 1e-14;
  result->root = covariance.llt().matrixL().toDenseMatrix();
  return result;
}

}  // namespace alidade::internal
