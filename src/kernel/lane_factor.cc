#include "src/kernel/kernel_targets.h"
//
#include <algorithm>
#include <limits>

#include "src/kernel/lane_factor.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/kernel/lane_factor.cc"
#include <hwy/foreach_target.h>
//
#include "src/kernel/vectors-inl.h"

#ifndef ALIDADE_SRC_MEASUREMENT_LANE_FACTOR_CC_ONCE
#define ALIDADE_SRC_MEASUREMENT_LANE_FACTOR_CC_ONCE
namespace alidade::internal::kernel {
namespace {

// Where row k of an upper triangle begins, in entries, less k: entry (k, j) is
// at RowStart + j.
inline std::size_t RowStart(int columns, int k) {
  return static_cast<std::size_t>(k) * columns -
         static_cast<std::size_t>(k) * (k + 1) / 2;
}

}  // namespace
}  // namespace alidade::internal::kernel
#endif

HWY_BEFORE_NAMESPACE();
namespace alidade::internal::kernel::HWY_NAMESPACE {
namespace {

std::size_t LanesOfTarget() { return hn::Lanes(kTag); }

std::int64_t TargetOfBuild() { return HWY_TARGET; }

// H = I - w v v^T with v = (1, scale x) takes (alpha, x) to (beta, 0).
struct Reflector {
  V scale;
  V weight;
};

// Sums that do not wait for one another.
constexpr std::size_t kChains = 4;

// x . y of `rows` vectors.
HWY_INLINE V Product(const double* x, const double* y, std::size_t rows) {
  const std::size_t lanes = hn::Lanes(kTag);
  const std::size_t step = kChains * lanes;
  const std::size_t end = rows * lanes;
  V sum0 = hn::Zero(kTag);
  V sum1 = sum0;
  V sum2 = sum0;
  V sum3 = sum0;
  std::size_t i = 0;
  for (; i + step <= end; i += step) {
    const double* const a = x + i;
    const double* const b = y + i;
    sum0 = hn::MulAdd(hn::Load(kTag, a), hn::Load(kTag, b), sum0);
    sum1 =
        hn::MulAdd(hn::Load(kTag, a + lanes), hn::Load(kTag, b + lanes), sum1);
    sum2 = hn::MulAdd(hn::Load(kTag, a + 2 * lanes),
                      hn::Load(kTag, b + 2 * lanes), sum2);
    sum3 = hn::MulAdd(hn::Load(kTag, a + 3 * lanes),
                      hn::Load(kTag, b + 3 * lanes), sum3);
  }
  for (; i < end; i += lanes) {
    sum0 = hn::MulAdd(hn::Load(kTag, x + i), hn::Load(kTag, y + i), sum0);
  }
  return hn::Add(hn::Add(sum0, sum1), hn::Add(sum2, sum3));
}

// Makes the reflector that clears x, whose sum of squares is given, below
// *diagonal; none where x is zero, or so small that its square has lost digits.
HWY_INLINE Reflector MakeReflector(V squares, double* diagonal) {
  const V alpha = hn::Load(kTag, diagonal);
  const V norm = hn::Sqrt(hn::MulAdd(alpha, alpha, squares));
  const V beta = hn::Neg(hn::CopySign(norm, alpha));
  const V first = hn::Sub(alpha, beta);
  const auto is_zero =
      hn::Lt(squares, hn::Set(kTag, std::numeric_limits<double>::min()));
  const V one = hn::Set(kTag, 1.0);
  const V safe_first = hn::IfThenElse(is_zero, one, first);
  const V safe_beta = hn::IfThenElse(is_zero, one, beta);
  Reflector reflector;
  reflector.scale = hn::IfThenZeroElse(is_zero, hn::Div(one, safe_first));
  reflector.weight =
      hn::IfThenZeroElse(is_zero, hn::Neg(hn::Div(first, safe_beta)));
  hn::Store(hn::IfThenElse(is_zero, alpha, beta), kTag, diagonal);
  return reflector;
}

// Applies one reflector to one column; `top` is its entry in the triangle.
// Returns the sum of squares that the column then has.
HWY_INLINE V ApplyOne(const Reflector& reflector, const double* x,
                      std::size_t rows, double* top, double* column) {
  const std::size_t lanes = hn::Lanes(kTag);
  const V dot = Product(x, column, rows);
  const V head = hn::Load(kTag, top);
  const V w = hn::Mul(reflector.weight, hn::MulAdd(reflector.scale, dot, head));
  hn::Store(hn::Sub(head, w), kTag, top);
  const V factor = hn::Mul(reflector.scale, w);
  for (std::size_t i = 0; i < rows * lanes; i += lanes) {
    hn::Store(hn::NegMulAdd(hn::Load(kTag, x + i), factor,
                            hn::Load(kTag, column + i)),
              kTag, column + i);
  }
  return Product(column, column, rows);
}

// A matrix and the triangle above it.
struct Stack {
  int columns;
  std::size_t rows;    // of the matrix
  std::size_t stride;  // from column to column
  double* matrix;
  double* triangle;

