// Files as instruments, controllers and spreadsheets write them, made by a
// writer of our own that knows the numbers: each is read right, or refused with
// what to state. None is misread.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/rotation.h"
#include "alidade/units.h"
#include "src/common/random.h"
#include "src/dataio/dataset_csv.h"
#include "tests/support/io_test_util.h"

namespace alidade::internal {
namespace {

constexpr int kJoints = 6;
constexpr int kRows = 30;

// What a program has chosen.
struct Style {
  std::string separator = ",";
  char decimal = '.';
  std::string thousands;
  int decimals = 4;
  std::string line_end = "\n";
  bool has_separator_line = false;
  bool has_title = false;
  std::string comment;      // on top
  std::string unit_suffix;  // "_", "[" or "("
  bool has_header = true;
  bool has_header_in_comment = false;
  bool has_unit_row = false;
  bool has_quotes = false;
  bool has_plus = false;
  bool has_counter = false;
  bool has_texts = false;
  bool has_trailing_separators = false;
  bool has_empty_rows = false;
  bool has_matrix = false;
  std::string missing;  // of the rows 7 and 19
  std::string encoding = "utf-8";
};

std::string Utf16(const std::string& text, bool is_big_endian) {
  std::string bytes;
  for (const char c : text) {  // the files are ASCII but for that
    if (!is_big_endian) bytes += c;
    bytes += '\0';
    if (is_big_endian) bytes += c;
  }
  return bytes;
}

// A number with `decimals` decimals, grouped.
std::string NumberText(double value, const Style& style) {
  char buffer[64];
  std::snprintf(buffer, sizeof(buffer), "%.*f", style.decimals,
                std::abs(value));
  std::string text = buffer;
  const std::size_t point = text.find('.');
  std::string whole = text.substr(0, point);
  const std::string rest =
      point == std::string::npos ? "" : text.substr(point + 1);
  if (!style.thousands.empty()) {
    for (int at = static_cast<int>(whole.size()) - 3; at > 0; at -= 3) {
      whole.insert(static_cast<std::size_t>(at), style.thousands);
    }
  }
  const std::string sign = value < 0.0 ? "-" : style.has_plus ? "+" : "";
  return sign + whole + (rest.empty() ? "" : style.decimal + rest);
}

struct Truth {
  Eigen::MatrixXd joints{kJoints, kRows};  // deg
  Eigen::Matrix3Xd points{3, kRows};       // mm
  std::vector<Eigen::Matrix3d> rotations;
};

double Rounded(double value, int decimals) {
  const double scale = std::pow(10.0, decimals);
  return std::round(value * scale) / scale;
}

Truth Draw(const Style& style, std::uint64_t seed) {
  Random random(seed);
  Truth truth;
  for (int i = 0; i < kRows; ++i) {
    for (int j = 0; j < kJoints; ++j) {
      truth.joints(j, i) =
          Rounded(random.Uniform(-180.0, 180.0), style.decimals);
    }
    for (int axis = 0; axis < 3; ++axis) {
      truth.points(axis, i) =
          Rounded(random.Uniform(-2500.0, 2500.0), style.decimals);
    }
    const Eigen::Vector3d angles(random.Uniform(-3.0, 3.0),
                                 random.Uniform(-1.0, 1.0),
                                 random.Uniform(-3.0, 3.0));
    truth.rotations.push_back(
        (Eigen::AngleAxisd(angles.x(), Eigen::Vector3d::UnitX()) *
         Eigen::AngleAxisd(angles.y(), Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(angles.z(), Eigen::Vector3d::UnitZ()))
            .toRotationMatrix());
  }
  return truth;
}

bool IsLost(int row) { return row == 7 || row == 19; }

class Writer {
 public:
  Writer(const Style& style, const Truth& truth)
      : style_(style), truth_(truth) {}

  std::string Text() {
    WriteTop();
    if (style_.has_header_in_comment && style_.has_header) text_ += "# ";
    if (style_.has_header) Line(Names());
    if (style_.has_unit_row) Line(Units());
    for (int i = 0; i < kRows; ++i) {
      if (style_.has_empty_rows && i % 10 == 5) {
        text_ += std::string(
                     i % 20 == 5 ? "" : style_.separator + style_.separator) +
                 style_.line_end;
      }
      Line(Row(i));
    }
    return Encoded();
  }

 private:
  using Cells = std::vector<std::string>;

  void WriteTop() {
    const std::string& end = style_.line_end;
    if (style_.has_separator_line) text_ += "sep=" + style_.separator + end;
    if (!style_.comment.empty()) text_ += style_.comment + end;
    if (!style_.has_title) return;
    text_ += "Measurement report 2026-11-29" + end + "Operator" +
             style_.separator + "A. Smith" + end + end;
  }

  Cells Names() const {
    Cells names;
    if (style_.has_counter) names.emplace_back("No");
    if (style_.has_texts) names.emplace_back("Time");
    for (int j = 1; j <= kJoints; ++j) {
      names.push_back("J" + std::to_string(j) + Suffix("deg"));
    }
    for (const char* axis : {"X", "Y", "Z"})
      names.push_back(axis + Suffix("mm"));
    for (int i = 0; style_.has_matrix && i < 9; ++i) {
      names.push_back("M" + std::to_string(11 + 10 * (i / 3) + i % 3));
    }
    if (style_.has_texts) names.emplace_back("Remark");
    return names;
  }

  std::string Suffix(const std::string& unit) const {
    if (style_.unit_suffix == "_") return "_" + unit;
    if (style_.unit_suffix == "[") return " [" + unit + "]";
    if (style_.unit_suffix == "(") return " (" + unit + ")";
    return "";
  }

  Cells Units() const {
    Cells units;
    if (style_.has_counter) units.emplace_back("");
    if (style_.has_texts) units.emplace_back("s");
    for (int j = 0; j < kJoints; ++j) units.emplace_back("deg");
    for (int axis = 0; axis < 3; ++axis) units.emplace_back("mm");
    for (int i = 0; style_.has_matrix && i < 9; ++i) units.emplace_back("-");
    if (style_.has_texts) units.emplace_back("");
    return units;
  }

  Cells Row(int i) const {
    Cells cells;
    if (style_.has_counter) cells.push_back(std::to_string(i + 1));
    if (style_.has_texts) {
      cells.push_back("12:03:" + std::to_string(10 + i));
    }
    for (int j = 0; j < kJoints; ++j) {
      cells.push_back(NumberText(truth_.joints(j, i), style_));
    }
    for (int axis = 0; axis < 3; ++axis) {
      cells.push_back(IsLost(i) ? style_.missing
                                : NumberText(truth_.points(axis, i), style_));
    }
    Style fine = style_;
    fine.decimals = 9;
    for (int k = 0; style_.has_matrix && k < 9; ++k) {
      cells.push_back(
          IsLost(i) ? style_.missing
                    : NumberText(truth_.rotations[i](k / 3, k % 3), fine));
    }
    if (style_.has_texts) cells.emplace_back(i % 2 == 0 ? "ok" : "checked");
    return cells;
  }

  void Line(const Cells& cells) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (i > 0) text_ += style_.separator;
      const bool needs_quotes =
          style_.has_quotes ||
          cells[i].find(style_.separator) != std::string::npos;
      text_ += needs_quotes ? "\"" + cells[i] + "\"" : cells[i];
    }
    if (style_.has_trailing_separators) text_ += style_.separator;
    text_ += style_.line_end;
  }

