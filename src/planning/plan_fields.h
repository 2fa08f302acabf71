#ifndef ALIDADE_SRC_PLANNING_PLAN_FIELDS_H_
#define ALIDADE_SRC_PLANNING_PLAN_FIELDS_H_

#include <limits>

#include "alidade/plan.h"
#include "src/calibration/calibration_result_fields.h"
#include "src/common/constants.h"
#include "src/common/option_fields.h"

namespace alidade::internal {

/// "O1" is read as D.
template <>
inline constexpr std::array kWords<DesignCriterion> = {
    std::pair{DesignCriterion::kD, "D"},
    std::pair{DesignCriterion::kD, "O1"},
    std::pair{DesignCriterion::kA, "A"},
    std::pair{DesignCriterion::kE, "E"},
    std::pair{DesignCriterion::kG, "G"},
    std::pair{DesignCriterion::kI, "I"},
    std::pair{DesignCriterion::kO2, "O2"},
    std::pair{DesignCriterion::kO3, "O3"},
    std::pair{DesignCriterion::kO4, "O4"},
    std::pair{DesignCriterion::kO5, "O5"},
};

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

/// What LinkCaution takes links for.
template <typename Visitor>
void VisitLinkRadius(Visitor& v, std::optional<double>* radius) {
  v.Field(LengthKey("link_radius")
              .AtLeast(0)
              .Default("a twentieth of all lengths of the chain"),
          *radius,
          "about how thick links are: the plan names poses at which capsules "
          "of this radius about the links overlap. 0: it does not look");
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, PredictedAccuracy>& accuracy) {
  v.Field("worst", accuracy.worst, kInfinity);
  v.Field("rms", accuracy.rms, kInfinity);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, PlanEvaluation>& evaluation) {
  v.Field("name", evaluation.name);
  v.Field("candidates", evaluation.candidates);
  v.Field("region", evaluation.region);
  v.Field("observability", evaluation.observability);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, PlanCurvePoint>& point) {
  v.Field("poses", point.num_poses);
  v.Field("planned", point.planned);
  v.Field("random", point.random);
  v.Field("bound", point.bound);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, PlannedParameter>& parameter) {
  v.Field("name", parameter.name);
  v.Field("unit", parameter.dimension);
  v.Field("prior_std", parameter.prior_std,
          std::numeric_limits<double>::infinity());
  v.Field("planned_std", parameter.planned_std);
  v.Field("random_std", parameter.random_std);
  v.Field("identified_combination", parameter.identified_combination);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, PlannedErrorTerm>& term) {
  v.Field("name", term.name);
  v.Field("unit", term.unit);
  v.Field("prior_std", term.prior_std);
  v.Field("planned_std", term.planned_std);
  v.Field("poses_needed", term.poses_needed);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, LinkOverlap>& overlap) {
  v.Field("pose", overlap.pose);
  v.Field("first", overlap.first);
  v.Field("second", overlap.second);
  v.Field("overlap", overlap.overlap);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, LinkCaution>& links) {
  v.Field("radius", links.radius);
  v.Field("overlaps", links.overlaps);
}

/// A column of PlanResult::joint_values, as the file has it.
struct PlannedPose {
  Eigen::VectorXd joints;
  double std = 0.0;
};

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, PlannedPose>& pose) {
  v.Field("joints", pose.joints);
  v.Field("std", pose.std);
}

inline std::vector<PlannedPose> PosesOf(const PlanResult& result) {
  std::vector<PlannedPose> poses;
  for (Eigen::Index k = 0; k < result.joint_values.cols(); ++k) {
    poses.push_back({result.joint_values.col(k), result.pose_std[k]});
  }
  return poses;
}

/// Nothing reads plans back: poses and travel are computed.
template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, PlanResult>& result) {
  v.Field("version", result.version);
  v.Field("command", result.command);
  v.Field("title", result.title);
  v.Field("arm", result.arm);
  v.Field("inputs", result.inputs);
  v.Field("seed", result.seed);
  v.Field("criterion", result.criterion);
  v.Group("measurement", [&](auto& measurement) {
    measurement.Field("kind", result.measured);
    measurement.Field("sigma", result.sigma);
    measurement.Field("sigma_rotation", result.rotation_sigma);
    measurement.Field("equations", result.equations);
  });
  v.Field("candidates", result.num_candidates);
  v.Field("looked_at", result.num_looked_at);
  v.Field("measured_before", result.measured_before);
  v.Field("priors", result.has_priors);
  v.Field("repeats", result.allow_repeats);
  v.Field("wanted", result.wanted);
  v.Field("joint_units", result.joint_dimensions);
  v.Computed("poses", PosesOf(result));
  v.Field("distinct", result.num_distinct);
  v.Group("travel", [&](auto& travel) {
    travel.Computed("unit", result.travel_in_seconds ? "s" : "rad or m");
    travel.Field("before", result.travel_before);
    travel.Field("after", result.travel);
  });
  v.Field("parameters", result.parameters);
  v.Field("terms", result.terms);
  v.Field("evaluations", result.evaluations);
  v.Field("bound", result.bound);
  v.Field("d_efficiency", result.d_efficiency);
  v.Field("converged", result.converged);
  v.Field("exchanges", result.exchanges);
  v.Field("passes", result.passes);
  v.Group("log_criterion", [&](auto& criterion) {
    criterion.Field("greedy", result.greedy_value);
    criterion.Field("planned", result.value);
  });
  v.Field("curve", result.curve);
  v.Field("links", result.links);
  v.Field("warnings", result.warnings);
  v.Group("times", [&](auto& times) {
    times.Field("plan_s", result.plan_time_s);
    times.Field("total_s", result.total_time_s);
  });
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_PLANNING_PLAN_FIELDS_H_
