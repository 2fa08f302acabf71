#include "src/uncertainty/residual_gram.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

#include "src/kernel/measurement_model.h"

namespace alidade::internal {
namespace {

// Sums of a part, and rows that are not in its products yet: products of many
// rows at once stay in the cache.
struct Part {
  static constexpr Eigen::Index kMost = 192;

  void Push(int which, const Eigen::MatrixXd& rows) {
    if (pending[which].size() == 0) pending[which].resize(rows.cols(), kMost);
    if (count[which] + rows.rows() > kMost) Flush(which);
    pending[which].middleCols(count[which], rows.rows()) = rows.transpose();
    count[which] += rows.rows();
  }
  void Flush(int which) {
    if (count[which] == 0) return;
    sums.products[which].selfadjointView<Eigen::Lower>().rankUpdate(
        pending[which].leftCols(count[which]));
    count[which] = 0;
  }

  ResidualGram sums;
  std::array<Eigen::MatrixXd, 2> pending;  // transposed
  std::array<Eigen::Index, 2> count{};
};

// The free columns, then those directions that are not free.
struct Columns {
  Columns(const std::vector<int>& free, const std::vector<int>& directions)
      : all(free) {
    for (const int direction : directions) {
      const auto found = std::find(all.begin(), all.end(), direction);
      of_direction.push_back(static_cast<int>(found - all.begin()));
      if (found == all.end()) all.push_back(direction);
    }
  }
  std::vector<int> all;
  std::vector<int> of_direction;  // place in `all`
};

// (1 - H)^-1/2; what decides a parameter alone keeps a little of its residual.
Eigen::MatrixXd RootOfRest(const Eigen::MatrixXd& hat) {
  constexpr double kLeast = 0.05;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(hat);
  const Eigen::VectorXd factors =
      (1.0 - solver.eigenvalues().array()).max(kLeast).rsqrt();
  return solver.eigenvectors() * factors.asDiagonal() *
         solver.eigenvectors().transpose();
}

class Sums {
 public:
  Sums(const FittedProblem& fit, const Looks& looks,
       const StructureColumns& structure, const Eigen::MatrixXd& root)
      : fit_(fit),
        looks_(looks),
        structure_(structure),
        root_(root),
        columns_(fit.free_columns, structure.directions()),
        first_(FirstObservations(looks.data)),
        parts_(kRowParts),
        scores_(Eigen::MatrixXd::Zero(p(), looks.data.num_observations())) {
    Eigen::Index row = 0;
    for (const ObservationBlock& block : looks.data.blocks) {
      first_row_.push_back(row);
      row += block.rows_each() * block.size();
    }
  }

  ResidualGram Run() {
    ForEachObservation(fit_.model, fit_.values, looks_.data, columns_.all,
                       [this](int part, Eigen::Index i,
                              const Eigen::Ref<const Eigen::MatrixXd>& rows) {
                         Visit(i, rows,
                               &parts_[static_cast<std::size_t>(part)]);
                       });
    ResidualGram total = Empty();
    for (Part& each : parts_) {
      const ResidualGram& part = each.sums;
      if (part.information.size() == 0) continue;
      for (const int which : {kLengths, kRotations}) {
        each.Flush(which);
        if (total.products[which].size() == 0) break;
        total.products[which] += part.products[which];
        total.common[which] += part.common[which];
        total.rows[which] += part.rows[which];
        total.precision[which] += part.precision[which];
        total.inverse_counts[which] += part.inverse_counts[which];
      }
      total.information += part.information;
    }
    SumScores(&total);
    return total;
  }

 private:
  Eigen::Index p() const {
    return static_cast<Eigen::Index>(fit_.free_columns.size());
  }

  ResidualGram Empty() const {
    const Eigen::Index size = p() + structure_.size() + 1;
    ResidualGram gram;
    for (const int which : {kLengths, kRotations}) {
      gram.common[which].setZero(p(), p());
      if (which == kRotations && !looks_.data.Has(MeasurementKind::kPose)) {
        continue;
      }
      gram.products[which].setZero(size, size);
    }
    gram.information.setZero(p(), p());
    return gram;
  }

