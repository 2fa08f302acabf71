#include "src/serialization/errors_section.h"

#include <string>
#include <utility>

#include "src/calibration/calibration_options_fields.h"

namespace alidade::internal {
namespace {

int ReadJoint(const YamlValue& value, int num_joints) {
  const Key key = Key("joint").AtLeast(1).AtMost(num_joints);
  return ReadInteger(value, key) - 1;
}

std::vector<double> ReadCycles(const YamlValue& value, const Units& units) {
  std::vector<double> cycles;
  for (const YamlValue& item : value.List()) {
    cycles.push_back(ReadNumber(item, Key("harmonics").Above(0), units));
  }
  return cycles;
}

std::vector<std::pair<int, int>> ReadCoupling(const YamlValue& value,
                                              int num_joints) {
  std::vector<std::pair<int, int>> coupling;
  for (const YamlValue& item : value.List()) {
    const std::vector<YamlValue> pair = item.List(2, "joint, other joint");
    const int joint = ReadJoint(pair[0], num_joints);
    const int other = ReadJoint(pair[1], num_joints);
    if (joint == other) {
      item.Fail("expected two joints, found joint " +
                std::to_string(joint + 1) + " twice: `scale` is of its own");
    }
    coupling.emplace_back(joint, other);
  }
  return coupling;
}

template <typename Visitor>
void VisitTerms(Visitor& v, int num_joints, ErrorTermOptions* options) {
  VisitFields(v, *options);
  v.Custom(Key("harmonics").Default("`[]`").Schema(kNumbersSchema),
           "list: cycles per turn of a revolute joint, `[1, 2]`; those of a "
           "gear may be no whole numbers",
           [=](const YamlValue& value, const Units& units) {
             options->harmonics = ReadCycles(value, units);
           });
  v.Custom(
      Key("coupling")
          .Default("`[]`")
          .Schema(
              R"({"type": "array", "items": {"type": "array", "items": {"type": "integer"}, "minItems": 2, "maxItems": 2}})"),
      "list of `[joint, other]`: the first moves with the value of the other",
      [=](const YamlValue& value) {
        options->coupling = ReadCoupling(value, num_joints);
      });
}

}  // namespace

std::vector<FieldRecord> ErrorTermFields() {
  ErrorTermOptions options;
  return CollectFields([&](auto& v) { VisitTerms(v, 1, &options); });
}

ErrorTermOptions ReadErrorTerms(const YamlValue& value, const Units& units,
                                int num_joints) {
  ErrorTermOptions options;
  if (!value.IsMap()) {
    options.selection = ValueOf<ErrorTermSelection>(
        value.Choice("error terms", {"none", "auto"}));
    return options;
  }
  options.selection = ErrorTermSelection::kStated;
  ReadFields(value, units,
             [&](auto& v) { VisitTerms(v, num_joints, &options); });
  const bool is_empty = !options.elasticity && !options.scale &&
                        !options.backlash && !options.covariates &&
                        options.function_length == 0.0 &&
                        options.harmonics.empty() && options.coupling.empty();
  if (is_empty) {
    value.Fail("asks for no term, expected `none` or one of " +
               JoinNames(KeysOf(ErrorTermFields())));
  }
  return options;
}

}  // namespace alidade::internal
