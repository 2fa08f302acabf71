#include "tests/support/random_errors.h"

namespace alidade::internal::testing {

Load RandomLoad(Random* random) {
  Load load;
  load.mass = random->Uniform(0.2, 3.0);
  load.centre = RandomVector(0.2, random);
  return load;
}

ErrorTerms RandomErrors(const Arm& arm, Random* random) {
  constexpr double kSize = 0.05;  // rad, m
  const int n = arm.num_joints();
  ErrorTerms errors;
  errors.gravity = RandomDirection(random);
  errors.coupling = Eigen::MatrixXd::NullaryExpr(
      n, n, [&] { return random->Uniform(-kSize, kSize); });
  errors.load_geometry.resize(5, n);
  for (int j = 0; j < n; ++j) {
    const Joint& joint = arm.joints[j];
    JointErrors terms;
    // Of moments of some 10 N m.
    terms.compliance = RandomVector(0.1 * kSize, random);
    const double range = joint.upper - joint.lower;
    terms.function.spacing = range / 15.0;
    terms.function.first = joint.lower + range / 6.0;
    terms.function.values = Eigen::VectorXd::NullaryExpr(
        11, [&] { return random->Uniform(-kSize, kSize); });
    if (j == 1 && joint.type == JointType::kRevolute) {
      terms.function.is_periodic = true;
      terms.function.spacing = 2.0 * M_PI / 11.0;
    }
    terms.harmonics = {{1.0, kSize, -0.3 * kSize},
                       {random->Uniform(2.0, 9.0), 0.2 * kSize, kSize}};
    terms.backlash = random->Uniform(-kSize, kSize);
    errors.joints.push_back(terms);
    errors.links.push_back(RandomLoad(random));
    errors.load_geometry.col(j) << joint.beta, joint.alpha, joint.d,
        joint.theta, joint.r;
    for (double& value : errors.load_geometry.col(j)) {
      value += random->Uniform(-kSize, kSize);
    }
  }
  errors.payload = RandomLoad(random);
  errors.load_target = RandomVector(0.2, random);
  return errors;
}

}  // namespace alidade::internal::testing
