#include "src/dataio/plain_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "src/dataio/orientation_cells.h"

namespace alidade::internal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A matrix keeps its columns `kept`, in their order.
void KeepColumns(const std::vector<Eigen::Index>& kept, MatrixBuilder* matrix) {
  const auto count = static_cast<Eigen::Index>(kept.size());
  MatrixBuilder less(matrix->rows(), count);
  for (Eigen::Index to = 0; to < count; ++to) {
    less.map().col(to) = matrix->map().col(kept[static_cast<std::size_t>(to)]);
  }
  *matrix = std::move(less);
}

template <typename T>
void KeepEntries(const std::vector<Eigen::Index>& kept, std::vector<T>* list) {
  if (list->empty()) return;
  for (std::size_t to = 0; to < kept.size(); ++to) {
    const auto from = static_cast<std::size_t>(kept[to]);
    if (from != to) (*list)[to] = std::move((*list)[from]);
  }
  list->resize(kept.size());
}

}  // namespace

PlainRows::PlainRows(const PlainLayout& layout, Eigen::Index size)
    : layout_(layout),
      rows_each_(RowsOf(layout.kind())),
      motors_(layout.num_joints(), size),
      measured_(rows_each_, size),
      targets_(layout.has_target || layout.target != 0 ? size : 0,
               layout.target),
      sets_(layout.has_set ? size : 0) {
  if (layout.states_sigmas) sigmas_.emplace(rows_each_, size);
}

// The sigmas of a row. As long as all rows have the same, there is one column
// of them.
double* PlainRows::SigmasOf(Eigen::Index i) {
  std::call_once(has_own_sigmas_, [this] {
    if (sigmas_) return;
    sigmas_.emplace(layout_.DefaultSigmas().replicate(1, motors_.cols()));
  });
  return sigmas_->map().col(i).data();
}

PlainRows::State PlainRows::Set(Eigen::Index i, const double* row) {
  // A call of memmove for a handful of numbers takes longer than the loop.
  double* const motors = motors_.map().col(i).data();
  for (int j = 0; j < layout_.num_joints(); ++j) motors[j] = row[j];
  double* const measured = measured_.map().col(i).data();
  const double* const position = row + layout_.slots.position;
  const double* const sigma = row + layout_.slots.position_sigma;
  int count = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const bool is_measured = !std::isnan(position[axis]);
    measured[axis] = is_measured ? position[axis] : 0.0;
    if (is_measured && std::isnan(sigma[axis])) return State::kSuspect;
    count += is_measured ? 1 : 0;
  }
  if (layout_.states_sigmas || count < 3) {
    double* const sigmas = SigmasOf(i);
    for (int axis = 0; axis < 3; ++axis) {
      sigmas[axis] = std::isnan(position[axis]) ? kInfinity : sigma[axis];
    }
  }
  if (layout_.orientation != PlainOrientation::kNone) {
    return SetOrientation(i, row) ? State::kKept : State::kSuspect;
  }
  return count > 0 ? State::kKept : State::kNothing;
}

// False where it was not measured (the row is none of a pose then), or is none.
bool PlainRows::SetOrientation(Eigen::Index i, const double* row) {
  const double* const numbers = row + layout_.slots.orientation;
  const double* const sigma = row + layout_.slots.turn_sigma;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::isnan(sigma[axis])) return false;
    if (layout_.states_sigmas) SigmasOf(i)[3 + axis] = sigma[axis];
  }
  Eigen::Matrix3d rotation;
  if (layout_.orientation == PlainOrientation::kQuaternion) {
    const auto read =
        RotationOfQuaternion(Eigen::Map<const Eigen::Vector4d>(numbers));
    if (!read) return false;
    rotation = *read;
  } else {
    const Eigen::Vector3d three = Eigen::Map<const Eigen::Vector3d>(numbers);
    if (three.hasNaN()) return false;
    rotation = layout_.orientation == PlainOrientation::kVector
                   ? RotationOfVector(three)
                   : RotationOf(*layout_.convention, three);
  }
  measured_.map().col(i).tail<3>() = MeasuredVector(rotation);
  return true;
}

void PlainRows::Drop(const std::vector<Eigen::Index>& rows) {
  std::vector<Eigen::Index> kept;
  auto next = rows.begin();
  for (Eigen::Index i = 0; i < motors_.cols(); ++i) {
    if (next != rows.end() && *next == i) {
      ++next;
    } else {
      kept.push_back(i);
    }
  }
  KeepColumns(kept, &motors_);
  KeepColumns(kept, &measured_);
  if (sigmas_) KeepColumns(kept, &*sigmas_);
  KeepEntries(kept, &targets_);
  KeepEntries(kept, &sets_);
  PoseSources sources;
  for (const Eigen::Index i : kept) sources.push_back({0, LineOf(i)});
  sources_ = std::move(sources);
}

LoadedData PlainRows::Finish(const std::string& path, const Arm& arm,
                             const std::vector<Eigen::Index>& nothing) {
  LoadedData loaded;
  for (const Eigen::Index i : nothing) {
    loaded.rejected.push_back({path, LineOf(i), kNothingMeasured});
  }
  if (lines_.empty()) {
    sources_.Append({0, 1}, static_cast<std::size_t>(motors_.cols()));
  } else {
    for (const int line : lines_) sources_.push_back({0, line});
  }
  if (!nothing.empty()) Drop(nothing);
  Dataset& data = loaded.data;
  data.name = path;
  data.files = {path};
  data.sources = std::move(sources_);
  data.joint_values = JointsFromMotors(arm, motors_.Freeze());
  ObservationBlock block;
  block.kind = layout_.kind();
  block.measured = measured_.Freeze();
  block.sigmas =
      sigmas_ ? sigmas_->Freeze()
              : SharedMatrix::Repeated(layout_.DefaultSigmas(), block.size());
  const auto is_other = [](int target) { return target != 0; };
  if (std::any_of(targets_.begin(), targets_.end(), is_other)) {
    block.targets = std::move(targets_);
  }
  data.blocks.push_back(std::move(block));
  loaded.sets = std::move(sets_);
  return loaded;
}

}  // namespace alidade::internal
