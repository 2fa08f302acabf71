#include "alidade/measurement/compression.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "alidade/base/parallel.h"
#include "alidade/measurement/row_evaluator.h"

namespace alidade {
namespace {

// The observations of a block are cut into so many parts at most, whatever
// their number: few enough for O(columns^2) memory, enough for the threads to
// share.
constexpr Eigen::Index kParts = 16;

// Observations of one pass: their rows stay in the cache with some tens of
// columns.
constexpr Eigen::Index kObservationsPerPass = 64;

// Keeps the triangular factor of all rows seen so far.
class FactorBuilder {
 public:
  explicit FactorBuilder(Eigen::Index columns)
      : factor_(Eigen::MatrixXd::Zero(columns, columns)) {}

  void Add(const Eigen::Ref<const Eigen::MatrixXd>& rows) {
    const Eigen::Index p = factor_.cols();
    stacked_.resize(p + rows.rows(), p);
    stacked_.topRows(p) = factor_;
    stacked_.bottomRows(rows.rows()) = rows;
    const Eigen::HouseholderQR<Eigen::Ref<Eigen::MatrixXd>> qr(stacked_);
    factor_ = qr.matrixQR().topRows(p).triangularView<Eigen::Upper>();
  }

  const Eigen::MatrixXd& factor() const { return factor_; }

 private:
  Eigen::MatrixXd factor_;
  Eigen::MatrixXd stacked_;
};

// Calls fill(evaluator, block, first, count, block's first row, &rows) for
// every pass over the data and factors the rows that it makes.
template <typename Fill>
Eigen::MatrixXd FactorRows(const MeasurementModel& model,
                           const Eigen::VectorXd& values, const Dataset& data,
                           const std::vector<int>& columns, Eigen::Index width,
                           const Fill& fill) {
  FactorBuilder all(width);
  Eigen::Index first_row = 0;
  for (const ObservationBlock& block : data.blocks) {
    const Eigen::Index count = block.size();
    const Eigen::Index part_size =
        std::max(kObservationsPerPass, (count + kParts - 1) / kParts);
    const Eigen::Index num_parts = (count + part_size - 1) / part_size;
    std::vector<FactorBuilder> parts(num_parts, FactorBuilder(width));
    const auto work = [&](std::int64_t begin, std::int64_t end) {
      RowEvaluator evaluator(model, values, data, columns);
      Eigen::MatrixXd rows;
      for (Eigen::Index i = begin; i < end; i += kObservationsPerPass) {
        const Eigen::Index size =
            std::min<Eigen::Index>(end - i, kObservationsPerPass);
        rows.resize(size * block.rows_each(), width);
        fill(&evaluator, block, i, size, first_row, &rows);
        parts[begin / part_size].Add(rows);
      }
    };
    ParallelFor(model.num_threads(), count, part_size, work);
    for (const FactorBuilder& part : parts) all.Add(part.factor());
    first_row += count * block.rows_each();
  }
  return all.factor();
}

// Scales the rows of each observation by the root of its weight; the last
// column holds the residuals.
void ApplyLosses(const ObservationBlock& block, Eigen::Index first,
                 const std::vector<RobustLoss>& losses, Eigen::MatrixXd* rows) {
  if (losses.empty()) return;
  const int height = block.rows_each();
  for (Eigen::Index i = 0; i * height < rows->rows(); ++i) {
    auto mine = rows->middleRows(i * height, height);
    const int dimension = block.Dimension(first + i);
    if (dimension == 0) continue;
    const double squared = mine.rightCols<1>().squaredNorm();
    mine *= std::sqrt(losses[dimension - 1].Weight(squared));
  }
}

}  // namespace

double RobustChiSquare(const Eigen::VectorXd& errors, const Dataset& data,
                       const std::vector<RobustLoss>& losses) {
  const Eigen::VectorXd squared = SquaredNorms(errors, data);
  if (losses.empty()) return squared.sum();
  const Eigen::VectorXi dimensions = Dimensions(data);
  double cost = 0.0;
  for (Eigen::Index i = 0; i < squared.size(); ++i) {
    if (dimensions[i] == 0) continue;
    double rho[3];
    losses[dimensions[i] - 1].Evaluate(squared[i], rho);
    cost += rho[0];
  }
  return cost;
}

Eigen::MatrixXd JacobianFactor(const MeasurementModel& model,
                               const Eigen::VectorXd& values,
                               const Dataset& data,
                               const std::vector<int>& columns) {
  return FactorRows(model, values, data, columns,
                    static_cast<Eigen::Index>(columns.size()),
                    [](RowEvaluator* evaluator, const ObservationBlock& block,
                       Eigen::Index first, Eigen::Index count, Eigen::Index,
                       Eigen::MatrixXd* rows) {
                      evaluator->Fill(block, first, count, *rows);
                    });
}

CompressedProblem Compress(const MeasurementModel& model,
                           const Eigen::VectorXd& values, const Dataset& data,
                           const std::vector<int>& columns,
                           const std::vector<RobustLoss>& losses) {
  const auto p = static_cast<Eigen::Index>(columns.size());
  const Eigen::VectorXd errors = model.Errors(values, data);
  const Eigen::MatrixXd factor = FactorRows(
      model, values, data, columns, p + 1,
      [&](RowEvaluator* evaluator, const ObservationBlock& block,
          Eigen::Index first, Eigen::Index count, Eigen::Index first_row,
          Eigen::MatrixXd* rows) {
        const int height = block.rows_each();
        evaluator->Fill(block, first, count, rows->leftCols(p));
        auto residuals = rows->rightCols(1);
        residuals = errors.segment(first_row + first * height, rows->rows());
        Whiten(block, first, count, residuals);
        ApplyLosses(block, first, losses, rows);
      });
  CompressedProblem problem;
  problem.factor = factor.topLeftCorner(p, p);
  problem.projected = factor.topRightCorner(p, 1);
  problem.cost = RobustChiSquare(errors, data, losses);
  return problem;
}

}  // namespace alidade
