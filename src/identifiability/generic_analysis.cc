#include <algorithm>
#include <cmath>
#include <string>

#include "src/identifiability/analysis.h"
#include "src/identifiability/elimination.h"
#include "src/identifiability/factor.h"
#include "src/identifiability/generic_data.h"
#include "src/identifiability/perturbation.h"
#include "src/identifiability/rank.h"
#include "src/kernel/reduction.h"

namespace alidade::internal {
namespace {

constexpr int kPerturbations = 3;

// Steps along a relation, small enough that second-order terms stay below the
// tolerance and large enough that rounding does.
constexpr double kRelationStep = 1e-5;
constexpr double kRelationTolerance = 1e-3;

int NumGenericPoses(std::size_t columns) {
  return std::max(64, 4 * static_cast<int>(columns));
}

class Generic {
 public:
  Generic(const MeasurementModel& model, const std::vector<int>& candidates,
          const Dataset& data, const IdentifiabilityOptions& options)
      : model_(model),
        layout_(model.layout()),
        candidates_(candidates),
        options_(options),
        data_(MakeGenericData(model, data, NumGenericPoses(candidates.size()),
                              options.seed)) {}

  GenericAnalysis Run() {
    if (candidates_.empty()) return analysis_;
    nominal_factor_ = Factor(model_.NominalValues());
    analysis_.generic_rank =
        AnalyzeRank(nominal_factor_, options_.relative_tolerance);
    elimination_ =
        Eliminate(nominal_factor_, analysis_.generic_rank.MiddleOfGap(),
                  NumForced(model_, options_, candidates_));
    for (const int index : elimination_.kept) {
      analysis_.kept.push_back(candidates_[index]);
    }
    FindWeak();
    for (const Dependency& dependency : ToDependencies(
             model_, nominal_factor_, candidates_, elimination_, 0.0)) {
      AddRelation(dependency);
    }
    return analysis_;
  }

 private:
  Eigen::MatrixXd Factor(const Eigen::VectorXd& values) const {
    return ScaleColumns(model_, candidates_,
                        JacobianFactor(model_, values, data_, candidates_));
  }

  // The perturbed geometry of largest rank decides which of the dependent
  // columns are so at the nominal geometry only.
  void FindWeak() {
    Eigen::MatrixXd best;
    for (int draw = 0; draw < kPerturbations; ++draw) {
      const Eigen::MatrixXd factor =
          Factor(PerturbedValues(model_, options_, draw));
      const RankReport report =
          AnalyzeRank(factor, options_.relative_tolerance);
      if (draw == 0 || report.rank > analysis_.structural_rank.rank) {
        analysis_.structural_rank = report;
        best = factor;
      }
    }
    ExtendKept(best);
  }

  // Adds to the kept columns those that raise the rank at a perturbed geometry,
  // by singular values as the structural rank itself.
  void ExtendKept(const Eigen::MatrixXd& factor) {
    std::vector<int> selected = elimination_.kept;
    int rank = static_cast<int>(selected.size());
    for (const int index : DependentByAngleFirst()) {
      if (rank == analysis_.structural_rank.rank) return;
      selected.push_back(index);
      const RankReport report = AnalyzeRank(SelectColumns(factor, selected),
                                            options_.relative_tolerance);
      if (report.rank > rank) {
        rank = report.rank;
        analysis_.weak.push_back(candidates_[index]);
      } else {
        selected.pop_back();
      }
    }
  }

  std::vector<int> DependentByAngleFirst() const {
    std::vector<int> indices;
    for (const DependentColumn& dependent : elimination_.dependent) {
      indices.push_back(dependent.index);
    }
    const auto preference = [&](int index) {
      const Parameter& parameter = layout_.parameter(candidates_[index]);
      if (parameter.kind == ParameterKind::kBeta) return 0;
      if (parameter.kind == ParameterKind::kAlpha) return 1;
      return parameter.dimension == Dimension::kAngle ? 2 : 3;
    };
    std::stable_sort(indices.begin(), indices.end(), [&](int a, int b) {
      return preference(a) < preference(b);
    });
    return indices;
  }

  void AddRelation(const Dependency& dependency) {
    Relation relation;
    relation.parameter = layout_.parameter(dependency.column).name;
    const bool weak = std::find(analysis_.weak.begin(), analysis_.weak.end(),
                                dependency.column) != analysis_.weak.end();
    relation.level = weak                       ? "at_geometry"
                     : dependency.terms.empty() ? "no_effect"
                                                : "structural";
    for (const auto& [column, coefficient] : dependency.terms) {
      relation.terms.emplace_back(layout_.parameter(column).name, coefficient);
    }
    relation.text = DescribeDependency(layout_, dependency);
    relation.verified = MeasurementsStay(dependency);
    analysis_.relations.push_back(std::move(relation));
  }

  // The parameter by a step, the ones that it depends on by as much the other
  // way: what is left is of second order in the step.
  bool MeasurementsStay(const Dependency& dependency) const {
    const double step = kRelationStep / ColumnScale(model_, dependency.column);
    Eigen::VectorXd moved = model_.NominalValues();
    moved[dependency.column] += step;
    for (const auto& [column, coefficient] : dependency.terms) {
      moved[column] -= coefficient * step;
    }
    const SharedVector difference =
        model_.Errors(moved, data_).map() -
        model_.Errors(model_.NominalValues(), data_).map();
    return std::sqrt(SquaredNorms(difference, data_).map().maxCoeff()) <=
           kRelationTolerance * kRelationStep;
  }

  const MeasurementModel& model_;
  const ParameterLayout& layout_;
  const std::vector<int>& candidates_;
  const IdentifiabilityOptions& options_;
  const Dataset data_;
  Eigen::MatrixXd nominal_factor_;
  Elimination elimination_;
  GenericAnalysis analysis_;
};

}  // namespace

GenericAnalysis AnalyzeGeneric(const MeasurementModel& model,
                               const std::vector<int>& candidates,
                               const Dataset& data,
                               const IdentifiabilityOptions& options) {
  return Generic(model, candidates, data, options).Run();
}

}  // namespace alidade::internal
