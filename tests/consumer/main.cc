// Calibrates a simulated arm of three joints, and checks what is found.

#include <cmath>
#include <cstdio>
#include <random>

#include "alidade/calibration.h"
#include "alidade/forward_kinematics.h"
#include "alidade/units.h"

int main() {
  alidade::Arm arm;
  arm.joints.resize(3);
  arm.joints[0].r = 0.3;
  arm.joints[1].alpha = -90 * alidade::kDegree;
  arm.joints[2].d = 0.25;
  arm.last_from_target().translation().x() = 0.2;

  // The real arm: its third link is 1 mm longer, its second joint off by 2
  // mrad. 40 poses of it are measured with 0.02 mm of noise.
  alidade::Arm real = arm;
  real.joints[2].d += 1e-3;
  real.joints[1].theta += 2e-3;
  const double sigma = 0.02e-3;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> joint_value(-1.5, 1.5);
  std::normal_distribution<double> noise(0.0, sigma);
  const Eigen::MatrixXd joint_values =
      Eigen::MatrixXd::NullaryExpr(3, 40, [&] { return joint_value(random); });
  const Eigen::Matrix3Xd measured =
      alidade::TargetPositions(real, joint_values) +
      Eigen::Matrix3Xd::NullaryExpr(3, 40, [&] { return noise(random); });

  alidade::CalibrationOptions options;
  options.holdout = alidade::HoldOutOptions();  // 30 % for validation
  const alidade::CalibrationResult result = alidade::Calibrate(
      arm, alidade::MakePositions(joint_values, measured, sigma), options);
  std::printf("%s", result.FullReport().c_str());
  if (!result.IsUsable()) return 1;
  const alidade::ParameterResult& d3 = result.Parameter("d3");
  const alidade::ConfidenceInterval interval = result.Interval("d3");
  std::printf("d3 = %.4f mm, from %.4f to %.4f mm with 95 %% confidence\n",
              d3.value / alidade::kMillimetre,
              interval.lower / alidade::kMillimetre,
              interval.upper / alidade::kMillimetre);

  // Five standard deviations, and an accuracy of the order of the noise.
  const bool is_found = std::abs(d3.value - 0.251) < 5 * d3.std &&
                        interval.lower < d3.value && d3.value < interval.upper;
  const double rms = result.validation->after.rms;
  return is_found && rms > 0.5 * sigma && rms < 4 * sigma ? 0 : 1;
}
