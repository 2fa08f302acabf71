#include "alidade/plan.h"

#include <algorithm>
#include <utility>

#include "src/planning/plan_fields.h"

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
  internal::FieldCheck others("");
  others.Field(internal::Key("num_poses").AtLeast(1), num_poses, "");
  others.Field(internal::Key("num_threads").AtLeast(1), num_threads, "");
  *error = others.error();
  return internal::AreFieldsValid(*this, "", error) && error->empty();
}

}  // namespace alidade
