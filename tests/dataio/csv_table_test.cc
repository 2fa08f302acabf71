// Random CSV files in pieces of any size, by several threads: the bits that
// strtod reads of each cell, or the message of the first mistake.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "alidade/rotation.h"
#include "alidade/units.h"
#include "src/common/numbers.h"
#include "src/common/random.h"
#include "src/common/text.h"
#include "src/dataio/dataset_csv.h"
#include "tests/dataio/loaded_data_util.h"
#include "tests/support/io_test_util.h"

namespace alidade::internal {
namespace {

int Draw(Random* random, int count) {
  return static_cast<int>(random->Uniform(0.0, count));
}

bool Chance(Random* random, double probability) {
  return random->Uniform(0.0, 1.0) < probability;
}

std::string Digits(Random* random, int count) {
  std::string digits;
  for (int i = 0; i < count; ++i) {
    digits += static_cast<char>('0' + Draw(random, 10));
  }
  return digits;
}

// A number above zero, written in any way that a program may choose.
std::string PositiveText(Random* random) {
  switch (Draw(random, 8)) {
    case 0:
      return std::to_string(1 + Draw(random, 2000));
    case 1:
      return Digits(random, 1 + Draw(random, 4)) + "." +
             Digits(random, 1 + Draw(random, 6)) + "1";
    case 2:  // all digits of a double
      return ShortestNumber(random->Uniform(1e-6, 400.0));
    case 3:  // around 2^53, where integers stop being doubles
      return "900719925474099" + Digits(random, 1) + "e-" +
             std::to_string(10 + Draw(random, 20));
    case 4:  // more digits than 64 bits hold
      return "1." + Digits(random, 15 + Draw(random, 30));
    case 5:
      return "1" + Digits(random, Draw(random, 5)) +
             (Draw(random, 2) ? "e" : "E") + (Draw(random, 2) ? "+" : "") +
             std::to_string(Draw(random, 26));
    case 6:
      return "3.1e-" + std::to_string(Draw(random, 26));
    default:
      return Draw(random, 2) ? ".25" : "007.";
  }
}

std::string NumberText(Random* random) {
  if (Chance(random, 0.05)) return "0";
  if (Chance(random, 0.05)) return "-0.000";
  return (Draw(random, 2) ? "-" : "") + PositiveText(random);
}

// Turning, sliding, turning.
Arm ThreeJoints(bool has_motor_map) {
  Arm arm;
  arm.name = "test";
  arm.joints.resize(3);
  arm.joints[1].type = JointType::kPrismatic;
  if (!has_motor_map) return arm;
  arm.joints_from_motors = Eigen::Matrix3d::Identity();
  arm.joints_from_motors(2, 1) = -0.3;
  arm.motor_offsets = Eigen::Vector3d(0.1, 0.0, -0.2);
  return arm;
}

// What a file of random layout needs to be read, and its text.
class RandomFile {
 public:
  explicit RandomFile(std::uint64_t seed)
      : random_(seed), arm(ThreeJoints(Draw(&random_, 2) == 1)) {
    ChooseColumns();
    if (Draw(&random_, 3) == 0) text = "\xef\xbb\xbf";
    end_ = Draw(&random_, 2) ? "\r\n" : "\n";
    AddNoise();
    for (const std::string& name : names_) {
      text += (&name == names_.data() ? "" : ",") + name;
    }
    text += end_;
    const int num_rows = 1 + Draw(&random_, 40);
    for (int i = 0; i < num_rows; ++i) AddRow();
    if (Draw(&random_, 3) == 0) text.erase(text.size() - end_.size());
  }

 private:
  Random random_;

 public:
  Arm arm;
  DataFormat format;
  std::string text;
  std::vector<std::map<std::string, std::string>> rows;  // cells by column
  std::vector<int> lines;                                // of each

