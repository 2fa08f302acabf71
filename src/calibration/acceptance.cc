#include "src/calibration/acceptance.h"

#include <limits>
#include <optional>

#include "src/common/format.h"

namespace alidade::internal {
namespace {

// A limit on what was not measured is not met.
double OrInfinity(const Accuracy& accuracy, double value) {
  return accuracy.n > 0 ? value : std::numeric_limits<double>::infinity();
}

}  // namespace

ValidationErrors ValidationErrorsOf(const CalibrationResult& result) {
  if (result.validation) {
    const KeptErrors judged = result.validation->Judged();
    return {judged.after, judged.rotation_after, judged.num_rejected};
  }
  if (!result.cross_validation) return {};
  const CrossValidation& all = *result.cross_validation;
  return all.kept ? ValidationErrors{all.kept->position, all.kept->rotation,
                                     all.kept->num_rejected}
                  : ValidationErrors{all.position, all.rotation};
}

std::vector<AcceptanceCheck> CheckAcceptance(const AcceptanceLimits& limits,
                                             const CalibrationResult& result) {
  std::vector<AcceptanceCheck> checks;
  std::int64_t num_rejected = 0;
  const auto add = [&](const std::string& quantity,
                       const std::optional<double>& limit, double obtained,
                       Dimension dimension) {
    if (!limit) return;
    checks.push_back({quantity, *limit, obtained, dimension, num_rejected});
  };
  const auto add_lengths = [&](const std::string& set, const Accuracy& accuracy,
                               const std::optional<double>& rms,
                               const std::optional<double>& max) {
    add(set + "_rms", rms, OrInfinity(accuracy, accuracy.rms),
        Dimension::kLength);
    add(set + "_max", max, OrInfinity(accuracy, accuracy.max),
        Dimension::kLength);
  };
  const auto add_rotations =
      [&](const std::string& set, const Accuracy& accuracy,
          const std::optional<double>& rms, const std::optional<double>& max) {
        add(set + "_rotation_rms", rms, OrInfinity(accuracy, accuracy.rms),
            Dimension::kAngle);
        add(set + "_rotation_max", max, OrInfinity(accuracy, accuracy.max),
            Dimension::kAngle);
      };
  const KeptErrors train = result.train.Judged();
  num_rejected = train.num_rejected;
  add_lengths("train", train.after, limits.train_rms, limits.train_max);
  add_rotations("train", train.rotation_after, limits.train_rotation_rms,
                limits.train_rotation_max);
  const ValidationErrors validation = ValidationErrorsOf(result);
  num_rejected = validation.num_rejected;
  add_lengths("validation", validation.lengths, limits.validation_rms,
              limits.validation_max);
  add_rotations("validation", validation.rotations,
                limits.validation_rotation_rms, limits.validation_rotation_max);
  return checks;
}

std::string MissedLimits(const CalibrationResult& result) {
  std::string text;
  for (const AcceptanceCheck& check : result.acceptance) {
    if (check.met()) continue;
    const bool length = check.dimension == Dimension::kLength;
    const double unit = length ? kMillimetre : kDegree;
    const std::string name = std::string(" ") + UnitForPeople(check.dimension);
    text += (text.empty() ? "" : "; ") + check.quantity + " " +
            FormatSignificant(check.obtained / unit, 3) + name + ", at most " +
            FormatSignificant(check.limit / unit, 3) + name;
  }
  return text;
}

}  // namespace alidade::internal
