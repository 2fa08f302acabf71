// Every key of every format, misspelt, of the wrong type and out of its range:
// made from the descriptions of fields, so that a new one is tested as well.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "alidade/arm_file.h"
#include "alidade/error.h"
#include "src/serialization/job_config.h"
#include "src/serialization/plan_file.h"
#include "src/serialization/simulation_file.h"
#include "tests/serialization/described_formats.h"
#include "tests/support/config_files.h"
#include "tests/support/io_test_util.h"

namespace alidade::internal {
namespace {

using testing::Kind;

// Values of keys whose type does not say what would do. Units are mm and deg.
const std::map<std::string, std::string>& KnownValues() {
  static const auto* const values = new std::map<std::string, std::string>{
      {"units", "{length: mm, angle: deg}"},
      {"arm", "arm.yaml"},
      {"joints", "[{type: revolute}, {type: revolute}]"},
      {"data", "data.csv"},
      {"file", "data.csv"},
      {"deviations", "{}"},
      {"between", "[A, B]"},
      {"normal", "[0, 0, 1]"},
      {"point", "[0, 0, 0]"},
      {"instrument", "[0, 0, 0]"},
      {"x", "[0, 1]"},
      {"y", "[0, 1]"},
      {"z", "[0, 1]"},
      {"elevation", "[0, 1]"},
      {"start", "[0, 100]"},
      {"first", "0"},
      {"spacing", "1"},
      {"values", "[1, 2]"},
      {"output", "out.csv"},
      {"sigma", "1"},
      {"name", "A"}};
  return *values;
}

// What a map needs besides its required keys, where there is a choice.
std::string ChoiceAmong(const std::vector<FieldRecord>& fields) {
  for (const FieldRecord& field : fields) {
    const std::string name = field.key.name;
    if (name == "random") return "random: {count: 5}, ";
    if (name == "accuracy") return "count: 5, ";
  }
  return "";
}

// That choice beside a key that may be one of its own.
std::string ChoiceBeside(const std::string& name,
                         const std::vector<FieldRecord>& fields) {
  if (name == "most") return "accuracy: 1, ";
  for (const char* one : {"cylinder", "random", "file", "count", "accuracy"}) {
    if (name == one) return "";
  }
  return ChoiceAmong(fields);
}

// A place in a text that is being put together.
struct Text {
  std::string text;
  std::size_t bad_at = 0;  ///< of what is wrong
};

struct FieldCase {
  std::string format;
  std::vector<const FieldRecord*> path;
};

std::string SampleOf(const FieldRecord& field, const std::string& format);

std::string SampleNumber(const Key& key) {
  if (key.Allows(1.0)) return "1";
  return key.Allows(2.0) ? "2" : "0.05";
}

// The required keys of a map but one.
std::string RequiredBut(const std::vector<FieldRecord>& fields,
                        const std::string& name, const std::string& format) {
  std::string text;
  for (const FieldRecord& field : fields) {
    if (!field.key.is_required || field.key.name == name) continue;
    text += std::string(field.key.name) + ": " + SampleOf(field, format) + ", ";
  }
  return text;
}

std::string SampleOf(const FieldRecord& field, const std::string& format) {
  if (std::string(field.key.name) == "format") {
    // The first of the words that the format may be.
    const std::size_t begin = field.text.find('`') == 0 ? 1 : 0;
    return field.text.substr(begin, field.text.find('`', begin) - begin);
  }
  const auto known = KnownValues().find(field.key.name);
  if (known != KnownValues().end() && field.kind != Kind::kSection) {
    return known->second;
  }
  switch (field.kind) {
    case Kind::kNumber:
    case Kind::kInteger:
      return SampleNumber(field.key);
    case Kind::kBoolean:
      return "true";
    case Kind::kWord:
      return field.words.front();
    case Kind::kSection:
      return "{" + RequiredBut(field.fields, "", format) +
             ChoiceAmong(field.fields) + "}";
    default:
      return "a text";
  }
}

// What a file is to say of the last field of a path.
struct Entry {
  std::string key;
  std::string value;
  bool key_is_bad;
};

// The entry within the fields of the path from `depth` on, of a map of
// `siblings`.
Text MapAround(const FieldCase& one, std::size_t depth,
               const std::vector<FieldRecord>& siblings, const Entry& entry) {
  const FieldRecord& field = *one.path[depth];
  const std::string before = RequiredBut(siblings, field.key.name, one.format) +
                             ChoiceBeside(field.key.name, siblings);
  if (depth + 1 == one.path.size()) {
    return {before + entry.key + ": " + entry.value,
            before.size() + (entry.key_is_bad ? 0 : entry.key.size() + 2)};
  }
  const Text inner = MapAround(one, depth + 1, field.fields, entry);
  const bool is_list = field.kind == Kind::kItems;
  const std::string opening =
      before + field.key.name + ": " + (is_list ? "[{" : "{");
  return {opening + inner.text + (is_list ? "}]" : "}"),
          opening.size() + inner.bad_at};
}

class FieldErrors {
 public:
  FieldErrors() {
    directory_.Write("arm.yaml", kArmText);
    directory_.Write("data.csv", kDataText);
  }

