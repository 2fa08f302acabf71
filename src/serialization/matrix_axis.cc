#include "src/serialization/matrix_axis.h"

#include <algorithm>
#include <filesystem>
#include <limits>

#include "src/common/names.h"
#include "src/common/numbers.h"
#include "src/serialization/job_file.h"
#include "src/serialization/yaml_merge.h"

namespace alidade::internal {
namespace {

constexpr std::int64_t kMaxJobs = 1000000;

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

MatrixAxis::MatrixAxis(const std::string& name, const YamlValue& value)
    : name_(name), key_place_(value.node().key_place) {
  if (value.IsList()) {
    ReadList(value);
  } else if (const auto range = value.Find("range"); range && !range->IsMap()) {
    ReadRange(value.Map({"range"}).Required("range"));
  } else if (value.IsMap()) {
    ReadChanges(value.AnyMap("values and what each changes"));
  } else {
    value.Fail(
        "expected a list of values for the key, `{range: N}`, or a map from "
        "names to what each changes");
  }
  if (size_ == 0) value.Fail("no values here, expected one or more");
  if (sets_key()) CheckKey(value, name_.substr(0, name_.find('.')));
}

void MatrixAxis::ReadRange(const YamlValue& range) {
  constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();
  std::int64_t last = 0;
  first_ = 1;
  if (range.IsList()) {
    const std::vector<YamlValue> ends = range.List(2, "first, last");
    first_ = ends[0].Integer(0, kMax);
    last = ends[1].Integer(first_, kMax);
  } else {
    last = range.Integer(1, kMaxJobs);
  }
  if (last - first_ >= kMaxJobs) {
    range.Fail("expected at most " + std::to_string(kMaxJobs) + " values");
  }
  is_range_ = true;
  size_ = last - first_ + 1;
  place_.kind = YamlNode::Kind::kScalar;
  place_.file = range.node().file;
  place_.place = range.node().place;
  place_.key_place = key_place_;
}

void MatrixAxis::ReadList(const YamlValue& list) {
  for (const YamlValue& item : list.List()) {
    const bool is_single = !item.IsMap() && !item.IsList();
    AddValue(item, is_single ? ValueName(name_, item.Text())
                             : LastPart(name_) + "-" +
                                   std::to_string(values_.size() + 1));
  }
}

void MatrixAxis::ReadChanges(const YamlMap& changes) {
  has_changes_ = true;
  for (const auto& [name, change] : changes.entries()) {
    change.Map(ChangeableKeys());
    AddValue(change, NameForFiles(name));
  }
}

void MatrixAxis::AddValue(const YamlValue& value, const std::string& name) {
  if (std::find(names_.begin(), names_.end(), name) != names_.end()) {
    value.Fail("a second value is called " + Quote(name) +
               " in names of jobs, expected different ones: a map from names "
               "to what each changes gives them names of your choice");
  }
  names_.push_back(name);
  values_.push_back(value.node());
  values_.back().key_place = key_place_;
  size_ = static_cast<std::int64_t>(values_.size());
}

std::string MatrixAxis::NameOf(std::int64_t value) const {
  if (!is_range_) return names_[value];
  // As many digits as the last one has: in the order of numbers when sorted.
  const std::string number = std::to_string(first_ + value);
  const std::size_t width = std::to_string(first_ + size_ - 1).size();
  return NameForFiles(LastPart(name_)) + "-" +
         std::string(width - number.size(), '0') + number;
}

void MatrixAxis::Apply(std::int64_t value, YamlDocument* job) const {
  if (has_changes_) {
    Overlay(*job, "", values_[value], &job->root);
    return;
  }
  if (!is_range_) {
    SetAt(name_, values_[value], &job->root);
    return;
  }
  YamlNode number = place_;
  number.text = std::to_string(first_ + value);
  SetAt(name_, number, &job->root);
}

}  // namespace alidade::internal
