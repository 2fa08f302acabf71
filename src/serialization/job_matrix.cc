#include "src/serialization/job_matrix.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "src/common/files.h"
#include "src/common/names.h"
#include "src/common/numbers.h"
#include "src/dataio/file_pattern.h"
#include "src/serialization/config_file.h"
#include "src/serialization/job_config.h"
#include "src/serialization/job_tree.h"
#include "src/serialization/yaml_reader.h"

namespace alidade::internal {

namespace {

constexpr std::int64_t kMaxJobs = 1000000;

// `text` as a part of file names everywhere: letters, digits, '.', '+', '-',
// '_'; others become '-', as does '.' in front.
std::string NameForFiles(const std::string& text) {
  std::string name;
  for (const char c : text) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                          (c >= '0' && c <= '9') || c == '.' || c == '+' ||
                          c == '-' || c == '_';
    name += is_plain ? c : '-';
  }
  if (!name.empty() && name.front() == '.') name.front() = '-';
  return name;
}

// Keys of a job that a matrix may change: not what the file is, nor what its
// numbers mean.
std::vector<std::string> ChangeableKeys() {
  std::vector<std::string> keys = JobKeys();
  const auto is_fixed = [](const std::string& key) {
    return key == "format" || key == "units";
  };
  keys.erase(std::remove_if(keys.begin(), keys.end(), is_fixed), keys.end());
  return keys;
}

void CheckKey(const YamlValue& value, const std::string& key) {
  const std::vector<std::string> keys = ChangeableKeys();
  if (std::find(keys.begin(), keys.end(), key) != keys.end()) return;
  value.Fail(UnknownName("key", key, keys));
}

std::string LastPart(const std::string& path) {
  return path.substr(path.rfind('.') + 1);
}

bool IsPath(const std::string& text) {
  if (text.find('/') != std::string::npos) return true;
  const std::string ending = std::filesystem::path(text).extension().string();
  return ending == ".yaml" || ending == ".yml" || ending == ".csv" ||
         ending == ".npy";
}

// Of a single value in a list: files by their names, numbers by what they are.
std::string ValueName(const std::string& axis, const std::string& text) {
  if (IsPath(text)) {
    return NameForFiles(std::filesystem::path(text).stem().string());
  }
  const bool is_word =
      !text.empty() && !ParseNumber(text) && text != "true" && text != "false";
  return NameForFiles(is_word ? text : LastPart(axis) + "-" + text);
}

}  // namespace

// One axis of a job file's matrix. Its values set one key of the job,
//
//     measurement.sigma: [0.02, 0.05]
//     data.simulate.seed: {range: 1000}         # 1 to 1000
//
// or each changes several, laid on the job as a file is on the one it extends:
//
//     cell: {left: {arm: l.yaml, data: l.csv}, right: {...}}
struct MatrixAxis {
  std::int64_t size = 0;
  // The value's part of a job's name: "left", "ceres", "sigma-0.02",
  // "seed-0017"; see NameForFiles.
  std::function<std::string(std::int64_t value)> name_of;
  // Changes a job of this document accordingly. Throws InputError.
  std::function<void(std::int64_t value, YamlDocument* job)> apply;
};

namespace {

MatrixAxis RangeAxis(const std::string& key, const YamlValue& range,
                     const YamlPlace& key_place) {
  constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();
  std::int64_t first = 1;
  std::int64_t last = 0;
  if (range.IsList()) {
    const std::vector<YamlValue> ends = range.List(2, "first, last");
    first = ends[0].Integer(0, kMax);
    last = ends[1].Integer(first, kMax);
  } else {
    last = range.Integer(1, kMaxJobs);
  }
  if (last - first >= kMaxJobs) {
    range.Fail("expected at most " + std::to_string(kMaxJobs) + " values");
  }
  YamlNode node = range.node();
  node.kind = YamlNode::Kind::kScalar;
  node.items.clear();
  node.quoted = false;
  node.key_place = key_place;
  // As many digits as the last one has: in the order of numbers when sorted.
  const std::size_t width = std::to_string(last).size();
  const auto name_of = [first, width, key](std::int64_t value) {
    const std::string number = std::to_string(first + value);
    return NameForFiles(LastPart(key)) + "-" +
           std::string(width - number.size(), '0') + number;
  };
  const auto apply = [first, node, key](std::int64_t value, YamlDocument* job) {
    YamlNode number = node;
    number.text = std::to_string(first + value);
    SetAt(key, number, &job->root);
  };
  return {last - first + 1, name_of, apply};
}

// Values that are listed one by one, and their parts of names.
class ListedValues {
 public:
  explicit ListedValues(const YamlPlace& key_place) : key_place_(key_place) {}

