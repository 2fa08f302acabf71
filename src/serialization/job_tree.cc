#include "src/serialization/job_tree.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "src/common/names.h"
#include "src/serialization/config_file.h"
#include "src/serialization/yaml_merge.h"
#include "src/serialization/yaml_reader.h"

namespace alidade::internal {
namespace {

// The same file whatever it is called.
std::string Canonical(const std::string& path) {
  std::error_code error;
  const auto canonical = std::filesystem::weakly_canonical(path, error);
  return error ? path : canonical.string();
}

void CheckUnits(const YamlDocument& document, const YamlDocument& base) {
  const YamlNode* const own = document.root.Find("units");
  const YamlNode* const inherited = base.root.Find("units");
  if (own == nullptr || inherited == nullptr) return;
  for (const char* key : {"length", "angle"}) {
    const YamlNode* const a = own->Find(key);
    const YamlNode* const b = inherited->Find(key);
    if (a == nullptr || b == nullptr || a->text == b->text) continue;
    throw InputError(LocationOf(document, *a, std::string("units.") + key),
                     "found " + Quote(a->text) + ", but the numbers of " +
                         base.files.front() + " are in " + Quote(b->text) +
                         ": expected the same units");
  }
}

class TreeReader {
 public:
  YamlDocument Read(const std::string& path) {
    const YamlValue root = ReadConfigFile(path, FileFormat::kJob);
    YamlDocument document = root.document();
    const std::optional<YamlValue> extends = root.Find("extends");
    if (!extends) return document;
    chain_.push_back(path);
    NamedFiles files(path);
    const std::string base_path = files.Resolve(*extends);
    RefuseCircle(*extends, base_path);
    YamlDocument base = files.Read(
        *extends, [this](const std::string& named) { return Read(named); });
    CheckUnits(document, base);
    RemoveKey("extends", &document.root);
    Inherit(std::move(base), &document);
    return document;
  }

 private:
  void RefuseCircle(const YamlValue& extends, const std::string& base) const {
    const auto same = std::find_if(chain_.begin(), chain_.end(),
                                   [&](const std::string& path) {
                                     return Canonical(path) == Canonical(base);
                                   });
    if (same == chain_.end()) return;
    std::string circle;
    for (auto link = same; link != chain_.end(); ++link) {
      circle += *link + " -> ";
    }
    extends.Fail("files extend each other in a circle: " + circle + base +
                 "; expected one that extends none");
  }

  std::vector<std::string> chain_;
};

}  // namespace

YamlDocument ReadJobTree(const std::string& path) {
  return TreeReader().Read(path);
}

}  // namespace alidade::internal
