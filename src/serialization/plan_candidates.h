#ifndef ALIDADE_SRC_SERIALIZATION_PLAN_CANDIDATES_H_
#define ALIDADE_SRC_SERIALIZATION_PLAN_CANDIDATES_H_

#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "src/planning/plan_fields.h"
#include "src/serialization/job_context.h"
#include "src/serialization/plan_config.h"
#include "src/serialization/references_section.h"
#include "src/serialization/yaml_fields.h"

namespace alidade::internal {

/// @throws InputError where a list is there that has no items.
void RefuseEmptyList(const YamlMap& map, const std::string& key);
/// What goes with candidates that are drawn. @throws InputError.
void RefuseDrawing(const YamlMap& map);

/// @throws InputError where the list has not one interval for every joint.
std::vector<std::pair<double, double>> ReadJointLimits(const YamlValue& value,
                                                       const Units& units,
                                                       const Arm& arm);

/// Boxes in the base's frame.
template <typename Visitor>
void VisitBoxes(Visitor& v, std::vector<WorkspaceBox>* boxes) {
  v.Items(LengthKey("boxes").Default("anywhere"),
          "boxes in the base's frame: each target that is measured is in one "
          "of them",
          *boxes, [](auto& item, WorkspaceBox& box) {
            for (const auto& [axis, side] :
                 {std::pair(0, "x"), std::pair(1, "y"), std::pair(2, "z")}) {
              double* const lower = &box.lower[axis];
              double* const upper = &box.upper[axis];
              item.Custom(LengthKey(side).Required().Schema(kIntervalSchema),
                          "`[lower, upper]`",
                          [=](const YamlValue& value, const Units& units) {
                            std::tie(*lower, *upper) =
                                ReadInterval(value, Dimension::kLength, units);
                          });
            }
          });
  v.Check([](const YamlMap& map) { RefuseEmptyList(map, "boxes"); });
}

template <typename Visitor>
void VisitConstraints(Visitor& v, PoseConstraints* constraints) {
  VisitBoxes(v, &constraints->boxes);
  const Key margin = LengthKey("margin").AtLeast(0);
  const char* thickness = "for the thickness of the links";
  v.Section(Key("floor"),
            "origins of all frames but the first, and all targets, stay above "
            "it. A height that the arm's own stand is nearer to leaves no pose",
            [&](auto& section) {
              HalfSpace floor;
              section.Field(LengthKey("height").Required(), floor.offset,
                            "in the base's frame");
              section.Field(margin, floor.margin, thickness);
              section.Check([&](const YamlMap& /*map*/) {
                constraints->half_spaces.push_back(floor);
              });
            });
  v.Items(Key("walls"),
          "likewise on the side of a plane that `normal` points to",
          constraints->half_spaces, [&](auto& item, HalfSpace& wall) {
            Eigen::Vector3d point;
            item.Field(Key("normal").Required(), wall.normal,
                       "direction into the free space");
            item.Field(LengthKey("point").Required(), point, "on the plane");
            item.Field(margin, wall.margin, thickness);
            item.Check([&](const YamlMap& /*map*/) {
              wall.offset = wall.normal.dot(point);
            });
          });
  v.Section(
      Key("visibility"), "the instrument sees a target that looks at it",
      [&](auto& section) {
        Visibility visibility;
        section.Field(LengthKey("instrument").Required(), visibility.instrument,
                      "where it stands, in the base's frame");
        section.Field(Key("axis").Default("`[0, 0, 1]`"), visibility.axis,
                      "direction in the frame of each target that is measured");
        section.Field(AngleKey("angle").Above(0).AtMost(kPi).Required(),
                      visibility.angle,
                      "the most between `axis` and the way from the "
                      "target to the instrument");
        section.Check([&](const YamlMap& /*map*/) {
          constraints->visibility = visibility;
        });
      });
}

/// The section `candidates`: how they are drawn or read, and their constraints.
template <typename Visitor>
void VisitCandidates(Visitor& v, JobContext* context, PlanConfig* plan) {
  VisitFields(v, plan->candidates);
  v.Custom(Key("file").In("path").Schema(kTextSchema),
           "instead of drawing: the joint values of a data set; its other "
           "columns are ignored",
           [plan, context](const YamlValue& value) {
             plan->given_candidates =
                 context->files.ReadJointValues(value, plan->job.arm);
           });
  v.Check(RefuseDrawing);
  VisitConstraints(v, &plan->constraints);
}

/// The section `region`.
template <typename Visitor>
void VisitRegion(Visitor& v, PlanConfig* plan) {
  v.Custom(Key("joints")
               .In("angle or length")
               .Default("the arm's limits")
               .Schema(R"({"type": "array"})"),
           "`[lower, upper]` of every joint",
           [plan](const YamlValue& value, const Units& units) {
             plan->region.joint_limits =
                 ReadJointLimits(value, units, plan->job.arm);
           });
  VisitBoxes(v, &plan->region.boxes);
  v.Field(Key("count").AtLeast(1).AtMost(10000), plan->region.count,
          "poses of the region that `G` and `I` are evaluated at");
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_PLAN_CANDIDATES_H_
