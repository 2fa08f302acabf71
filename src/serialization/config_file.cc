#include "src/serialization/config_file.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "src/common/names.h"
#include "src/dataio/dataset_csv.h"
#include "src/dataio/file_pattern.h"
#include "src/serialization/result_json.h"
#include "src/serialization/robot_files.h"
#include "src/serialization/ur_kinematics.h"

namespace alidade::internal {
namespace {

YamlValue FormatEntry(const YamlValue& root) {
  const std::optional<YamlValue> entry = root.Find("format");
  if (!entry) {
    root.Fail("expected a map with the key \"format\", one of " +
              JoinNames(WordsOf<FileFormat>()));
  }
  return *entry;
}

// What reads a file that is none of the kind asked for.
std::string ReaderOf(FileFormat format) {
  switch (format) {
    case FileFormat::kArm:
      return "";
    case FileFormat::kDeviations:
      return ": deviations are named by jobs (`truth`) and simulations";
    case FileFormat::kJob:
      return ": `alidade calibrate` takes jobs";
    case FileFormat::kSimulation:
      return ": `alidade simulate` takes simulations";
    case FileFormat::kPlan:
      return ": `alidade plan` takes plans";
  }
  return "";
}

FileFormat ReadFormat(const YamlValue& root) {
  if (IsUrKinematics(root)) return FileFormat::kArm;
  const YamlValue entry = FormatEntry(root);
  if (entry.Text() == kResultFormat) {
    entry.Fail(
        "is the result of a job, expected a file that is written by hand: "
        "`alidade show`, `validate` and `report` take results");
  }
  if (entry.Text() == kPlanResultFormat) {
    entry.Fail(kPlanResultIsForMachines);
  }
  return ValueOf<FileFormat>(entry.Choice("format", WordsOf<FileFormat>()));
}

std::string PlaceName(const SourceLocation& location) {
  return location.file + ":" + std::to_string(location.line) + ": " +
         location.key;
}

}  // namespace

FileFormat DetectFormat(const std::string& path) {
  RefuseBareName(path, path, {});
  return ReadFormat(ReadYaml(path));
}

void RequireFormat(const YamlValue& root, FileFormat expected) {
  const FileFormat format = ReadFormat(root);
  if (format == expected) return;
  FormatEntry(root).Fail("found " + Quote(FormatEntry(root).Text()) +
                         ", expected " + Quote(WordOf(expected)) + " here" +
                         ReaderOf(format));
}

YamlValue ParseConfig(const std::string& text, const std::string& path,
                      FileFormat expected) {
  YamlValue root = ParseYaml(text, path);
  RequireFormat(root, expected);
  return root;
}

YamlValue ReadConfigFile(const std::string& path, FileFormat expected) {
  return ParseConfig(ReadFile(path), path, expected);
}

Eigen::VectorXd ReadJointQuantities(const YamlValue& value, const Units& units,
                                    const Arm& arm, const std::string& what) {
  const std::vector<YamlValue> items = value.List(arm.joints.size(), what);
  Eigen::VectorXd quantities(arm.num_joints());
  for (int j = 0; j < arm.num_joints(); ++j) {
    quantities[j] = items[j].Quantity(arm.joints[j].dimension(), units);
  }
  return quantities;
}

std::pair<double, double> ReadInterval(const YamlValue& value,
                                       Dimension dimension,
                                       const Units& units) {
  const std::vector<YamlValue> ends = value.List(2, "lower, upper");
  const double lower = ends[0].Quantity(dimension, units);
  const double upper = ends[1].Quantity(dimension, units);
  if (lower > upper) {
    value.Fail("expected [lower, upper] with lower not above upper, found [" +
               ends[0].Text() + ", " + ends[1].Text() + "]");
  }
  return {lower, upper};
}

std::vector<std::string> NamesOf(const ParameterLayout& layout) {
  std::vector<std::string> names;
  for (const Parameter& parameter : layout.parameters()) {
    names.push_back(parameter.name);
  }
  return names;
}

Eigen::VectorXd ReadDeviations(const YamlValue& value, const Units& units,
                               const Arm& arm) {
  const ParameterLayout layout(arm);
  Eigen::VectorXd deviations = Eigen::VectorXd::Zero(layout.size());
  const YamlMap map = value.Map(NamesOf(layout));
  for (const auto& [name, deviation] : map.entries()) {
    const int column = layout.Find(name).value();
    const Dimension dimension = layout.parameter(column).dimension;
    deviations[column] = deviation.Quantity(dimension, units);
  }
  return deviations;
}

Arm NamedFiles::ReadArm(const YamlValue& value,
                        Arm (*load)(const std::string& path,
                                    std::vector<std::string>* input_files)) {
  RefuseBareName(value.Text(), Resolve(value), value.location());
  const std::string arm_path =
      ArmPath(value.Text(), Resolve(value), value.location());
  std::vector<std::string> named;
  Arm arm = ReadPath(arm_path, value, [&](const std::string& path) {
    return load(path, &named);
  });
  for (const std::string& path : named) Remember(path);
  arm_path_ = arm_path;
  return arm;
}

Eigen::MatrixXd NamedFiles::ReadJointValues(const YamlValue& value,
                                            const Arm& arm) {
  return Read(value, [&](const std::string& path) {
    return LoadJointValues(path, arm);
  });
}

void NamedFiles::Remember(const std::string& path) {
  if (std::find(paths_.begin(), paths_.end(), path) != paths_.end()) return;
  paths_.push_back(path);
}

std::vector<std::string> NamedFiles::PathsOf(const YamlValue& value) {
  const std::string path = Resolve(value);
  if (!IsPattern(path)) return {path};
  std::vector<std::string> found = MatchingFiles(path);
  if (found.empty()) {
    value.Fail("no file matches " + path +
               ", expected one or more; '*' stands for any characters of a "
               "file's name, not of a folder's");
  }
  return found;
}

std::string NamedFiles::ExpandVariable(const YamlValue& value) {
  std::string text = value.Text();
  if (text.rfind("${", 0) != 0) return text;
  const std::size_t end = text.find('}');
  if (end == std::string::npos) {
    value.Fail("\"${\" without \"}\", expected ${NAME}/path");
  }
  const std::string name = text.substr(2, end - 2);
  const char* const expansion = std::getenv(name.c_str());
  if (expansion == nullptr) {
    value.Fail("the environment variable " + Quote(name) +
               " is not set, expected it to hold a directory");
  }
  return expansion + text.substr(end + 1);
}

// A file that cannot be read at all is wrong at the key that names it; an error
// inside it stays where it is.
InputError NamedFiles::Explain(const InputError& error,
                               const YamlValue& value) const {
  const SourceLocation named_at = value.location();
  if (error.location().line == 0) {
    return InputError(named_at, error.location().file + ": " + error.message());
  }
  std::string message = error.message() + " (named in " + PlaceName(named_at);
  if (!arm_path_.empty()) message += ", for the arm of " + arm_path_;
  return InputError(error.location(), message + ")");
}

}  // namespace alidade::internal
