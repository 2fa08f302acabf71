#ifndef ALIDADE_IDENTIFIABILITY_PRIORS_H_
#define ALIDADE_IDENTIFIABILITY_PRIORS_H_

#include <Eigen/Core>
#include <string>

#include "alidade/model/parameter_layout.h"

namespace alidade {

/// What is known of an arm before anything is measured: the standard deviations
/// of its parameters about their nominal values, by kind (rad, m). The defaults
/// are those of industrial arms of up to some metres: 5 mrad and 1 mm. Base and
/// tool are known no better than where they were put by hand: 1 m and 1 rad.
struct PriorTolerances {
  double beta = 5e-3;
  double alpha = 5e-3;
  double d = 1e-3;
  double theta = 5e-3;
  double r = 1e-3;
  double frame_length = 1.0;
  double frame_angle = 1.0;

  double Of(ParameterKind kind) const;
  /// One entry per column of the layout.
  Eigen::VectorXd Deviations(const ParameterLayout& layout) const;
  /// False with a message that names the field, its value and the constraint.
  bool IsValid(std::string* error) const;
};

}  // namespace alidade

#endif  // ALIDADE_IDENTIFIABILITY_PRIORS_H_
