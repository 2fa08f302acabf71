#include "src/serialization/job_matrix.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "src/common/files.h"
#include "src/dataio/file_pattern.h"
#include "src/serialization/config_file.h"
#include "src/serialization/job_tree.h"
#include "src/serialization/matrix_axis.h"
#include "src/serialization/yaml_merge.h"
#include "src/serialization/yaml_reader.h"

namespace alidade::internal {

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
      values[i] = job % axes[i].size();
      job /= axes[i].size();
    }
    return values;
  }

  /// "left_seed-17"; empty without a matrix.
  std::string VariantOf(std::int64_t job) const {
    const std::vector<std::int64_t> values = ValuesOf(job);
    std::string name;
    for (std::size_t i = 0; i < axes.size(); ++i) {
      name += (i == 0 ? "" : "_") + axes[i].NameOf(values[i]);
    }
    return name;
  }

  YamlDocument TreeOf(std::int64_t job) const {
    const std::vector<std::int64_t> values = ValuesOf(job);
    YamlDocument changed = tree;
    for (std::size_t i = 0; i < axes.size(); ++i) {
      axes[i].Apply(values[i], &changed);
    }
    return changed;
  }
};

namespace {

constexpr std::int64_t kMaxJobs = 1000000;

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

JobMatrix::JobMatrix(const std::string& path) {
  Contents contents;
  contents.path = path;
  contents.stem = NameOfFile(path);
  contents.tree = ReadJobTree(path);
  const YamlValue root = RootOf(contents.tree);
  if (const auto value = root.Find("matrix")) {
    const YamlMap matrix = value->AnyMap("keys and their values");
    if (matrix.entries().empty()) {
      matrix.Fail("the map is empty, expected keys and their values");
    }
    for (const auto& [name, axis] : matrix.entries()) {
      contents.axes.emplace_back(name, axis);
      contents.size *= contents.axes.back().size();
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
  return NameForFiles(std::filesystem::path(path).stem().string());
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