  void Add(const YamlValue& value, const std::string& name) {
    if (std::find(names_.begin(), names_.end(), name) != names_.end()) {
      value.Fail("a second value is called " + Quote(name) +
                 " in names of jobs, expected different ones: a map from names "
                 "to what each changes gives them names of your choice");
    }
    names_.push_back(name);
    nodes_.push_back(value.node());
    nodes_.back().key_place = key_place_;
  }

  template <typename Apply>
  MatrixAxis Take(const Apply& apply) && {
    const auto size = static_cast<std::int64_t>(names_.size());
    return {size,
            [names = std::move(names_)](std::int64_t k) { return names[k]; },
            [nodes = std::move(nodes_), apply](
                std::int64_t k, YamlDocument* job) { apply(nodes[k], job); }};
  }

 private:
  YamlPlace key_place_;
  std::vector<std::string> names_;
  std::vector<YamlNode> nodes_;
};

MatrixAxis MakeAxis(const std::string& key, const YamlValue& value) {
  MatrixAxis axis;
  const YamlPlace& key_place = value.node().key_place;
  const std::optional<YamlValue> range = value.Find("range");
  ListedValues values(key_place);
  bool sets_key = true;
  if (value.IsList()) {
    int number = 0;
    for (const YamlValue& item : value.List()) {
      const std::string numbered =
          LastPart(key) + "-" + std::to_string(++number);
      const bool is_single = !item.IsMap() && !item.IsList();
      values.Add(item, is_single ? ValueName(key, item.Text()) : numbered);
    }
    axis =
        std::move(values).Take([key](const YamlNode& node, YamlDocument* job) {
          SetAt(key, node, &job->root);
        });
  } else if (range && !range->IsMap()) {
    axis = RangeAxis(key, value.Map({"range"}).Required("range"), key_place);
  } else if (value.IsMap()) {
    sets_key = false;
    const YamlMap changes = value.AnyMap("values and what each changes");
    for (const auto& [name, change] : changes.entries()) {
      change.Map(ChangeableKeys());
      values.Add(change, NameForFiles(name));
    }
    axis = std::move(values).Take([](const YamlNode& node, YamlDocument* job) {
      Overlay(*job, "", node, &job->root);
    });
  } else {
    value.Fail(
        "expected a list of values for the key, `{range: N}`, or a map from "
        "names to what each changes");
  }
  if (axis.size == 0) value.Fail("no values here, expected one or more");
  if (sets_key) CheckKey(value, key.substr(0, key.find('.')));
  return axis;
}

std::string AsText(const YamlValue& value) {
  if (value.IsList()) {
    std::string text;
    for (const YamlValue& item : value.List()) {
      text += (text.empty() ? "" : ", ") + AsText(item);
    }
    return text;
  }
  if (value.Find("simulate")) return "simulated";
  if (const auto file = value.Find("file")) return AsText(*file);
  return value.IsMap() ? "" : NamedFiles::Resolve(value);
}

// What cannot be known will be said when the job is loaded.
std::string TextOf(const YamlValue& root, const std::string& key) {
  const std::optional<YamlValue> value = root.Find(key);
  if (!value) return "";
  try {
    return AsText(*value);
  } catch (const InputError&) {
    return "";
  }
}

// What texts that may be paths stand for today.
void AppendExpansions(const YamlNode& node, const YamlDocument& tree,
                      std::string* out) {
  for (const YamlNode& item : node.items) AppendExpansions(item, tree, out);
  if (node.kind != YamlNode::Kind::kScalar) return;
  std::string path = node.text;
  if (path.rfind("${", 0) == 0 && path.find('}') != std::string::npos) {
    const std::size_t end = path.find('}');
    const char* const value = std::getenv(path.substr(2, end - 2).c_str());
    path = (value == nullptr ? "" : value) + path.substr(end + 1);
    *out += path + "\n";
  }
  if (!IsPattern(path)) return;
  const std::string pattern = ResolvePath(tree.files[node.file], path);
  for (const std::string& found : MatchingFiles(pattern)) {
    *out += found + "\n";
  }
}

}  // namespace

