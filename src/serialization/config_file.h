#ifndef ALIDADE_SRC_SERIALIZATION_CONFIG_FILE_H_
#define ALIDADE_SRC_SERIALIZATION_CONFIG_FILE_H_

#include <Eigen/Core>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "alidade/arm.h"
#include "alidade/error.h"
#include "alidade/parameter_layout.h"
#include "src/common/files.h"
#include "src/serialization/field_records.h"
#include "src/serialization/yaml_reader.h"

namespace alidade::internal {

/// What a YAML file says it is in its `format` key.
enum class FileFormat { kArm, kDeviations, kJob, kSimulation, kPlan };

template <>
inline constexpr std::array kWords<FileFormat> = {
    std::pair{FileFormat::kArm, "alidade-arm-1"},
    std::pair{FileFormat::kDeviations, "alidade-deviations-1"},
    std::pair{FileFormat::kJob, "alidade-job-2"},
    std::pair{FileFormat::kJob, "alidade-job-1"},
    std::pair{FileFormat::kSimulation, "alidade-simulation-1"},
    std::pair{FileFormat::kPlan, "alidade-plan-1"},
};

/// @throws InputError where the file is no YAML map or its format is unknown.
FileFormat DetectFormat(const std::string& path);

/// @throws InputError where the file's `format` is not the expected one.
void RequireFormat(const YamlValue& root, FileFormat expected);

/// The root of a YAML text whose `format` is the expected one; `path` is for
/// messages, and what paths in it are relative to. @throws InputError.
YamlValue ParseConfig(const std::string& text, const std::string& path,
                      FileFormat expected);

/// The same of a file. @throws InputError.
YamlValue ReadConfigFile(const std::string& path, FileFormat expected);

/// The first keys of every file.
template <typename Visitor>
void VisitHead(Visitor& v, FileFormat format) {
  v.Custom(Key("format").Required().Schema(kTextSchema),
           format == FileFormat::kJob
               ? "`alidade-job-2`; `alidade-job-1` is the same, but that "
                 "`errors` is `none` where it is left out"
               : WordOf(format),
           ReadElsewhere);
  v.Custom(
      Key("units").Required().Schema(
          R"({"type": "object", "properties": {"length": {"enum": ["mm", "m", "um"]}, "angle": {"enum": ["deg", "rad", "mrad"]}}, "required": ["length", "angle"], "additionalProperties": false})"),
      "of all numbers", ReadElsewhere);
}

/// Reads a whole YAML file by the description of its fields.
template <typename Visit>
void ReadConfig(const YamlValue& root, const Visit& visit) {
  ReadFields(root, Units(MapOf(root, visit)), visit);
}

/// One quantity of every joint; `what` describes the list. @throws InputError.
Eigen::VectorXd ReadJointQuantities(const YamlValue& value, const Units& units,
                                    const Arm& arm, const std::string& what);

inline constexpr char kIntervalSchema[] =
    R"({"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2})";

/// [lower, upper]. @throws InputError.
std::pair<double, double> ReadInterval(const YamlValue& value,
                                       Dimension dimension, const Units& units);

/// The names of all parameters of the layout.
std::vector<std::string> NamesOf(const ParameterLayout& layout);

/// A map from parameter names to deviations: one entry per column of the layout
/// of the arm alone, zero where the map names none. @throws InputError.
Eigen::VectorXd ReadDeviations(const YamlValue& value, const Units& units,
                               const Arm& arm);

/// Reads the files that a config file names, and remembers them. Errors in them
/// say which key named them, and which arm they are read for.
class NamedFiles {
 public:
  explicit NamedFiles(const std::string& config_path) : paths_{config_path} {}
  /// Of a config file that is put together from several.
  explicit NamedFiles(const YamlDocument& config) : paths_(config.files) {}

  /// The path that `value` names, relative to the file that it stands in.
  /// "${NAME}" at its beginning stands for an environment variable, for data
  /// that are not kept with their job. @throws InputError where the variable is
  /// not set.
  static std::string Resolve(const YamlValue& value) {
    return ResolvePath(value.location().file, ExpandVariable(value));
  }

  /// load(path) of the path that `value` names. @throws InputError.
  template <typename Load>
  auto Read(const YamlValue& value, const Load& load) {
    return ReadPath(Resolve(value), value, load);
  }

  /// The paths of all files that `value` names, as ReadEach takes them.
  /// @throws InputError where there is none.
  static std::vector<std::string> PathsOf(const YamlValue& value);

  /// load(path) of every file that `value` names: one, or all that the '*' in
  /// its name stands for, in the order of their names. @throws InputError, also
  /// where there is none.
  template <typename Load>
  void ReadEach(const YamlValue& value, const Load& load) {
    for (const std::string& path : PathsOf(value)) ReadPath(path, value, load);
  }

  /// The arm that `value` names, and the files that it names; `load` is LoadArm
  /// (arm_file.h), which reads its files by this class. @throws InputError.
  Arm ReadArm(const YamlValue& value,
              Arm (*load)(const std::string& path,
                          std::vector<std::string>* input_files));

  /// The joint values of the data set that `value` names. @throws InputError.
  Eigen::MatrixXd ReadJointValues(const YamlValue& value, const Arm& arm);

  /// Every file read so far, the config file first, each once.
  const std::vector<std::string>& paths() const { return paths_; }

 private:
  template <typename Load>
  auto ReadPath(const std::string& path, const YamlValue& value,
                const Load& load) {
    Remember(path);
    try {
      return load(path);
    } catch (const InputError& error) {
      throw Explain(error, value);
    }
  }
  void Remember(const std::string& path);
  static std::string ExpandVariable(const YamlValue& value);
  InputError Explain(const InputError& error, const YamlValue& value) const;

  std::string arm_path_;
  std::vector<std::string> paths_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_CONFIG_FILE_H_