  std::string Encoded() const {
    if (style_.encoding == "bom") return "\xef\xbb\xbf" + text_;
    if (style_.encoding == "utf-16le") return "\xff\xfe" + Utf16(text_, false);
    if (style_.encoding == "utf-16be") return "\xfe\xff" + Utf16(text_, true);
    if (style_.encoding == "utf-16") return Utf16(text_, false);
    return text_;
  }

  const Style& style_;
  const Truth& truth_;
  std::string text_;
};

Arm SixJoints() {
  Arm arm;
  arm.name = "six";
  arm.joints.resize(kJoints);
  return arm;
}

// A job that names columns as the file does, and the units where it does not.
DataFormat FormatOf(const Style& style) {
  DataFormat format;
  format.ignore_others = true;
  auto name = [&,
               next = (style.has_counter ? 2 : 1) + (style.has_texts ? 1 : 0)](
                  const std::string& header) mutable {
    const std::string number = std::to_string(next++);
    return style.has_header ? header : number;
  };
  const std::string unit = style.unit_suffix == "_" ? "_deg" : "";
  const std::string length = style.unit_suffix == "_" ? "_mm" : "";
  for (int j = 1; j <= kJoints; ++j) {
    format.columns.joints.push_back(name("J" + std::to_string(j) + unit));
  }
  for (const std::string axis : {"X", "Y", "Z"}) {
    format.columns.position.push_back(name(axis + length));
  }
  for (int i = 0; style.has_matrix && i < 9; ++i) {
    format.columns.orientation.push_back(
        name("M" + std::to_string(11 + 10 * (i / 3) + i % 3)));
  }
  format.columns.length_unit = FindUnit("mm");
  format.columns.angle_unit = FindUnit("deg");
  if (style.missing == "-9999") format.dialect.missing = {style.missing};
  return format;
}

enum class Outcome { kRead, kRefused };

// Reads a file and compares every number. What is refused must be refused with
// what to state, or do.
Outcome Check(const Style& style, std::uint64_t seed, DataFormat format) {
  const TestDirectory directory;
  const Truth truth = Draw(style, seed);
  const std::string path =
      directory.Write("data.csv", Writer(style, truth).Text());
  References references;
  LoadedData loaded;
  try {
    loaded = LoadData(path, SixJoints(), format, &references);
  } catch (const InputError& error) {
    const std::string what = error.what();
    EXPECT_TRUE(what.find("in the job's `data`") != std::string::npos ||
                what.find("expected") != std::string::npos)
        << what;
    return Outcome::kRefused;
  }
  const Dataset& data = loaded.data;
  EXPECT_EQ(data.num_poses(), kRows - 2);
  EXPECT_EQ(loaded.rejected.size(), 2u);
  if (data.num_poses() != kRows - 2) return Outcome::kRead;
  const ObservationBlock& block = data.blocks.front();
  int at = 0;
  for (int i = 0; i < kRows; ++i) {
    if (IsLost(i)) continue;
    for (int j = 0; j < kJoints; ++j) {
      EXPECT_NEAR(data.joint_values(j, at), truth.joints(j, i) * kDegree, 1e-12)
          << "row " << i << ", joint " << j;
    }
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(block.measured(axis, at), truth.points(axis, i) * 1e-3, 1e-12)
          << "row " << i << ", axis " << axis;
    }
    if (style.has_matrix) {
      // Nine numbers are written to so many decimals.
      const Eigen::Matrix3d read = RotationFromVector<double>(
          Eigen::Vector3d(block.measured.col(at).tail<3>()));
      EXPECT_LT((read - truth.rotations[i]).norm(), 1e-8) << "row " << i;
    }
    ++at;
  }
  return Outcome::kRead;
}