  // Puts the entry into a file that is right without it, each top-level key on
  // a line of its own.
  void Expect(const FieldCase& one, const Entry& entry,
              const std::string& message) {
    const Text text = MapAround(one, 0, {}, entry);
    const std::string before = OtherLines(one);
    const auto line = 1 + std::count(before.begin(), before.end(), '\n');
    const auto column = static_cast<int>(text.bad_at) + 1;
    SCOPED_TRACE(before + text.text);
    ++num_errors_;
    try {
      Load(one.format, before + text.text + "\n");
      ADD_FAILURE() << "no error";
    } catch (const InputError& error) {
      const SourceLocation& location = error.location();
      EXPECT_EQ(location.line, line) << error.what();
      if (entry.key_is_bad) {
        EXPECT_EQ(location.column, column) << error.what();
      } else {
        EXPECT_GE(location.column, column) << error.what();
      }
      EXPECT_EQ(location.key.find(PathOf(one, entry.key)), 0U) << error.what();
      EXPECT_NE(error.message().find(message), std::string::npos)
          << error.what();
    }
  }

  int num_errors() const { return num_errors_; }

 private:
  // What the file has to say besides the path's first key.
  static std::string OtherLines(const FieldCase& one) {
    const std::string first = one.path.front()->key.name;
    std::string lines;
    // The key of a joint that the convention by default does not have.
    if (one.path.back()->key.name == std::string("a")) {
      lines = "convention: craig\n";
    }
    for (const FieldRecord& field : FieldsAt(one.format)) {
      const std::string name = field.key.name;
      // A plan needs an arm or a job that has one, an arm joints or a URDF.
      const bool is_needed =
          field.key.is_required ||
          (one.format == "plan" && name == "arm" && first != "job") ||
          (name == "joints" && first != "urdf");
      if (!is_needed || name == first) continue;
      lines += name + ": " + SampleOf(field, one.format) + "\n";
    }
    return lines;
  }

  static std::string PathOf(const FieldCase& one, const std::string& key) {
    std::string path;
    for (std::size_t i = 0; i + 1 < one.path.size(); ++i) {
      path += one.path[i]->key.name;
      path += one.path[i]->kind == Kind::kItems ? "[1]." : ".";
    }
    return path + key;
  }

  void Load(const std::string& format, const std::string& text) {
    const std::string path = directory_.Write(format + "_case.yaml", text);
    if (format == "arm") LoadArm(path);
    if (format == "deviations") {
      LoadDeviations(path, LoadArm(directory_.Path("arm.yaml")));
    }
    if (format == "job") LoadJob(path);
    if (format == "plan") LoadPlan(path);
    if (format == "simulation") LoadSimulation(path);
  }