struct JobMatrix::Contents {
  std::string path;
  std::string stem;
  YamlDocument tree;  ///< without its matrix
  std::vector<MatrixAxis> axes;
  std::int64_t size = 1;

  /// Which value of each axis a job has.
  std::vector<std::int64_t> ValuesOf(std::int64_t job) const {
    std::vector<std::int64_t> values(axes.size());
    for (std::size_t i = axes.size(); i-- > 0;) {
      values[i] = job % axes[i].size;
      job /= axes[i].size;
    }
    return values;
  }

  /// "left_seed-17"; empty without a matrix.
  std::string VariantOf(std::int64_t job) const {
    const std::vector<std::int64_t> values = ValuesOf(job);
    std::string name;
    for (std::size_t i = 0; i < axes.size(); ++i) {
      name += (i == 0 ? "" : "_") + axes[i].name_of(values[i]);
    }
    return name;
  }

  YamlDocument TreeOf(std::int64_t job) const {
    const std::vector<std::int64_t> values = ValuesOf(job);
    YamlDocument changed = tree;
    for (std::size_t i = 0; i < axes.size(); ++i) {
      axes[i].apply(values[i], &changed);
    }
    return changed;
  }
};

JobMatrix::JobMatrix(const std::string& path)
    : JobMatrix(ReadConfigFile(path, FileFormat::kJob)) {}

JobMatrix::JobMatrix(const YamlValue& root) {
  Contents contents;
  contents.path = root.location().file;
  contents.stem = NameOfFile(contents.path);
  contents.tree = ReadJobTree(root);
  if (const auto value = RootOf(contents.tree).Find("matrix")) {
    const YamlMap matrix = value->AnyMap("keys and their values");
    if (matrix.entries().empty()) {
      matrix.Fail("the map is empty, expected keys and their values");
    }
    for (const auto& [name, axis] : matrix.entries()) {
      contents.axes.push_back(MakeAxis(name, axis));
      contents.size *= contents.axes.back().size;
      if (contents.size > kMaxJobs) {
        matrix.Fail("expected at most " + std::to_string(kMaxJobs) +
                    " combinations");
      }
    }
    RemoveKey("matrix", &contents.tree.root);
  }
  contents_ = std::make_shared<const Contents>(std::move(contents));
}

std::int64_t JobMatrix::size() const { return contents_->size; }

const std::string& JobMatrix::path() const { return contents_->path; }

const std::vector<std::string>& JobMatrix::files() const {
  return contents_->tree.files;
}

std::string JobMatrix::NameOfFile(const std::string& path) {
  const std::filesystem::path file = path;
  const std::string folder = file.parent_path().filename().string();
  const bool says_nothing = file.filename() == "job.yaml";
  const bool has_folder = !folder.empty() && folder != "." && folder != "..";
  return NameForFiles(says_nothing && has_folder ? folder
                                                 : file.stem().string());
}

std::string JobMatrix::NameOf(std::int64_t job) const {
  const std::string variant = contents_->VariantOf(job);
  return contents_->stem + (variant.empty() ? "" : "/" + variant);
}

JobOutline JobMatrix::OutlineOf(std::int64_t job) const {
  const YamlValue root = RootOf(contents_->TreeOf(job));
  return {NameOf(job), TextOf(root, "arm"), TextOf(root, "data")};
}

JobConfig JobMatrix::Load(std::int64_t job, const Execution& execution) const {
  JobConfig config = LoadJobTree(contents_->TreeOf(job), execution);
  const std::string variant = contents_->VariantOf(job);
  if (!variant.empty()) config.title += ", " + variant;
  return config;
}

std::string JobMatrix::FingerprintOf(std::int64_t job) const {
  const YamlDocument tree = contents_->TreeOf(job);
  std::string text;
  // The same words mean other files elsewhere.
  for (const std::string& file : tree.files) {
    text += std::filesystem::absolute(file).lexically_normal().string() + "\n";
  }
  text += CanonicalText(tree.root) + "\n";
  AppendExpansions(tree.root, tree, &text);
  return Sha256(text);
}

}  // namespace alidade::internal