struct Property {
  const char* name;
  std::function<void(Style*)> apply;
};

std::vector<Property> Properties() {
  return {
      {"Semicolons", [](Style* s) { s->separator = ";"; }},
      {"Tabs", [](Style* s) { s->separator = "\t"; }},
      {"Bars", [](Style* s) { s->separator = "|"; }},
      {"Blanks",
       [](Style* s) {
         s->separator = " ";
         s->has_separator_line = false;
         if (s->missing.empty()) s->missing = "nan";
       }},
      {"DecimalCommas",
       [](Style* s) {
         if (s->separator == ",") s->separator = ";";
         s->decimal = ',';
         if (s->thousands == ",") s->thousands = ".";
       }},
      {"ThousandsByTheOtherMark",
       [](Style* s) { s->thousands = s->decimal == ',' ? "." : ","; }},
      {"ThousandsByBlanks",
       [](Style* s) {
         if (s->separator == ",") s->separator = ";";
         s->thousands = " ";
       }},
      {"ThousandsByApostrophes", [](Style* s) { s->thousands = "'"; }},
      {"ThreeDecimals", [](Style* s) { s->decimals = 3; }},
      {"ByteOrderMark", [](Style* s) { s->encoding = "bom"; }},
      {"Utf16", [](Style* s) { s->encoding = "utf-16le"; }},
      {"Utf16BigEndian", [](Style* s) { s->encoding = "utf-16be"; }},
      {"Utf16WithoutMark", [](Style* s) { s->encoding = "utf-16"; }},
      {"WindowsLines", [](Style* s) { s->line_end = "\r\n"; }},
      {"OldMacLines", [](Style* s) { s->line_end = "\r"; }},
      {"SeparatorLine",
       [](Style* s) {
         if (s->separator == " ") s->separator = ",";
         s->has_separator_line = true;
       }},
      {"Title", [](Style* s) { s->has_title = true; }},
      {"SlashComments",
       [](Style* s) { s->comment = "// SA 2021.1, X Y Z mm"; }},
      {"PercentComments", [](Style* s) { s->comment = "% exported"; }},
      {"UnitsInNames", [](Style* s) { s->unit_suffix = "_"; }},
      {"UnitsInBrackets", [](Style* s) { s->unit_suffix = "["; }},
      {"UnitRow", [](Style* s) { s->has_unit_row = true; }},
      {"NoHeader",
       [](Style* s) {
         s->has_header = false;
         s->has_unit_row = false;
       }},
      {"HeaderInComment",
       [](Style* s) {
         s->has_header_in_comment = s->has_header && !s->has_quotes;
       }},
      {"Quotes", [](Style* s) { s->has_quotes = !s->has_header_in_comment; }},
      {"PlusSigns", [](Style* s) { s->has_plus = true; }},
      {"Counter", [](Style* s) { s->has_counter = true; }},
      {"Texts", [](Style* s) { s->has_texts = true; }},
      {"TrailingSeparators",
       [](Style* s) { s->has_trailing_separators = true; }},
      {"EmptyRows", [](Style* s) { s->has_empty_rows = true; }},
      {"NotAvailable", [](Style* s) { s->missing = "#N/A"; }},
      {"Dashes", [](Style* s) { s->missing = "---"; }},
      {"Null", [](Style* s) { s->missing = "null"; }},
      {"StatedNumber", [](Style* s) { s->missing = "-9999"; }},
      {"Matrix", [](Style* s) { s->has_matrix = true; }},
  };
}

