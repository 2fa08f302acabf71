#include "src/error_terms/term_normal.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace alidade::internal {
namespace {

// So little that it holds what nothing else determines, and no more: 1 m or 1
// rad where a residual has its sigma.
constexpr double kLeastPrecision = 1e-6;

// The turns of an observation at one of its poses.
auto TurnsOf(const TermRows& rows, const TermRows::Observation& one,
             bool second) {
  const TermRows::RowMatrix& turns = second ? rows.second_turns : rows.turns;
  return turns.middleRows(one.first_row, one.height);
}

// Sums of one data set, part by part.
class GramSum {
 public:
  GramSum(const WeightedRows& data, const TermColumns& columns)
      : rows_(data.rows),
        weights_(data.weights),
        columns_(columns),
        p_(data.rows.num_columns()),
        width_(p_ + columns.num_dense() + 1),
        dense_(Eigen::MatrixXd::Zero(width_, width_)),
        beside_(Eigen::MatrixXd::Zero(width_, columns.num_knots())),
        knots_(Eigen::MatrixXd::Zero(columns.num_knots(), columns.num_knots())),
        batch_(kBatchRows + kMostRows, width_) {}

  void Add(int observation) {
    const TermRows::Observation& one = rows_.observations[observation];
    const double weight = weights_[observation];
    if (weight <= 0.0) return;
    auto block = batch_.middleRows(filled_, one.height);
    Fill(one, std::sqrt(weight), &block);
    AddKnots(block);
    filled_ += one.height;
    if (filled_ >= kBatchRows) Flush();
  }

  // Geometry, dense terms, knots, residual.
  Eigen::MatrixXd Total() {
    Flush();
    const Eigen::Index dense = width_ - 1;
    const Eigen::Index knots = knots_.rows();
    Eigen::MatrixXd gram(dense + knots + 1, dense + knots + 1);
    dense_.triangularView<Eigen::StrictlyUpper>() = dense_.transpose();
    knots_.triangularView<Eigen::StrictlyUpper>() = knots_.transpose();
    gram.topLeftCorner(dense, dense) = dense_.topLeftCorner(dense, dense);
    gram.block(0, dense, dense, knots) = beside_.topRows(dense);
    gram.block(dense, 0, knots, dense) = beside_.topRows(dense).transpose();
    gram.block(dense, dense, knots, knots) = knots_;
    gram.topRightCorner(dense, 1) = dense_.topRightCorner(dense, 1);
    gram.block(dense, dense + knots, knots, 1) = beside_.row(dense).transpose();
    gram.bottomRows(1).leftCols(dense + knots) =
        gram.rightCols(1).topRows(dense + knots).transpose();
    gram(dense + knots, dense + knots) = dense_(dense, dense);
    return gram;
  }

 private:
  static constexpr Eigen::Index kBatchRows = 192;
  static constexpr Eigen::Index kMostRows = 6;

  using Batch = TermRows::RowMatrix;

  // A knot that an observation touches.
  struct Touched {
    int knot;
    int turn;  // of which pose and joint
    double weight;
    Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostRows, 1> column;
  };

  // Writes the rows of dense columns, and lists the knots.
  template <typename Block>
  void Fill(const TermRows::Observation& one, double root, Block* block) {
    touched_.clear();
    block->leftCols(p_) = rows_.geometry.middleRows(one.first_row, one.height);
    block->middleCols(p_, columns_.num_dense()).setZero();
    block->col(width_ - 1) = rows_.residuals.segment(one.first_row, one.height);
    for (const bool second : {false, true}) {
      const int pose = second ? one.second_pose : one.pose;
      if (pose < 0) continue;
      const auto turns = TurnsOf(rows_, one, second);
      columns_.ForEachAt(
          rows_.NumbersOf(pose), [&](int column, int turn, double size) {
            const int knot = column - columns_.num_dense();
            if (knot < 0) {
              block->col(p_ + column) += size * turns.col(turn);
            } else {
              const int of_pose = turn + (second ? 3 * rows_.num_joints() : 0);
              touched_.push_back({knot, of_pose, size, root * turns.col(turn)});
            }
          });
    }
    *block *= root;
  }

  template <typename Block>
  void AddKnots(const Block& block) {
    Eigen::VectorXd product(width_);
    for (std::size_t a = 0; a < touched_.size(); ++a) {
      // Both knots of a joint share their column.
      if (a == 0 || touched_[a].turn != touched_[a - 1].turn) {
        product.noalias() = block.transpose() * touched_[a].column;
      }
      beside_.col(touched_[a].knot) += touched_[a].weight * product;
      for (std::size_t b = 0; b <= a; ++b) {
        const double value = touched_[a].weight * touched_[b].weight *
                             touched_[a].column.dot(touched_[b].column);
        const auto [low, high] =
            std::minmax(touched_[a].knot, touched_[b].knot);
        knots_(high, low) += value;
        // The same knot of both poses of a difference.
        if (a != b && low == high) knots_(high, low) += value;
      }
    }
  }

