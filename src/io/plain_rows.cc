#include "src/io/plain_rows.h"

#include <sys/mman.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "src/io/orientation_cells.h"

namespace alidade {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Asks for large pages below a large matrix that nothing was written to yet.
// With small ones, most of the time of filling it is the system's, which
// provides and clears one page after the other. Only a hint.
void AskForLargePages(const Eigen::MatrixXd& matrix) {
#ifdef MADV_HUGEPAGE
  constexpr std::uintptr_t kPage = 1 << 21;
  const auto begin = reinterpret_cast<std::uintptr_t>(matrix.data());
  const std::uintptr_t end =
      begin + sizeof(double) * static_cast<std::uintptr_t>(matrix.size());
  const std::uintptr_t first = (begin + kPage - 1) / kPage * kPage;
  if (first + kPage > end) return;
  (void)madvise(reinterpret_cast<void*>(first), (end - first) / kPage * kPage,
                MADV_HUGEPAGE);
#else
  (void)matrix;
#endif
}

// A matrix keeps its columns `kept`, in their order.
void KeepColumns(const std::vector<Eigen::Index>& kept,
                 Eigen::MatrixXd* matrix) {
  for (std::size_t to = 0; to < kept.size(); ++to) {
    matrix->col(static_cast<Eigen::Index>(to)) = matrix->col(kept[to]);
  }
  matrix->conservativeResize(Eigen::NoChange,
                             static_cast<Eigen::Index>(kept.size()));
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
      motors_(layout.num_joints(), size),
      measured_(RowsOf(layout.kind()), size),
      sigmas_(RowsOf(layout.kind()), size),
      targets_(layout.has_target || layout.target != 0 ? size : 0,
               layout.target),
      sets_(layout.has_set ? size : 0),
      sources_(static_cast<std::size_t>(size)) {
  for (const Eigen::MatrixXd* matrix : {&motors_, &measured_, &sigmas_}) {
    AskForLargePages(*matrix);
  }
}

PlainRows::State PlainRows::Set(Eigen::Index i, const double* row) {
  // A call of memmove for a handful of numbers takes longer than the loop.
  double* const motors = &motors_(0, i);
  for (int j = 0; j < layout_.num_joints(); ++j) motors[j] = row[j];
  const double* const position = row + layout_.slots.position;
  const double* const sigma = row + layout_.slots.position_sigma;
  int count = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const bool is_measured = !std::isnan(position[axis]);
    measured_(axis, i) = is_measured ? position[axis] : 0.0;
    sigmas_(axis, i) = is_measured ? sigma[axis] : kInfinity;
    if (is_measured && std::isnan(sigma[axis])) return State::kDoubtful;
    count += is_measured ? 1 : 0;
  }
  if (layout_.orientation != PlainOrientation::kNone) {
    return SetOrientation(i, row) ? State::kKept : State::kDoubtful;
  }
  return count > 0 ? State::kKept : State::kNothing;
}

// False where it was not measured (the row is none of a pose then), or is none.
bool PlainRows::SetOrientation(Eigen::Index i, const double* row) {
  const double* const numbers = row + layout_.slots.orientation;
  const double* const sigma = row + layout_.slots.turn_sigma;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::isnan(sigma[axis])) return false;
    sigmas_(3 + axis, i) = sigma[axis];
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
  measured_.col(i).tail<3>() = MeasuredVector(rotation);
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
  KeepColumns(kept, &sigmas_);
  KeepEntries(kept, &targets_);
  KeepEntries(kept, &sets_);
  KeepEntries(kept, &sources_);
}

LoadedData PlainRows::Finish(const std::string& path, const Arm& arm,
                             const std::vector<Eigen::Index>& nothing) {
  LoadedData loaded;
  for (const Eigen::Index i : nothing) {
    loaded.rejected.push_back({path, sources_[i].line, kNothingMeasured});
  }
  if (!nothing.empty()) Drop(nothing);
  const bool is_mapped =
      arm.joints_from_motors.size() > 0 || arm.motor_offsets.size() > 0;
  Dataset& data = loaded.data;
  data.name = path;
  data.files = {path};
  data.sources = std::move(sources_);
  data.joint_values =
      is_mapped ? JointsFromMotors(arm, motors_) : std::move(motors_);
  ObservationBlock block;
  block.kind = layout_.kind();
  block.measured = std::move(measured_);
  block.sigmas = std::move(sigmas_);
  const auto is_other = [](int target) { return target != 0; };
  if (std::any_of(targets_.begin(), targets_.end(), is_other)) {
    block.targets = std::move(targets_);
  }
  data.blocks.push_back(std::move(block));
  loaded.sets = std::move(sets_);
  return loaded;
}

}  // namespace alidade
