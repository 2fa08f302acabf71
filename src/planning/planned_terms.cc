#include "src/planning/planned_terms.h"

#include <algorithm>
#include <cmath>

#include "src/error_terms/term_rows.h"

namespace alidade::internal {
namespace {

constexpr double kKnotDistance = 0.8;   // rad
constexpr double kPlannedLength = 0.8;  // rad

TermSet SetOf(const ErrorTermOptions& options) {
  TermSet set;
  const bool is_auto = options.selection == ErrorTermSelection::kAuto;
  set.elasticity = options.elasticity || is_auto;
  if (options.function_length > 0.0 || is_auto) {
    set.function_length = kPlannedLength;
    set.knot_spacing = kKnotDistance;
  }
  set.cycles = options.harmonics;
  set.scale = options.scale;
  set.backlash = options.backlash;
  set.coupling = options.coupling;
  return set;
}

}  // namespace

std::optional<PlannedTerms> PlannedTerms::Of(
    const MeasurementModel& model, const ErrorTermOptions& options,
    const Eigen::MatrixXd& joint_values) {
  if (options.selection == ErrorTermSelection::kNone) return std::nullopt;
  PlannedTerms terms(TermColumns(model.nominal(), SetOf(options), joint_values,
                                 Eigen::VectorXd()));
  if (terms.size() == 0) return std::nullopt;
  terms.SetScales(model, joint_values);
  terms.ListEntries(model.nominal());
  return terms;
}

// A coefficient of one unit turns the joint by `turn` in the root mean square
// over the candidates.
void PlannedTerms::SetScales(const MeasurementModel& model,
                             const Eigen::MatrixXd& joint_values) {
  constexpr Eigen::Index kEnough = 1000;
  const Arm& arm = model.nominal();
  const double turn = 1.0 / ArmReach(arm) / kTermUnit;
  const Eigen::Index poses = std::min(kEnough, joint_values.cols());
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(size());
  for (Eigen::Index pose = 0; pose < poses; ++pose) {
    const double* const q = joint_values.col(pose).data();
    const Eigen::Matrix3Xd moments = LoadMoments(arm, q);
    columns_.ForEachAt({q, moments.data(), nullptr},
                       [&](int column, int /*turn*/, double size) {
                         squares[column] += size * size;
                       });
  }
  scales_ = Eigen::VectorXd::Constant(size(), turn);
  for (int k = 0; k < columns_.num_dense(); ++k) {
    const double typical = std::sqrt(squares[k] / static_cast<double>(poses));
    if (typical > 0.0) scales_[k] = turn / typical;
  }
  known_.setIdentity(size(), size());
  for (const FunctionKnots& knots : columns_.functions()) {
    const int first = columns_.num_dense() + knots.offset;
    known_.block(first, first, knots.count, knots.count) =
        columns_.Precision(knots);
  }
  known_ /= kPrior * kPrior;
}

void PlannedTerms::ListEntries(const Arm& arm) {
  for (int k = 0; k < columns_.num_dense(); ++k) {
    const DenseTerm& term = columns_.dense()[k];
    const bool is_compliance = term.regressor == DenseTerm::Regressor::kMoment;
    entries_.push_back({NameOf(term, arm.num_joints()),
                        is_compliance ? "rad/(N m)" : "rad",
                        kPrior * scales_[k] * term.unit, k, 1});
  }
  for (const FunctionKnots& knots : columns_.functions()) {
    const int first = columns_.num_dense() + knots.offset;
    const bool is_length =
        arm.joints[knots.joint].dimension() == Dimension::kLength;
    entries_.push_back(
        {"e" + std::to_string(knots.joint + 1), is_length ? "m" : "rad",
         kPrior * scales_[first] * kTermUnit, first, knots.count});
  }
}

void PlannedTerms::Append(const MeasurementModel& model,
                          const Eigen::VectorXd& values, const Dataset& data,
                          PoseRows* rows) const {
  const TermRows made = MakeTermRows(model, values, data, {});
  const Eigen::Index p = rows->transposed.rows();
  const Eigen::Index num_rows = rows->transposed.cols();
  rows->transposed.conservativeResize(p + size(), num_rows);
  rows->transposed.bottomRows(size()).setZero();
  for (const TermRows::Observation& one : made.observations) {
    auto to = rows->transposed.block(p, one.first_row, size(), one.height);
    columns_.ForEachAt(
        made.NumbersOf(one.pose), [&](int column, int turn, double size) {
          to.row(column) +=
              scales_[column] * size *
              made.turns.block(one.first_row, turn, one.height, 1).transpose();
        });
  }
}

}  // namespace alidade::internal
