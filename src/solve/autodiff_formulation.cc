#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/normal_prior.h>
#include <ceres/problem.h>

#include <algorithm>
#include <map>
#include <memory>
#include <vector>

#include "src/kernel/observation_cost.h"
#include "src/solve/formulation.h"

namespace alidade::internal {
namespace {

// Free columns of one block, as indices within it.
std::vector<int> FreeInBlock(const CalibrationProblem& problem,
                             const ParameterBlock& block) {
  std::vector<int> free;
  for (const int column : problem.free_columns) {
    const int index = column - block.first_column;
    if (index >= 0 && index < block.size) free.push_back(index);
  }
  return free;
}

std::vector<int> Complement(const std::vector<int>& free, int size) {
  std::vector<int> held;
  for (int i = 0; i < size; ++i) {
    if (!std::binary_search(free.begin(), free.end(), i)) held.push_back(i);
  }
  return held;
}

// Base and tool are blocks of the problem only where something in them is free.
bool NeedsFrames(const CalibrationProblem& problem) {
  const ParameterLayout& layout = problem.model.layout();
  return std::any_of(
      problem.free_columns.begin(), problem.free_columns.end(),
      [&](int column) {
        return !ParameterLayout::IsJointKind(layout.parameter(column).kind);
      });
}

void HoldFixedParameters(const CalibrationProblem& problem, double* values,
                         ceres::Problem* ceres_problem) {
  for (const ParameterBlock& block : problem.model.layout().blocks()) {
    double* const data = values + block.first_column;
    if (!ceres_problem->HasParameterBlock(data)) continue;
    const std::vector<int> free = FreeInBlock(problem, block);
    if (free.empty()) {
      ceres_problem->SetParameterBlockConstant(data);
    } else if (static_cast<int>(free.size()) < block.size) {
      ceres_problem->SetManifold(
          data,
          new ceres::SubsetManifold(block.size, Complement(free, block.size)));
    }
  }
}

// Ours, handed to Ceres, so that the loss has one definition.
class CeresLoss : public ceres::LossFunction {
 public:
  explicit CeresLoss(const RobustLoss& loss) : loss_(loss) {}
  void Evaluate(double s, double* rho) const override {
    loss_.Evaluate(s, rho);
  }

 private:
  RobustLoss loss_;
};

// One loss object per dimension, shared by all residual blocks of it; the
// problem owns it.
class Losses {
 public:
  explicit Losses(const std::vector<RobustLoss>& losses) : losses_(losses) {}

  ceres::LossFunction* Of(int dimension) {
    if (losses_.empty()) return nullptr;
    ceres::LossFunction*& loss = made_[dimension];
    if (loss == nullptr) loss = new CeresLoss(losses_[dimension - 1]);
    return loss;
  }

 private:
  const std::vector<RobustLoss>& losses_;
  std::map<int, ceres::LossFunction*> made_;
};

void AddResiduals(const CalibrationProblem& problem, double* values,
                  ceres::Problem* ceres_problem) {
  const bool with_frames = NeedsFrames(problem);
  const std::vector<ParameterBlock>& blocks = problem.model.layout().blocks();
  Losses losses(problem.losses);
  for (const ObservationBlock& block : problem.data.blocks) {
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      const int dimension = block.Dimension(i);
      if (dimension == 0) continue;
      ObservationCost cost = MakeObservationCost(problem.model, problem.data,
                                                 block, i, with_frames);
      std::vector<double*> parameters;
      for (const int index : cost.blocks) {
        parameters.push_back(values + blocks[index].first_column);
      }
      ceres_problem->AddResidualBlock(cost.function.release(),
                                      losses.Of(dimension), parameters);
    }
  }
}

void AddPriors(const CalibrationProblem& problem, double* values,
               ceres::Problem* ceres_problem) {
  const std::vector<int> with_prior = problem.ColumnsWithPrior();
  const Eigen::VectorXd nominal = problem.model.NominalValues();
  for (const ParameterBlock& block : problem.model.layout().blocks()) {
    ceres::Vector weights = ceres::Vector::Zero(block.size);
    for (const int column : with_prior) {
      const int index = column - block.first_column;
      if (index < 0 || index >= block.size) continue;
      weights[index] = 1.0 / problem.priors[column];
    }
    if (weights.isZero(0.0)) continue;
    ceres_problem->AddResidualBlock(
        new ceres::NormalPrior(weights.asDiagonal(),
                               nominal.segment(block.first_column, block.size)),
        nullptr, values + block.first_column);
  }
}

class AutodiffFormulation : public Formulation {
 public:
  AutodiffFormulation(const CalibrationProblem& problem,
                      const Eigen::VectorXd& values)
      : values_(values) {
    AddResiduals(problem, values_.data(), &ceres_problem_);
    AddPriors(problem, values_.data(), &ceres_problem_);
    HoldFixedParameters(problem, values_.data(), &ceres_problem_);
  }

  ceres::Problem* problem() override { return &ceres_problem_; }
  Eigen::VectorXd Values() const override { return values_; }

 private:
  Eigen::VectorXd values_;
  ceres::Problem ceres_problem_;
};

}  // namespace

std::unique_ptr<Formulation> MakeAutodiffFormulation(
    const CalibrationProblem& problem, const Eigen::VectorXd& values) {
  return std::make_unique<AutodiffFormulation>(problem, values);
}

}  // namespace alidade::internal
