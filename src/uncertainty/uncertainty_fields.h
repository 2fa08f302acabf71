#ifndef ALIDADE_SRC_UNCERTAINTY_UNCERTAINTY_FIELDS_H_
#define ALIDADE_SRC_UNCERTAINTY_UNCERTAINTY_FIELDS_H_

#include <limits>

#include "alidade/uncertainty.h"
#include "src/common/accuracy_fields.h"
#include "src/common/constants.h"
#include "src/common/option_fields.h"

namespace alidade::internal {

template <>
inline constexpr std::array kWords<IntervalMethod> = {
    std::pair{IntervalMethod::kAutomatic, "auto"},
    std::pair{IntervalMethod::kLinear, "linear"},
    std::pair{IntervalMethod::kProfile, "profile"},
};

template <>
inline constexpr std::array kWords<StructureKind> = {
    std::pair{StructureKind::kJointValue, "joint_value"},
    std::pair{StructureKind::kJointRipple, "joint_ripple"},
    std::pair{StructureKind::kGravityMoment, "gravity_moment"},
    std::pair{StructureKind::kGravitySign, "gravity_sign"},
    std::pair{StructureKind::kApproach, "approach_direction"},
    std::pair{StructureKind::kRowOrder, "row_order"},
    std::pair{StructureKind::kCovariate, "covariate"},
};

template <>
inline constexpr std::array kWords<NoiseSource> = {
    std::pair{NoiseSource::kNone, "none"},
    std::pair{NoiseSource::kStated, "stated"},
    std::pair{NoiseSource::kRepeats, "repeats"},
    std::pair{NoiseSource::kStructure, "structure"},
};

template <>
inline constexpr std::array kWords<BudgetSource> = {
    std::pair{BudgetSource::kParameters, "parameters"},
    std::pair{BudgetSource::kModel, "model"},
    std::pair{BudgetSource::kRepeatability, "repeatability"},
    std::pair{BudgetSource::kResiduals, "residuals"},
    std::pair{BudgetSource::kMeasurement, "measurement"},
};

template <>
inline constexpr std::array kWords<EvaluationType> = {
    std::pair{EvaluationType::kA, "A"},
    std::pair{EvaluationType::kB, "B"},
};

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, UncertaintyOptions>& options) {
  v.Field(Key("confidence").Above(0).Below(1), options.confidence,
          "of intervals and ellipsoids");
  v.Field(Key("intervals"), options.intervals,
          "`linear`: estimate +- quantile * standard deviation; `profile`: of "
          "the profile likelihood, for every parameter; `auto`: for those "
          "whose nonlinearity is above the limit. Profiles need the solver "
          "`ceres` and 100 000 observations at most");
  v.Field(Key("nonlinearity_limit").Above(0), options.nonlinearity_limit,
          "second-order part of an estimate, in standard deviations");
  v.Field(Key("map").AtLeast(0).AtMost(1000000), options.map_configurations,
          "configurations, drawn within the joint limits, that the accuracy is "
          "predicted at; 0 = none");
  v.Field(Key("seed"), options.seed, "of these");
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, ConfidenceInterval>& interval) {
  v.Field("lower", interval.lower, -kInfinity);
  v.Field("upper", interval.upper, kInfinity);
  v.Field("profile", interval.is_profile);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, ParameterUncertainty>& one) {
  v.Field("name", one.name);
  v.Field("std", one.std, kInfinity);
  v.Field("interval", one.interval);
  v.Field("nonlinearity", one.nonlinearity, kInfinity);
  v.Field("prior_share", one.prior_share);
  v.Later("robust_std", one.robust_std);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, CorrelatedPair>& pair) {
  v.Field("first", pair.first);
  v.Field("second", pair.second);
  v.Field("correlation", pair.correlation);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, TestResult>& test) {
  v.Field("statistic", test.statistic);
  v.Field("p_value", test.p_value);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, Histogram>& histogram) {
  v.Field("lower", histogram.lower);
  v.Field("width", histogram.width);
  v.Field("counts", histogram.counts);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, Coverage>& coverage) {
  v.Field("held", coverage.held);
  v.Field("n", coverage.n);
  v.Computed("rate", coverage.rate());
  v.Field("lower", coverage.lower);
  v.Field("upper", coverage.upper);
}

