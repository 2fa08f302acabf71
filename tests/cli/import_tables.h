#ifndef ALIDADE_TESTS_CLI_IMPORT_TABLES_H_
#define ALIDADE_TESTS_CLI_IMPORT_TABLES_H_

#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "tests/support/process.h"

// Tables of poses as people have them, for tests of `alidade import`.
namespace alidade::internal::import_test {

using testing::ProcessResult;
using testing::ReadWhole;
using testing::TemporaryDirectory;
using testing::WriteWhole;

// An arm whose base is nowhere near its origin.
inline constexpr char kPlaces[] =
    "base: {x: 1650, y: -840, z: 410, rx: 1, ry: -2, rz: 143}\n";

using Row = std::vector<double>;

class ImportTest : public ::testing::Test {
 protected:
  ProcessResult Alidade(const std::string& arguments) const {
    return testing::RunIn(directory_.path(),
                          std::string(ALIDADE_BINARY) + " " + arguments);
  }
  void Write(const std::string& name, const std::string& text) const {
    WriteWhole(directory_ / name, text);
  }
  std::string Read(const std::string& name) const {
    return ReadWhole(directory_ / name);
  }

  // Joint values (deg) and the pose at them: x, y, z (mm), rx, ry, rz (deg).
  std::vector<Row> Poses(int count) const {
    std::string joints = "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n";
    for (int i = 0; i < count; ++i) {
      for (int j = 0; j < 6; ++j) {
        const int value = (i * (17 + 10 * j) + 31 * j) % 160 - 80;
        joints += std::to_string(value) + (j < 5 ? "," : "\n");
      }
    }
    Write("joints.csv", joints);
    Write("placed.yaml", ReadWhole(std::string(ALIDADE_SOURCE_DIR) +
                                   "/configs/robots/irb120.yaml") +
                             kPlaces);
    const ProcessResult poses =
        Alidade("fk placed.yaml joints.csv --rotation=extrinsic_xyz");
    EXPECT_EQ(poses.status, 0) << poses.err;
    std::vector<Row> rows;
    std::istringstream lines(poses.out);
    for (std::string line; std::getline(lines, line);) {
      if (line.empty() || line[0] == '#' || line[0] == 'q') continue;
      std::istringstream cells(line);
      Row row;
      for (std::string cell; std::getline(cells, cell, ',');) {
        row.push_back(std::stod(cell));
      }
      rows.push_back(row);
    }
    EXPECT_EQ(rows.size(), static_cast<std::size_t>(count));
    return rows;
  }

  // `header` and a line of each row's cells.
  static std::string Table(const std::string& header,
                           const std::vector<Row>& rows) {
    std::ostringstream text;
    text.precision(10);
    text << header << "\n";
    for (const Row& row : rows) {
      for (std::size_t i = 0; i < row.size(); ++i) {
        text << row[i] << (i + 1 < row.size() ? "," : "\n");
      }
    }
    return text.str();
  }

  const TemporaryDirectory directory_;
};

inline std::vector<Row> Times(std::vector<Row> rows, std::size_t first,
                              std::size_t last, double factor) {
  for (Row& row : rows) {
    for (std::size_t i = first; i < last; ++i) row[i] *= factor;
  }
  return rows;
}

inline constexpr char kPosition[] = "J1,J2,J3,J4,J5,J6,X,Y,Z";

inline std::vector<Row> PositionsOf(std::vector<Row> rows) {
  for (Row& row : rows) row.resize(9);
  return rows;
}

}  // namespace alidade::internal::import_test

#endif  // ALIDADE_TESTS_CLI_IMPORT_TABLES_H_
