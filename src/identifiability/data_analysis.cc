#include "src/identifiability/data_analysis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>

#include "src/common/bytes.h"
#include "src/identifiability/elimination.h"
#include "src/identifiability/factor.h"
#include "src/identifiability/generic_data.h"
#include "src/identifiability/observability.h"
#include "src/identifiability/perturbation.h"
#include "src/identifiability/rank.h"
#include "src/kernel/partition.h"
#include "src/kernel/reduction.h"
#include "src/model/joint_draw.h"

namespace alidade::internal {
namespace {

// Poses that questions about ranks and orders of magnitude are asked of; with
// more the answer is the same.
constexpr Eigen::Index kEnoughPoses = 256;

// Perturbed arms that second-order deviations are taken over.
constexpr int kSecondOrderDraws = 9;

// Ratio of neighbouring singular values above which a gap is clear.
constexpr double kClearGap = 100.0;

Eigen::VectorXd NoPriors(Eigen::Index size) {
  return Eigen::VectorXd::Constant(size,
                                   std::numeric_limits<double>::infinity());
}

// Poses that touch something cannot move one joint alone.
bool HasContacts(const Dataset& data) {
  return data.Has(MeasurementKind::kFixedPoint) ||
         data.Has(MeasurementKind::kPlane);
}

class DataAnalyzer {
 public:
  DataAnalyzer(const MeasurementModel& model, const Dataset& data,
               const std::vector<int>& kept, const std::vector<int>& weak,
               const IdentifiabilityOptions& options)
      : model_(model),
        data_(data),
        kept_(kept),
        weak_(weak),
        options_(options),
        subset_(EvenSubset(model.communicator(), data, kEnoughPoses)) {}

  DataAnalysis Run() {
    analysis_.columns = kept_;
    if (kept_.empty()) return analysis_;
    analysis_.whitened_factor =
        JacobianFactor(model_, model_.NominalValues(), data_, kept_);
    const Eigen::MatrixXd scaled =
        ScaleColumns(model_, kept_, analysis_.whitened_factor);
    analysis_.rank = AnalyzeRank(scaled, options_.relative_tolerance);
    const Elimination elimination =
        Eliminate(scaled, analysis_.rank.MiddleOfGap(),
                  NumForced(model_, options_, kept_));
    for (const Dependency& dependency : ToDependencies(
             model_, scaled, kept_, elimination, kSmallestMeasuredTerm)) {
      AddRelation(dependency);
    }
    if (!analysis_.relations.empty()) Advise();
    if (!analysis_.relations.empty() || !weak_.empty()) {
      DescribeSecondOrder();
    }
    return analysis_;
  }

 private:
  void AddRelation(const Dependency& dependency) {
    const ParameterLayout& layout = model_.layout();
    Relation relation;
    relation.parameter = layout.parameter(dependency.column).name;
    relation.level = "not_excited";
    relation.text = DescribeDependency(layout, dependency);
    // The factor itself showed it, over all poses.
    relation.verified = true;
    for (const auto& [column, coefficient] : dependency.terms) {
      relation.terms.emplace_back(layout.parameter(column).name, coefficient);
    }
    analysis_.relations.push_back(std::move(relation));
  }

  int RankOf(const Dataset& data) const {
    const Eigen::MatrixXd factor =
        JacobianFactor(model_, model_.NominalValues(), data, kept_);
    return AnalyzeRank(ScaleColumns(model_, kept_, factor),
                       options_.relative_tolerance)
        .rank;
  }

  int RankWithJointMoved(int joint) const {
    constexpr std::uint64_t kSeed = 1;
    Dataset moved = subset_;
    MatrixBuilder joint_values(subset_.joint_values);
    joint_values.map().row(joint) =
        DrawJointValues(model_.nominal(), static_cast<int>(moved.num_poses()),
                        kSeed)
            .row(joint);
    moved.joint_values = joint_values.Freeze();
    return RankOf(moved);
  }

