#include "alidade/large_matrix.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <utility>

#include "alidade/error.h"

namespace alidade::internal {
namespace {

// Large enough to be counted and to lie in a file beyond the limit (bytes).
constexpr Eigen::Index kColumns = 1 << 18;

LargeMatrix Counted(Eigen::Index columns) {
  LargeMatrix matrix(3, columns);
  LargeMatrix::Editable numbers = matrix.edit();
  for (Eigen::Index i = 0; i < columns; ++i) {
    numbers.col(i).setConstant(static_cast<double>(i));
  }
  return matrix;
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

TEST(LargeMatrixTest, CopiesShareUntilOneIsEdited) {
  LargeMatrix a = Eigen::MatrixXd::Random(3, 7);
  const Eigen::MatrixXd before = a.eval();
  const LargeMatrix b = a;
  EXPECT_EQ(a.data(), b.data());
  a.edit()(1, 2) = 5.0;
  EXPECT_NE(a.data(), b.data());
  EXPECT_EQ(b, before);
  EXPECT_EQ(a(1, 2), 5.0);
  EXPECT_EQ(a.rightCols(4), before.rightCols(4));
  // Alone, it edits in place.
  const double* const own = a.data();
  a.edit() *= 2.0;
  EXPECT_EQ(a.data(), own);
  EXPECT_EQ(a(1, 2), 10.0);
}

TEST(LargeMatrixTest, TakesOverWhatIsMovedHere) {
  Eigen::MatrixXd plain = Eigen::MatrixXd::Random(4, 5);
  const double* const numbers = plain.data();
  const Eigen::MatrixXd expected = plain;
  const LargeMatrix taken = std::move(plain);
  EXPECT_EQ(taken.data(), numbers);
  EXPECT_EQ(taken, expected);
}

TEST(LargeMatrixTest, IsAssignedWhatReadsFromIt) {
  LargeMatrix a = Eigen::MatrixXd::Random(3, 6);
  const Eigen::MatrixXd before = a.eval();
  a = a.rightCols(2);
  EXPECT_EQ(a, before.rightCols(2));
  a = a.replicate(1, 3) * 2.0;
  EXPECT_EQ(a, before.rightCols(2).replicate(1, 3) * 2.0);
  LargeMatrix b = Eigen::MatrixXd::Zero(1, 1);
  b = std::move(a);
  EXPECT_EQ(b.cols(), 6);
}

TEST(LargeMatrixTest, OthersNumbersAreCopiedBeforeTheyAreEdited) {
  const double numbers[] = {1, 2, 9, 3, 4, 9};
  LargeMatrix view(std::shared_ptr<const double>(numbers, [](const double*) {}),
                   2, 2, 3);
  EXPECT_EQ(view, (Eigen::Matrix2d() << 1, 3, 2, 4).finished());
  view.edit()(0, 0) = 7.0;
  EXPECT_EQ(numbers[0], 1.0);
  EXPECT_EQ(view, (Eigen::Matrix2d() << 7, 3, 2, 4).finished());
}

TEST(LargeMatrixTest, PartsAndShapesShareTheirNumbers) {
  const LargeMatrix all = Counted(10);
  const LargeMatrix part = all.SharedColumns(4, 3);
  EXPECT_EQ(part.data(), all.col(4).data());
  EXPECT_EQ(part, all.middleCols(4, 3));
  LargeVector vector(6);
  vector.edit() << 1, 2, 3, 4, 5, 6;
  const LargeMatrix shaped = vector.Reshaped(3);
  EXPECT_EQ(shaped.data(), vector.data());
  EXPECT_EQ(shaped.col(1), Eigen::Vector3d(4, 5, 6));
}

TEST(LargeMatrixTest, RepeatedColumnsAreThoseOfAnyMatrix) {
  const Eigen::Vector3d column(0.1, 0.2, 0.7);
  // A few, and so many that they are pages seen again and again.
  for (const Eigen::Index count : {0, 5, 1000001}) {
    LargeMatrix repeated = LargeMatrix::Repeated(column, count);
    ASSERT_EQ(repeated.cols(), count);
    EXPECT_EQ(repeated, column.replicate(1, count));
    if (count == 0) continue;
    repeated.edit()(1, count - 1) = 3.0;
    EXPECT_EQ(repeated(1, count - 1), 3.0);
    EXPECT_EQ(repeated.leftCols(count - 1), column.replicate(1, count - 1));
  }
}

TEST_F(MemoryTest, BeyondTheLimitNumbersLieInATemporaryFile) {
  const LargeMatrix inside = Counted(kColumns);
  EXPECT_FALSE(LiesInNamelessFile(inside.data()));
  SetMemoryLimit(1);
  LargeMatrix outside = Counted(kColumns);
  EXPECT_TRUE(LiesInNamelessFile(outside.data()));
  EXPECT_EQ(outside, inside);
  outside.edit()(0, 0) = 4.0;
  EXPECT_EQ(outside(0, 0), 4.0);
  // Small ones stay.
  EXPECT_FALSE(LiesInNamelessFile(Counted(10).data()));
}

TEST_F(MemoryTest, WhatIsFreedMayBeTakenAgain) {
  constexpr std::size_t kBytes = sizeof(double) * 3 * kColumns;
  SetMemoryLimit(kBytes + kBytes / 2);
  for (int i = 0; i < 3; ++i) {
    const LargeMatrix first = Counted(kColumns);
    EXPECT_FALSE(LiesInNamelessFile(first.data()));
    const LargeMatrix second = Counted(kColumns);
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
