#ifndef ALIDADE_TESTS_SUPPORT_STUDY_H_
#define ALIDADE_TESTS_SUPPORT_STUDY_H_

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "alidade/arm.h"
#include "alidade/dataset.h"
#include "alidade/parameter_layout.h"
#include "alidade/units.h"
#include "src/serialization/job_config.h"
#include "src/simulation/simulation.h"
#include "tests/support/rv2aj_arms.h"

namespace alidade::internal::testing {

/// How positions are measured.
struct Measurement {
  std::uint64_t seed = 2;
  double noise_sigma = 0.0;  ///< (m); 0 = exact, with sigmas of 1 m
};

/// Values of the assumed real arm, one per column of the layout. `nominal` is
/// one of the RV-2AJ arms.
Eigen::VectorXd Rv2ajTrueValues(const Arm& nominal);

SimulationConfig MeasurementOf(const Arm& nominal,
                               const Eigen::VectorXd& true_values,
                               const Measurement& measurement);

/// The RV-2AJ at the study's 56 poses in the plane z = 215 mm: 8 azimuths
/// times 7 radii, the elevation of the last axis drawn.
Dataset MeasureStudyPoses(const Arm& nominal,
                          const Measurement& measurement = {});

/// The same without noise, of sigmas of 0.02 mm.
Dataset StudyData(const Arm& nominal);

/// Any arm at poses drawn uniformly within its limits.
Dataset MeasureGenericPoses(const Arm& nominal,
                            const Eigen::VectorXd& true_values, int num_poses,
                            const Measurement& measurement = {});

/// Columns of parameters by name. @pre every name exists.
std::vector<int> ColumnsOf(const ParameterLayout& layout,
                           const std::vector<std::string>& names);

/// Columns of all parameters of the joints: all but base and tool.
std::vector<int> JointColumns(const ParameterLayout& layout);

/// The 17 parameters that the study identifies at the wrist.
std::vector<int> WristFreeColumns(const ParameterLayout& layout);

/// The 18 that are left at the flange once alpha5 and theta4 are fixed.
std::vector<int> FlangeFreeColumns(const ParameterLayout& layout);

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_SUPPORT_STUDY_H_
