#ifndef ALIDADE_TESTS_UNCERTAINTY_FITTED_ARM_H_
#define ALIDADE_TESTS_UNCERTAINTY_FITTED_ARM_H_

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "src/common/random.h"
#include "src/model/joint_draw.h"
#include "src/uncertainty/lack_of_fit.h"
#include "tests/support/matrix_kinematics.h"
#include "tests/support/reference_solution.h"
#include "tests/support/rv2aj_arms.h"
#include "tests/support/study.h"

// An RV-2AJ calibrated with the positions of a simulated real arm, which may
// have errors beyond its parameters.
namespace alidade::internal::testing {

inline constexpr double kSigma = 0.02e-3;  // m

// From the nominal values, in extended precision.
inline Eigen::VectorXd FitReference(const MeasurementModel& model,
                                    const Dataset& data,
                                    const std::vector<int>& columns) {
  return SolveReference(model.nominal(),
                        model.NominalValues().cast<long double>(), data,
                        columns)
      .values.cast<double>();
}

inline Eigen::Vector3d PositionOf(const Arm& arm,
                                  const Eigen::VectorXd& joints) {
  return MatrixPosition(arm, joints.data()).cast<double>();
}

// What the real arm does at joint values, of row i.
using RealArm = std::function<Eigen::Vector3d(const Eigen::VectorXd&, int)>;

// An RV-2AJ fitted to what a real arm did, each pose measured `repeats` times.
class Fitted {
 public:
  Fitted(int poses, int repeats, std::uint64_t seed, const RealArm& real,
         double noise = kSigma)
      : model_(Rv2ajFlange()), columns_(FlangeFreeColumns(ParameterLayout(5))) {
    const Eigen::MatrixXd drawn =
        DrawJointValues(model_.nominal(), poses, seed);
    Eigen::MatrixXd joints(5, poses * repeats);
    Eigen::Matrix3Xd points(3, poses * repeats);
    Random random(seed, 77);
    for (int i = 0; i < joints.cols(); ++i) {
      joints.col(i) = drawn.col(i / repeats);
      points.col(i) = real(joints.col(i), i / repeats);
      for (double& value : points.col(i)) value += noise * random.Normal();
    }
    data_ = MakePositions(joints, points, kSigma);
    values_ = FitReference(model_, data_, columns_);
  }

  FittedProblem problem() const {
    return {model_, data_, columns_, no_priors_, losses_, values_};
  }
  LackAssessment Assess(const StatedNoise& stated) const {
    return AssessLackOfFit(problem(), CovarianceOf(problem()), stated);
  }
  Linearization Rows() const {
    Linearization rows;
    model_.Linearize(values_, data_, columns_, &rows);
    return rows;
  }
  void AddCovariate(const std::string& name, const Eigen::MatrixXd& values) {
    data_.covariate_names.push_back(name);
    data_.covariates = values;
  }
  const MeasurementModel& model() const { return model_; }
  const Dataset& data() const { return data_; }

 private:
  const MeasurementModel model_;
  Dataset data_;
  const std::vector<int> columns_;
  const Eigen::VectorXd no_priors_;
  const std::vector<RobustLoss> losses_;
  Eigen::VectorXd values_;
};

// The nominal arm itself.
inline Eigen::Vector3d Rigid(const Eigen::VectorXd& joints, int /*row*/) {
  return PositionOf(Rv2ajFlange(), joints);
}

// Off by a draw of so much in each axis, the same at each visit of a pose.
inline RealArm OffBy(double size, std::uint64_t seed) {
  return [=](const Eigen::VectorXd& joints, int row) {
    Random random(seed, static_cast<std::uint64_t>(row));
    Eigen::Vector3d off;
    for (double& value : off) value = size * random.Normal();
    return Eigen::Vector3d(Rigid(joints, row) + off);
  };
}

// The derivative of the heights of the frames beyond joint j and of the target
// by the joint's value: what the moment of unit weights is, up to its sign.
inline double MomentByHeights(const Arm& arm, const Eigen::VectorXd& joints,
                              int j) {
  const Eigen::Vector3d upwards = -arm.errors.gravity;
  constexpr double kStep = 1e-6;
  double moment = 0.0;
  for (int frames = j + 2; frames <= arm.num_joints() + 1; ++frames) {
    Arm part = arm;
    const bool is_target = frames > arm.num_joints();
    if (!is_target) {
      // The frame of joint `frames - 1`: all beyond it left out.
      for (int k = frames; k < arm.num_joints(); ++k) part.joints[k] = Joint();
      part.last_from_target().setIdentity();
    }
    Eigen::VectorXd up = joints;
    Eigen::VectorXd down = joints;
    up[j] += kStep;
    down[j] -= kStep;
    moment += upwards.dot(PositionOf(part, up) - PositionOf(part, down)) /
              (2.0 * kStep);
  }
  return moment;
}

// Joint 2 gives way by its gravity moment: 4e-4 rad a metre of unit weights.
inline Eigen::Vector3d Bent(const Eigen::VectorXd& joints, int row) {
  Eigen::VectorXd moved = joints;
  moved[1] -= 4e-4 * MomentByHeights(Rv2ajFlange(), joints, 1);
  return Rigid(moved, row);
}

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_UNCERTAINTY_FITTED_ARM_H_