  // Row k of the triangle; entry j is at j vectors from there.
  double* TriangleRow(int k) const {
    return triangle + RowStart(columns, k) * hn::Lanes(kTag);
  }
  double* Column(int k) const { return matrix + k * stride; }
};

// Two reflectors, the second made of x2 after the first had been applied to
// it, and the product x1 . x2.
struct Pair {
  Reflector first;
  Reflector second;
  V product;
  const double* x1;
  const double* x2;
  std::size_t rows;
};

// Applies both to kCount columns in one pass. `top1` and `top2` are the
// columns' entries in the two rows of the triangle.
template <int kCount>
HWY_INLINE void ApplyPair(const Pair& pair, std::size_t stride, double* top1,
                          double* top2, double* columns) {
  const std::size_t lanes = hn::Lanes(kTag);
  V dots1[kCount];
  V dots2[kCount];
  for (int c = 0; c < kCount; ++c) dots1[c] = dots2[c] = hn::Zero(kTag);
  for (std::size_t i = 0; i < pair.rows * lanes; i += lanes) {
    const V x1 = hn::Load(kTag, pair.x1 + i);
    const V x2 = hn::Load(kTag, pair.x2 + i);
    for (int c = 0; c < kCount; ++c) {
      const V a = hn::Load(kTag, columns + c * stride + i);
      dots1[c] = hn::MulAdd(x1, a, dots1[c]);
      dots2[c] = hn::MulAdd(x2, a, dots2[c]);
    }
  }
  V factors1[kCount];
  V factors2[kCount];
  for (int c = 0; c < kCount; ++c) {
    const V head1 = hn::Load(kTag, top1 + c * lanes);
    const V w1 = hn::Mul(pair.first.weight,
                         hn::MulAdd(pair.first.scale, dots1[c], head1));
    hn::Store(hn::Sub(head1, w1), kTag, top1 + c * lanes);
    factors1[c] = hn::Mul(pair.first.scale, w1);
    // x2 . (a - x1 factor1)
    const V dot2 = hn::NegMulAdd(pair.product, factors1[c], dots2[c]);
    const V head2 = hn::Load(kTag, top2 + c * lanes);
    const V w2 =
        hn::Mul(pair.second.weight, hn::MulAdd(pair.second.scale, dot2, head2));
    hn::Store(hn::Sub(head2, w2), kTag, top2 + c * lanes);
    factors2[c] = hn::Mul(pair.second.scale, w2);
  }
  for (std::size_t i = 0; i < pair.rows * lanes; i += lanes) {
    const V x1 = hn::Load(kTag, pair.x1 + i);
    const V x2 = hn::Load(kTag, pair.x2 + i);
    for (int c = 0; c < kCount; ++c) {
      double* const a = columns + c * stride + i;
      hn::Store(
          hn::NegMulAdd(x2, factors2[c],
                        hn::NegMulAdd(x1, factors1[c], hn::Load(kTag, a))),
          kTag, a);
    }
  }
}

// Clears columns k and k + 1, which exist, and returns what did it.
HWY_INLINE Pair ClearTwo(const Stack& stack, int k, std::size_t rows) {
  const std::size_t lanes = hn::Lanes(kTag);
  double* const x1 = stack.Column(k);
  double* const x2 = stack.Column(k + 1);
  Pair pair;
  pair.rows = rows;
  pair.x1 = x1;
  pair.x2 = x2;
  double* const row = stack.TriangleRow(k);
  pair.first = MakeReflector(Product(x1, x1, rows), row + k * lanes);
  const V squares = ApplyOne(pair.first, x1, rows, row + (k + 1) * lanes, x2);
  pair.second =
      MakeReflector(squares, stack.TriangleRow(k + 1) + (k + 1) * lanes);
  pair.product = Product(x1, x2, rows);
  return pair;
}

// Applies the pair of columns k and k + 1 to all columns behind them.
HWY_INLINE void ApplyBehind(const Stack& stack, int k, const Pair& pair) {
  const std::size_t lanes = hn::Lanes(kTag);
  double* top1 = stack.TriangleRow(k) + (k + 2) * lanes;
  double* top2 = stack.TriangleRow(k + 1) + (k + 2) * lanes;
  int j = k + 2;
  for (; j + 4 <= stack.columns; j += 4) {
    ApplyPair<4>(pair, stack.stride, top1, top2, stack.Column(j));
    top1 += 4 * lanes;
    top2 += 4 * lanes;
  }
  double* const rest = stack.Column(j);
  switch (stack.columns - j) {
    case 3:
      return ApplyPair<3>(pair, stack.stride, top1, top2, rest);
    case 2:
      return ApplyPair<2>(pair, stack.stride, top1, top2, rest);
    case 1:
      return ApplyPair<1>(pair, stack.stride, top1, top2, rest);
    default:
      return;
  }
}

// `is_triangle`: the matrix is an upper triangle, so that column k has k + 1
// rows.
HWY_INLINE void Factor(const Stack& stack, bool is_triangle) {
  for (int k = 0; k < stack.columns; k += 2) {
    const std::size_t height =
        is_triangle ? std::min(stack.rows, static_cast<std::size_t>(k) + 2)
                    : stack.rows;
    if (k + 1 == stack.columns) {
      const double* const x = stack.Column(k);
      MakeReflector(Product(x, x, height),
                    stack.TriangleRow(k) + k * hn::Lanes(kTag));
      return;
    }
    ApplyBehind(stack, k, ClearTwo(stack, k, height));
  }
}

void AddRows(int columns, int rows, std::size_t stride, double* matrix,
             double* triangle) {
  Factor({columns, static_cast<std::size_t>(rows), stride, matrix, triangle},
         false);
}

// The triangle `other`, its lanes moved down by `shift`, as a matrix in `work`.
HWY_INLINE void Unpack(int columns, const double* other, std::size_t shift,
                       double* work) {
  const std::size_t lanes = hn::Lanes(kTag);
  const auto kept = hn::FirstN(kTag, lanes - shift);
  const std::size_t stride = static_cast<std::size_t>(columns) * lanes;
  for (int j = 0; j < columns; ++j) {
    double* const column = work + j * stride;
    for (int i = 0; i <= j; ++i) {
      const double* const from =
          other + (RowStart(columns, i) + j) * lanes + shift;
      hn::Store(hn::IfThenElseZero(kept, hn::LoadU(kTag, from)), kTag,
                column + i * lanes);
    }
    if (j + 1 < columns) {
      hn::Store(hn::Zero(kTag), kTag, column + (j + 1) * lanes);
    }
  }
}

// What Unpack left in `work`, and a triangle above it.
HWY_INLINE Stack PackedStack(int columns, double* work, double* triangle) {
  const auto rows = static_cast<std::size_t>(columns);
  return {columns, rows, rows * hn::Lanes(kTag), work, triangle};
}

void MergeTriangles(int columns, const double* other, double* work,
                    double* triangle) {
  Unpack(columns, other, 0, work);
  Factor(PackedStack(columns, work, triangle), true);
}

// Lane by lane the upper half joins the lower one, until lane 0 has it all.
// What the others then hold is of no use.
void MergeAllLanes(int columns, double* triangle, double* work) {
  const std::size_t lanes = hn::Lanes(kTag);
  for (std::size_t half = lanes / 2; half > 0; half /= 2) {
    Unpack(columns, triangle, half, work);
    Factor(PackedStack(columns, work, triangle), true);
  }
}

// Adds the products of kA columns from `a` on with kB columns from `b` on.
template <int kA, int kB>
HWY_INLINE void MultiplyColumns(const Stack& stack, int a, int b) {
  const std::size_t lanes = hn::Lanes(kTag);
  V sums[kA][kB];
  for (auto& row : sums) {
    for (V& sum : row) sum = hn::Zero(kTag);
  }
  const double* const left = stack.Column(a);
  const double* const right = stack.Column(b);
  for (std::size_t i = 0; i < stack.rows * lanes; i += lanes) {
    V factors[kB];
    for (int n = 0; n < kB; ++n) {
      factors[n] = hn::Load(kTag, right + n * stack.stride + i);
    }
    for (int m = 0; m < kA; ++m) {
      const V factor = hn::Load(kTag, left + m * stack.stride + i);
      for (int n = 0; n < kB; ++n) {
        sums[m][n] = hn::MulAdd(factor, factors[n], sums[m][n]);
      }
    }
  }
  for (int m = 0; m < kA; ++m) {
    double* const row = stack.TriangleRow(a + m);
    for (int n = std::max(0, a + m - b); n < kB; ++n) {
      double* const entry = row + (b + n) * lanes;
      hn::Store(hn::Add(hn::Load(kTag, entry), sums[m][n]), kTag, entry);
    }
  }
}

// Columns that four others are multiplied with at a time: with the sums no more
// vectors than there are registers, 16 with AVX2 and SSE4.
constexpr int kWide = HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_SSE4 ? 3 : 4;

// The products of kA columns from `a` on with all from there on.
template <int kA>
HWY_INLINE void MultiplyFrom(const Stack& stack, int a) {
  int b = a;
  for (; b + kWide <= stack.columns; b += kWide) {
    MultiplyColumns<kA, kWide>(stack, a, b);
  }
  switch (stack.columns - b) {
    case 3:
      return MultiplyColumns<kA, 3>(stack, a, b);
    case 2:
      return MultiplyColumns<kA, 2>(stack, a, b);
    case 1:
      return MultiplyColumns<kA, 1>(stack, a, b);
    default:
      return;
  }
}

void AddProducts(int columns, int rows, std::size_t stride, double* matrix,
                 double* triangle) {
  const Stack stack = {columns, static_cast<std::size_t>(rows), stride, matrix,
                       triangle};
  int a = 0;
  for (; a + 4 <= columns; a += 4) MultiplyFrom<4>(stack, a);
  switch (columns - a) {
    case 3:
      return MultiplyFrom<3>(stack, a);
    case 2:
      return MultiplyFrom<2>(stack, a);
    case 1:
      return MultiplyFrom<1>(stack, a);
    default:
      return;
  }
}

}  // namespace
}  // namespace alidade::internal::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace alidade::internal::kernel {

