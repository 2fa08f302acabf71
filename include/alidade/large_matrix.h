#ifndef ALIDADE_LARGE_MATRIX_H_
#define ALIDADE_LARGE_MATRIX_H_

#include <Eigen/Core>
#include <atomic>
#include <cstddef>
#include <memory>
#include <new>
#include <utility>

#include "alidade/memory.h"

namespace alidade {

/// A matrix (or a vector) with a column (an entry) for each pose or
/// observation, which may be larger than the memory. To Eigen it is a Map of
/// constant numbers, and all that takes an expression or a Ref takes it. Its
/// owner sees a value: copies share their numbers until one of them is edited.
/// Numbers lie in memory from AllocateLarge (memory.h), in a matrix that was
/// moved here, or in somebody else's, such as a mapped file.
template <typename Plain>
class Large
    : public Eigen::Map<const Plain, Eigen::Unaligned, Eigen::OuterStride<>> {
 public:
  using Base = Eigen::Map<const Plain, Eigen::Unaligned, Eigen::OuterStride<>>;
  using Editable = Eigen::Map<Plain>;
  using Index = Eigen::Index;
  static constexpr bool kIsVector = Plain::ColsAtCompileTime == 1;

  Large() : Base(nullptr, 0, kIsVector ? 1 : 0, Eigen::OuterStride<>(0)) {}
  /// The numbers are anything.
  Large(Index rows, Index cols) : Large() { resize(rows, cols); }
  explicit Large(Index size) : Large(size, 1) {
    static_assert(kIsVector, "a matrix has rows and columns");
  }
  /// Takes over the numbers of a matrix that is moved here.
  Large(Plain matrix) : Large() {  // NOLINT: it is a value of the same kind
    const auto own = std::make_shared<Plain>(std::move(matrix));
    Own({own, own->data()}, own->rows(), own->cols());
  }
  template <typename Derived>
  Large(const Eigen::MatrixBase<Derived>& numbers)  // NOLINT: as Eigen's
      : Large(numbers.rows(), numbers.cols()) {
    edit() = numbers;
  }
  /// Others' numbers, column c from `first` + c * stride on. They must not
  /// change.
  Large(std::shared_ptr<const double> first, Index rows, Index cols,
        Index stride)
      : Large() {
    Point(std::move(first), rows, cols, stride);
  }
  Large(const Large& other) : Large() { Share(other); }
  Large(Large&& other) noexcept : Large() { Swap(&other); }
  ~Large() = default;

  Large& operator=(const Large& other) {
    if (this != &other) Share(other);
    return *this;
  }
  Large& operator=(Large&& other) noexcept {
    Large taken(std::move(other));
    Swap(&taken);  // so that what was here is freed
    return *this;
  }
  Large& operator=(Plain matrix) {
    Large taken(std::move(matrix));
    Swap(&taken);
    return *this;
  }
  template <typename Derived>
  Large& operator=(const Eigen::MatrixBase<Derived>& numbers) {
    Large taken(numbers);  // which may read from this
    Swap(&taken);
    return *this;
  }

  /// The numbers, to be changed: first they become this object's own, which
  /// takes a copy where they are shared. Valid until the object is assigned to,
  /// resized or copied.
  Editable edit() {
    const bool is_shared = !is_own_ || first_.use_count() > 1;
    // What others read before they let go of it comes before what is written.
    std::atomic_thread_fence(std::memory_order_acquire);
    if (is_shared && this->size() > 0) {
      const std::shared_ptr<double> own = AllocateLarge(Count());
      Editable(own.get(), this->rows(), this->cols()) = *this;
      Own(own, this->rows(), this->cols());
    }
    return Editable(const_cast<double*>(this->data()), this->rows(),
                    this->cols());
  }

  /// As Eigen's: numbers are lost where the size changes.
  void resize(Index rows, Index cols) {
    if (rows == this->rows() && cols == this->cols()) return;
    Own(AllocateLarge(static_cast<std::size_t>(rows * cols)), rows, cols);
  }
  void resize(Index size) {
    static_assert(kIsVector, "a matrix has rows and columns");
    resize(size, 1);
  }

  /// A plain matrix of large size is made where it is asked for: .eval().
  operator Plain() const = delete;  // NOLINT: what is not to happen unseen

  /// `count` times the same column, which takes next to no memory.
  static Large Repeated(const Eigen::VectorXd& column, Index count) {
    const auto rows = static_cast<std::size_t>(column.size());
    return Large(
        RepeatLarge(column.data(), rows, static_cast<std::size_t>(count)),
        column.size(), count, column.size());
  }

  /// The same numbers in the same order as columns of `rows` each.
  /// @pre columns lie one behind the other; rows divides their size.
  Large<Eigen::MatrixXd> Reshaped(Index rows) const {
    return Large<Eigen::MatrixXd>(first_, rows, this->size() / rows, rows);
  }

  /// Columns [begin, begin + count), which share their numbers with these.
  Large SharedColumns(Index begin, Index count) const {
    return Large(std::shared_ptr<const double>(
                     first_, first_.get() + begin * this->outerStride()),
                 this->rows(), count, this->outerStride());
  }

 private:
  std::size_t Count() const { return static_cast<std::size_t>(this->size()); }
  void Point(std::shared_ptr<const double> first, Index rows, Index cols,
             Index stride) {
    first_ = std::move(first);
    is_own_ = false;
    // What Eigen documents for maps that are to look elsewhere.
    new (static_cast<Base*>(this))
        Base(first_.get(), rows, cols, Eigen::OuterStride<>(stride));
  }
  void Own(const std::shared_ptr<double>& first, Index rows, Index cols) {
    Point(first, rows, cols, rows);
    is_own_ = true;
  }
  void Share(const Large& other) {
    Point(other.first_, other.rows(), other.cols(), other.outerStride());
    is_own_ = other.is_own_;
  }
  void Swap(Large* other) {
    const Large mine = *this;
    Share(*other);
    other->Share(mine);
  }

  std::shared_ptr<const double> first_;
  bool is_own_ = false;  // not of others who count on its numbers
};

using LargeMatrix = Large<Eigen::MatrixXd>;
using LargeVector = Large<Eigen::VectorXd>;

}  // namespace alidade

#endif  // ALIDADE_LARGE_MATRIX_H_
