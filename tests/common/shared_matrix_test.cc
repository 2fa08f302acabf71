#include "alidade/shared_matrix.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <utility>

#include "alidade/error.h"
#include "src/common/memory.h"
#include "src/common/random.h"

namespace alidade::internal {
namespace {

// Large enough to be counted and to lie in a file beyond the limit (bytes).
constexpr Eigen::Index kColumns = 1 << 18;

SharedMatrix Counted(Eigen::Index columns) {
  MatrixBuilder matrix(3, columns);
  for (Eigen::Index i = 0; i < columns; ++i) {
    matrix.map().col(i).setConstant(static_cast<double>(i));
  }
  return matrix.Freeze();
}

// Restores the limit and the directory of temporary files.
class MemoryTest : public ::testing::Test {
 protected:
  ~MemoryTest() override {
    SetMemoryLimit(limit_);
    unsetenv("TMPDIR");
  }

 private:
  const std::size_t limit_ = MemoryLimit();
};

// Whether a file of this process that has no name any more is mapped there.
bool LiesInNamelessFile(const double* first) {
  std::ifstream maps("/proc/self/maps");
  const auto wanted = reinterpret_cast<std::uintptr_t>(first);
  for (std::string line; std::getline(maps, line);) {
    const auto begin = std::stoull(line, nullptr, 16);
    const auto end = std::stoull(line.substr(line.find('-') + 1), nullptr, 16);
    if (wanted < begin || wanted >= end) continue;
    return line.find("(deleted)") != std::string::npos;
  }
  return false;
}

TEST(SharedMatrixTest, CopiesShareAndBuildersCopy) {
  const Eigen::MatrixXd numbers = Eigen::MatrixXd::Random(3, 7);
  const SharedMatrix a = numbers;
  const SharedMatrix b = a;
  EXPECT_EQ(a.data(), b.data());
  MatrixBuilder builder(a);
  builder.map()(1, 2) = 5.0;
  const double* const own = builder.map().data();
  EXPECT_NE(own, a.data());
  const SharedMatrix changed = builder.Freeze();
  EXPECT_EQ(changed.data(), own);
  EXPECT_EQ(changed(1, 2), 5.0);
  EXPECT_EQ(changed.Columns(3, 4), numbers.rightCols(4));
  EXPECT_EQ(a, numbers);
}

TEST(SharedMatrixTest, EigenSeesTheSameNumbers) {
  const SharedMatrix matrix = Counted(5).Columns(1, 3);
  EXPECT_EQ(matrix.map().data(), matrix.data());
  EXPECT_EQ(matrix.map().sum(), 3.0 * (1.0 + 2.0 + 3.0));
  EXPECT_EQ(matrix.col(2), Eigen::Vector3d::Constant(3.0));
  EXPECT_EQ(matrix.row(0), Eigen::RowVector3d(1.0, 2.0, 3.0));
  const auto address = [](const Eigen::Ref<const Eigen::MatrixXd>& numbers) {
    return numbers.data();
  };
  EXPECT_EQ(address(matrix), matrix.data());
}

TEST(SharedMatrixTest, EqualityComparesSizesAndNumbers) {
  EXPECT_EQ(Counted(4), Counted(5).Columns(0, 4));
  EXPECT_NE(Counted(4), Counted(5));
  EXPECT_NE(Counted(4), Counted(5).Columns(1, 4));
  EXPECT_EQ(SharedMatrix(), Eigen::MatrixXd(0, 0));
}

TEST(SharedMatrixTest, TakesOverWhatIsMovedHere) {
  Eigen::MatrixXd plain = Eigen::MatrixXd::Random(4, 5);
  const double* const numbers = plain.data();
  const Eigen::MatrixXd expected = plain;
  const SharedMatrix taken = std::move(plain);
  EXPECT_EQ(taken.data(), numbers);
  EXPECT_EQ(taken, expected);
}

TEST(SharedMatrixTest, IsAssignedWhatReadsFromIt) {
  const Eigen::MatrixXd before = Eigen::MatrixXd::Random(3, 6);
  SharedMatrix a = before;
  a = a.map().rightCols(2);
  EXPECT_EQ(a, before.rightCols(2));
  a = a.map().replicate(1, 3) * 2.0;
  EXPECT_EQ(a, before.rightCols(2).replicate(1, 3) * 2.0);
  SharedMatrix b = Eigen::MatrixXd::Zero(1, 1);
  b = std::move(a);
  EXPECT_EQ(b.cols(), 6);
}

TEST(SharedMatrixTest, OthersNumbersMayHaveAStride) {
  const double numbers[] = {1, 2, 9, 3, 4, 9};
  const SharedMatrix view(
      std::shared_ptr<const double>(numbers, [](const double*) {}), 2, 2, 3);
  EXPECT_EQ(view, (Eigen::Matrix2d() << 1, 3, 2, 4).finished());
  EXPECT_EQ(MatrixBuilder(view).Freeze(), view);
}

TEST(SharedMatrixTest, PartsAndShapesShareTheirNumbers) {
  const SharedMatrix all = Counted(10);
  const SharedMatrix part = all.Columns(4, 3);
  EXPECT_EQ(part.data(), all.col(4).data());
  EXPECT_EQ(part, all.map().middleCols(4, 3));
  const SharedVector vector = Eigen::VectorXd::LinSpaced(6, 1.0, 6.0);
  const SharedMatrix shaped = vector.Reshaped(3);
  EXPECT_EQ(shaped.data(), vector.data());
  EXPECT_EQ(shaped.col(1), Eigen::Vector3d(4, 5, 6));
}

TEST(SharedMatrixTest, RepeatedColumnsAreThoseOfAnyMatrix) {
  const Eigen::Vector3d column(0.1, 0.2, 0.7);
  // A few, and so many that they are pages seen again and again.
  for (const Eigen::Index count : {0, 5, 1000001}) {
    const SharedMatrix repeated = SharedMatrix::Repeated(column, count);
    ASSERT_EQ(repeated.cols(), count);
    EXPECT_EQ(repeated, column.replicate(1, count));
    if (count == 0) continue;
    MatrixBuilder changed(repeated);
    changed.map()(1, count - 1) = 3.0;
    EXPECT_EQ(repeated(1, count - 1), column[1]);
  }
}

TEST_F(MemoryTest, BeyondTheLimitNumbersLieInATemporaryFile) {
  const SharedMatrix inside = Counted(kColumns);
  EXPECT_FALSE(LiesInNamelessFile(inside.data()));
  SetMemoryLimit(1);
  const SharedMatrix outside = Counted(kColumns);
  EXPECT_TRUE(LiesInNamelessFile(outside.data()));
  EXPECT_EQ(outside, inside);
  // Small ones stay.
  EXPECT_FALSE(LiesInNamelessFile(Counted(10).data()));
}

TEST_F(MemoryTest, WhatIsFreedMayBeTakenAgain) {
  constexpr std::size_t kBytes = sizeof(double) * 3 * kColumns;
  SetMemoryLimit(kBytes + kBytes / 2);
  for (int i = 0; i < 3; ++i) {
    const SharedMatrix first = Counted(kColumns);
    EXPECT_FALSE(LiesInNamelessFile(first.data()));
    const SharedMatrix second = Counted(kColumns);
    EXPECT_TRUE(LiesInNamelessFile(second.data()));
  }
}

TEST_F(MemoryTest, ADirectoryThatIsNoneIsNamed) {
  setenv("TMPDIR", "/nonexistent/place", 1);
  SetMemoryLimit(1);
  try {
    Counted(kColumns);
    FAIL() << "expected an error";
  } catch (const InputError& error) {
    EXPECT_EQ(error.location().file, "/nonexistent/place");
    EXPECT_NE(error.message().find("TMPDIR"), std::string::npos);
  }
}

TEST_F(MemoryTest, ADeviceWithoutRoomIsToldBeforeItIsWrittenTo) {
  // More than any file system has.
  setenv("TMPDIR", std::filesystem::temp_directory_path().c_str(), 1);
  SetMemoryLimit(1);
  EXPECT_THROW(AllocateLarge(std::size_t{1} << 56), InputError);
}

TEST_F(MemoryTest, TheLimitIsPartOfTheMachinesMemory) {
  EXPECT_GT(MemoryLimit(), std::size_t{1} << 24);
  EXPECT_LT(MemoryLimit(), std::size_t{1} << 50);
}

}  // namespace
}  // namespace alidade::internal
