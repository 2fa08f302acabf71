#ifndef ALIDADE_SRC_CALIBRATION_CALIBRATION_OPTIONS_FIELDS_H_
#define ALIDADE_SRC_CALIBRATION_CALIBRATION_OPTIONS_FIELDS_H_

#include "alidade/calibration_options.h"
#include "src/common/option_fields.h"

namespace alidade::internal {

template <>
inline constexpr std::array kWords<SolverName> = {
    std::pair{SolverName::kCeres, "ceres"},
    std::pair{SolverName::kPseudoInverse, "pseudo_inverse"},
};

template <>
inline constexpr std::array kWords<LossKind> = {
    std::pair{LossKind::kNone, "none"},
    std::pair{LossKind::kHuber, "huber"},
    std::pair{LossKind::kCauchy, "cauchy"},
    std::pair{LossKind::kTukey, "tukey"},
};

template <>
inline constexpr std::array kWords<PriorScale> = {
    std::pair{PriorScale::kGiven, "given"},
    std::pair{PriorScale::kEstimated, "estimated"},
};

template <>
inline constexpr std::array kWords<ErrorTermSelection> = {
    std::pair{ErrorTermSelection::kNone, "none"},
    std::pair{ErrorTermSelection::kAuto, "auto"},
    std::pair{ErrorTermSelection::kStated, "stated"},
};

/// The terms of a job that states them.
template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, ErrorTermOptions>& options) {
  v.Field(Key("elasticity"), options.elasticity,
          "each joint gives way to the moment of gravity about its three axes "
          "(a prismatic one about two)");
  v.Field(AngleKey("functions").AtLeast(0).Default("none"),
          options.function_length,
          "a smooth function of its value is added to each joint; this is "
          "how far its values resemble each other: 0.05 to 0.3 rad for errors "
          "of gears and encoders, 1.5 rad for what repeats once or twice a "
          "turn. Along a prismatic joint a metre counts as a radian");
  v.Field(Key("scale"), options.scale,
          "each joint moves by more or less than it should");
  v.Field(Key("backlash"), options.backlash,
          "half a step by the sign of the moment about a revolute joint's "
          "axis");
  v.Field(Key("covariates"), options.covariates,
          "each covariate of the data moves the base, or what its `effects` "
          "say (`columns`: `covariates`, `station`, `approach`)");
}

template <>
inline constexpr std::array kWords<HoldOutBy> = {
    std::pair{HoldOutBy::kPose, "pose"},
    std::pair{HoldOutBy::kBlock, "block"},
    std::pair{HoldOutBy::kRegion, "region"},
};

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, HoldOutOptions>& options) {
  v.Field(Key("by"), options.by,
          "what `fraction` holds out: each `pose` by itself, `block`s of "
          "consecutive ones (of twenty), or whole `region`s of joint space, "
          "which shows what the calibration is worth where nothing was "
          "measured");
  v.Field(Key("fraction").Above(0).Below(1).Default(""), options.fraction,
          "so much of the configurations is held out. Rows with equal joint "
          "values are one configuration and stay together, and so do the two "
          "poses of a difference");
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, FoldsOptions>& options) {
  v.Field(Key("folds").AtLeast(2).AtMost(1000).Default(""), options.folds,
          "cross-validation with so many folds: the fit is repeated without "
          "each, stations, frames, sigma and error terms anew as the job asks "
          "for them; the result itself is of all poses");
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, AcceptanceLimits>& limits) {
  const auto train = "of the position error at the poses of `data`";
  const auto validation =
      "likewise at those of `validation`; with `folds`, of "
      "the errors of the poses left out of each fit";
  const auto rotation =
      "likewise of the orientation error, where orientations are measured";
  v.Field(LengthKey("train_rms").Above(0), limits.train_rms, train);
  v.Field(LengthKey("train_max").Above(0), limits.train_max, train);
  v.Field(LengthKey("validation_rms").Formerly("heldout_rms").Above(0),
          limits.validation_rms, validation);
  v.Field(LengthKey("validation_max").Formerly("heldout_max").Above(0),
          limits.validation_max, validation);
  v.Field(AngleKey("train_rotation_rms").Above(0), limits.train_rotation_rms,
          rotation);
  v.Field(AngleKey("train_rotation_max").Above(0), limits.train_rotation_max,
          rotation);
  v.Field(AngleKey("validation_rotation_rms")
              .Formerly("heldout_rotation_rms")
              .Above(0),
          limits.validation_rotation_rms, rotation);
  v.Field(AngleKey("validation_rotation_max")
              .Formerly("heldout_rotation_max")
              .Above(0),
          limits.validation_rotation_max, rotation);
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_CALIBRATION_OPTIONS_FIELDS_H_
