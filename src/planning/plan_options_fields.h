#ifndef ALIDADE_SRC_PLANNING_PLAN_OPTIONS_FIELDS_H_
#define ALIDADE_SRC_PLANNING_PLAN_OPTIONS_FIELDS_H_

#include "alidade/plan_options.h"
#include "src/common/option_fields.h"

namespace alidade::internal {

/// How candidates are drawn.
template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, CandidateOptions>& options) {
  v.Field(Key("count").AtLeast(1).AtMost(1000000), options.count,
          "drawn within the joint limits (those without limits: a turn, or the "
          "reach to both sides)");
  v.Field(Key("limit_faces"), options.limit_faces,
          "every other candidate has a third of its joints at their lower "
          "limits and a third at their upper ones, on average");
  v.Field(Key("joint_decimals").AtLeast(0).AtMost(12), options.joint_decimals,
          "decimals of a degree or a mm that the motors' values are rounded "
          "to");
}

/// How the exchange searches.
template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, DesignOptions>& options) {
  v.Field(Key("starts").AtLeast(1).AtMost(1000), options.starts,
          "starts of the exchange");
  v.Field(Key("shortlist").AtLeast(1).AtMost(10000), options.shortlist,
          "candidates that are evaluated for each place of the plan, for all "
          "criteria but `D`");
  v.Field(Key("max_passes").AtLeast(1).AtMost(100000), options.max_passes,
          "rounds of exchanges in a start, at most");
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_PLANNING_PLAN_OPTIONS_FIELDS_H_
