#include "alidade/plan.h"

#include <algorithm>
#include <utility>

namespace alidade {
namespace {

constexpr std::array<std::pair<const char*, DesignCriterion>, 10> kNames = {{
    {"D", DesignCriterion::kD},
    {"O1", DesignCriterion::kD},
    {"A", DesignCriterion::kA},
    {"E", DesignCriterion::kE},
    {"G", DesignCriterion::kG},
    {"I", DesignCriterion::kI},
    {"O2", DesignCriterion::kO2},
    {"O3", DesignCriterion::kO3},
    {"O4", DesignCriterion::kO4},
    {"O5", DesignCriterion::kO5},
}};

}  // namespace

const std::vector<std::string>& DesignCriterionNames() {
  static const auto* const names = [] {
    auto* list = new std::vector<std::string>;
    for (const auto& [name, criterion] : kNames) list->emplace_back(name);
    return list;
  }();
  return *names;
}

const char* NameOf(DesignCriterion criterion) {
  for (const auto& [name, known] : kNames) {
    if (known == criterion) return name;
  }
  return "";
}

DesignCriterion FindDesignCriterion(const std::string& name) {
  for (const auto& [known, criterion] : kNames) {
    if (name == known) return criterion;
  }
  return DesignCriterion::kD;
}

bool NeedsRegion(DesignCriterion criterion) {
  return criterion == DesignCriterion::kG || criterion == DesignCriterion::kI;
}

int PoseMeasurement::num_equations() const {
  const auto lengths =
      static_cast<int>(std::count(axes.begin(), axes.end(), true));
  return static_cast<int>(targets.size()) * (lengths + (orientation ? 3 : 0));
}

bool DesignOptions::IsValid(std::string* error) const {
  const auto fail = [&](const std::string& text) {
    *error = text;
    return false;
  };
  if (num_poses < 1) {
    return fail("num_poses = " + std::to_string(num_poses) +
                ", must be 1 or more");
  }
  if (starts < 1) {
    return fail("starts = " + std::to_string(starts) + ", must be 1 or more");
  }
  if (shortlist < 1) {
    return fail("shortlist = " + std::to_string(shortlist) +
                ", must be 1 or more");
  }
  if (max_passes < 0) {
    return fail("max_passes = " + std::to_string(max_passes) +
                ", must not be negative");
  }
  if (num_threads < 1) {
    return fail("num_threads = " + std::to_string(num_threads) +
                ", must be 1 or more");
  }
  return true;
}

}  // namespace alidade
