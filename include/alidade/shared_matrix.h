#ifndef ALIDADE_SHARED_MATRIX_H_
#define ALIDADE_SHARED_MATRIX_H_

#include <Eigen/Core>
#include <memory>
#include <utility>

namespace alidade {

/// An immutable matrix (or vector) with a column (an entry) for each pose or
/// observation, which may be larger than the memory. Copies share their
/// numbers, which are those of an Eigen matrix that was moved here, of a
/// MatrixBuilder, or of somebody else, such as a mapped file. To change
/// numbers, make a new matrix of them.
///
/// Eigen sees it by map() and as Eigen::Ref<const Plain>. Both are valid as
/// long as some copy of the shared matrix is.
template <typename Plain>
class BasicSharedMatrix {
 public:
  using Index = Eigen::Index;
  using Map = Eigen::Map<const Plain, Eigen::Unaligned, Eigen::OuterStride<>>;

  BasicSharedMatrix() = default;
  /// Takes over the numbers of a matrix that is moved here.
  BasicSharedMatrix(Plain matrix) {  // NOLINT: it is a value of the same kind
    const auto own = std::make_shared<const Plain>(std::move(matrix));
    *this = {{own, own->data()}, own->rows(), own->cols(), own->rows()};
  }
  /// Copies the numbers of an expression, as MatrixBuilder does.
  template <typename Derived>
  BasicSharedMatrix(  // NOLINT: as Eigen's
      const Eigen::MatrixBase<Derived>& numbers);
  /// Others' numbers, column c from `first` + c * stride on. They must not
  /// change.
  BasicSharedMatrix(std::shared_ptr<const double> first, Index rows, Index cols,
                    Index stride)
      : first_(std::move(first)), rows_(rows), cols_(cols), stride_(stride) {}

  Index rows() const { return rows_; }
  Index cols() const { return cols_; }
  Index size() const { return rows_ * cols_; }
  /// From a column to the next.
  Index stride() const { return stride_; }
  const double* data() const { return first_.get(); }

  Map map() const {
    return Map(data(), rows_, cols_, Eigen::OuterStride<>(stride_));
  }
  operator Eigen::Ref<const Plain>() const {  // NOLINT: it copies nothing
    return map();
  }
  auto col(Index i) const { return map().col(i); }
  auto row(Index i) const { return map().row(i); }
  double operator()(Index row, Index col) const {
    return data()[row + col * stride_];
  }
  /// Of a vector.
  double operator[](Index i) const { return data()[i]; }

  friend bool operator==(const BasicSharedMatrix& a,
                         const BasicSharedMatrix& b) {
    return a.rows_ == b.rows_ && a.cols_ == b.cols_ && a.map() == b.map();
  }
  friend bool operator!=(const BasicSharedMatrix& a,
                         const BasicSharedMatrix& b) {
    return !(a == b);
  }

  /// `count` times the same column, which takes next to no memory.
  static BasicSharedMatrix Repeated(const Eigen::VectorXd& column, Index count);

  /// The same numbers in the same order as columns of `rows` each.
  /// @pre columns are stored one after the other; rows divides their size.
  BasicSharedMatrix<Eigen::MatrixXd> Reshaped(Index rows) const {
    return {first_, rows, size() / rows, rows};
  }
  /// Columns [begin, begin + count), which share their numbers with these.
  BasicSharedMatrix Columns(Index begin, Index count) const {
    return {{first_, data() + begin * stride_}, rows_, count, stride_};
  }

 private:
  std::shared_ptr<const double> first_;
  Index rows_ = 0;
  Index cols_ = Plain::IsVectorAtCompileTime ? 1 : 0;
  Index stride_ = 0;
};

/// Numbers of a shared matrix to be, while they are written. They are stored in
/// memory or, beyond the limit that the program was given (docs/large_data.md),
/// in a temporary file. @throws InputError where that has no room.
template <typename Plain>
class BasicMatrixBuilder {
 public:
  using Index = Eigen::Index;
  using Map = Eigen::Map<Plain>;

  /// The numbers are anything.
  explicit BasicMatrixBuilder(Index rows, Index cols = 1);
  /// A copy, to be changed.
  template <typename Derived>
  explicit BasicMatrixBuilder(const Eigen::MatrixBase<Derived>& numbers)
      : BasicMatrixBuilder(numbers.rows(), numbers.cols()) {
    map() = numbers;
  }
  explicit BasicMatrixBuilder(const BasicSharedMatrix<Plain>& numbers)
      : BasicMatrixBuilder(numbers.map()) {}

  Index rows() const { return rows_; }
  Index cols() const { return cols_; }
  Map map() { return Map(first_.get(), rows_, cols_); }

  /// The matrix. Leaves the builder without numbers.
  BasicSharedMatrix<Plain> Freeze() {
    return {std::shared_ptr<const double>(std::move(first_)), rows_, cols_,
            rows_};
  }

 private:
  std::shared_ptr<double> first_;
  Index rows_;
  Index cols_;
};

using SharedMatrix = BasicSharedMatrix<Eigen::MatrixXd>;
using SharedVector = BasicSharedMatrix<Eigen::VectorXd>;
using MatrixBuilder = BasicMatrixBuilder<Eigen::MatrixXd>;
using VectorBuilder = BasicMatrixBuilder<Eigen::VectorXd>;

template <typename Plain>
template <typename Derived>
BasicSharedMatrix<Plain>::BasicSharedMatrix(
    const Eigen::MatrixBase<Derived>& numbers)
    : BasicSharedMatrix(BasicMatrixBuilder<Plain>(numbers).Freeze()) {}

}  // namespace alidade

#endif  // ALIDADE_SHARED_MATRIX_H_
