#include <ceres/cost_function.h>
#include <ceres/problem.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "src/kernel/compression.h"
#include "src/solve/formulation.h"
#include "src/solve/prior_residual.h"

namespace alidade::internal {
namespace {

// The free values, as Ceres has them, among all of the layout.
void Expand(const CalibrationProblem& problem, const double* free,
            Eigen::VectorXd* all) {
  for (std::size_t k = 0; k < problem.free_columns.size(); ++k) {
    (*all)[problem.free_columns[k]] = free[k];
  }
}

// With z the projected residual and c the cost, the residual is z and below it
// sqrt(c - |z|^2), what no step can lower to first order: half its squared norm
// is what Ceres minimises, R its Jacobian.
class CompressedResidual : public ceres::CostFunction {
 public:
  CompressedResidual(const CalibrationProblem& problem,
                     const Eigen::VectorXd& values, Compressor* compressor)
      : problem_(problem), compressor_(compressor), values_(values) {
    const auto p = static_cast<int>(problem.free_columns.size());
    mutable_parameter_block_sizes()->push_back(p);
    set_num_residuals(p + 1);
  }

  // Not to be called from two threads at once: Ceres has one.
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    Expand(problem_, parameters[0], &values_);
    const int p = parameter_block_sizes()[0];
    Eigen::Map<Eigen::VectorXd> residual(residuals, p + 1);
    if (jacobians == nullptr || jacobians[0] == nullptr) {
      residual.setZero();
      residual[p] = std::sqrt(CostOfTrial());
      return residual.allFinite();
    }
    if (compressed_at_.size() == 0 || values_ != compressed_at_) Compress();
    expects_success_ = true;
    residual.head(p) = compressed_.projected;
    const double rest = compressed_.cost - compressed_.projected.squaredNorm();
    residual[p] = std::sqrt(std::max(0.0, rest));
    Eigen::Map<
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>
        jacobian(jacobians[0], p + 1, p);
    jacobian.topRows(p) = compressed_.factor;
    jacobian.row(p).setZero();
    return residual.allFinite() && jacobian.allFinite();
  }

 private:
  void Compress() const {
    compressor_->Compress(values_, &compressed_);
    compressed_at_ = values_;
  }

  // Of a trial step only the cost is asked for. Most steps succeed, and then
  // all else is asked for at the same values: it is made at once. Behind a step
  // that was taken back the cost alone is, which is cheaper.
  double CostOfTrial() const {
    if (expects_success_) {
      expects_success_ = false;
      Compress();
      return compressed_.cost;
    }
    return compressor_->Summarize(values_).cost;
  }

  const CalibrationProblem& problem_;
  Compressor* const compressor_;
  mutable Eigen::VectorXd values_;
  mutable CompressedProblem compressed_;
  mutable Eigen::VectorXd compressed_at_ = Eigen::VectorXd::Zero(0);
  // False behind a trial whose Jacobian was never asked for.
  mutable bool expects_success_ = true;
};

class CompressedFormulation : public Formulation {
 public:
  CompressedFormulation(const CalibrationProblem& problem,
                        const Eigen::VectorXd& values, Compressor* compressor)
      : problem_(problem), values_(values) {
    for (const int column : problem.free_columns) {
      free_.push_back(values[column]);
    }
    ceres_problem_.AddResidualBlock(
        new CompressedResidual(problem, values, compressor), nullptr,
        free_.data());
    AddPriors();
    AddBounds();
  }

  ceres::Problem* problem() override { return &ceres_problem_; }
  Eigen::VectorXd Values() const override {
    Eigen::VectorXd all = values_;
    Expand(problem_, free_.data(), &all);
    return all;
  }

 private:
  void AddPriors() {
    if (problem_.ColumnsWithPrior().empty()) return;
    const Eigen::VectorXd nominal = problem_.model.NominalValues();
    std::vector<PriorResidual::Entry> entries;
    for (std::size_t k = 0; k < free_.size(); ++k) {
      const int column = problem_.free_columns[k];
      if (!std::isfinite(problem_.priors[column])) continue;
      entries.push_back(
          {static_cast<int>(k), nominal[column], problem_.priors[column]});
    }
    ceres_problem_.AddResidualBlock(
        new PriorResidual(static_cast<int>(free_.size()), std::move(entries)),
        nullptr, free_.data());
  }

  void AddBounds() {
    if (problem_.lower.size() == 0) return;
    for (std::size_t k = 0; k < free_.size(); ++k) {
      const int column = problem_.free_columns[k];
      const auto index = static_cast<int>(k);
      ceres_problem_.SetParameterLowerBound(free_.data(), index,
                                            problem_.lower[column]);
      ceres_problem_.SetParameterUpperBound(free_.data(), index,
                                            problem_.upper[column]);
    }
  }

  const CalibrationProblem& problem_;
  const Eigen::VectorXd values_;
  std::vector<double> free_;
  ceres::Problem ceres_problem_;
};

}  // namespace

std::unique_ptr<Formulation> MakeCompressedFormulation(
    const CalibrationProblem& problem, const Eigen::VectorXd& values,
    Compressor* compressor) {
  return std::make_unique<CompressedFormulation>(problem, values, compressor);
}

}  // namespace alidade::internal
