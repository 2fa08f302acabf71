#ifndef ALIDADE_SRC_SERIALIZATION_JOB_OPTIONS_H_
#define ALIDADE_SRC_SERIALIZATION_JOB_OPTIONS_H_

#include <utility>
#include <vector>

#include "src/calibration/calibration_options_fields.h"
#include "src/serialization/errors_section.h"
#include "src/serialization/field_records.h"
#include "src/serialization/identifiability_section.h"
#include "src/serialization/job_config.h"
#include "src/serialization/references_section.h"
#include "src/solve/solver_fields.h"

namespace alidade::internal {

/// What a job says of the calibration itself, whatever it is made of: for job
/// files, and for options that are given without one (option_text.h).

inline constexpr char kBoundsSchema[] =
    R"({"type": "object", "additionalProperties": {"type": "array", "items": {"type": ["number", "string"]}, "minItems": 2, "maxItems": 2}})";

/// Whether points or planes are to be identified.
bool HasUnknownReferences(const References& references);

/// What options must agree in. @throws InputError at the map.
void CheckLoss(const YamlMap& map, const JobConfig& job);
void CheckCompareWith(const YamlMap& map, const JobConfig& job);
void CheckMethod(const YamlMap& map, const JobConfig& job);
/// Many ranks cannot do what asks for all data in one place.
void RefuseForMany(const YamlMap& map, const JobConfig& job);

template <typename Visitor>
void VisitSolvers(Visitor& v, JobConfig* job) {
  CalibrationOptions& options = job->options;
  v.Section(Key("solver"), "how the least-squares problem is solved",
            [&](auto& section) {
              section.Field(Key("name").Named("solver"), options.solver,
                            "`ceres` (Levenberg-Marquardt by Ceres) or "
                            "`pseudo_inverse`");
              VisitFields(section, options.solver_options);
            });
  v.Section(Key("robust"), "against outliers", [&](auto& section) {
    section.Field(
        Key("loss").Required(), options.loss,
        "how the cost of an outlier grows: `none` (squares), `huber`, `cauchy` "
        "or `tukey`, on the norm of each observation's whitened residual, with "
        "the constant of 95 % efficiency for that observation's own dimension, "
        "the number of its rows that were measured. The last two start from "
        "the solution of the ones before them. `ceres` only");
    section.Check([&](const YamlMap& map) { CheckLoss(map, *job); });
  });
  v.Field(Key("compare_with").Named("solver"), options.compare_with,
          "other solvers to run on the same data");
  v.Check([&](const YamlMap& map) { CheckCompareWith(map, *job); });
  v.Check([&](const YamlMap& map) { RefuseForMany(map, *job); });
}

template <typename Visitor>
void VisitIdentification(Visitor& v, JobConfig* job) {
  v.Section(
      Key("identifiability"), "which parameters are identified",
      [&](auto& section) {
        VisitIdentifiability(section, LayoutOf(job->arm, job->data.references),
                             job->arm, &job->options.identifiability);
        section.Field(
            Key("prior_scale"), job->options.prior_scale,
            "`estimated`: the priors of the joints are multiplied by a factor "
            "of the angles and one of the lengths under which the "
            "measurements are most likely (empirical Bayes); `given`: they "
            "are as stated");
        section.Check([&](const YamlMap& map) { CheckMethod(map, *job); });
      });
  v.Custom(
      Key("errors").Default("auto").Schema(kErrorsSchema),
      "errors of the arm that are not rigid geometry: `none`, `auto` (what "
      "the measurements have evidence for), or a map of terms (\"Error "
      "terms of a job\", below). `none` leaves those of the arm as they "
      "are",
      [&](const YamlValue& value, const Units& units) {
        ErrorTermOptions& errors = job->options.errors;
        std::vector<CovariateUse> uses = std::move(errors.uses);
        errors = ReadErrorTerms(value, units, job->arm.num_joints());
        errors.uses = std::move(uses);
      });
  v.Custom(
      Key("bounds").In("the parameter's").Schema(kBoundsSchema),
      "map from names of joint parameters (`beta1`, `alpha2`, `d3`, `theta4`, "
      "`r5`) to `[lower, upper]`: limits in the solve, as deviations from the "
      "nominal value, 0 between them; `-.inf` or `.inf` leaves one end open. "
      "`ceres` only",
      [&](const YamlValue& value, const Units& units) {
        job->options.bounds =
            ReadBounds(value, units, LayoutOf(job->arm, job->data.references),
                       NominalValues(job->arm, job->data.references));
      });
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_JOB_OPTIONS_H_