  // The joints that would raise the rank if they moved through their range
  // while the others stay as measured.
  void Advise() {
    const int num_joints =
        HasContacts(data_) ? 0 : model_.layout().num_joints();
    const int rank = num_joints > 0 ? RankOf(subset_) : 0;
    for (int j = 0; j < num_joints; ++j) {
      const int gain = RankWithJointMoved(j) - rank;
      if (gain <= 0) continue;
      analysis_.advice.emplace_back(
          "moving joint " + std::to_string(j + 1) +
          " through its range, the others as measured, would determine " +
          std::to_string(gain) + " more " +
          (gain == 1 ? "parameter" : "parameters"));
    }
    if (!analysis_.advice.empty()) return;
    analysis_.advice.emplace_back(
        "no joint alone would help: vary several of them together");
  }

  // Median standard deviations, over arms perturbed by the tolerances, of the
  // parameters that take part in a relation: what a solve without priors or
  // fixing would leave.
  void DescribeSecondOrder() {
    std::vector<int> all = kept_;
    all.insert(all.end(), weak_.begin(), weak_.end());
    // Uniform draws of this half width have the tolerance as their standard
    // deviation. Where base and tool are is no matter of tolerances.
    Eigen::VectorXd sizes =
        std::sqrt(3.0) * options_.priors.Deviations(model_.layout());
    for (Eigen::Index c = 0; c < sizes.size(); ++c) {
      const Parameter& parameter =
          model_.layout().parameter(static_cast<int>(c));
      if (!ParameterLayout::IsJointKind(parameter.kind)) sizes[c] = 0.0;
    }
    Eigen::MatrixXd draws(static_cast<Eigen::Index>(all.size()),
                          kSecondOrderDraws);
    for (int draw = 0; draw < kSecondOrderDraws; ++draw) {
      const Eigen::MatrixXd factor = JacobianFactor(
          model_, PerturbedValues(model_, sizes, draw), subset_, all);
      draws.col(draw) = PredictDeviations(factor, NoPriors(factor.cols()));
    }
    const double factor =
        std::sqrt(static_cast<double>(subset_.joint_values.cols()) /
                  static_cast<double>(data_.global_poses()));
    std::string list;
    for (std::size_t k = 0; k < all.size(); ++k) {
      Eigen::VectorXd row = draws.row(static_cast<Eigen::Index>(k));
      std::sort(row.data(), row.data() + row.size());
      const Parameter& parameter = model_.layout().parameter(all[k]);
      const double median = factor * row[kSecondOrderDraws / 2];
      if (!(median > options_.priors.Of(parameter.kind))) continue;
      if (!list.empty()) list += ", ";
      list +=
          parameter.name + " " + FormatDeviation(median, parameter.dimension);
    }
    if (list.empty()) return;
    analysis_.second_order =
        "without priors the noise would leave standard deviations of about " +
        list + " in an arm within its tolerances";
  }

