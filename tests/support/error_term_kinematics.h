#ifndef ALIDADE_TESTS_SUPPORT_ERROR_TERM_KINEMATICS_H_
#define ALIDADE_TESTS_SUPPORT_ERROR_TERM_KINEMATICS_H_

#include <Eigen/Core>

#include "alidade/arm.h"
#include "src/common/random.h"
#include "tests/support/matrix_kinematics.h"

namespace alidade::internal::testing {

/// An independent forward kinematics with error terms: the equations of
/// alidade/error_terms.h as products of 4 x 4 matrices in long double. It takes
/// an arm whose moments are those of its own geometry.
class ErrorTermKinematics {
 public:
  explicit ErrorTermKinematics(const Arm& arm) : arm_(arm) {}

  Matrix4l TargetFrame(const Eigen::VectorXd& q) const;

 private:
  // Of the arm without its errors, in the axes of each frame.
  Matrix3Xl Moments(const Eigen::VectorXd& q) const;

  const Arm& arm_;
};

/// `nominal` with every parameter off by up to 3 mrad or 0.5 mm, and all error
/// terms of the sizes of real arms.
Arm WithRandomErrors(const Arm& nominal, Random* random);

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_SUPPORT_ERROR_TERM_KINEMATICS_H_
