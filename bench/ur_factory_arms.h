#ifndef ALIDADE_BENCH_UR_FACTORY_ARMS_H_
#define ALIDADE_BENCH_UR_FACTORY_ARMS_H_

#include <cstdint>
#include <string>
#include <vector>

#include "alidade/arm.h"
#include "alidade/dataset.h"

namespace alidade::internal {

/// An arm of Universal Robots: as its model is made, and as the factory's own
/// calibration found it.
struct FactoryArm {
  std::string model;       ///< "UR5e"
  std::string repository;  ///< where its calibration was found
  Arm nominal;
  /// Installed in an instrument's frame, with a target on its flange.
  Arm real;
  /// One file has a half turn in its elbow: it describes no arm of this model.
  bool has_half_turn = false;
};

/// Reads nominal_kinematics.json and factory_calibrations.json of `directory`.
std::vector<FactoryArm> LoadFactoryArms(const std::string& directory);

/// Positions (sigma 0.05 mm) or poses (and 0.02 deg) of the target at random
/// joint values. `seed` draws the joint values, the next one the noise.
Dataset MeasureArm(const Arm& arm, MeasurementKind kind, int num_poses,
                   std::uint64_t seed);

}  // namespace alidade::internal

#endif  // ALIDADE_BENCH_UR_FACTORY_ARMS_H_
