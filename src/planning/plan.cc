#include "alidade/plan.h"

#include <algorithm>

#include "src/planning/plan_fields.h"

namespace alidade {
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