 private:
  void Add(const std::vector<std::string>& bases, const char* unit,
           const char* other) {
    for (const std::string& base : bases) {
      names_.push_back(base + (Draw(&random_, 2) ? unit : other));
    }
  }

  void ChooseColumns() {
    Add({"x", "y", "z"}, "_mm", "_m");
    Add({"q1", "q3"}, "_deg", "_rad");
    Add({"q2"}, "_mm", "_m");
    format.sigma = 2e-5;
    if (Draw(&random_, 2)) Add({"std_x", "std_y", "std_z"}, "_mm", "_m");
    const int orientation = Draw(&random_, 6);
    if (orientation == 0) Add({"wx", "wy", "wz"}, "_deg", "_rad");
    if (orientation == 1) Add({"qw", "qx", "qy", "qz"}, "", "");
    if (orientation == 2) {
      Add({"rx", "ry", "rz"}, "_deg", "_rad");
      format.rotation = RotationConvention{false, true, {2, 1, 0}};
    }
    if (orientation < 3 && Draw(&random_, 2)) {
      Add({"std_wx", "std_wy", "std_wz"}, "_deg", "_rad");
    }
    if (Draw(&random_, 4) == 0) {
      arm.targets.resize(3);
      for (int i = 0; i < 3; ++i) {
        arm.targets[i].name = "smr" + std::to_string(i);
      }
      if (Draw(&random_, 3)) {
        names_.push_back("target");
      } else {
        format.target = "smr2";
      }
    }
    if (Draw(&random_, 4) == 0) names_.push_back("set");
    if (Draw(&random_, 4) == 0) names_.push_back("comment");
  }

  void AddNoise() {
    if (Chance(&random_, 0.05)) text += "# x_mm, \"quoted\", 1.5" + end_;
    if (Chance(&random_, 0.05)) text += "  \t" + end_;
    if (Chance(&random_, 0.05)) text += end_;
    if (Chance(&random_, 0.05)) text += " #" + end_;
  }

  std::string Cell(const std::string& name) {
    const auto begins = [&](const char* with) {
      return name.rfind(with, 0) == 0;
    };
    if (name == "target") return "smr" + std::to_string(Draw(&random_, 3));
    if (name == "set") return Draw(&random_, 2) ? "train" : "";
    if (name == "comment") return Draw(&random_, 2) ? "a 'b; c" : "";
    if (begins("qw")) return "0.6";
    if (begins("qx")) return Draw(&random_, 2) ? "0.8" : "-0.8";
    if (begins("qy")) return "0.0001";
    if (begins("qz")) return "-0";
    if (begins("std_")) return PositiveText(&random_);
    if (begins("w") || begins("r")) {  // beyond 10 rad they are refused
      return ShortestNumber(random_.Uniform(-9.9, 9.9));
    }
    return NumberText(&random_);
  }

  void AddRow() {
    AddNoise();
    lines.push_back(
        1 + static_cast<int>(std::count(text.begin(), text.end(), '\n')));
    rows.emplace_back();
    for (const std::string& name : names_) {
      if (&name != names_.data()) text += ',';
      if (Chance(&random_, 0.05)) text += " \t";
      const std::string cell = Cell(name);
      rows.back()[name] = cell;
      text += Chance(&random_, 0.05) ? '"' + cell + '"' : cell;
      if (Chance(&random_, 0.05)) text += ' ';
    }
    text += end_;
  }

