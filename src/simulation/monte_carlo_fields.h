#ifndef ALIDADE_SRC_SIMULATION_MONTE_CARLO_FIELDS_H_
#define ALIDADE_SRC_SIMULATION_MONTE_CARLO_FIELDS_H_

#include "alidade/monte_carlo.h"
#include "src/common/option_fields.h"
#include "src/simulation/noise_study.h"

namespace alidade::internal {

template <>
inline constexpr std::array kWords<SimulatedTruth> = {
    std::pair{SimulatedTruth::kGiven, "given"},
    std::pair{SimulatedTruth::kIdentified, "identified"},
    std::pair{SimulatedTruth::kPriors, "priors"},
};

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, MonteCarloOptions>& options) {
  v.Field(Key("trials").AtLeast(2).AtMost(100000000), options.trials,
          "simulated calibrations of `alidade montecarlo`, at most");
  v.Field(Key("seed"), options.seed, "trial k draws from stream k of it");
  v.Field(Key("truth").Default(
              "`given` where the job has a `truth`, else `identified`"),
          options.truth,
          "the real arm: `given`, the job's `truth`; `identified`, the arm "
          "that the job identifies (a parametric bootstrap); `priors`: all "
          "joint parameters drawn from their priors, anew for every trial");
  v.Section(Key("outliers"),
            "observations that are off by a Gaussian error in every coordinate",
            [&](auto& outliers) {
              outliers.Field(Key("fraction").Above(0).Below(1).Required(),
                             options.outlier_fraction, "so many of them");
              outliers.Field(LengthKey("size").Above(0).Required(),
                             options.outlier_size,
                             "standard deviation of that error; orientations "
                             "are off by as much at the end of the reach");
            });
  v.Section(Key("joint_repeatability"),
            "standard deviations with which joints miss their values",
            [&](auto& joints) {
              joints.Field(AngleKey("angle").Above(0),
                           options.joint_angle_sigma, "of revolute joints");
              joints.Field(LengthKey("length").Above(0),
                           options.joint_length_sigma, "of prismatic joints");
            });
  v.Field(Key("workspace_poses").AtLeast(1).AtMost(1000000),
          options.workspace_poses,
          "configurations at which calibrated and real arm are compared");
  v.Field(Key("precision").Above(0).Below(1).Default("none"), options.precision,
          "stop where the mean error over the workspace is known to this part "
          "of itself (half its 95 % interval)");
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, NoiseStudyConfig>& study) {
  v.Field(Key("trials").AtLeast(1), study.trials, "number of calibrations");
  v.Field(Key("workspace_poses").AtLeast(1), study.workspace_poses,
          "poses drawn within the limits that each result is compared with the "
          "true arm at");
  v.Field(Key("seed"), study.seed, "of noise and poses");
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SIMULATION_MONTE_CARLO_FIELDS_H_
