#ifndef ALIDADE_TESTS_DATAIO_LOADED_DATA_UTIL_H_
#define ALIDADE_TESTS_DATAIO_LOADED_DATA_UTIL_H_

#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

#include "src/dataio/dataset_csv.h"

namespace alidade::internal {

/// Whether two matrices have the same bits, signs of zeros included.
inline bool HaveSameBits(const Eigen::Ref<const Eigen::MatrixXd>& a,
                         const Eigen::Ref<const Eigen::MatrixXd>& b) {
  if (a.rows() != b.rows() || a.cols() != b.cols()) return false;
  const Eigen::MatrixXd x = a;
  const Eigen::MatrixXd y = b;
  return x.size() == 0 ||
         std::memcmp(x.data(), y.data(), sizeof(double) * x.size()) == 0;
}

inline void ExpectSameBlocks(const ObservationBlock& a,
                             const ObservationBlock& b) {
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.poses, b.poses);
  EXPECT_EQ(a.targets, b.targets);
  EXPECT_EQ(a.references, b.references);
  EXPECT_EQ(a.seconds, b.seconds);
  EXPECT_TRUE(HaveSameBits(a.measured, b.measured));
  EXPECT_TRUE(HaveSameBits(a.sigmas, b.sigmas));
  ASSERT_EQ(a.whiteners.size(), b.whiteners.size());
  for (std::size_t i = 0; i < a.whiteners.size(); ++i) {
    EXPECT_TRUE(HaveSameBits(a.whiteners[i], b.whiteners[i])) << i;
  }
}

/// All of them but names of files.
inline void ExpectSameNumbers(const Dataset& a, const Dataset& b) {
  EXPECT_TRUE(HaveSameBits(a.joint_values, b.joint_values));
  ASSERT_EQ(a.blocks.size(), b.blocks.size());
  for (std::size_t i = 0; i < a.blocks.size(); ++i) {
    ExpectSameBlocks(a.blocks[i], b.blocks[i]);
  }
}

inline void ExpectSameData(const Dataset& a, const Dataset& b) {
  ExpectSameNumbers(a, b);
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.files, b.files);
  ASSERT_EQ(a.sources.size(), b.sources.size());
  for (std::size_t i = 0; i < a.sources.size(); ++i) {
    ASSERT_EQ(a.sources[i].file, b.sources[i].file) << i;
    ASSERT_EQ(a.sources[i].line, b.sources[i].line) << i;
  }
}

inline void ExpectSameLoaded(const LoadedData& a, const LoadedData& b) {
  ExpectSameData(a.data, b.data);
  EXPECT_EQ(a.sets, b.sets);
  ASSERT_EQ(a.rejected.size(), b.rejected.size());
  for (std::size_t i = 0; i < a.rejected.size(); ++i) {
    EXPECT_EQ(a.rejected[i].file, b.rejected[i].file);
    EXPECT_EQ(a.rejected[i].line, b.rejected[i].line);
    EXPECT_EQ(a.rejected[i].reason, b.rejected[i].reason);
  }
}

}  // namespace alidade::internal

#endif  // ALIDADE_TESTS_DATAIO_LOADED_DATA_UTIL_H_