/// What has one entry per pose or configuration is in CSV files beside it,
/// here and below.
template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, ResidualDiagnostics>& residuals) {
  v.Field("chi_square", residuals.chi_square);
  v.Field("degrees_of_freedom", residuals.degrees_of_freedom);
  v.Field("reduced_chi_square", residuals.reduced_chi_square);
  v.Field("chi_square_p_value", residuals.chi_square_p_value);
  v.Field("normality", residuals.normality);
  v.Field("whiteness", residuals.whiteness);
  v.Field("lags", residuals.lags);
  v.Field("studentised_histogram", residuals.histogram);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, StructureTest>& test) {
  v.Field("kind", test.kind);
  v.Field("joint", test.joint);
  v.Optional("covariate", test.covariate);
  v.Field("statistic", test.statistic);
  v.Field("degrees_of_freedom", test.degrees_of_freedom);
  v.Field("p_value", test.p_value);
  v.Field("explained", test.explained);
  v.Field("found", test.is_found);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, LackOfFit>& lack) {
  v.Field("noise_source", lack.source);
  v.Field("noise", lack.noise);
  v.Field("residual", lack.residual);
  v.Field("degrees_of_freedom", lack.degrees_of_freedom);
  v.Field("p_value", lack.p_value);
  v.Field("excess_variance", lack.excess_variance);
  v.Field("rotation_excess_variance", lack.rotation_excess_variance);
  v.Later("excess_degrees_of_freedom", lack.excess_degrees_of_freedom);
  v.Field("looks", lack.looks);
  v.Field("sample", lack.is_sample);
  v.Field("structure", lack.structure);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, PredictionParts>& parts) {
  v.Field("from_parameters", parts.from_parameters,
          std::numeric_limits<double>::infinity());
  v.Field("from_model", parts.from_model);
  v.Field("from_measurement", parts.from_measurement);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, PredictionCheck>& check) {
  v.Field("confidence", check.confidence);
  v.Field("axes", check.axes);
  v.Field("ellipsoids", check.ellipsoids);
  v.Later("outliers", check.num_outliers);
  v.Field("rms_z", check.rms_z);
  v.Field("verdict", check.verdict);
  v.Later("parts", check.parts);
  v.Field("z_histogram", check.histogram);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, PredictedMap>& map) {
  v.Field("position_std", map.summary);
  v.Field("rotation_std", map.rotation_summary);
  v.Optional("true_error", map.true_summary);
  v.Later("parts", map.parts);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, WorkspaceBox>& box) {
  v.Field("lower", box.lower);
  v.Field("upper", box.upper);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, BudgetContribution>& one) {
  v.Field("source", one.source);
  v.Field("type", one.type);
  v.Field("std", one.std, kInfinity);
  v.Field("degrees_of_freedom", one.degrees_of_freedom, kInfinity);
  v.Field("basis", one.basis);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, ParameterContribution>& one) {
  v.Field("name", one.name);
  v.Field("unit", one.dimension);
  v.Field("std", one.std, kInfinity);
  v.Field("sensitivity", one.sensitivity);
  v.Computed("contribution", one.contribution());
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, CombinedUncertainty>& combined) {
  v.Field("std", combined.std, kInfinity);
  v.Field("degrees_of_freedom", combined.degrees_of_freedom, kInfinity);
  v.Field("coverage_factor", combined.coverage_factor, kInfinity);
  v.Field("expanded", combined.expanded, kInfinity);
  v.Field("expanded_distance", combined.expanded_distance, kInfinity);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, UncertaintyBudget>& budget) {
  v.Field("region", budget.region);
  v.Field("configurations", budget.configurations);
  v.Field("confidence", budget.confidence);
  v.Field("contributions", budget.contributions);
  v.Field("parameters", budget.parameters);
  v.Field("position", budget.position);
  v.Field("measured", budget.measured);
  v.Field("worst_std", budget.worst_std,
          std::numeric_limits<double>::infinity());
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, UncertaintyResult>& result) {
  v.Field("confidence", result.confidence);
  v.Field("degrees_of_freedom", result.degrees_of_freedom,
          std::numeric_limits<double>::infinity());
  v.Field("estimator", result.estimator);
  v.Field("parameters", result.parameters);
  v.Field("covariance", result.covariance);
  v.Later("prediction_covariance", result.prediction_covariance);
  v.Field("correlated", result.correlated);
  v.Field("residuals", result.residuals);
  v.Later("lack_of_fit", result.lack_of_fit);
  v.Optional("workspace", result.workspace);
  v.Optional("validation", result.validation);
  v.Optional("budget", result.budget);
  v.Field("warnings", result.warnings);
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_UNCERTAINTY_UNCERTAINTY_FIELDS_H_
