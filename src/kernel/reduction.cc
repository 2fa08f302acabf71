#include "src/kernel/reduction.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <cmath>
#include <limits>

#include "src/kernel/lane_factor.h"
#include "src/kernel/parted_data.h"

namespace alidade::internal {
namespace {

// The largest condition that products are good enough for.
constexpr double kGramCondition = 1e4;

// Of fewer observations a sample would cost as much as it saves.
constexpr Eigen::Index kFewestForSample = 1000;

// |S| |S^-1| in Frobenius' norm, S being an upper triangle with its columns
// made of norm 1; no less than the condition of S.
class ScaledCondition {
 public:
  // p^3 / 6 multiply-adds.
  double operator()(const Eigen::MatrixXd& factor) {
    const Eigen::Index p = factor.cols();
    double squares = 0.0;
    inverse_.setIdentity(p, p);
    for (Eigen::Index i = p - 1; i >= 0; --i) {
      auto row = inverse_.row(i);
      for (Eigen::Index k = i + 1; k < p; ++k) {
        row.tail(p - k) -= factor(i, k) * inverse_.row(k).tail(p - k);
      }
      row.tail(p - i) /= factor(i, i);
      squares += factor.col(i).squaredNorm() * row.tail(p - i).squaredNorm();
    }
    const double condition = std::sqrt(static_cast<double>(p) * squares);
    return std::isfinite(condition) ? condition
                                    : std::numeric_limits<double>::infinity();
  }

 private:
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>
      inverse_;
};

}  // namespace

std::string VectorInstructions() { return kernel::TargetName(); }

double RobustChiSquare(const SharedVector& errors, const Dataset& data,
                       const std::vector<RobustLoss>& losses) {
  const SharedVector squared = SquaredNorms(errors, data);
  if (losses.empty()) return squared.map().sum();
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
  PartedData parted(model, data, static_cast<int>(columns.size()), 0);
  const kernel::Columns wanted(model.layout(), columns);
  parted.ForEachTile(values, wanted,
                     [](Part* part, TileRows* rows) { part->AddRows(rows); });
  Eigen::MatrixXd factor;
  parted.MergeTriangles(&factor);
  return factor;
}

class Reducer::Implementation {
 public:
  Implementation(const MeasurementModel& model, const Dataset& data,
                 const std::vector<int>& columns,
                 const std::vector<RobustLoss>& losses,
                 const ReducerOptions& options)
      : parted_(model, data, static_cast<int>(columns.size()) + 1,
                options.cache_bytes),
        columns_(model.layout(), columns),
        no_columns_(model.layout(), {}),
        losses_(losses),
        factorization_(options.factorization),
        may_use_gram_(options.factorization != Factorization::kOrthogonal),
        is_large_(data.global_observations() >= kFewestForSample) {
    if (options.priors.size() == 0) return;
    prior_columns_ = columns;
    nominal_ = model.NominalValues()(prior_columns_);
    prior_weights_ = options.priors(prior_columns_).cwiseInverse();
    prior_weights_ =
        prior_weights_.array().isFinite().select(prior_weights_, 0.0);
  }

  void Reduce(const Eigen::VectorXd& values, ReducedLeastSquares* problem) {
    used_gram_ = may_use_gram_ && SampleIsGood(values, problem) &&
                 ReduceByProducts(values, problem);
    if (!used_gram_) ReduceByReflections(values, problem);
    Remember(values);
    problem->cost = summary_.cost;
    // Products that were kept have shown it already.
    if (factorization_ == Factorization::kAutomatic && !used_gram_) {
      may_use_gram_ = HasGoodCondition(problem->factor);
    }
  }

  const ResidualSummary& Summarize(const Eigen::VectorXd& values) {
    if (values.size() != summarized_.size() || values != summarized_) {
      parted_.ForEachTile(values, no_columns_,
                          [this](Part* part, TileRows* rows) {
                            part->AddCost(losses_, false, rows);
                          });
      parted_.MergeSums();
      Remember(values);
    }
    return summary_;
  }

  bool used_gram() const { return used_gram_; }

 private:
  void Remember(const Eigen::VectorXd& values) {
    summary_ = parted_.summary();
    if (prior_weights_.size() > 0) {
      summary_.cost += PriorResiduals(values).squaredNorm();
    }
    summarized_ = values;
  }

  Eigen::VectorXd PriorResiduals(const Eigen::VectorXd& values) const {
    return prior_weights_.cwiseProduct(values(prior_columns_) - nominal_);
  }

  bool HasGoodCondition(const Eigen::MatrixXd& factor) {
    return condition_(factor) <= kGramCondition;
  }

