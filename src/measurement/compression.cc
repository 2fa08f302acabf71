#include "alidade/measurement/compression.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

#include "lane_factor.h"
#include "parted_data.h"

namespace alidade {
namespace {

// Below, products instead of transformations gain nothing.
constexpr Eigen::Index kFewestForGram = 1000;

// The largest condition that products are good enough for.
constexpr double kGramCondition = 1e4;

// |S| |S^-1| in Frobenius' norm, S being `factor` with columns of norm 1; no
// less than the condition of S. `scaled` and `inverse` are scratch.
double ScaledCondition(const Eigen::MatrixXd& factor, Eigen::MatrixXd* scaled,
                       Eigen::MatrixXd* inverse) {
  const Eigen::Index p = factor.cols();
  *scaled = factor;
  for (Eigen::Index k = 0; k < p; ++k) {
    scaled->col(k) /= scaled->col(k).norm();
  }
  inverse->setIdentity(p, p);
  scaled->triangularView<Eigen::Upper>().solveInPlace(*inverse);
  const double condition = std::sqrt(static_cast<double>(p)) * inverse->norm();
  return std::isfinite(condition) ? condition
                                  : std::numeric_limits<double>::infinity();
}

}  // namespace

std::string VectorInstructions() { return kernel::TargetName(); }

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
  PartedData parted(model, data, static_cast<int>(columns.size()), 0);
  const kernel::Columns wanted(model.layout(), columns);
  parted.ForEachTile(values, wanted,
                     [](Part* part, TileRows* rows) { part->AddRows(rows); });
  Eigen::MatrixXd factor;
  parted.MergeTriangles(&factor);
  return factor;
}

class Compressor::Implementation {
 public:
  Implementation(const MeasurementModel& model, const Dataset& data,
                 const std::vector<int>& columns,
                 const std::vector<RobustLoss>& losses,
                 const CompressorOptions& options)
      : parted_(model, data, static_cast<int>(columns.size()) + 1,
                options.cache_bytes),
        columns_(model.layout(), columns),
        no_columns_(model.layout(), {}),
        losses_(losses),
        factorization_(options.factorization),
        may_use_gram_(options.factorization == Factorization::kGram),
        is_large_(data.all_observations() >= kFewestForGram) {}

  void Compress(const Eigen::VectorXd& values, CompressedProblem* problem) {
    used_gram_ = may_use_gram_ && CompressByProducts(values, problem);
    if (!used_gram_) CompressByReflections(values, problem);
    Remember(values);
    problem->cost = summary_.cost;
    // Products that were kept have shown it already.
    if (factorization_ == Factorization::kAutomatic && is_large_ &&
        !used_gram_) {
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
    summarized_ = values;
  }

  bool HasGoodCondition(const Eigen::MatrixXd& factor) {
    return ScaledCondition(factor, &scaled_, &inverse_) <= kGramCondition;
  }

  void CompressByReflections(const Eigen::VectorXd& values,
                             CompressedProblem* problem) {
    parted_.ForEachTile(values, columns_, [this](Part* part, TileRows* rows) {
      part->AddCost(losses_, true, rows);
      part->AddRows(rows);
    });
    parted_.MergeTriangles(&triangle_);
    const Eigen::Index p = triangle_.cols() - 1;
    problem->factor = triangle_.topLeftCorner(p, p);
    problem->projected = triangle_.topRightCorner(p, 1);
  }

  // False where the products have no Cholesky factor, or one that shows that
  // they are not good enough.
  bool CompressByProducts(const Eigen::VectorXd& values,
                          CompressedProblem* problem) {
    parted_.ForEachTile(values, columns_, [this](Part* part, TileRows* rows) {
      part->AddCost(losses_, true, rows);
      part->AddProducts(rows);
    });
    parted_.SumProducts(&triangle_);
    const Eigen::Index p = triangle_.cols() - 1;
    cholesky_.compute(
        triangle_.topLeftCorner(p, p).selfadjointView<Eigen::Upper>());
    if (cholesky_.info() != Eigen::Success) return false;
    problem->factor = cholesky_.matrixU();
    if (factorization_ != Factorization::kGram &&
        !HasGoodCondition(problem->factor)) {
      return false;
    }
    problem->projected = triangle_.topRightCorner(p, 1);
    cholesky_.matrixL().solveInPlace(problem->projected);
    return true;
  }

  PartedData parted_;
  const kernel::Columns columns_;
  const kernel::Columns no_columns_;
  const std::vector<RobustLoss> losses_;
  const Factorization factorization_;
  bool may_use_gram_ = false;
  const bool is_large_;
  bool used_gram_ = false;
  Eigen::MatrixXd triangle_;
  Eigen::MatrixXd scaled_;
  Eigen::MatrixXd inverse_;
  Eigen::LLT<Eigen::MatrixXd, Eigen::Upper> cholesky_;
  Eigen::VectorXd summarized_;
  ResidualSummary summary_;
};

Compressor::Compressor(const MeasurementModel& model, const Dataset& data,
                       const std::vector<int>& columns,
                       const std::vector<RobustLoss>& losses,
                       const CompressorOptions& options)
    : implementation_(std::make_unique<Implementation>(model, data, columns,
                                                       losses, options)) {}

Compressor::~Compressor() = default;

void Compressor::Compress(const Eigen::VectorXd& values,
                          CompressedProblem* problem) {
  implementation_->Compress(values, problem);
}

const ResidualSummary& Compressor::Summarize(const Eigen::VectorXd& values) {
  return implementation_->Summarize(values);
}

bool Compressor::used_gram() const { return implementation_->used_gram(); }

CompressedProblem Compress(const MeasurementModel& model,
                           const Eigen::VectorXd& values, const Dataset& data,
                           const std::vector<int>& columns,
                           const std::vector<RobustLoss>& losses) {
  CompressorOptions options;
  options.cache_bytes = 0;
  Compressor compressor(model, data, columns, losses, options);
  CompressedProblem problem;
  compressor.Compress(values, &problem);
  return problem;
}

}  // namespace alidade