HWY_EXPORT(LanesOfTarget);
HWY_EXPORT(TargetOfBuild);
HWY_EXPORT(AddRows);
HWY_EXPORT(MergeTriangles);
HWY_EXPORT(MergeAllLanes);
HWY_EXPORT(AddProducts);

std::size_t Lanes() { return HWY_DYNAMIC_DISPATCH(LanesOfTarget)(); }

const char* TargetName() {
  return hwy::TargetName(HWY_DYNAMIC_DISPATCH(TargetOfBuild)());
}

std::size_t TriangleSize(int columns) {
  // One vector more, since the last entry is read with its lanes moved.
  return (RowStart(columns, columns) + columns + 1) * kMostLanes;
}

std::size_t MergeSize(int columns) {
  return static_cast<std::size_t>(columns) * columns * kMostLanes;
}

void AddRows(int columns, int rows, std::size_t stride, double* matrix,
             double* triangle) {
  HWY_DYNAMIC_DISPATCH(AddRows)(columns, rows, stride, matrix, triangle);
}

void MergeTriangles(int columns, const double* other, double* work,
                    double* triangle) {
  HWY_DYNAMIC_DISPATCH(MergeTriangles)(columns, other, work, triangle);
}

void MergeLanes(int columns, double* triangle, double* work,
                Eigen::MatrixXd* factor) {
  HWY_DYNAMIC_DISPATCH(MergeAllLanes)(columns, triangle, work);
  const std::size_t lanes = Lanes();
  factor->setZero(columns, columns);
  for (int i = 0; i < columns; ++i) {
    for (int j = i; j < columns; ++j) {
      (*factor)(i, j) = triangle[(RowStart(columns, i) + j) * lanes];
    }
  }
}

void AddProducts(int columns, int rows, std::size_t stride, double* matrix,
                 double* triangle) {
  HWY_DYNAMIC_DISPATCH(AddProducts)(columns, rows, stride, matrix, triangle);
}

void SumLanes(int columns, const double* triangle, Eigen::MatrixXd* sum) {
  const std::size_t lanes = Lanes();
  sum->setZero(columns, columns);
  for (int i = 0; i < columns; ++i) {
    for (int j = i; j < columns; ++j) {
      const double* const entry = triangle + (RowStart(columns, i) + j) * lanes;
      double total = 0.0;
      for (std::size_t lane = 0; lane < lanes; ++lane) total += entry[lane];
      (*sum)(i, j) = total;
    }
  }
}

}  // namespace alidade::internal::kernel
#endif  // HWY_ONCE
