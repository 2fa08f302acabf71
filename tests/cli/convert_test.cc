// `alidade convert`, and NumPy arrays wherever the program takes data sets.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/process.h"

namespace alidade::internal::convert_test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::ProcessResult;
using testing::ReadWhole;
using testing::TemporaryDirectory;
using testing::WriteWhole;

const std::string kSource = ALIDADE_SOURCE_DIR;
const std::string kArm = kSource + "/configs/robots/rv2aj_wrist.yaml";
const std::string kData = kSource + "/datasets/rv2aj/wrist_56.csv";

// Five joints, a position and its sigmas.
constexpr std::size_t kColumns = 11;

class ConvertTest : public ::testing::Test {
 protected:
  static ProcessResult Alidade(const std::string& arguments) {
    return testing::RunProcess(std::string(ALIDADE_BINARY) + " " + arguments);
  }

  static ProcessResult Convert(const std::string& from, const std::string& to,
                               const std::string& arm = kArm) {
    return Alidade("convert " + from + " " + to + " --arm=" + arm);
  }

  // The last doubles of an array's file, on a little-endian machine.
  static std::vector<double> Numbers(const std::string& path,
                                     std::size_t count) {
    const std::string bytes = ReadWhole(path);
    std::vector<double> numbers(count);
    const std::size_t size = count * sizeof(double);
    EXPECT_EQ(bytes.substr(1, 5), "NUMPY");
    EXPECT_GT(bytes.size(), size);
    std::memcpy(numbers.data(), bytes.data() + bytes.size() - size, size);
    return numbers;
  }

  // What a file says besides comments.
  static std::string Rows(const std::string& path) {
    std::string text = ReadWhole(path);
    while (!text.empty() && text[0] == '#') text.erase(0, text.find('\n') + 1);
    return text;
  }

  std::string Write(const std::string& name, const std::string& text) {
    WriteWhole(directory_ / name, text);
    return directory_ / name;
  }

  // Nothing was written, not even half a file.
  void ExpectRefused(const ProcessResult& result, const std::string& message,
                     const std::string& to) {
    EXPECT_EQ(result.status, 2);
    EXPECT_THAT(result.err, HasSubstr(message));
    EXPECT_THAT(result.out, IsEmpty());
    for (const auto& entry :
         std::filesystem::directory_iterator(directory_.path())) {
      EXPECT_THAT(entry.path().string(), Not(HasSubstr(to)));
    }
  }

  TemporaryDirectory directory_;
};

TEST_F(ConvertTest, ThereAndBackGivesTheSameArrayByteForByte) {
  const std::string array = directory_ / "a.npy";
  const std::string back = directory_ / "back.csv";
  const std::string again = directory_ / "again.npy";
  const ProcessResult result = Convert(kData, array);
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out, array + ": 56 poses\n");
  ASSERT_EQ(Convert(array, back).status, 0);
  ASSERT_EQ(Convert(back, again).status, 0);
  EXPECT_EQ(ReadWhole(array), ReadWhole(again));
  EXPECT_THAT(Rows(back), HasSubstr("q1_deg,q2_deg"));
  EXPECT_EQ(std::filesystem::file_size(array) % 64, 0u);
}

// The simulation's own CSV, converted, is the oracle.
TEST_F(ConvertTest, SimulationsAreWrittenAsArrays) {
  const std::string simulation =
      Write("sim.yaml",
            "format: alidade-simulation-1\nunits: {length: mm, angle: deg}\n"
            "arm: " +
                kArm +
                "\nposes: {random: {count: 7}}\nnoise: {sigma: 0.01}\n"
                "seed: 3\noutput: sim.csv\n");
  const std::string array = directory_ / "sim.npy";
  ASSERT_EQ(Alidade("simulate " + simulation).status, 0);
  ASSERT_EQ(Alidade("simulate " + simulation + " --out=" + array).status, 0);
  const std::string converted = directory_ / "converted.npy";
  ASSERT_EQ(Convert(directory_ / "sim.csv", converted).status, 0);
  const std::vector<double> numbers = Numbers(array, 7 * kColumns);
  const std::vector<double> expected = Numbers(converted, 7 * kColumns);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    // A nanometre: decimals of the CSV. Any slip of a column is millimetres.
    EXPECT_NEAR(numbers[i], expected[i], 1e-9) << i;
  }
}

