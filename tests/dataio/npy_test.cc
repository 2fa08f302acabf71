// NumPy arrays as data sets: what is read, what is refused and how, and that no
// bytes at all end the process.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "alidade/dataset_file.h"
#include "alidade/units.h"
#include "src/common/constants.h"
#include "src/common/random.h"
#include "src/common/text.h"
#include "src/dataio/dataset_csv.h"
#include "src/dataio/dataset_npy.h"
#include "src/dataio/npy_header.h"
#include "tests/dataio/loaded_data_util.h"
#include "tests/support/io_test_util.h"

namespace alidade::internal::npy_test {
namespace {

using Names = std::vector<std::string>;
using Rows = std::vector<std::vector<double>>;

const Names kNames = {"q1_rad", "q2_m", "x_m", "y_m", "z_m"};

// A turning joint, then a sliding one.
Arm TwoJoints() {
  Arm arm;
  arm.name = "test";
  arm.joints.resize(2);
  arm.joints[1].type = JointType::kPrismatic;
  return arm;
}

std::string Bytes(const Rows& rows) {
  std::string bytes;
  for (const std::vector<double>& row : rows) {
    bytes.append(reinterpret_cast<const char*>(row.data()), 8 * row.size());
  }
  return bytes;
}

std::string Npy(const Names& names, const Rows& rows) {
  return FormatNpyHeader(names, static_cast<std::int64_t>(rows.size())) +
         Bytes(rows);
}

// Any header, as NumPy would pad it or not.
std::string WithHeader(const std::string& header, const std::string& data,
                       char major = 1) {
  std::string bytes = "\x93NUMPY";
  bytes += major;
  bytes += '\0';
  bytes += static_cast<char>(header.size() & 0xff);
  bytes += static_cast<char>(header.size() >> 8);
  if (major > 1) bytes += std::string(2, '\0');
  return bytes + header + data;
}

LoadedData Load(const std::string& bytes, const DataFormat& format = {},
                const ReadOptions& options = {}) {
  const TestDirectory directory;
  const Arm arm = TwoJoints();
  References references;
  return LoadDataWith({directory.Write("data.npy", bytes), arm, format},
                      &references, options);
}

// The same numbers in a CSV, with all their digits; lines are rows.
LoadedData LoadAsCsv(const Names& names, const Rows& rows) {
  std::string text = Join(names, ",") + "\n";
  for (const std::vector<double>& row : rows) {
    for (const double& number : row) {
      text += &number == row.data() ? "" : ",";
      text += std::signbit(number) ? "-" : "";  // of zero too
      text += ShortestNumber(std::abs(number));
    }
    text += "\n";
  }
  const TestDirectory directory;
  const Arm arm = TwoJoints();
  References references;
  LoadedData loaded = LoadDataWith({directory.Write("data.csv", text), arm, {}},
                                   &references, ReadOptions());
  loaded.data.sources.MoveLines(-1);
  for (RejectedRow& row : loaded.rejected) --row.line;
  return loaded;
}

TEST(NpyTest, ReadsWhatNumPyWrites) {
  // Byte by byte what np.save of NumPy 1.24 writes.
  const std::string header =
      "{'descr': [('q1_rad', '<f8'), ('q2_m', '<f8'), ('x_m', '<f8'), ('y_m', "
      "'<f8'), ('z_m', '<f8')], 'fortran_order': False, 'shape': (2,), }";
  const Rows rows = {{1, 2, 3, 4, 5}, {-1, -2, -3, -4, -5}};
  for (const char major : {'\x01', '\x02', '\x03'}) {
    const Dataset data = Load(WithHeader(header, Bytes(rows), major)).data;
    ASSERT_EQ(data.num_poses(), 2);
    EXPECT_EQ(data.joint_values.col(0), Eigen::Vector2d(1, 2));
    EXPECT_EQ(data.positions().col(1), Eigen::Vector3d(-3, -4, -5));
    EXPECT_EQ(data.sources[1].line, 2);
  }
}

TEST(NpyTest, TakesUnitsFromNames) {
  const Dataset data = Load(Npy({"z_mm", "q2_mm", "x_mm", "q1_deg", "y_m",
                                 "std_x_mm", "std_y_mm", "std_z_mm"},
                                {{3.3, 40, 0.1, 90, 2, 0.1, 0.2, 0.7}}))
                           .data;
  EXPECT_EQ(data.joint_values.col(0), Eigen::Vector2d(kPi / 2.0, 0.04));
  EXPECT_EQ(data.positions().col(0), Eigen::Vector3d(0.0001, 2, 0.0033));
  EXPECT_EQ(data.sigmas().col(0), Eigen::Vector3d(0.0001, 0.0002, 0.0007));
}

TEST(NpyTest, NanIsNotMeasuredAndRowsOfItAreRejected) {
  const LoadedData loaded = Load(
      Npy(kNames,
          {{1, 2, 3, 4, 5}, {1, 2, kNan, kNan, kNan}, {6, 7, kNan, 8, -kNan}}));
  ASSERT_EQ(loaded.data.num_poses(), 2);
  EXPECT_EQ(loaded.data.joint_values.col(1), Eigen::Vector2d(6, 7));
  EXPECT_EQ(loaded.data.positions().col(1), Eigen::Vector3d(0, 8, 0));
  EXPECT_EQ(loaded.data.sigmas()(0, 1), kInfinity);
  EXPECT_EQ(loaded.data.sources[1].line, 3);
  ASSERT_EQ(loaded.rejected.size(), 1u);
  EXPECT_EQ(loaded.rejected[0].line, 2);
}

TEST(NpyTest, ReadsKindsBesidePositions) {
  DataFormat format;
  format.point = "post";
  const Dataset data = Load(Npy({"q1_rad", "q2_m", "distance_m"},
                                {{1, 2, 0.5}, {1, 3, kNan}, {2, 2, 0.75}}),
                            format)
                           .data;
  ASSERT_EQ(data.blocks.size(), 1u);
  EXPECT_EQ(data.blocks[0].kind, MeasurementKind::kDistance);
  EXPECT_EQ(data.blocks[0].measured(0, 1), 0.75);
  EXPECT_EQ(data.sources[1].line, 3);
}

void ExpectSameButFile(const LoadedData& npy, LoadedData csv) {
  csv.data.name = npy.data.name;
  csv.data.files = npy.data.files;
  for (RejectedRow& row : csv.rejected) row.file = npy.data.name;
  ExpectSameLoaded(npy, csv);
}

double AnyNumber(Random* random) {
  const double number = random->Uniform(-2000.0, 2000.0);
  const double kind = random->Uniform(0.0, 1.0);
  if (kind < 0.3) return std::round(number * 1e3) / 1e3;
  if (kind < 0.35) return -0.0;
  if (kind < 0.4) return number * 1e-12;
  if (kind < 0.45) return number * 1e15;
  return number;
}

Names RandomNames(Random* random) {
  const bool in_si = random->Uniform(0.0, 1.0) < 0.3;
  const std::string length = in_si ? "_m" : "_mm";
  const std::string angle = in_si ? "_rad" : "_deg";
  Names names = {"x" + length, "q2" + length, "y_m",
                 "q1" + angle, "z" + length,  "note"};
  const double kind = random->Uniform(0.0, 1.0);
  if (kind < 0.3) {
    for (const char* base : {"wx", "wy", "wz"}) names.push_back(base + angle);
  } else if (kind < 0.5) {
    for (const char* name : {"qx", "qy", "qw", "qz"}) names.push_back(name);
  }
  if (kind > 0.2 && kind < 0.7) {
    for (const char* base : {"std_x", "std_y", "std_z"}) {
      names.push_back(base + length);
    }
  }
  return names;
}

double NumberFor(const std::string& name, Random* random) {
  const bool may_be_missing =
      name[0] == 'x' || name[0] == 'y' || name[0] == 'z' || name == "note";
  if (may_be_missing && random->Uniform(0.0, 1.0) < 0.2) return kNan;
  if (name == "qw") return 0.6;
  if (name == "qz") return random->Uniform(0.0, 1.0) < 0.5 ? 0.8 : -0.8;
  if (name == "qx" || name == "qy") return 0.0;
  if (name[0] == 's') return random->Uniform(1e-6, 1.0);
  return AnyNumber(random);
}

TEST(NpyTest, GivesTheBitsOfTheSameCsv) {
  Random random(7);
  for (int trial = 0; trial < 300; ++trial) {
    const Names names = RandomNames(&random);
    Rows rows(1 + trial % 40);
    for (std::vector<double>& row : rows) {
      for (const std::string& name : names) {
        row.push_back(NumberFor(name, &random));
      }
    }
    ReadOptions options;
    options.num_threads = 1 + trial % 3;
    options.chunk_bytes = 200;
    const std::string bytes = Npy(names, rows);
    try {
      ExpectSameButFile(Load(bytes, {}, options), LoadAsCsv(names, rows));
    } catch (const InputError& error) {
      // A single row that measures nothing.
      EXPECT_EQ(rows.size(), 1u) << error.what();
    }
    if (HasFailure()) FAIL() << trial;
  }
}

// What is read of an array that is large enough to stay where it is.
LoadedData LoadLarge(const std::string& bytes) {
  ReadOptions options;
  options.num_threads = 2;
  options.fewest_bytes_in_place = 0;
  return Load(bytes, {}, options);
}

TEST(NpyTest, NumbersInSiStayInTheirFile) {
  const Names with_sigmas = {"q1_rad", "q2_m",    "x_m",     "y_m",
                             "z_m",    "std_x_m", "std_y_m", "std_z_m"};
  for (const Names& names : {kNames, with_sigmas}) {
    Random random(3, 0);
    Rows rows(17000, std::vector<double>(names.size()));
    for (std::vector<double>& row : rows) {
      for (double& number : row) number = random.Uniform(0.1, 2.0);
    }
    const std::string bytes = Npy(names, rows);
    const LoadedData loaded = LoadLarge(bytes);
    ExpectSameLoaded(loaded, Load(bytes));
    const auto width = static_cast<Eigen::Index>(names.size());
    EXPECT_EQ(loaded.data.joint_values.stride(), width);
    EXPECT_EQ(loaded.data.positions().data(),
              loaded.data.joint_values.data() + 2);
    EXPECT_EQ(loaded.data.positions()(0, 0), rows[0][2]);
  }
}

TEST(NpyTest, NumbersThatDoNotStandAsInMemoryAreCopied) {
  const Rows row = {{1, 2, 3, 4, 5}, {6, 7, 8, 9, 10}};
  Rows holes = row;
  holes[1][3] = kNan;
  const std::string unaligned = WithHeader(
      "{'descr': [('q1_rad', '<f8'), ('q2_m', '<f8'), ('x_m', '<f8'), ('y_m', "
      "'<f8'), ('z_m', '<f8')], 'fortran_order': False, 'shape': (2,), }",
      Bytes(row));
  ASSERT_NE(unaligned.find("}") % 8, 7u);
  for (const std::string& bytes :
       {Npy({"q1_deg", "q2_m", "x_m", "y_m", "z_m"}, row),
        Npy({"q1_rad", "q2_m", "x_mm", "y_mm", "z_mm"}, row),
        Npy({"q2_m", "q1_rad", "x_m", "y_m", "z_m"}, row),
        Npy({"q1_rad", "q2_m", "x_m", "z_m", "y_m"}, row), Npy(kNames, holes),
        unaligned}) {
    const LoadedData loaded = LoadLarge(bytes);
    ExpectSameLoaded(loaded, Load(bytes));
    EXPECT_EQ(loaded.data.joint_values.stride(), 2);
  }
}

TEST(NpyTest, WrongNumbersInLargeArraysAreNamed) {
  Rows rows(20000, {1, 2, 3, 4, 5, 0.1, 0.1, 0.1});
  rows[15000][6] = -0.1;
  try {
    LoadLarge(Npy({"q1_rad", "q2_m", "x_m", "y_m", "z_m", "std_x_m", "std_y_m",
                   "std_z_m"},
                  rows));
    FAIL() << "expected an error";
  } catch (const InputError& error) {
    EXPECT_EQ(error.location().line, 15001);
    EXPECT_EQ(error.location().key, "std_y_m");
  }
}

TEST(NpyTest, JointValuesAreReadAlone) {
  const TestDirectory directory;
  const std::string path = directory.Write(
      "data.npy",
      Npy({"force", "q2_mm", "q1_deg"}, {{kNan, 3, 90}, {0, 4, 0}}));
  const Eigen::MatrixXd joints = LoadJointValues(path, TwoJoints());
  ASSERT_EQ(joints.cols(), 2);
  EXPECT_EQ(joints.col(0), Eigen::Vector2d(kPi / 2.0, 0.003));
  directory.Write("data.npy", Npy({"q2_mm", "q1_deg"}, {{3, 90}, {kNan, 0}}));
  ExpectInputError([&] { LoadJointValues(path, TwoJoints()); },
                   {2, 0, "q2_mm", "finite"});
}

struct BadFile {
  const char* name;
  std::string bytes;
  ExpectedError error;
};

std::string Descr(const std::string& descr,
                  const std::string& rest =
                      "'fortran_order': False, 'shape': "
                      "(1,)") {
  return WithHeader("{'descr': " + descr + ", " + rest + ", }\n",
                    Bytes({{1, 2, 3, 4, 5}}));
}

const char kFields[] =
    "[('q1_rad', '<f8'), ('q2_m', '<f8'), ('x_m', '<f8'), ('y_m', '<f8'), "
    "('z_m', '<f8')]";

std::vector<BadFile> BadHeaders() {
  const auto of = [](const std::string& rest) { return Descr(kFields, rest); };
  return {
      {"empty", "", {0, 0, "", "not a NumPy array"}},
      {"text", "q1_rad,q2_m\n", {0, 0, "", "not a NumPy array"}},
      {"magic_alone", "\x93NUMPY", {0, 0, "", "cut off in its header"}},
      {"version_4", WithHeader("{}", "", 4), {0, 0, "", "NumPy's format 4"}},
      {"header_cut",
       of("'shape': (1,)").substr(0, 60),
       {0, 0, "", "cut off in its header"}},
      {"no_dict", WithHeader("[1]", ""), {0, 0, "", "expected '{'"}},
      {"key_missing", of("'shape': (1,)"), {0, 0, "", "each once"}},
      {"key_twice",
       of("'fortran_order': False, 'shape': (1,), 'shape': (1,)"),
       {0, 0, "", "each once"}},
      {"key_unknown",
       of("'fortran_order': False, 'size': (1,)"),
       {0, 0, "", "alone"}},
      {"fortran",
       of("'fortran_order': True, 'shape': (1,)"),
       {0, 0, "", "Fortran"}},
      {"two_dimensions",
       of("'fortran_order': False, 'shape': (1, 1)"),
       {0, 0, "", "a.ravel()"}},
      {"no_dimension",
       of("'fortran_order': False, 'shape': ()"),
       {0, 0, "", "shape ()"}},
      {"negative",
       of("'fortran_order': False, 'shape': (-1,)"),
       {0, 0, "", "a number of rows"}},
      {"huge",
       of("'fortran_order': False, 'shape': (99999999999999999999,)"),
       {0, 0, "", "a number of rows"}},
      {"cut_off",
       of("'fortran_order': False, 'shape': (999999999999999999,)"),
       {0, 0, "", "found 1"}},
      {"too_long",
       of("'fortran_order': False, 'shape': (1,)") + "x",
       {0, 0, "", "save one array"}},
      {"no_row", FormatNpyHeader(kNames, 0), {0, 0, "", "no rows"}},
      {"plain_array", Descr("'<f8'"), {0, 0, "", "np.rec.fromarrays"}},
      {"big_endian",
       Descr("[('q1_rad', '>f8')]"),
       {0, 0, "q1_rad", "big endian"}},
      {"floats", Descr("[('q1_rad', '<f4')]"), {0, 0, "q1_rad", "\"<f8\""}},
      {"nested",
       Descr("[('q1_rad', [('a', '<f8')])]"),
       {0, 0, "q1_rad", "fields of its own"}},
      {"array_field",
       Descr("[('q1_rad', '<f8', (3,))]"),
       {0, 0, "q1_rad", "holds an array"}},
      {"title", Descr("[(('a', 'q1_rad'), '<f8')]"), {0, 0, "", "title"}},
      {"no_field", Descr("[]"), {0, 0, "", "without any field"}},
      {"field_name", Descr("[('a,b', '<f8')]"), {0, 0, "", "name of a column"}},
      {"field_open", Descr("[('q1_rad', '<f8'}"), {0, 0, "", "expected ')'"}},
  };
}

std::vector<BadFile> BadContents() {
  const auto with = [](int column, double value) {
    Rows rows = {{1, 2, 3, 4, 5}, {1, 2, 3, 4, 5}};
    rows[1][column] = value;
    return Npy(kNames, rows);
  };
  const Names sigmas = {"q1_rad", "q2_m", "x_m", "std_x_m"};
  return {
      {"unknown",
       Npy({"q1_rad", "q2_m", "x_m", "std_q"}, {}),
       {0, 0, "", "unknown column \"std_q\""}},
      {"unit", Npy({"q1_mm", "q2_m", "x_m"}, {}), {0, 0, "q1_mm", "angle"}},
      {"missing", Npy({"q1_rad", "x_m"}, {}), {0, 0, "", "1 joints"}},
      {"nothing", Npy({"q1_rad", "q2_m"}, {}), {0, 0, "", "no column holds"}},
      {"repeated",
       Npy({"q1_rad", "q2_m", "x_m", "x_mm"}, {}),
       {0, 0, "x_mm", "repeated"}},
      {"target",
       Npy({"q1_rad", "q2_m", "x_m", "target"}, {}),
       {0, 0, "target", "holds text"}},
      {"nan_joint", with(0, kNan), {2, 0, "q1_rad", "finite"}},
      {"infinite_joint", with(1, -kInfinity), {2, 0, "q2_m", "-inf"}},
      {"infinite_position", with(3, kInfinity), {2, 0, "y_m", "finite"}},
      {"zero_sigma",
       Npy(sigmas, {{1, 2, 3, 0}}),
       {1, 0, "std_x_m", "above zero"}},
      {"negative_sigma",
       Npy(sigmas, {{1, 2, 3, 1}, {1, 2, 3, -1}}),
       {2, 0, "std_x_m", "above zero"}},
      {"no_sigma", Npy(sigmas, {{1, 2, 3, kNan}}), {1, 0, "std_x_m", "number"}},
      {"only_nan",
       Npy({"q1_rad", "q2_m", "x_m"}, {{1, 2, kNan}}),
       {1, 0, "", "no row holds"}},
  };
}

TEST(NpyTest, SaysWhatIsWrongWithAFile) {
  for (const std::vector<BadFile>& files : {BadHeaders(), BadContents()}) {
    for (const BadFile& file : files) {
      SCOPED_TRACE(file.name);
      ExpectInputError([&] { Load(file.bytes); }, file.error);
    }
  }
}

TEST(NpyTest, AnyBytesGiveDataOrAnInputError) {
  Random random(11);
  const auto draw = [&](std::size_t count) {
    return static_cast<std::size_t>(
        random.Uniform(0.0, static_cast<double>(count)));
  };
  const std::string good =
      Npy(kNames, {{1, 2, 3, 4, 5}, {1, 2, 3, 4, 5}, {1, 2, 3, 4, 5}});
  const std::string signs = "(){}[],:'\"<f8 0123456789\n\\\xff";
  int read = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    std::string bytes = good;
    for (std::size_t i = 0; i <= draw(3); ++i) {
      const std::size_t at = draw(trial % 2 ? bytes.size() : 140);
      const std::string part(draw(3), signs[draw(signs.size())]);
      bytes.replace(at, draw(4), part);
    }
    if (trial % 8 == 0) bytes.resize(draw(bytes.size()));
    try {
      Load(bytes);
      ++read;
    } catch (const InputError& error) {
      EXPECT_EQ(error.message().find('\n'), std::string::npos);
    }
  }
  EXPECT_GT(read, 50);
}

TEST(FormatNpyTest, CsvReadsBackFromNpyToTheSameBits) {
  const TestDirectory directory;
  Random random(5);
  std::string text = "q1_deg,q2_mm,x_mm,y_mm,z_mm,std_x_mm,std_y_mm,std_z_mm\n";
  for (int row = 0; row < 500; ++row) {
    for (int column = 0; column < 8; ++column) {
      if (column > 0) text += ",";
      if (column < 5) {
        text += ShortestNumber(AnyNumber(&random));
      } else {
        text += ShortestNumber(random.Uniform(0.01, 0.1));
      }
    }
    text += "\n";
  }
  const Arm arm = TwoJoints();
  const Dataset data =
      LoadDataset(directory.Write("data.csv", text), arm, kMillimetre);
  const Dataset array = LoadDataset(
      directory.Write("data.NPY", FormatNpy(data, arm, true)), arm, 1.0);
  ExpectSameNumbers(data, array);
  const Dataset back = LoadDataset(
      directory.Write("back.csv",
                      FormatDataset(array, arm, kFewestDigits, true, {})),
      arm, 1.0);
  ExpectSameNumbers(data, back);
}

TEST(FormatNpyTest, PosesReadBackToRoundingInTheOrderOfPoses) {
  const TestDirectory directory;
  const std::string text =
      "q1_rad,q2_m,x_m,y_m,z_m,wx_deg,wy_deg,wz_deg\n"
      "1,2,3,4,5,10,20,30\n"
      "2,2,3,,5,,,\n"
      "3,2,,4,,-170,20,30\n";
  const Arm arm = TwoJoints();
  const Dataset data =
      LoadDataset(directory.Write("data.csv", text), arm, kUnstatedSigma);
  const std::string bytes = FormatNpy(data, arm, true);
  EXPECT_EQ(bytes.find("std_"), std::string::npos);
  const Dataset array =
      LoadDataset(directory.Write("data.npy", bytes), arm, kUnstatedSigma);
  EXPECT_EQ(array.joint_values, data.joint_values);
  ASSERT_EQ(array.blocks.size(), 2u);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(array.blocks[i].poses, data.blocks[i].poses);
    EXPECT_EQ(array.blocks[i].sigmas, data.blocks[i].sigmas);
    EXPECT_TRUE(array.blocks[i].measured.map().isApprox(
        data.blocks[i].measured.map(), 1e-14));
  }
}

}  // namespace
}  // namespace alidade::internal::npy_test