  const MeasurementModel& model_;
  const Dataset& data_;
  const std::vector<int>& kept_;
  const std::vector<int>& weak_;
  const IdentifiabilityOptions& options_;
  const Dataset subset_;
  DataAnalysis analysis_;
};

bool HasClearGap(const RankReport& report) {
  return report.rank == 0 || report.gap >= kClearGap;
}

// One sigma for all positions lets the factor be unwhitened without another
// pass; 0 where they differ.
double OneSigma(Communicator* communicator, const Dataset& data) {
  if (data.blocks.size() != 1) return 0.0;
  const ObservationBlock& block = data.blocks[0];
  const bool has_any = block.size() > 0;
  double mine = 0.0;
  if (has_any && block.kind == MeasurementKind::kPosition &&
      block.whiteners.empty() && std::isfinite(block.sigmas(0, 0)) &&
      (block.sigmas.map().array() == block.sigmas(0, 0)).all()) {
    mine = block.sigmas(0, 0);
  }
  ByteWriter writer;
  if (has_any) writer.Put(mine);
  std::vector<double> sigmas;
  for (const std::string& bytes :
       HoldersOf(communicator, data)->Gather(writer.Take())) {
    if (!bytes.empty()) sigmas.push_back(ByteReader(bytes).Get<double>());
  }
  const bool are_one =
      std::all_of(sigmas.begin(), sigmas.end(),
                  [&](double sigma) { return sigma == sigmas.front(); });
  return are_one && !sigmas.empty() ? sigmas.front() : 0.0;
}

Eigen::MatrixXd Unwhitened(const MeasurementModel& model, const Dataset& data,
                           const std::vector<int>& free,
                           const Eigen::MatrixXd& whitened) {
  const double sigma = OneSigma(model.communicator(), data);
  if (sigma > 0.0) return whitened * sigma;
  return JacobianFactor(model, model.NominalValues(),
                        WithUnitSigmas(model, data), free);
}

}  // namespace

Eigen::VectorXd DataAnalysis::Deviations(const std::vector<int>& some) const {
  std::vector<int> indices;
  for (const int column : some) {
    indices.push_back(static_cast<int>(
        std::find(columns.begin(), columns.end(), column) - columns.begin()));
  }
  const Eigen::MatrixXd factor = SelectColumns(whitened_factor, indices);
  return PredictDeviations(factor, NoPriors(factor.cols()));
}

DataAnalysis AnalyzeData(const MeasurementModel& model, const Dataset& data,
                         const std::vector<int>& kept,
                         const std::vector<int>& weak,
                         const IdentifiabilityOptions& options) {
  return DataAnalyzer(model, data, kept, weak, options).Run();
}

Eigen::VectorXd FreeAnalysis::Deviations(bool with_priors) const {
  return PredictDeviations(whitened_factor,
                           with_priors ? priors : NoPriors(priors.size()));
}

FreeAnalysis AnalyzeFree(const MeasurementModel& model, const Dataset& data,
                         const std::vector<int>& free,
                         const IdentifiabilityOptions& options) {
  FreeAnalysis analysis;
  analysis.whitened_factor =
      JacobianFactor(model, model.NominalValues(), data, free);
  analysis.rank =
      AnalyzeRank(ScaleColumns(model, free, analysis.whitened_factor),
                  options.relative_tolerance);
  const Eigen::MatrixXd perturbed = JacobianFactor(
      model, PerturbedValues(model, options, 0),
      EvenSubset(model.communicator(), data, kEnoughPoses), free);
  analysis.perturbed_rank = AnalyzeRank(ScaleColumns(model, free, perturbed),
                                        options.relative_tolerance);
  const Eigen::MatrixXd plain =
      Unwhitened(model, data, free, analysis.whitened_factor);
  analysis.unscaled = ComputeObservability(plain, data.global_poses());
  analysis.scaled = ComputeObservability(ScaleColumns(model, free, plain),
                                         data.global_poses());
  return analysis;
}

void WarnAboutFree(const MeasurementModel& model, const Dataset& data,
                   const FreeAnalysis& analysis,
                   IdentifiabilityResult* result) {
  const std::array<std::pair<const char*, const RankReport*>, 3> reports = {
      {{"of the free parameters over these poses", &analysis.rank},
       {"over generic poses", &result->generic_rank},
       {"at perturbed geometries", &result->structural_rank}}};
  for (const auto& [where, report] : reports) {
    if (HasClearGap(*report)) continue;
    result->warnings.push_back(
        std::string("the rank ") + where + " is not clear: it is read as " +
        std::to_string(report->rank) +
        ", but neighbouring singular values are only a factor of " +
        std::to_string(static_cast<std::int64_t>(std::min(report->gap, 1e15))) +
        " apart");
  }
  const Arm& arm = model.nominal();
  const double off_axis = arm.last_from_target().translation().head<2>().norm();
  if (arm.joints.back().type == JointType::kRevolute &&
      arm.num_targets() == 1 && !data.Has(MeasurementKind::kPose) &&
      off_axis <= 1e-6 * ArmReach(arm)) {
    result->warnings.emplace_back(
        "the target lies on the axis of the last joint, whose rotation "
        "therefore moves no measured point: two parameters fewer can be "
        "identified than with a target off the axis");
  }
  const Eigen::Index num_equations =
      GlobalEquations(model.communicator(), data);
  if (num_equations < result->num_free) {
    result->warnings.push_back(
        std::to_string(data.global_poses()) + " poses give " +
        std::to_string(num_equations) + " equations for " +
        std::to_string(result->num_free) + " parameters");
  }
}

std::string FormatDeviation(double value, Dimension dimension) {
  if (!std::isfinite(value)) return "no bound";
  std::array<char, 32> text{};
  const bool angle = dimension == Dimension::kAngle;
  std::snprintf(text.data(), text.size(), "%.2g %s",
                value / (angle ? kMilliradian : kMillimetre),
                angle ? "mrad" : "mm");
  return text.data();
}

}  // namespace alidade::internal