class ForeignFileTest : public ::testing::TestWithParam<std::size_t> {};

TEST_P(ForeignFileTest, IsReadRight) {
  Style style;
  Properties()[GetParam()].apply(&style);
  EXPECT_EQ(Check(style, GetParam() + 1, FormatOf(style)), Outcome::kRead);
}

INSTANTIATE_TEST_SUITE_P(One, ForeignFileTest,
                         ::testing::Range(std::size_t{0}, Properties().size()),
                         [](const auto& test) {
                           return std::string(Properties()[test.param].name);
                         });

// Every pair of properties, in both orders where one depends on the other.
TEST(ForeignFilesTest, PairsAreReadRightOrRefused) {
  const std::vector<Property> all = Properties();
  int count = 0;
  int refused = 0;
  for (std::size_t a = 0; a < all.size(); ++a) {
    for (std::size_t b = 0; b < all.size(); ++b) {
      if (a == b) continue;
      SCOPED_TRACE(std::string(all[a].name) + " and " + all[b].name);
      Style style;
      all[a].apply(&style);
      all[b].apply(&style);
      const Outcome outcome = Check(style, 100 * a + b, FormatOf(style));
      ++count;
      if (outcome == Outcome::kRead) continue;
      ++refused;
      ADD_FAILURE() << "refused";
    }
  }
  EXPECT_GT(count, 1000);
  EXPECT_EQ(refused, 0);
}

// Five properties at once, drawn: what a shop floor comes up with.
TEST(ForeignFilesTest, ManyPropertiesAreReadRightOrRefused) {
  const std::vector<Property> all = Properties();
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Random random(seed);
    Style style;
    std::string names;
    for (int k = 0; k < 5; ++k) {
      const auto i = static_cast<std::size_t>(
          random.Uniform(0.0, static_cast<double>(all.size())));
      all[i].apply(&style);
      names += std::string(" ") + all[i].name;
    }
    SCOPED_TRACE(names);
    Check(style, seed, FormatOf(style));
  }
}

}  // namespace
}  // namespace alidade::internal