TEST_F(ConvertTest, ShortDecimalsComeBackAsTheyWere) {
  const std::string text =
      "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,x_mm,y_mm,z_mm,std_x_mm,std_y_mm,"
      "std_z_mm\n"
      "-107.756,32.1796,104.1809,42.9295,0.1,1.5,-2.25,300.7,0.02,0.02,0.03\n"
      "0,-0.0001,90,179.9999,45,0.001,,12,0.02,,0.03\n";
  const std::string array = directory_ / "a.npy";
  ASSERT_EQ(Convert(Write("a.csv", text), array).status, 0);
  ASSERT_EQ(Convert(array, directory_ / "b.csv").status, 0);
  EXPECT_EQ(Rows(directory_ / "b.csv"), text);
}

TEST_F(ConvertTest, ArraysStandWhereDataSetsDo) {
  const std::string array = directory_ / "a.npy";
  ASSERT_EQ(Convert(kData, array).status, 0);
  for (const char* command : {"show ", "check ", "validate ", "identify "}) {
    const ProcessResult csv = Alidade(command + kArm + " " + kData);
    const ProcessResult npy =
        Alidade(command + kArm + " " + array + " --threads=2");
    EXPECT_EQ(npy.status, 0) << npy.err;
    std::string expected = csv.out;
    for (std::size_t at; (at = expected.find(kData)) != std::string::npos;) {
      expected.replace(at, kData.size(), array);
    }
    // Tables are as wide as their longest name.
    const auto squeeze = [](std::string text) {
      std::string squeezed;
      for (const char c : text) {
        if (c != ' ' && c != '-') squeezed += c;
      }
      return squeezed;
    };
    EXPECT_EQ(squeeze(npy.out), squeeze(expected)) << command;
  }
}

TEST_F(ConvertTest, RefusesWhatAnArrayCannotHold) {
  const std::string joints = "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,";
  const std::string row = "1,2,3,4,5,";
  const std::string to = directory_ / "out.npy";
  const auto convert = [&](const std::string& columns,
                           const std::string& cells) {
    return Convert(Write("a.csv", joints + columns + "\n" + row + cells + "\n"),
                   to);
  };
  ExpectRefused(convert("x_mm,set", "1,a"), "\"set\"", "out");
  ExpectRefused(convert("distance_mm,point", "1,a"), "\"distance\"", "out");
  ExpectRefused(convert("x_mm", "one"), "a.csv:2:11: x_mm", "out");
  ExpectRefused(convert("x_mm,y_mm,z_mm,cov_xx_mm2,cov_xy_mm2,cov_xz_mm2,"
                        "cov_yy_mm2,cov_yz_mm2,cov_zz_mm2",
                        "1,2,3,1,0,0,1,0,1"),
                "covariances", "out");
}

TEST_F(ConvertTest, TakesOneTargetOfAnArmAndMotorsAsTheyAre) {
  const std::string arm =
      Write("arm.yaml",
            "format: alidade-arm-1\n"
            "name: two targets\n"
            "units: {length: mm, angle: deg}\n"
            "joints: [{type: revolute, sign: -1, offset: 30}"
            "]\n"
            "targets: [{name: ball}, {name: probe}]\n");
  const std::string plain = Write("a.csv", "q1_deg,x_mm\n10.25,7\n");
  ASSERT_EQ(Convert(plain, directory_ / "a.npy", arm).status, 0);
  ASSERT_EQ(Convert(directory_ / "a.npy", directory_ / "b.csv", arm).status, 0);
  EXPECT_EQ(Rows(directory_ / "b.csv"), "q1_deg,x_mm,y_mm,z_mm\n10.25,7,,\n");
  const std::string named = Write("c.csv", "q1_deg,x_mm,target\n1,7,ball\n");
  ExpectRefused(Convert(named, directory_ / "out.npy", arm),
                "rows name their targets", "out");
}

}  // namespace
}  // namespace alidade::internal::convert_test
