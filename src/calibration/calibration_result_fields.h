#ifndef ALIDADE_SRC_CALIBRATION_CALIBRATION_RESULT_FIELDS_H_
#define ALIDADE_SRC_CALIBRATION_CALIBRATION_RESULT_FIELDS_H_

#include <cmath>

#include "alidade/calibration_result.h"
#include "src/common/accuracy_fields.h"
#include "src/common/fields.h"
#include "src/identifiability/identifiability_fields.h"
#include "src/solve/solver_fields.h"
#include "src/uncertainty/uncertainty_fields.h"

namespace alidade::internal {

template <>
inline constexpr std::array kWords<ParameterAssessment> = {
    std::pair{ParameterAssessment::kKnown, "known"},
    std::pair{ParameterAssessment::kFixed, "fixed"},
    std::pair{ParameterAssessment::kWeak, "weak"},
    std::pair{ParameterAssessment::kPriorDominated, "prior_dominated"},
    std::pair{ParameterAssessment::kEstimated, "estimated"},
};

template <>
inline constexpr std::array kWords<FindingLevel> = {
    std::pair{FindingLevel::kPassed, "passed"},
    std::pair{FindingLevel::kNote, "note"},
    std::pair{FindingLevel::kAttention, "attention"},
    std::pair{FindingLevel::kFailed, "failed"},
};

template <>
inline constexpr std::array kWords<VerdictDecision> = {
    std::pair{VerdictDecision::kAccepted, "accepted"},
    std::pair{VerdictDecision::kAcceptedWithWarnings, "accepted_with_warnings"},
    std::pair{VerdictDecision::kRejected, "rejected"},
};

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, InputFile>& input) {
  v.Field("path", input.path);
  v.Field("sha256", input.sha256);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, Finding>& finding) {
  v.Field("key", finding.key);
  v.Field("level", finding.level);
  v.Field("statistic", finding.statistic);
  v.Field("threshold", finding.threshold);
  v.Field("sentence", finding.sentence);
  v.Later("next", finding.next);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, Verdict>& verdict) {
  v.Computed("decision", verdict.decision());
  v.Field("level", verdict.level);
  v.Field("title", verdict.title);
  v.Field("sentence", verdict.sentence);
  v.Field("findings", verdict.findings);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, ParameterResult>& parameter) {
  v.Field("name", parameter.name);
  v.Field("kind", parameter.kind);
  v.Field("unit", parameter.dimension);
  v.Field("nominal", parameter.nominal);
  v.Field("value", parameter.value);
  v.Computed("deviation", parameter.deviation());
  v.Field("std", parameter.std);
  v.Optional("truth", parameter.truth);
  v.Optional("published", parameter.published);
  auto& decision = parameter.decision;
  if constexpr (Visitor::kReads) decision.name = parameter.name;
  v.Field("state", decision.state);
  v.Later("assessment", parameter.assessment);
  v.Field("rule", decision.rule);
  v.Field("reason", decision.reason);
  v.Field("identified_combination", decision.identified_combination);
  v.Field("prior_std", decision.prior_std);
  v.Field("predicted_std", decision.predicted_std);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, ErrorRung>& rung) {
  v.Field("name", rung.name);
  v.Field("num_terms", rung.num_terms);
  v.Field("weight", rung.weight);
  v.Later("evidence", rung.evidence);
  v.Later("is_weighed", rung.is_weighed);
  v.Field("compliance_std", rung.compliance_std);
  v.Field("other_compliance_std", rung.other_compliance_std);
  v.Field("function_std", rung.function_std);
  v.Field("region_error", rung.region_error);
  v.Field("random_error", rung.random_error);
  v.Field("train", rung.train);
  v.Optional("validation", rung.validation);
  v.Optional("validation_rotation", rung.validation_rotation);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, ErrorTermEstimate>& term) {
  v.Field("name", term.name);
  v.Field("value", term.value);
  v.Field("std", term.std);
  v.Field("unit", term.unit);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, ErrorTermEffect>& effect) {
  v.Field("joint", effect.joint);
  v.Field("term", effect.term);
  v.Field("rms", effect.rms);
  v.Field("max", effect.max);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, MeasuredRange>& range) {
  v.Field("joint", range.joint);
  v.Field("lower", range.lower);
  v.Field("upper", range.upper);
}

