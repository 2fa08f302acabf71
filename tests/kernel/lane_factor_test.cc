#include "src/kernel/lane_factor.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "src/common/random.h"
#include "src/common/svd.h"
#include "src/kernel/aligned.h"
#include "tests/support/vector_targets.h"

namespace alidade::internal {
namespace {

using MatrixXl = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

Eigen::MatrixXd RandomMatrix(Eigen::Index rows, Eigen::Index columns,
                             Random* random) {
  Eigen::MatrixXd matrix(rows, columns);
  for (double& value : matrix.reshaped()) value = random->Normal();
  return matrix;
}

// A matrix as the kernels take it: `rows` vectors in each column, filled row by
// row; what is left of the last vectors is zero.
AlignedDoubles Pack(const Eigen::MatrixXd& matrix, int vectors) {
  const std::size_t lanes = kernel::Lanes();
  const std::size_t stride = vectors * lanes;
  AlignedDoubles packed = AllocateDoubles(stride * matrix.cols());
  std::fill_n(packed.get(), stride * matrix.cols(), 0.0);
  for (Eigen::Index c = 0; c < matrix.cols(); ++c) {
    for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
      packed[c * stride + r] = matrix(r, c);
    }
  }
  return packed;
}

int VectorsOf(const Eigen::MatrixXd& matrix) {
  const auto lanes = static_cast<Eigen::Index>(kernel::Lanes());
  return static_cast<int>((matrix.rows() + lanes - 1) / lanes);
}

struct Triangle {
  explicit Triangle(int columns)
      : values(AllocateDoubles(kernel::TriangleSize(columns))),
        work(AllocateDoubles(kernel::MergeSize(columns))) {
    std::fill_n(values.get(), kernel::TriangleSize(columns), 0.0);
  }
  AlignedDoubles values;
  AlignedDoubles work;
};

void AddRows(const Eigen::MatrixXd& matrix, Triangle* triangle) {
  const int vectors = VectorsOf(matrix);
  const AlignedDoubles packed = Pack(matrix, vectors);
  kernel::AddRows(static_cast<int>(matrix.cols()), vectors,
                  vectors * kernel::Lanes(), packed.get(),
                  triangle->values.get());
}

// R^T R is A^T A, each entry to some eps of the norms of its two columns.
void ExpectFactorOf(const Eigen::MatrixXd& matrix,
                    const Eigen::MatrixXd& factor) {
  ASSERT_EQ(factor.cols(), matrix.cols());
  const MatrixXl a = matrix.cast<long double>();
  const MatrixXl r = factor.cast<long double>();
  const Eigen::MatrixXd error =
      (r.transpose() * r - a.transpose() * a).cast<double>();
  for (Eigen::Index i = 0; i < error.rows(); ++i) {
    for (Eigen::Index j = 0; j < error.cols(); ++j) {
      const double scale = matrix.col(i).norm() * matrix.col(j).norm();
      EXPECT_LE(std::abs(error(i, j)), 2e-14 * scale) << i << ", " << j;
    }
    EXPECT_TRUE(factor.col(i).tail(factor.rows() - i - 1).isZero(0.0));
  }
}

class LaneFactorTest : public testing::VectorTargetTest {};

TEST_P(LaneFactorTest, IsAFactorOfAllRowsThatCameBy) {
  for (const int columns : {1, 2, 3, 4, 5, 6, 7, 9, 18, 31, 42}) {
    Random random(61, columns);
    Triangle triangle(columns);
    Eigen::MatrixXd all(0, columns);
    for (const int rows : {1, 8, 40, 200}) {
      const Eigen::MatrixXd block = RandomMatrix(rows, columns, &random);
      AddRows(block, &triangle);
      Eigen::MatrixXd more(all.rows() + rows, columns);
      more << all, block;
      all = more;
    }
    Eigen::MatrixXd factor;
    kernel::MergeLanes(columns, triangle.values.get(), triangle.work.get(),
                       &factor);
    ExpectFactorOf(all, factor);
  }
}

TEST_P(LaneFactorTest, MergesWhatOthersFactored) {
  for (const int columns : {1, 2, 5, 18}) {
    Random random(62, columns);
    const Eigen::MatrixXd first = RandomMatrix(70, columns, &random);
    const Eigen::MatrixXd second = RandomMatrix(33, columns, &random);
    Triangle one(columns);
    Triangle other(columns);
    AddRows(first, &one);
    AddRows(second, &other);
    kernel::MergeTriangles(columns, other.values.get(), one.work.get(),
                           one.values.get());
    Eigen::MatrixXd factor;
    kernel::MergeLanes(columns, one.values.get(), one.work.get(), &factor);
    Eigen::MatrixXd all(103, columns);
    all << first, second;
    ExpectFactorOf(all, factor);
  }
}

TEST_P(LaneFactorTest, KeepsColumnsThatDependOnOthersOrAreZero) {
  Random random(63);
  Eigen::MatrixXd matrix = RandomMatrix(96, 6, &random);
  matrix.col(1).setZero();
  matrix.col(4) = matrix.col(0) - 2.0 * matrix.col(3);
  Triangle triangle(6);
  AddRows(matrix, &triangle);
  Eigen::MatrixXd factor;
  kernel::MergeLanes(6, triangle.values.get(), triangle.work.get(), &factor);
  ASSERT_TRUE(factor.allFinite());
  ExpectFactorOf(matrix, factor);
  const Eigen::VectorXd singular = SingularValues(factor);
  EXPECT_GT(singular[3], 1.0);
  EXPECT_LT(singular[4], 1e-13 * singular[0]);
}

// Columns of sizes as far apart as those of parameters in m and in rad with a
// condition of 1e8 besides: transformations keep the small singular value.
TEST_P(LaneFactorTest, KeepsSmallSingularValues) {
  Random random(64);
  Eigen::MatrixXd matrix = RandomMatrix(400, 5, &random);
  matrix.col(4) = matrix.col(0) + 1e-8 * matrix.col(4);
  Triangle triangle(5);
  AddRows(matrix, &triangle);
  Eigen::MatrixXd factor;
  kernel::MergeLanes(5, triangle.values.get(), triangle.work.get(), &factor);
  const Eigen::VectorXd expected = SingularValues(matrix);
  const Eigen::VectorXd actual = SingularValues(factor);
  EXPECT_NEAR(actual[4], expected[4], 1e-14 * expected[0]);
  EXPECT_NEAR(actual[4] / expected[4], 1.0, 1e-5);
}

TEST_P(LaneFactorTest, ProductsAreThoseOfAllRows) {
  for (const int columns : {1, 2, 3, 4, 5, 6, 7, 9, 18, 31}) {
    Random random(65, columns);
    const Eigen::MatrixXd matrix = RandomMatrix(200, columns, &random);
    Triangle triangle(columns);
    const int vectors = VectorsOf(matrix);
    const AlignedDoubles packed = Pack(matrix, vectors);
    // Twice: what was there before is added to.
    for (int k = 0; k < 2; ++k) {
      kernel::AddProducts(columns, vectors, vectors * kernel::Lanes(),
                          packed.get(), triangle.values.get());
    }
    Eigen::MatrixXd sum;
    kernel::SumLanes(columns, triangle.values.get(), &sum);
    const MatrixXl a = matrix.cast<long double>();
    const Eigen::MatrixXd exact = (2.0L * a.transpose() * a).cast<double>();
    for (int i = 0; i < columns; ++i) {
      for (int j = 0; j < columns; ++j) {
        const double scale = 2.0 * matrix.col(i).norm() * matrix.col(j).norm();
        EXPECT_NEAR(sum(i, j), j >= i ? exact(i, j) : 0.0, 1e-14 * scale);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, LaneFactorTest, testing::AllVectorTargets(),
                         testing::TargetName);

}  // namespace
}  // namespace alidade::internal
