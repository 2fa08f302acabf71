#include "src/error_terms/term_covariance.h"

#include <Eigen/Cholesky>
#include <Eigen/SparseCore>
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

// A root of a matrix that may be singular to rounding.
Eigen::MatrixXd RootOf(Eigen::MatrixXd* covariance) {
  constexpr double kRounding = 1e-10;
  covariance->diagonal() *= 1.0 + kRounding;
  covariance->diagonal().array() += 1e-14;
  const Eigen::LLT<Eigen::MatrixXd> plain(*covariance);
  if (plain.info() == Eigen::Success) return plain.matrixL();
  const Eigen::LDLT<Eigen::MatrixXd> pivoted(*covariance);
  Eigen::MatrixXd root = pivoted.matrixL();
  root *= pivoted.vectorD().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  return pivoted.transpositionsP().transpose() * root;
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
  const auto count = static_cast<Eigen::Index>(rungs.size());
  const auto p = static_cast<Eigen::Index>(geometry.size());
  const Eigen::Index size = p + all.size();
  Eigen::VectorXd weights(count);
  for (Eigen::Index k = 0; k < count; ++k) weights[k] = share * rungs[k].weight;
  weights[0] += 1.0 - share;
  const Eigen::VectorXd probabilities =
      weights.cwiseAbs2() / weights.squaredNorm();
  auto result = std::make_shared<TermCovariance>();
  result->columns = all;
  result->geometry = geometry;
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(size, size);
  Eigen::MatrixXd estimates = Eigen::MatrixXd::Zero(size, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    if (!(weights[k] > 0.0)) continue;
    const RungEstimate& rung = rungs[k];
    const Eigen::SparseMatrix<double> from = all.From(rung.columns);
    AddWithin(probabilities[k] * rung.covariance, from, &covariance);
    estimates.col(k) << rung.values.head(p),
        from * rung.values.tail(from.cols());
    for (const FunctionKnots& knots : rung.columns.functions()) {
      result->gaps.push_back({knots, rung.columns.function_length(),
                              probabilities[k] * rung.function_variance});
    }
  }
  const Eigen::VectorXd mean = estimates * weights;
  for (Eigen::Index k = 0; k < count; ++k) {
    if (!(weights[k] > 0.0)) continue;
    const Eigen::VectorXd off = estimates.col(k) - mean;
    covariance += probabilities[k] * off * off.transpose();
  }
  result->root = RootOf(&covariance);
  return result;
}

}  // namespace alidade::internal