  TestDirectory directory_;
  int num_errors_ = 0;
};

// A value of another type than the field's.
std::string WrongType(const FieldRecord& field) {
  switch (field.kind) {
    case Kind::kSection:
    case Kind::kItems:
      return "3";
    case Kind::kCustom: {
      const std::string schema = field.key.schema;
      if (schema.rfind(R"({"anyOf")", 0) == 0 || schema[2] == '$') {
        return "{nothing: 1}";
      }
      const bool is_scalar = schema.find("string\"") == 10 ||
                             schema.find("number\"") == 10 ||
                             schema.rfind(R"({"type": [)", 0) == 0 ||
                             schema.rfind(R"({"enum)", 0) == 0;
      return is_scalar ? "[3]" : "3";
    }
    default:
      return "[3]";
  }
}

std::string InFileUnits(const Key& key, double value) {
  double shown = value;
  if (key.dimension) {
    shown /= *key.dimension == Dimension::kLength ? kMillimetre : kDegree;
  }
  std::ostringstream text;
  text << std::setprecision(17) << shown;
  return text.str();
}

void ExpectErrors(const FieldCase& one, FieldErrors* errors) {
  const FieldRecord& field = *one.path.back();
  const Key& key = field.key;
  const std::string name = key.name;
  errors->Expect(one, {name + "x", SampleOf(field, one.format), true},
                 "unknown key \"" + name + "x\"");
  errors->Expect(one, {name, WrongType(field), false}, "");
  if (field.kind == Kind::kWord) {
    errors->Expect(one, {name, "nonsense", false},
                   "\"nonsense\", expected one of");
  }
  if (field.kind != Kind::kNumber && field.kind != Kind::kInteger) return;
  const double step = 1.0;
  if (std::isfinite(key.lower)) {
    const double value = key.excludes_lower ? key.lower : key.lower - step;
    errors->Expect(one, {name, InFileUnits(key, value), false}, "expected a");
  }
  if (std::isfinite(key.upper)) {
    const double value = key.excludes_upper ? key.upper : key.upper + step;
    errors->Expect(one, {name, InFileUnits(key, value), false}, "expected a");
  }
}

// Those of `fields` and of all maps below.
void ExpectErrorsOfAll(const std::vector<FieldRecord>& fields,
                       const FieldCase& parent, FieldErrors* errors) {
  for (const FieldRecord& field : fields) {
    // Without its format nothing is known of a file.
    if (std::string(field.key.name) == "format") continue;
    FieldCase one = parent;
    one.path.push_back(&field);
    ExpectErrors(one, errors);
    ExpectErrorsOfAll(field.fields, one, errors);
  }
}

TEST(FieldErrorsTest, OfArms) {
  FieldErrors errors;
  ExpectErrorsOfAll(FieldsAt("arm"), {"arm", {}}, &errors);
  EXPECT_GT(errors.num_errors(), 80);
}

TEST(FieldErrorsTest, OfDeviations) {
  FieldErrors errors;
  ExpectErrorsOfAll(FieldsAt("deviations"), {"deviations", {}}, &errors);
  EXPECT_EQ(errors.num_errors(), 4);
}

TEST(FieldErrorsTest, OfJobs) {
  FieldErrors errors;
  ExpectErrorsOfAll(FieldsAt("job"), {"job", {}}, &errors);
  EXPECT_GT(errors.num_errors(), 200);
}

TEST(FieldErrorsTest, OfPlans) {
  FieldErrors errors;
  ExpectErrorsOfAll(FieldsAt("plan"), {"plan", {}}, &errors);
  EXPECT_GT(errors.num_errors(), 150);
}

TEST(FieldErrorsTest, OfSimulations) {
  FieldErrors errors;
  ExpectErrorsOfAll(FieldsAt("simulation"), {"simulation", {}}, &errors);
  EXPECT_GT(errors.num_errors(), 50);
}

// The maps of a job's data stand for one of its fields.
void ExpectErrorsOfData(const std::string& name,
                        std::vector<FieldRecord> fields) {
  FieldRecord data = {Key("data").Required(), "", Kind::kSection, ""};
  if (name == "simulate") {
    data.fields = {{Key("simulate").Required(),
                    "",
                    Kind::kSection,
                    "",
                    {},
                    std::move(fields)}};
  } else {
    data.fields = std::move(fields);
  }
  FieldErrors errors;
  FieldCase parent = {"job", {&data}};
  if (name == "simulate") parent.path.push_back(data.fields.data());
  ExpectErrorsOfAll(parent.path.back()->fields, parent, &errors);
  EXPECT_GT(errors.num_errors(), 40);
}

TEST(FieldErrorsTest, OfData) { ExpectErrorsOfData("data", DataFields()); }

TEST(FieldErrorsTest, OfSimulatedData) {
  ExpectErrorsOfData("simulate", SimulatedDataFields());
}

}  // namespace
}  // namespace alidade::internal