  void ReduceByReflections(const Eigen::VectorXd& values,
                           ReducedLeastSquares* problem) {
    parted_.ForEachTile(values, columns_, [this](Part* part, TileRows* rows) {
      part->AddCost(losses_, true, rows);
      part->AddRows(rows);
    });
    parted_.MergeTriangles(&triangle_);
    const Eigen::Index p = triangle_.cols() - 1;
    if (prior_weights_.size() > 0) AddPriorRows(values);
    problem->factor = triangle_.topLeftCorner(p, p);
    problem->projected = triangle_.topRightCorner(p, 1);
  }

  // Merges the rows of the priors into the triangle.
  void AddPriorRows(const Eigen::VectorXd& values) {
    const Eigen::Index p = triangle_.cols() - 1;
    Eigen::MatrixXd stacked = Eigen::MatrixXd::Zero(2 * p + 1, p + 1);
    stacked.topRows(p + 1) = triangle_;
    stacked.bottomLeftCorner(p, p).diagonal() = prior_weights_;
    stacked.bottomRightCorner(p, 1) = PriorResiduals(values);
    triangle_ = Eigen::HouseholderQR<Eigen::MatrixXd>(stacked)
                    .matrixQR()
                    .topRows(p + 1)
                    .triangularView<Eigen::Upper>();
  }

  // Before anything is known of the columns: whether a few tiles of many let
  // expect that products will do, lest a whole pass be made in vain.
  bool SampleIsGood(const Eigen::VectorXd& values,
                    ReducedLeastSquares* problem) {
    const bool is_first = summarized_.size() == 0;
    return !is_first || !is_large_ || factorization_ == Factorization::kGram ||
           ReduceByProducts(values, problem, PartedData::Extent::kSample);
  }

  // False where the products have no Cholesky factor, or one that shows that
  // they are not good enough.
  bool ReduceByProducts(const Eigen::VectorXd& values,
                        ReducedLeastSquares* problem,
                        PartedData::Extent extent = PartedData::Extent::kAll) {
    const auto add = [this](Part* part, TileRows* rows) {
      part->AddCost(losses_, true, rows);
      part->AddProducts(rows);
    };
    parted_.ForEachTile(values, columns_, add, extent);
    parted_.SumProducts(&triangle_);
    const Eigen::Index p = triangle_.cols() - 1;
    if (prior_weights_.size() > 0) {
      triangle_.diagonal().head(p) += prior_weights_.cwiseAbs2();
      triangle_.topRightCorner(p, 1) +=
          prior_weights_.cwiseProduct(PriorResiduals(values));
    }
    cholesky_.compute(
        triangle_.topLeftCorner(p, p).selfadjointView<Eigen::Upper>());
    if (cholesky_.info() != Eigen::Success) return false;
    problem->factor = cholesky_.matrixU();
    if (factorization_ != Factorization::kGram &&
        !HasGoodCondition(problem->factor)) {
      return false;
    }
    // R^T projected = J^T r.
    problem->projected = triangle_.topRightCorner(p, 1);
    for (Eigen::Index k = 0; k < p; ++k) {
      const auto above = problem->factor.col(k).head(k);
      problem->projected[k] -= above.dot(problem->projected.head(k));
      problem->projected[k] /= problem->factor(k, k);
    }
    return true;
  }

  PartedData parted_;
  const kernel::Columns columns_;
  const kernel::Columns no_columns_;
  const std::vector<RobustLoss> losses_;
  const Factorization factorization_;
  bool may_use_gram_;
  const bool is_large_;
  // Where there are priors: the columns, their nominal values, and the inverses
  // of the standard deviations, 0 where a column has no prior.
  std::vector<int> prior_columns_;
  Eigen::VectorXd nominal_;
  Eigen::VectorXd prior_weights_;
  bool used_gram_ = false;
  Eigen::MatrixXd triangle_;
  ScaledCondition condition_;
  Eigen::LLT<Eigen::MatrixXd, Eigen::Upper> cholesky_;
  Eigen::VectorXd summarized_;
  ResidualSummary summary_;
};

Reducer::Reducer(const MeasurementModel& model, const Dataset& data,
                 const std::vector<int>& columns,
                 const std::vector<RobustLoss>& losses,
                 const ReducerOptions& options)
    : implementation_(std::make_unique<Implementation>(model, data, columns,
                                                       losses, options)) {}

Reducer::~Reducer() = default;

void Reducer::Reduce(const Eigen::VectorXd& values,
                     ReducedLeastSquares* problem) {
  implementation_->Reduce(values, problem);
}

const ResidualSummary& Reducer::Summarize(const Eigen::VectorXd& values) {
  return implementation_->Summarize(values);
}

bool Reducer::used_gram() const { return implementation_->used_gram(); }

}  // namespace alidade::internal