  void Visit(Eigen::Index i, const Eigen::Ref<const Eigen::MatrixXd>& rows,
             Part* part) {
    ResidualGram* const sums = &part->sums;
    const auto b = static_cast<std::size_t>(
        std::upper_bound(first_.begin(), first_.end(), i) - first_.begin() - 1);
    const ObservationBlock& block = looks_.data.blocks[b];
    const Eigen::Index in_block = i - first_[b];
    const int dimension = block.Dimension(in_block);
    if (dimension == 0) return;
    if (sums->information.size() == 0) *sums = Empty();
    Eigen::MatrixXd all = Rows(block, in_block, rows);
    all.col(all.cols() - 1) = looks_.residuals.segment(
        first_row_[b] + in_block * block.rows_each(), block.rows_each());
    const double weight = fit_.losses.empty()
                              ? 1.0
                              : fit_.losses[dimension - 1].Weight(
                                    all.col(all.cols() - 1).squaredNorm());
    all *= std::sqrt(weight);
    const double count = looks_.counts[static_cast<std::size_t>(i)];
    for (int row = 0; row < block.rows_each(); ++row) {
      const double sigma = block.sigmas(row, in_block);
      if (std::isinf(sigma)) continue;
      const int which = row < 3 ? kLengths : kRotations;
      sums->rows[which] += weight;
      sums->precision[which] += weight / (sigma * sigma);
      sums->inverse_counts[which] += weight / count;
    }
    Add(block, in_block, count, all, part);
    AddScore(i, count, all);
  }

  Eigen::MatrixXd Rows(const ObservationBlock& block, Eigen::Index in_block,
                       const Eigen::Ref<const Eigen::MatrixXd>& rows) const {
    const Eigen::Index m = structure_.size();
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(rows.rows(), p() + m + 1);
    all.leftCols(p()) = rows.leftCols(p());
    if (block.kind != MeasurementKind::kPointDistance &&
        block.kind != MeasurementKind::kDifference) {
      structure_.Fill(block.pose(in_block), block.target(in_block),
                      rows(Eigen::all, columns_.of_direction),
                      all.middleCols(p(), m));
    }
    return all;
  }

  void Add(const ObservationBlock& block, Eigen::Index in_block, double count,
           const Eigen::MatrixXd& all, Part* part) const {
    ResidualGram* const sums = &part->sums;
    const Eigen::Index lengths = std::min<Eigen::Index>(3, all.rows());
    for (const int which : {kLengths, kRotations}) {
      const Eigen::MatrixXd rows = which == kLengths
                                       ? all.topRows(lengths)
                                       : all.bottomRows(all.rows() - lengths);
      if (rows.rows() == 0) continue;
      part->Push(which, rows);
      const Eigen::MatrixXd free = rows.leftCols(p());
      sums->information.noalias() += count * free.transpose() * free;
      const Eigen::VectorXd precision =
          block.sigmas.col(in_block)
              .segment(which == kLengths ? 0 : lengths, rows.rows())
              .cwiseInverse();
      const Eigen::MatrixXd pull = count * precision.asDiagonal() * free;
      sums->common[which].noalias() += pull.transpose() * pull;
    }
  }

  void AddScore(Eigen::Index i, double count, const Eigen::MatrixXd& all) {
    const Eigen::MatrixXd free = all.leftCols(p());
    const Eigen::MatrixXd spread = free * root_;
    const Eigen::MatrixXd rest =
        RootOfRest(count * spread * spread.transpose());
    scores_.col(i) =
        count * free.transpose() * (rest * all.col(all.cols() - 1));
  }

  void SumScores(ResidualGram* total) const {
    const std::vector<int>& groups = looks_.configurations;
    const int last =
        groups.empty() ? -1 : *std::max_element(groups.begin(), groups.end());
    total->scores.setZero(p(), last + 1);
    Eigen::Index i = 0;
    for (const ObservationBlock& block : looks_.data.blocks) {
      for (Eigen::Index k = 0; k < block.size(); ++k, ++i) {
        if (block.kind == MeasurementKind::kPointDistance) continue;
        total->scores.col(groups[static_cast<std::size_t>(block.pose(k))]) +=
            scores_.col(i);
      }
    }
    for (Eigen::MatrixXd& products : total->products) {
      products.triangularView<Eigen::StrictlyUpper>() = products.transpose();
    }
  }

  const FittedProblem& fit_;
  const Looks& looks_;
  const StructureColumns& structure_;
  const Eigen::MatrixXd& root_;
  const Columns columns_;
  const std::vector<Eigen::Index> first_;
  std::vector<Eigen::Index> first_row_;  // of each block
  std::vector<Part> parts_;
  Eigen::MatrixXd scores_;  // of each look
};

}  // namespace

ResidualGram SumLooks(const FittedProblem& fit, const Looks& looks,
                      const StructureColumns& structure,
                      const Eigen::MatrixXd& root) {
  return Sums(fit, looks, structure, root).Run();
}

}  // namespace alidade::internal
