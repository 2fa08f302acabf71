// Calibrates a simulated arm of three joints, and checks what is found.

#include <cmath>
#include <cstdio>

#include "alidade/random.h"
#include "alidade/units.h"
#include "src/identifiability/rules.h"
#include "src/kernel/measurement_model.h"
#include "src/solve/solver.h"

int main() {
  alidade::Arm arm;
  arm.joints.resize(3);
  arm.joints[0].r = 0.3;
  arm.joints[1].alpha = -90 * alidade::kDegree;
  arm.joints[2].d = 0.25;
  arm.last_from_target().translation().x() = 0.2;

  // The real arm: its third link is 1 mm longer, its second joint off by 2
  // mrad. 30 poses of it are measured.
  const alidade::MeasurementModel model(arm);
  const alidade::ParameterLayout& layout = model.layout();
  const int d3 = layout.Find("d3").value();
  Eigen::VectorXd real_values = model.NominalValues();
  real_values[d3] += 1e-3;
  real_values[layout.Find("theta2").value()] += 2e-3;

  alidade::Random random(/*seed=*/1);
  alidade::Dataset data;
  data.joint_values = Eigen::MatrixXd::NullaryExpr(
      3, 30, [&random] { return random.Uniform(-1.5, 1.5); });
  data.positions() = model.Predict(real_values, data.joint_values);
  data.sigmas() = Eigen::Matrix3Xd::Constant(3, 30, 2e-5);

  const auto pass = alidade::ApplyRules(model, data, {});
  if (pass.exceeds_rank) {
    std::printf("%s\n", pass.refusal.c_str());
    return 1;
  }
  Eigen::VectorXd values = model.NominalValues();
  const auto summary = alidade::SolveLevenbergMarquardt(
      {model, data, alidade::FreeColumns(pass), pass.nominal_rank},
      alidade::SolverOptions(), &values);

  std::printf("%s\nd3 = %.6f mm\n", summary.BriefReport().c_str(),
              values[d3] / alidade::kMillimetre);
  const double error = (values - real_values).cwiseAbs().maxCoeff();
  return summary.IsSolutionUsable() && error < 1e-9 ? 0 : 1;
}