/// Residuals by joint value are in a CSV file beside it.
template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, ErrorTermsResult>& errors) {
  v.Field("share", errors.share);
  v.Field("t_regions", errors.t_regions);
  v.Field("t_random", errors.t_random);
  v.Field("effective_terms", errors.effective_terms);
  v.Field("sentence", errors.sentence);
  v.Field("rungs", errors.rungs);
  v.Later("region_error", errors.region_error);
  v.Later("random_error", errors.random_error);
  v.Later("terms", errors.terms);
  v.Later("effects", errors.effects);
  v.Later("measured", errors.measured);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, KeptErrors>& kept) {
  v.Field("rejected", kept.num_rejected);
  v.Field("before", kept.before);
  v.Field("after", kept.after);
  v.Optional("rotation_before", kept.rotation_before);
  v.Optional("rotation_after", kept.rotation_after);
  v.Field("change_t", kept.change_t);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, KeptCrossValidation>& kept) {
  v.Field("rejected", kept.num_rejected);
  v.Field("position", kept.position);
  v.Optional("rotation", kept.rotation);
}

/// Numbers of each pose are in CSV files beside it.
template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, EvaluatedSet>& set) {
  v.Field("name", set.name);
  v.Field("joint_units", set.joint_dimensions);
  v.Field("before", set.before);
  v.Field("after", set.after);
  v.Optional("rotation_before", set.rotation_before);
  v.Optional("rotation_after", set.rotation_after);
  v.Later("change_t", set.change_t);
  v.Optional("without_rejected", set.kept);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, SolverRun>& run) {
  VisitFields(v, run.summary);
  v.Field("train", run.train);
  v.Field("values", run.values);
  v.Field("history", run.summary.iterations);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, AcceptanceCheck>& check) {
  v.Field("quantity", check.quantity);
  v.Later("unit", check.dimension);
  v.Field("limit", check.limit);
  v.Field("obtained", check.obtained);
  v.Later("rejected", check.num_rejected);
  v.Computed("met", check.met());
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, StageResult>& stage) {
  v.Field("name", stage.name);
  v.Field("free", stage.num_free);
  v.Field("train", stage.train);
  v.Optional("validation", stage.validation);
  v.Optional("train_rotation", stage.train_rotation);
  v.Optional("validation_rotation", stage.validation_rotation);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, ReferenceResult>& reference) {
  v.Field("block", reference.block);
  v.Field("name", reference.name);
  v.Field("known", reference.is_known);
  const bool is_plane = v.Has("normal", std::isfinite(reference.offset));
  v.Field(is_plane ? "normal" : "position", reference.vector);
  if (is_plane) v.Field("offset", reference.offset);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, CrossValidation>& validation) {
  v.Field("folds", validation.folds);
  v.Field("position", validation.position);
  v.Optional("rotation", validation.rotation);
  v.Optional("without_rejected", validation.kept);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, PriorScaling>& scaling) {
  v.Field("angle", scaling.angle);
  v.Field("length", scaling.length);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, RepeatSpread>& repeats) {
  v.Field("length", repeats.length);
  v.Field("length_degrees_of_freedom", repeats.length_degrees_of_freedom);
  v.Field("rotation", repeats.rotation);
  v.Field("rotation_degrees_of_freedom", repeats.rotation_degrees_of_freedom);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, PosePerformance>& one) {
  v.Field("pose", one.pose);
  v.Optional("target", one.target);
  v.Field("n", one.n);
  v.Field("AP_p_before", one.before);
  v.Field("AP_p", one.accuracy);
  v.Field("mean_distance", one.mean_distance);
  v.Field("distance_std", one.distance_std);
  v.Computed("RP_l", one.repeatability());
  const bool has_rotation =
      v.Has("AP_abc", std::isfinite(one.rotation_accuracy[0]));
  if (!has_rotation) return;
  v.Field("AP_abc", one.rotation_accuracy);
  v.Field("RP_abc", one.rotation_repeatability);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, PosePerformanceSummary>& set) {
  v.Field("poses", set.poses);
  v.Field("configurations", set.configurations);
  v.Field("fewest_measurements", set.fewest);
  v.Field("AP_p_before", set.before);
  v.Field("AP_p", set.accuracy);
  v.Field("RP_l", set.repeatability);
  v.Field("each", set.each);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, RejectedRow>& row) {
  v.Field("file", row.file);
  v.Field("line", row.line);
  v.Field("reason", row.reason);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, Outlier>& outlier) {
  // Where a file has no label, each pose was one observation.
  const bool has_label = v.Has("observation", true);
  v.Later("observation", outlier.observation);
  v.Field("pose", outlier.label.pose);
  if constexpr (Visitor::kReads) {
    if (!has_label) outlier.observation = outlier.label.pose;
  }
  if (has_label) {
    v.Field("kind", outlier.label.kind);
    v.Field("target", outlier.label.target);
    v.Field("where", outlier.label.where);
  }
  v.Field("error", outlier.error);
  v.Field("standardised", outlier.standardised);
  v.Field("weight", outlier.weight);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, CalibrationResult>& result) {
  v.Field("version", result.version);
  v.Field("command", result.command);
  v.Field("title", result.title);
  v.Field("inputs", result.inputs);
  v.Field("seed", result.seed);
  v.Field("arm", result.arm_name);
  v.Later("verdict", result.verdict);
  v.Field("parameters", result.parameters);
  v.Field("warnings", result.warnings);
  v.Later("plausibility", result.plausibility);
  v.Field("identifiability", result.identifiability);
  v.Group("accuracy", [&](auto& accuracy) {
    accuracy.Field("train", result.train);
    accuracy.Optional("validation", result.validation);
    accuracy.Later("before_note", result.before_note);
  });
  v.Later("stages", result.stages);
  v.Optional("cross_validation", result.cross_validation);
  v.Later("rejected_rows", result.rejected);
  v.Pairs("aliases", result.aliases, "block", "name");
  v.Later("references", result.references);
  v.Optional("prior_scaling", result.prior_scaling);
  v.Optional("error_terms", result.error_terms);
  v.Later("repeats", result.repeats);
  v.Later("pose_performance", result.pose_performance);
  v.LaterGroup("fit", [&](auto& fit) {
    fit.Later("sigma", result.sigma);
    fit.Field("estimated_sigma", result.estimated_sigma);
    fit.Later("estimated_rotation_sigma", result.estimated_rotation_sigma);
    fit.Field("reduced_chi_square", result.reduced_chi_square);
    fit.Field("outlier_limit", result.outlier_limit);
    fit.Field("outliers", result.outliers);
    fit.Later("validation_outliers", result.validation_outliers);
  });
  v.Optional("uncertainty", result.uncertainty);
  v.Computed("solver", result.runs.empty() ? SolverSummary()
                                           : result.runs.front().summary);
  v.Field("runs", result.runs);
  v.Field("acceptance", result.acceptance);
  v.Optional("published_source", result.published_source);
  v.Group("times", [&](auto& times) {
    times.Field("identify_s", result.identify_time_s);
    times.Field("total_s", result.total_time_s);
  });
  if constexpr (Visitor::kReads) {
    for (const ParameterResult& parameter : result.parameters) {
      result.identifiability.decisions.push_back(parameter.decision);
    }
  }
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_CALIBRATION_RESULT_FIELDS_H_
