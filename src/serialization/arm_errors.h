#ifndef ALIDADE_SRC_SERIALIZATION_ARM_ERRORS_H_
#define ALIDADE_SRC_SERIALIZATION_ARM_ERRORS_H_

#include <string>
#include <vector>

#include "alidade/arm.h"
#include "src/serialization/config_file.h"
#include "src/serialization/field_records.h"

namespace alidade::internal {

/// As a quoted text of YAML.
std::string QuoteYaml(const std::string& text);

std::vector<double> ReadQuantities(const YamlValue& value, Dimension dimension,
                                   const Units& units);
std::vector<Harmonic> ReadHarmonics(const YamlValue& value, const Units& units);
Eigen::MatrixXd ReadCouplingMatrix(const YamlValue& value, const Units& units,
                                   const Arm& arm);
/// @throws InputError where terms and the arm do not go together.
void CheckErrors(const YamlMap& map, const Arm& arm);

template <typename Visitor>
void VisitLoad(Visitor& v, Load& load) {
  v.Field(Key("mass").In("kg").AtLeast(0), load.mass, "of the load");
  v.Field(LengthKey("centre"), load.centre, "`[x, y, z]`");
}

template <typename Visitor>
void VisitFunction(Visitor& v, Dimension dimension, JointFunction& function) {
  static constexpr char kAsVariable[] = "as the joint";
  const auto quantity = [&](const char* key, const char* text, double* member) {
    v.Custom(Key(key).In(kAsVariable).Required().Schema(kNumberSchema), text,
             [=](const YamlValue& value, const Units& units) {
               *member = value.Quantity(dimension, units);
             });
  };
  const auto list = [&](const Key& key, const char* text,
                        Eigen::VectorXd* member) {
    v.Custom(key.In(kAsVariable).Schema(kNumbersSchema), text,
             [=](const YamlValue& value, const Units& units) {
               const std::vector<double> all =
                   ReadQuantities(value, dimension, units);
               *member = Eigen::Map<const Eigen::VectorXd>(
                   all.data(), static_cast<Eigen::Index>(all.size()));
             });
  };
  quantity("first", "joint value of the first knot", &function.first);
  quantity("spacing", "between knots, above 0", &function.spacing);
  list(Key("values").Required(),
       "at the knots; linear between them, zero from one spacing beyond",
       &function.values);
  list(Key("deviations").Default("none"), "their standard deviations",
       &function.deviations);
  v.Field(Key("periodic"), function.is_periodic,
          "of the value modulo a turn: the knot after the last is the first");
}

template <typename Visitor>
void VisitJointErrors(Visitor& v, Dimension dimension, JointErrors& joint) {
  v.Field(AngleKey("compliance").Default("0"), joint.compliance,
          "`[x, y, z]`, per N m of the moment of all loads behind it, in the "
          "axes of the joint's frame");
  v.Section(Key("function"), "added to the joint value, by its value",
            [&](auto& section) {
              VisitFunction(section, dimension, joint.function);
            });
  v.Custom(
      Key("harmonics")
          .In("angle")
          .Default("`[]`")
          .Schema(
              R"({"type": "array", "items": {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3}})"),
      "list of `[cycles per turn, cosine, sine]`, added to the joint value",
      [&](const YamlValue& value, const Units& units) {
        joint.harmonics = ReadHarmonics(value, units);
      });
  v.Field(AngleKey("backlash"), joint.backlash,
          "half of the step with the sign of the moment about the axis");
}

template <typename Visitor>
void VisitCovariate(Visitor& v, const Arm& arm, CovariateEffect& effect) {
  v.Field(Key("name").Required(), effect.name, "of the column");
  v.Field(Key("reference"), effect.reference, "its value without effect");
  v.Custom(Key("move").In("length").Default("0").Schema(kVectorSchema),
           "`[x, y, z]` of the base per unit of the column",
           [&](const YamlValue& value, const Units& units) {
             effect.base.head<3>() =
                 ReadVector(value, LengthKey("move"), units);
           });
  v.Custom(Key("turn").In("angle").Default("0").Schema(kVectorSchema),
           "`[rx, ry, rz]` of the base, after the move",
           [&](const YamlValue& value, const Units& units) {
             effect.base.tail<3>() = ReadVector(value, AngleKey("turn"), units);
           });
  v.Custom(
      Key("joints").In("as the joints").Default("0").Schema(kNumbersSchema),
      "n numbers, added to the joint values",
      [&](const YamlValue& value, const Units& units) {
        effect.joints = ReadJointQuantities(value, units, arm, "one per joint");
      });
  v.Custom(Key("target_move").In("length").Default("0").Schema(kVectorSchema),
           "`[x, y, z]` of the targets, in the axes of the last frame",
           [&](const YamlValue& value, const Units& units) {
             effect.target.head<3>() =
                 ReadVector(value, LengthKey("target_move"), units);
           });
  v.Custom(Key("target_turn").In("angle").Default("0").Schema(kVectorSchema),
           "`[rx, ry, rz]` of the targets about its origin, after the move",
           [&](const YamlValue& value, const Units& units) {
             effect.target.tail<3>() =
                 ReadVector(value, AngleKey("target_turn"), units);
           });
  v.Field(Key("payload").In("kg"), effect.payload,
          "added to the mass of the payload");
}

/// The `errors` of an arm file. @pre the arm has its joints.
template <typename Visitor>
void VisitErrors(Visitor& v, Arm* arm) {
  ErrorTerms& errors = arm->errors;
  v.Field(Key("gravity").Default("`[0, 0, -1]`"), errors.gravity,
          "the direction in which things fall, in the base frame");
  v.Items(Key("links").Default("1 kg at the origin of each joint's frame"),
          "loads in the joints' frames, one per joint", errors.links,
          [](auto& item, Load& load) { VisitLoad(item, load); });
  v.Section(Key("payload"), "load at the target, from there",
            [&](auto& section) { VisitLoad(section, errors.payload); });
  v.Items(Key("joints"), "one per joint", errors.joints,
          [arm](auto& item, JointErrors& joint) {
            const std::size_t number = arm->errors.joints.size();
            const Dimension dimension = number < arm->joints.size()
                                            ? arm->joints[number].dimension()
                                            : Dimension::kAngle;
            VisitJointErrors(item, dimension, joint);
          });
  v.Custom(Key("coupling")
               .In("the row's joint's per the column's")
               .Default("none")
               .Schema(R"({"type": "array", "items": {"type": "array"}})"),
           "n rows of n numbers: what each joint moves with the values of all",
           [arm](const YamlValue& value, const Units& units) {
             arm->errors.coupling = ReadCouplingMatrix(value, units, *arm);
           });
  v.Items(Key("covariates"), "effects of columns of the data, per unit of each",
          errors.covariates, [arm](auto& item, CovariateEffect& effect) {
            VisitCovariate(item, *arm, effect);
            item.Check([&](const YamlMap& map) {
              RefuseRepeatedName(map, effect, arm->errors.covariates);
            });
          });
  v.Check([arm](const YamlMap& map) { CheckErrors(map, *arm); });
}

/// As VisitErrors reads them, in m and rad; empty for a rigid arm of which no
/// loads are known.
std::string FormatErrors(const ErrorTerms& errors);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_ARM_ERRORS_H_
