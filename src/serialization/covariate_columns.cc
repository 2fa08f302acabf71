#include "src/serialization/covariate_columns.h"

#include <algorithm>
#include <string_view>
#include <tuple>
#include <utility>

#include "alidade/error.h"
#include "src/common/names.h"

namespace alidade::internal {
namespace {

// "base", "target", "joint 2", "joints".
void ReadEffect(const YamlValue& value, int num_joints, CovariateUse* use) {
  std::vector<std::string> names = {"base", "target", "joints"};
  for (int j = 1; j <= num_joints; ++j) {
    names.push_back("joint " + std::to_string(j));
  }
  const std::string name = value.Choice("effect", names);
  use->moves_base = use->moves_base || name == "base";
  use->moves_target = use->moves_target || name == "target";
  for (int j = 0; j < num_joints; ++j) {
    if (name != "joints" && name != names[3 + j]) continue;
    if (std::count(use->joints.begin(), use->joints.end(), j) > 0) {
      value.Fail("names joint " + std::to_string(j + 1) + " again");
    }
    use->joints.push_back(j);
  }
}

bool AreSame(const std::vector<CovariateUse>& a,
             const std::vector<CovariateUse>& b) {
  const auto members = [](const CovariateUse& use) {
    return std::tie(use.name, use.moves_base, use.moves_target, use.joints,
                    use.is_approach, use.is_payload, use.is_station);
  };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [&](const CovariateUse& one, const CovariateUse& other) {
                      return members(one) == members(other);
                    });
}

}  // namespace

std::vector<std::string> ReadHeaders(const std::vector<YamlValue>& items) {
  std::vector<std::string> headers;
  for (const YamlValue& item : items) {
    headers.push_back(item.Text());
    if (std::count(headers.begin(), headers.end(), headers.back()) > 1) {
      item.Fail("column " + Quote(headers.back()) +
                " is repeated, expected each once");
    }
  }
  return headers;
}

std::vector<CovariateUse> ReadEffects(
    const YamlValue& value, int num_joints,
    const std::vector<std::string>& covariates) {
  std::vector<CovariateUse> uses;
  if (covariates.empty()) {
    value.Fail("found without \"covariates\", expected their list beside it");
  }
  const YamlMap map = value.AnyMap("covariates and what they move");
  for (const auto& [name, effects] : map.entries()) {
    if (std::count(covariates.begin(), covariates.end(), name) == 0) {
      effects.Fail(UnknownName("covariate", name, covariates));
    }
    CovariateUse use{name, false};
    std::vector<YamlValue> items = {effects};
    if (effects.IsList()) items = effects.List();
    for (const YamlValue& item : items) ReadEffect(item, num_joints, &use);
    uses.push_back(std::move(use));
  }
  return uses;
}

void AddCovariate(const YamlValue& value, CovariateUse use,
                  ColumnMapping* mapping) {
  std::vector<std::string>& names = mapping->covariates;
  if (std::count(names.begin(), names.end(), use.name) > 0) {
    value.Fail("column " + Quote(use.name) +
               " is a covariate already, expected each once");
  }
  names.push_back(use.name);
  mapping->uses.push_back(std::move(use));
}

void ReadApproach(const YamlValue& value, int num_joints,
                  ColumnMapping* mapping) {
  std::vector<YamlValue> items = {value};
  if (value.IsList()) {
    items = value.List(num_joints, "the header of each joint's column");
  }
  for (std::size_t k = 0; k < items.size(); ++k) {
    CovariateUse use{items[k].Text(), false};
    use.is_approach = true;
    for (int j = 0; j < num_joints; ++j) {
      if (!value.IsList() || j == static_cast<int>(k)) use.joints.push_back(j);
    }
    AddCovariate(items[k], std::move(use), mapping);
  }
}

void AddPayload(double mass, LoadedData* loaded) {
  const std::string name = kPayloadName;
  Dataset& data = loaded->data;
  const Eigen::Index before = data.covariates.rows();
  MatrixBuilder all(before + 1, data.num_poses());
  if (before > 0) all.map().topRows(before) = data.covariates.map();
  all.map().row(before).setConstant(mass);
  data.covariates = all.Freeze();
  data.covariate_names.push_back(name);
  CovariateUse use{name, false};
  use.is_payload = true;
  loaded->uses.push_back(std::move(use));
}

namespace {

constexpr std::string_view kStation = "station ";

// The one whose base is the arm's: of an arm that has been calibrated with
// stations, the one that it has no effect for; else the first.
std::string FirstStation(const std::vector<std::string>& stations,
                         const Arm& arm) {
  std::vector<std::string> others;
  for (const CovariateEffect& effect : arm.errors.covariates) {
    if (effect.name.rfind(kStation, 0) == 0) {
      others.push_back(effect.name.substr(kStation.size()));
    }
  }
  if (others.empty()) return stations.front();
  const auto first = std::find_if(
      stations.begin(), stations.end(), [&others](const std::string& station) {
        return std::find(others.begin(), others.end(), station) == others.end();
      });
  return first == stations.end() ? "" : *first;
}

}  // namespace

void AddStations(const std::vector<std::string>& stations, const Arm& arm,
                 std::string* first, LoadedData* loaded) {
  Dataset* const data = &loaded->data;
  if (first->empty()) *first = FirstStation(stations, arm);
  std::vector<std::string> names = {*first};
  for (const std::string& station : stations) {
    if (std::find(names.begin(), names.end(), station) == names.end()) {
      names.push_back(station);
    }
  }
  if (names.size() < 2) return;
  const auto before = static_cast<Eigen::Index>(data->covariate_names.size());
  const auto more = static_cast<Eigen::Index>(names.size()) - 1;
  MatrixBuilder all(before + more, data->num_poses());
  all.map().setZero();
  if (before > 0) all.map().topRows(before) = data->covariates.map();
  for (Eigen::Index pose = 0; pose < data->num_poses(); ++pose) {
    const auto number =
        std::find(names.begin(), names.end(), stations[pose]) - names.begin();
    if (number > 0) all.map()(before + number - 1, pose) = 1.0;
  }
  for (std::size_t k = 1; k < names.size(); ++k) {
    CovariateUse use{std::string(kStation) + names[k]};
    use.is_station = true;
    data->covariate_names.push_back(use.name);
    loaded->uses.push_back(std::move(use));
  }
  data->covariates = all.Freeze();
}

void RequireKnownStations(const YamlValue& value, const Dataset& training,
                          const LoadedData& loaded) {
  if (training.num_poses() == 0) return;
  const std::vector<std::string>& known = training.covariate_names;
  for (const CovariateUse& use : loaded.uses) {
    if (!use.is_station || std::count(known.begin(), known.end(), use.name)) {
      continue;
    }
    value.Fail(use.name +
               " is none of those of `data`: its base is not known, expected "
               "validation data of the same stations");
  }
}

void RequireSameCovariates(const std::vector<LoadedData>& parts) {
  for (const LoadedData& part : parts) {
    if (part.data.covariate_names == parts.front().data.covariate_names &&
        AreSame(part.uses, parts.front().uses)) {
      continue;
    }
    throw InputError({part.data.name, 0, 0, ""},
                     "has other `covariates` than " + parts.front().data.name +
                         ", expected the same in all files of `data`");
  }
}

}  // namespace alidade::internal