  void Flush() {
    if (filled_ == 0) return;
    dense_.selfadjointView<Eigen::Lower>().rankUpdate(
        batch_.topRows(filled_).transpose());
    filled_ = 0;
  }

  const TermRows& rows_;
  const Eigen::VectorXd& weights_;
  const TermColumns& columns_;
  const Eigen::Index p_;
  const Eigen::Index width_;
  Eigen::MatrixXd dense_;
  Eigen::MatrixXd beside_;
  Eigen::MatrixXd knots_;
  Batch batch_;
  Eigen::Index filled_ = 0;
  std::vector<Touched> touched_;
};

double LogDeterminant(const Eigen::LLT<Eigen::MatrixXd>& factor) {
  return 2.0 * factor.matrixLLT().diagonal().array().log().sum();
}

// Rounding may leave a matrix that is singular to it indefinite.
Eigen::LLT<Eigen::MatrixXd> FactorOf(Eigen::MatrixXd matrix) {
  Eigen::LLT<Eigen::MatrixXd> factor(matrix);
  for (double more = 1e-14; factor.info() != Eigen::Success && more < 1.0;
       more *= 10.0) {
    matrix.diagonal() *= 1.0 + more;
    factor.compute(matrix);
  }
  return factor;
}

}  // namespace

Eigen::MatrixXd TermGram(const WeightedRows& data, const TermColumns& columns,
                         const std::vector<int>& observations) {
  GramSum sum(data, columns);
  for (const int observation : observations) sum.Add(observation);
  return sum.Total();
}

Eigen::VectorXd ApplyTerms(const TermRows& rows, const TermColumns& columns,
                           const Eigen::VectorXd& coefficients,
                           const TermRows::Observation& one) {
  Eigen::VectorXd applied = Eigen::VectorXd::Zero(one.height);
  for (const bool second : {false, true}) {
    const int pose = second ? one.second_pose : one.pose;
    if (pose < 0) continue;
    Eigen::VectorXd sizes = Eigen::VectorXd::Zero(rows.turns.cols());
    columns.ForEachAt(rows.NumbersOf(pose),
                      [&](int column, int turn, double size) {
                        sizes[turn] += size * coefficients[column];
                      });
    applied += TurnsOf(rows, one, second) * sizes;
  }
  return applied;
}

TermRidge::TermRidge(const TermColumns& columns, Eigen::VectorXd deviations,
                     const Eigen::VectorXd& priors)
    : columns_(columns),
      deviations_(std::move(deviations)),
      geometry_precisions_(priors.cwiseAbs2().cwiseInverse()) {
  for (const DenseTerm& term : columns.dense()) {
    ++sizes_[static_cast<int>(term.group)];
  }
  sizes_[static_cast<int>(TermGroup::kFunction)] = columns.num_knots();
  for (const FunctionKnots& knots : columns.functions()) {
    function_precisions_.push_back(columns.Precision(knots));
  }
}

std::vector<TermGroup> TermRidge::Groups() const {
  std::vector<TermGroup> groups;
  for (int k = 0; k < kNumTermGroups; ++k) {
    if (sizes_[k] > 0) groups.push_back(static_cast<TermGroup>(k));
  }
  return groups;
}

void TermRidge::AddDensePrecisions(const LogPrecisions& precisions,
                                   Eigen::MatrixXd* matrix) const {
  const Eigen::Index p = num_geometry();
  matrix->diagonal().head(p) += geometry_precisions_;
  matrix->diagonal().head(p).array() += kLeastPrecision;
  for (int k = 0; k < columns_.num_dense(); ++k) {
    const auto group = static_cast<int>(columns_.dense()[k].group);
    (*matrix)(p + k, p + k) += std::pow(10.0, precisions[group]);
  }
}

void TermRidge::AddFunctionPrecisions(double log_precision, Eigen::Index first,
                                      Eigen::MatrixXd* matrix) const {
  const double scale = std::pow(10.0, log_precision);
  for (std::size_t f = 0; f < function_precisions_.size(); ++f) {
    const FunctionKnots& knots = columns_.functions()[f];
    matrix->block(first + knots.offset, first + knots.offset, knots.count,
                  knots.count) += scale * function_precisions_[f];
  }
}

Eigen::MatrixXd TermRidge::Penalised(const Eigen::MatrixXd& gram,
                                     const LogPrecisions& precisions) const {
  const Eigen::Index p = num_geometry();
  const Eigen::Index size = p + columns_.size();
  Eigen::MatrixXd matrix = gram.topLeftCorner(size, size);
  AddDensePrecisions(precisions, &matrix);
  AddFunctionPrecisions(precisions[static_cast<int>(TermGroup::kFunction)],
                        p + columns_.num_dense(), &matrix);
  return matrix;
}

