#include "src/dataio/observation_table.h"

#include <algorithm>
#include <utility>

namespace alidade::internal {
namespace {

template <typename T>
std::vector<T> KeepEntries(const KeptColumns& kept, std::vector<T>* list) {
  if (!kept || list->empty()) return std::move(*list);
  std::vector<T> entries;
  entries.reserve(kept->size());
  for (const Eigen::Index i : *kept) entries.push_back(std::move((*list)[i]));
  return entries;
}

template <typename List, typename Condition>
bool AllOf(const List& list, const Condition& condition) {
  return std::all_of(list.begin(), list.end(), condition);
}

}  // namespace

SharedMatrix KeepColumns(const KeptColumns& kept, Eigen::Index rows,
                         MatrixBuilder* matrix) {
  if (!kept && rows == matrix->rows()) return matrix->Freeze();
  if (!kept) return matrix->map().topRows(rows);
  MatrixBuilder less(rows, static_cast<Eigen::Index>(kept->size()));
  for (Eigen::Index to = 0; to < less.cols(); ++to) {
    less.map().col(to) = matrix->map().col((*kept)[to]).head(rows);
  }
  return less.Freeze();
}

ObservationTable::ObservationTable(const Shape& shape)
    : shape_(shape),
      measured_(RowsOf(shape.kind), shape.num_rows * shape.per_row),
      state_(measured_.cols(), kNothing),
      targets_(shape.states_targets ? measured_.cols() : 0),
      whiteners_(shape.has_whiteners ? measured_.cols() : 0) {
  if (shape_.states_sigmas) sigmas_.emplace(measured_.rows(), measured_.cols());
}

// As long as all observations have the same sigmas, there is one column.
double* ObservationTable::SigmasOf(Index i) {
  std::call_once(has_own_sigmas_, [this] {
    if (sigmas_) return;
    sigmas_.emplace(shape_.default_sigmas.replicate(1, measured_.cols()));
  });
  return sigmas_->map().col(i).data();
}

void ObservationTable::Set(Index i, MeasurementKind kind,
                           const StatedObservation& stated) {
  // A call of memmove for a handful of numbers takes longer than the loop.
  const Index rows = measured_.rows();
  double* const measured = measured_.map().col(i).data();
  for (Index row = 0; row < rows; ++row) measured[row] = stated.measured[row];
  const double* const sigmas = shape_.default_sigmas.data();
  if (shape_.states_sigmas ||
      !std::equal(sigmas, sigmas + RowsOf(kind), stated.sigmas.data())) {
    double* const own = SigmasOf(i);
    for (Index row = 0; row < rows; ++row) own[row] = stated.sigmas[row];
  }
  state_[i] = StateOf(kind);
  if (!targets_.empty()) targets_[i] = stated.target;
  if (!whiteners_.empty()) whiteners_[i] = stated.whitener;
}

bool ObservationTable::IsRowMeasured(Index row) const {
  const auto first = state_.begin() + row * shape_.per_row;
  return std::any_of(first, first + shape_.per_row,
                     [](State state) { return state != kNothing; });
}

std::optional<Eigen::Index> ObservationTable::FirstRow(
    MeasurementKind kind) const {
  const auto found = std::find(state_.begin(), state_.end(), StateOf(kind));
  if (found == state_.end()) return std::nullopt;
  return (found - state_.begin()) / shape_.per_row;
}

ObservationBlock ObservationTable::Take(MeasurementKind kind,
                                        const RowNumbers& numbers,
                                        Index num_poses) {
  KeptColumns kept;
  const State wanted = StateOf(kind);
  if (!AllOf(state_, [=](State state) { return state == wanted; })) {
    kept.emplace();
    for (Index i = 0; i < measured_.cols(); ++i) {
      if (state_[i] == wanted) kept->push_back(i);
    }
  }
  const Index rows = RowsOf(kind);
  ObservationBlock block;
  block.kind = kind;
  block.measured = KeepColumns(kept, rows, &measured_);
  block.sigmas = sigmas_ ? KeepColumns(kept, rows, &*sigmas_)
                         : SharedMatrix::Repeated(
                               shape_.default_sigmas.head(rows), block.size());
  const bool is_trivial = !kept && shape_.per_row == 1;
  for (Index k = 0; k < block.size(); ++k) {
    const Index row = (kept ? (*kept)[k] : k) / shape_.per_row;
    if (!numbers.poses.empty()) {
      block.poses.push_back(numbers.poses[row]);
    } else if (!is_trivial) {
      block.poses.push_back(static_cast<int>(row));
    }
    if (!numbers.references.empty()) {
      block.references.push_back(numbers.references[row]);
    }
    if (!numbers.seconds.empty()) block.seconds.push_back(numbers.seconds[row]);
  }
  DropTrivialPoses(num_poses, &block);
  block.targets = KeepEntries(kept, &targets_);
  if (AllOf(block.targets, [](int target) { return target == 0; })) {
    block.targets.clear();
  }
  block.whiteners = KeepEntries(kept, &whiteners_);
  if (AllOf(block.whiteners, [](const auto& one) { return one.size() == 0; })) {
    block.whiteners.clear();
  }
  return block;
}

}  // namespace alidade::internal
