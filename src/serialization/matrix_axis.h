#ifndef ALIDADE_SRC_SERIALIZATION_MATRIX_AXIS_H_
#define ALIDADE_SRC_SERIALIZATION_MATRIX_AXIS_H_

#include <cstdint>
#include <string>
#include <vector>

#include "src/serialization/yaml_reader.h"
#include "src/serialization/yaml_tree.h"

namespace alidade::internal {

/// `text` as a part of file names everywhere: letters, digits, '.', '+', '-',
/// '_'; others become '-', as does '.' in front.
std::string NameForFiles(const std::string& text);

/// One axis of a job file's matrix. Its values set one key of the job,
///
///     measurement.sigma: [0.02, 0.05]
///     data.simulate.seed: {range: 1000}         # 1 to 1000
///
/// or each changes several, laid on the job as a file is on the one it extends:
///
///     cell: {left: {arm: l.yaml, data: l.csv}, right: {...}}
class MatrixAxis {
 public:
  /// @throws InputError with file, line, column and key.
  MatrixAxis(const std::string& name, const YamlValue& value);

  std::int64_t size() const { return size_; }
  /// The value's part of a job's name: "left", "ceres", "sigma-0.02",
  /// "seed-0017"; see NameForFiles.
  std::string NameOf(std::int64_t value) const;
  /// Changes a job of this document accordingly. @throws InputError.
  void Apply(std::int64_t value, YamlDocument* job) const;

 private:
  void ReadRange(const YamlValue& range);
  void ReadList(const YamlValue& list);
  void ReadChanges(const YamlMap& changes);
  void AddValue(const YamlValue& value, const std::string& name);
  bool sets_key() const { return is_range_ || !has_changes_; }

  std::string name_;
  YamlPlace key_place_;
  bool is_range_ = false;
  bool has_changes_ = false;
  std::int64_t size_ = 0;
  std::int64_t first_ = 0;  ///< of a range
  YamlNode place_;          ///< of a range: where its numbers stand
  std::vector<std::string> names_;
  std::vector<YamlNode> values_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_MATRIX_AXIS_H_