TermSolution TermRidge::Solve(const Eigen::MatrixXd& gram,
                              const LogPrecisions& precisions) const {
  const Eigen::Index p = num_geometry();
  const Eigen::Index size = p + columns_.size();
  const Eigen::LLT<Eigen::MatrixXd> factor =
      FactorOf(Penalised(gram, precisions));
  TermSolution solution;
  if (factor.info() != Eigen::Success) {
    solution.geometry.setZero(p);
    solution.terms.setZero(columns_.size());
    solution.cost = std::numeric_limits<double>::infinity();
    return solution;
  }
  Eigen::VectorXd gradient = gram.col(size).head(size);
  gradient.head(p) += geometry_precisions_.cwiseProduct(deviations_);
  const Eigen::VectorXd x = factor.solve(-gradient);
  solution.geometry = x.head(p);
  solution.terms = x.tail(columns_.size());
  solution.cost = gram(size, size) +
                  geometry_precisions_.dot(deviations_.cwiseAbs2()) +
                  gradient.dot(x);
  solution.log_determinant = LogDeterminant(factor);
  return solution;
}

Eigen::MatrixXd TermRidge::Covariance(const Eigen::MatrixXd& gram,
                                      const LogPrecisions& precisions) const {
  const Eigen::MatrixXd matrix = Penalised(gram, precisions);
  return FactorOf(matrix).solve(
      Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()));
}

TermRidge::Eliminated TermRidge::Eliminate(const Eigen::MatrixXd& gram,
                                           double log_precision) const {
  const Eigen::Index dense = num_geometry() + columns_.num_dense();
  const Eigen::Index knots = columns_.num_knots();
  const Eigen::Index size = dense + knots;
  Eliminated rest;
  rest.matrix = gram.topLeftCorner(dense, dense);
  rest.gradient = gram.col(size).head(dense);
  rest.gradient.head(num_geometry()) +=
      geometry_precisions_.cwiseProduct(deviations_);
  rest.cost =
      gram(size, size) + geometry_precisions_.dot(deviations_.cwiseAbs2());
  if (knots == 0) return rest;
  Eigen::MatrixXd matrix = gram.block(dense, dense, knots, knots);
  AddFunctionPrecisions(log_precision, 0, &matrix);
  const Eigen::LLT<Eigen::MatrixXd> factor(matrix);
  rest.is_definite = factor.info() == Eigen::Success;
  if (!rest.is_definite) return rest;
  // L^-1 of what the knots have with all others and with the residual.
  Eigen::MatrixXd beside(knots, dense + 1);
  beside << gram.block(dense, 0, knots, dense),
      gram.block(dense, size, knots, 1);
  factor.matrixL().solveInPlace(beside);
  rest.matrix.noalias() -=
      beside.leftCols(dense).transpose() * beside.leftCols(dense);
  rest.gradient.noalias() -=
      beside.leftCols(dense).transpose() * beside.col(dense);
  rest.cost -= beside.col(dense).squaredNorm();
  rest.log_determinant = LogDeterminant(factor);
  return rest;
}

double TermRidge::Criterion(const Eliminated& rest, double freedom,
                            const LogPrecisions& precisions) const {
  Eigen::MatrixXd matrix = rest.matrix;
  AddDensePrecisions(precisions, &matrix);
  const Eigen::LLT<Eigen::MatrixXd> factor(matrix);
  if (!rest.is_definite || factor.info() != Eigen::Success) {
    return std::numeric_limits<double>::infinity();
  }
  const double cost =
      rest.cost - rest.gradient.dot(factor.solve(rest.gradient));
  if (!(cost > 0.0)) return std::numeric_limits<double>::infinity();
  double criterion = freedom * std::log(cost / freedom) + rest.log_determinant +
                     LogDeterminant(factor);
  for (int k = 0; k < kNumTermGroups; ++k) {
    criterion -= std::log(10.0) * sizes_[k] * precisions[k];
  }
  return criterion;
}

ChosenScales TermRidge::Choose(const Eigen::MatrixXd& gram, double equations,
                               const LogPrecisions& start) const {
  constexpr double kLowest = -5.0;
  constexpr double kHighest = 7.0;
  constexpr double kWorthwhile = 1e-3;
  const double freedom = std::max(1.0, equations - num_geometry());
  std::map<double, Eliminated> eliminated;
  const auto criterion_at = [&](const LogPrecisions& at) {
    const double of_functions = at[static_cast<int>(TermGroup::kFunction)];
    auto found = eliminated.find(of_functions);
    if (found == eliminated.end()) {
      found =
          eliminated.emplace(of_functions, Eliminate(gram, of_functions)).first;
    }
    return Criterion(found->second, freedom, at);
  };
  LogPrecisions at = start;
  double best = criterion_at(at);
  for (const double step : {2.0, 1.0, 0.5}) {
    for (bool moved = true; moved;) {
      moved = false;
      for (const TermGroup group : Groups()) {
        for (const double move : {step, -step}) {
          LogPrecisions trial = at;
          double& value = trial[static_cast<int>(group)];
          value += move;
          if (value < kLowest || value > kHighest) continue;
          const double criterion = criterion_at(trial);
          if (!(criterion < best - kWorthwhile)) continue;
          at = trial;
          best = criterion;
          moved = true;
          break;
        }
      }
    }
  }
  for (const Eigen::MatrixXd& precision : function_precisions_) {
    best -= LogDeterminant(FactorOf(precision));
  }
  return {at, best};
}

}  // namespace alidade::internal