  std::vector<std::string> names_;
  std::string end_;
};

ReadOptions Options(int num_threads, int chunk_bytes) {
  ReadOptions options;
  options.num_threads = num_threads;
  options.chunk_bytes = chunk_bytes;
  return options;
}

// The message where reading fails, else nothing.
std::optional<std::string> Read(const std::string& path, const RandomFile& file,
                                const ReadOptions& options,
                                LoadedData* loaded) {
  References references;
  try {
    *loaded = LoadDataWith({path, file.arm, file.format}, &references, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return std::nullopt;
}

// The SI value of the cell under "BASE_UNIT"; nothing where there is none. By
// another way than the reader's: the C library reads the decimal text with the
// unit's power of ten as a part of it.
std::optional<double> Expected(const std::map<std::string, std::string>& row,
                               const std::string& base) {
  for (const auto& [unit, exponent, factor] :
       {std::tuple{"_mm", -3, 1.0}, std::tuple{"_m", 0, 1.0},
        std::tuple{"_deg", 0, kDegree}, std::tuple{"_rad", 0, 1.0},
        std::tuple{"", 0, 1.0}}) {
    const auto cell = row.find(base + unit);
    if (cell == row.end()) continue;
    const std::size_t e =
        std::min(cell->second.find_first_of("eE"), cell->second.size());
    const int own = std::atoi(
        cell->second.substr(std::min(e + 1, cell->second.size())).c_str());
    const std::string text =
        cell->second.substr(0, e) + "e" + std::to_string(own + exponent);
    return std::strtod(text.c_str(), nullptr) * factor;
  }
  return std::nullopt;
}

Eigen::Vector3d ExpectedVector(const std::map<std::string, std::string>& row,
                               const std::string& prefix, double otherwise) {
  Eigen::Vector3d vector;
  for (int axis = 0; axis < 3; ++axis) {
    vector[axis] = Expected(row, prefix + "xyz"[axis]).value_or(otherwise);
  }
  return vector;
}

// The rotation vector of the row's orientation; nothing where it has none.
std::optional<Eigen::Vector3d> ExpectedRotation(
    const std::map<std::string, std::string>& row, const DataFormat& format) {
  if (row.count("qw") > 0) {
    const Eigen::Quaterniond quaternion(
        *Expected(row, "qw"), *Expected(row, "qx"), *Expected(row, "qy"),
        *Expected(row, "qz"));
    return VectorFromRotation(quaternion.normalized().toRotationMatrix());
  }
  if (Expected(row, "wx")) {
    return VectorFromRotation(
        RotationFromVector<double>(ExpectedVector(row, "w", 0.0)));
  }
  if (!Expected(row, "rx")) return std::nullopt;
  return VectorFromRotation(
      RotationOf(*format.rotation, ExpectedVector(row, "r", 0.0)));
}

void ExpectCells(const RandomFile& file, const LoadedData& loaded) {
  const auto size = static_cast<Eigen::Index>(file.rows.size());
  ASSERT_EQ(loaded.data.num_poses(), size);
  ASSERT_EQ(loaded.data.blocks.size(), 1u);
  const ObservationBlock& block = loaded.data.blocks[0];
  Eigen::MatrixXd motors(3, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    const std::map<std::string, std::string>& row = file.rows[i];
    for (int j = 0; j < 3; ++j) {
      motors(j, i) = *Expected(row, "q" + std::to_string(j + 1));
    }
    EXPECT_TRUE(HaveSameBits(block.measured.col(i).head(3),
                             ExpectedVector(row, "", 0.0)));
    EXPECT_TRUE(HaveSameBits(block.sigmas.col(i).head(3),
                             ExpectedVector(row, "std_", file.format.sigma)));
    const auto rotation = ExpectedRotation(row, file.format);
    ASSERT_EQ(block.rows_each(), rotation ? 6 : 3);
    if (rotation) {
      EXPECT_TRUE(HaveSameBits(block.measured.col(i).tail(3), *rotation));
      EXPECT_TRUE(HaveSameBits(
          block.sigmas.col(i).tail(3),
          ExpectedVector(row, "std_w",
                         DefaultRotationSigma(file.format.sigma))));
    }
    const auto target = row.find("target");
    const std::string name = target != row.end()          ? target->second
                             : file.format.target.empty() ? ""
                                                          : file.format.target;
    EXPECT_EQ(file.arm.targets[block.target(i)].name, name);
    if (row.count("set") > 0) {
      EXPECT_EQ(loaded.sets[i], row.at("set"));
    }
    EXPECT_EQ(loaded.data.sources[i].line, file.lines[i]);
  }
  EXPECT_TRUE(HaveSameBits(
      loaded.data.joint_values,
      JointsFromMotors(file.arm, SharedMatrix(std::move(motors)))));
  EXPECT_EQ(loaded.sets.empty(), file.rows[0].count("set") == 0);
}

TEST(CsvTableTest, ReadsTheBitsOfEveryCellWhateverThePieces) {
  const TestDirectory directory;
  for (int seed = 0; seed < 400; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const RandomFile file(seed);
    const std::string path = directory.Write("data.csv", file.text);
    LoadedData at_once;
    ASSERT_EQ(Read(path, file, Options(1, 1 << 20), &at_once), std::nullopt)
        << file.text;
    ExpectCells(file, at_once);
    for (const int chunk_bytes : {1, 50, 1000}) {
      LoadedData loaded;
      ASSERT_EQ(Read(path, file, Options(1 + seed % 3, chunk_bytes), &loaded),
                std::nullopt);
      ExpectSameLoaded(loaded, at_once);
    }
    if (HasFailure()) FAIL() << file.text;
  }
}

// Something else at a random place: most of it is an error, some is not.
std::string Damage(const std::string& text, Random* random) {
  const std::vector<std::string> parts = {"",
                                          ",",
                                          "\"",
                                          "nan",
                                          "inf",
                                          "x",
                                          "-",
                                          "+1",
                                          "1e",
                                          "e5",
                                          "1,5",
                                          "\n",
                                          "\r",
                                          "\"a",
                                          "\"1\"",
                                          "0",
                                          "#",
                                          " ",
                                          "..",
                                          "--1",
                                          "1 2",
                                          ";",
                                          "0x1",
                                          "1e999",
                                          "\t",
                                          "-1",
                                          "smr9",
                                          ",,,",
                                          "mm",
                                          "1_0",
                                          std::string(1, '\0')};
  std::string damaged = text;
  const auto at =
      static_cast<std::size_t>(Draw(random, static_cast<int>(damaged.size())));
  const std::string& part = parts[static_cast<std::size_t>(
      Draw(random, static_cast<int>(parts.size())))];
  damaged.replace(at, static_cast<std::size_t>(Draw(random, 4)), part);
  return damaged;
}

// Which mistake is the first, and what is read where there is none, does not
// depend on pieces and threads.
TEST(CsvTableTest, DamagedFilesGiveTheMessageOfTheFirstMistake) {
  const TestDirectory directory;
  Random random(3);
  int failures = 0;
  for (int i = 0; i < 1500; ++i) {
    const RandomFile file(i % 50);
    const std::string text = Damage(file.text, &random);
    const std::string path = directory.Write("data.csv", text);
    LoadedData in_pieces;
    LoadedData at_once;
    const auto expected = Read(path, file, Options(1, 1 << 20), &at_once);
    ASSERT_EQ(Read(path, file, Options(3, 1 + i % 200), &in_pieces), expected)
        << text;
    failures += expected ? 1 : 0;
    ExpectSameLoaded(in_pieces, at_once);
    if (HasFailure()) FAIL() << text;
  }
  EXPECT_GT(failures, 500);
  EXPECT_LT(failures, 1450);
}

TEST(CsvTableTest, NamesTheFirstOfManyMistakesOfManyThreads) {
  const TestDirectory directory;
  std::string text = "q1_deg,q2_mm,q3_deg,x_mm,y_mm,z_mm\n";
  for (int i = 0; i < 2000; ++i) {
    text += i < 700 ? "1,2,3,4,5,6\n" : "1,2,3,4,5,six\n";
  }
  const std::string path = directory.Write("data.csv", text);
  const Arm arm = ThreeJoints(false);
  for (int trial = 0; trial < 50; ++trial) {
    try {
      LoadDataWith({path, arm, DataFormat()}, nullptr, Options(4, 100));
      FAIL() << "expected an error";
    } catch (const InputError& error) {
      EXPECT_EQ(error.location().line, 702);
      EXPECT_EQ(error.location().column, 11);
      EXPECT_EQ(error.location().key, "z_mm");
    }
  }
}

TEST(CsvTableTest, TwoQuotesWithinQuotesAreOne) {
  const TestDirectory directory;
  const std::string path =
      directory.Write("data.csv",
                      "q1_deg,q2_mm,q3_deg,x_mm,y_mm,z_mm,set\n"
                      "1,2,3,4,5,6,\"say \"\"a\"\", b\"\n");
  const Arm arm = ThreeJoints(false);
  const LoadedData loaded =
      LoadDataWith({path, arm, DataFormat()}, nullptr, Options(1, 1 << 20));
  ASSERT_EQ(loaded.sets.size(), 1u);
  EXPECT_EQ(loaded.sets[0], "say \"a\", b");
}

TEST(CsvTableTest, LeavesOutRowsAndAxesThatAreNotMeasured) {
  const TestDirectory directory;
  const std::string path =
      directory.Write("data.csv",
                      "q1_deg,q2_mm,q3_deg,x_mm,y_mm,z_mm\n"
                      "1,2,3,4,5,6\n"
                      "1,2,3,,nan,\n"
                      "1,2,3,4,,6\n");
  const Arm arm = ThreeJoints(false);
  const LoadedData loaded =
      LoadDataWith({path, arm, DataFormat()}, nullptr, Options(1, 1 << 20));
  EXPECT_EQ(loaded.data.num_poses(), 2);
  EXPECT_EQ(loaded.data.sigmas()(0, 1), DataFormat().sigma);
  EXPECT_TRUE(std::isinf(loaded.data.sigmas()(1, 1)));
  ASSERT_EQ(loaded.rejected.size(), 1u);
  EXPECT_EQ(loaded.rejected[0].line, 3);
}

bool IsZero(const std::string& text) {
  return text.substr(0, text.find('e')).find_first_of("123456789") ==
         std::string::npos;
}

TEST(ParseQuantityTest, RoundsOnceAtTheEdgesOfTheShortWay) {
  const Unit& mm = *FindUnit("mm");
  const Unit& radians = *FindUnit("rad");
  for (const std::string text : {"9007199254740991",
                                 "9007199254740992",
                                 "9007199254740993",
                                 "9007199254740993.5",
                                 "-9007199254740995e22",
                                 "1e22",
                                 "1e23",
                                 "1e25",
                                 "1e26",
                                 "1e-19",
                                 "1e-22",
                                 "1e-23",
                                 "0.1",
                                 "-0",
                                 "0e99",
                                 "5e-324",
                                 "1.7976931348623157e308",
                                 "2.2250738585072011e-308",
                                 "123456789012345678",
                                 "1234567890123456789",
                                 "12345678901234567890",
                                 "0000000000000000000000001.5",
                                 "1.50000000000000000000000000",
                                 "0.30000000000000004",
                                 "107.7560",
                                 "1.5e1",
                                 "123456.7890125",
                                 "999999999.999999",
                                 "1e-400",
                                 "1e310"}) {
    for (const auto& [unit, name] :
         {std::pair{&mm, "_mm"}, std::pair{&radians, "_rad"}}) {
      const std::optional<double> value = ParseQuantity(text, *unit);
      const double expected = *Expected({{std::string("x") + name, text}}, "x");
      ASSERT_EQ(value.has_value(),
                std::isfinite(expected) && (expected != 0.0 || IsZero(text)))
          << text;
      if (!value) continue;
      EXPECT_EQ(*value, expected) << text;
      EXPECT_EQ(std::signbit(*value), std::signbit(expected)) << text;
    }
  }
}

}  // namespace
}  // namespace alidade::internal
