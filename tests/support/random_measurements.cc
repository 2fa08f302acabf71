#include "tests/support/random_measurements.h"

namespace alidade::internal::testing {

void PlaceReferences(MeasuredArm* measured, Random* random) {
  const VectorXl values = measured->values.cast<long double>();
  const ParameterLayout& layout = measured->layout;
  const auto position = [&](int pose) {
    return OraclePosition(*measured, values, pose, pose % kMeasuredTargets);
  };
  const auto set_point = [&](int k, const Eigen::Vector3d& point) {
    measured->values.segment<3>(layout.Column(ParameterKind::kPoint, 0, k)) =
        point;
  };
  for (int k = 0; k < kContactPoints; ++k) {
    set_point(k, position(k).cast<double>());
  }
  const double away = 2.0 * Reach(measured->arm) + 2.0;
  for (int k = kContactPoints; k < kMeasuredPoints; ++k) {
    set_point(k, away * RandomDirection(random));
  }
  for (int plane = 0; plane < kMeasuredPlanes; ++plane) {
    // Of three poses, both targets among them.
    const Vector3l corner = position(3 * plane);
    const Vector3l normal = (position(3 * plane + 1) - corner)
                                .cross(position(3 * plane + 2) - corner)
                                .normalized();
    Eigen::Vector3d& nominal = measured->references.planes[plane].normal;
    nominal = normal.cast<double>() + RandomVector(0.2, random);
    nominal.normalize();
    Vector3l t1;
    Vector3l t2;
    const Vector3l n0 = nominal.cast<long double>();
    TangentsOf(n0, &t1, &t2);
    const int tilt = layout.Column(ParameterKind::kPlaneTilt, 0, plane);
    const long double along = normal.dot(n0);
    measured->values[tilt] = static_cast<double>(normal.dot(t1) / along);
    measured->values[tilt + 1] = static_cast<double>(normal.dot(t2) / along);
    measured->values[tilt + 2] = static_cast<double>(normal.dot(corner));
  }
}

ObservationBlock MakeBlock(MeasurementKind kind, int count) {
  ObservationBlock block;
  block.kind = kind;
  block.measured = Eigen::MatrixXd::Zero(RowsOf(kind), count);
  block.sigmas = Eigen::MatrixXd::Ones(RowsOf(kind), count);
  const bool is_of_points = kind == MeasurementKind::kPointDistance;
  for (int i = 0; i < count; ++i) {
    if (!is_of_points) {
      block.poses.push_back(i);
      block.targets.push_back(i % kMeasuredTargets);
    }
    if (kind == MeasurementKind::kDifference) {
      block.seconds.push_back((i + 2) % kMeasuredPoses);
    }
    if (is_of_points) {
      // From a contact point to a far one or back: differences of a distance
      // are exact only where it is long.
      block.references.push_back(i % kContactPoints);
      block.seconds.push_back(kContactPoints + i % 2);
      if (i % 2 == 1) std::swap(block.references[i], block.seconds[i]);
    }
    if (kind == MeasurementKind::kDistance) {
      block.references.push_back(kContactPoints + i % 2);
    }
    if (kind == MeasurementKind::kFixedPoint) block.references.push_back(i);
    if (kind == MeasurementKind::kPlane) block.references.push_back(i / 3);
  }
  return block;
}

void Measure(const MeasuredArm& measured, ObservationBlock* block) {
  const VectorXl values = measured.values.cast<long double>();
  Eigen::MatrixXd exact =
      Eigen::MatrixXd::Zero(block->rows_each(), block->size());
  block->measured = exact;
  if (block->kind == MeasurementKind::kFixedPoint ||
      block->kind == MeasurementKind::kPlane) {
    return;
  }
  for (Eigen::Index i = 0; i < block->size(); ++i) {
    exact.col(i) = OracleResidual(measured, values, *block, i).cast<double>();
  }
  block->measured = std::move(exact);
}

void WeightRows(Weighting weighting, ObservationBlock* block, Random* random) {
  const int height = block->rows_each();
  auto sigmas = Edit(&block->sigmas);
  for (Eigen::Index i = 0; i < block->size(); ++i) {
    for (int row = 0; row < height; ++row) {
      sigmas.at(row, i) = random->Uniform(1e-5, 1e-3);
    }
    const bool is_masked = weighting != Weighting::kSigmas && i % 3 == 1;
    const auto mask = static_cast<int>(i + 1) % height;
    if (is_masked) {
      sigmas.at(mask, i) = std::numeric_limits<double>::infinity();
    }
    if (weighting != Weighting::kFull) continue;
    Eigen::MatrixXd whitener;
    if (i % 3 != 2) {
      whitener = Eigen::MatrixXd::NullaryExpr(
          height, height, [&] { return random->Uniform(-1e4, 1e4); });
      if (is_masked) {
        whitener.row(mask).setZero();
        whitener.col(mask).setZero();
      }
    }
    block->whiteners.push_back(whitener);
  }
}

void AddCovariates(MeasuredArm* measured, Random* random) {
  const int n = measured->arm.num_joints();
  measured->data.covariate_names = {"torque", "tilt", "temperature"};
  measured->data.covariates = Eigen::MatrixXd::NullaryExpr(
      3, kMeasuredPoses, [&] { return random->Uniform(-2.0, 2.0); });
  for (const char* name : {"temperature", "humidity", "tilt"}) {
    CovariateEffect effect;
    effect.name = name;
    effect.reference = random->Uniform(-1.0, 1.0);
    for (double& value : effect.base) value = random->Uniform(-0.03, 0.03);
    for (double& value : effect.target) value = random->Uniform(-0.03, 0.03);
    effect.payload = random->Uniform(-0.1, 0.1);
    if (effect.name != "tilt") {
      effect.joints = Eigen::VectorXd::NullaryExpr(
          n, [&] { return random->Uniform(-0.03, 0.03); });
    }
    measured->arm.errors.covariates.push_back(effect);
  }
}

MeasuredArm RandomMeasurements(int num_joints, Weighting weighting,
                               Random* random, double prismatic_fraction,
                               bool is_flexible) {
  RandomArmOptions options;
  options.num_targets = kMeasuredTargets;
  options.prismatic_fraction = prismatic_fraction;
  MeasuredArm measured{
      RandomArm(num_joints, random, options),
      {},
      ParameterLayout(LayoutShape{num_joints, kMeasuredTargets, kMeasuredPoints,
                                  kMeasuredPlanes}),
      {},
      {}};
  measured.data.name = "random";
  measured.data.joint_values =
      RandomJointValues(measured.arm, kMeasuredPoses, random);
  if (is_flexible) {
    measured.arm.errors = RandomErrors(measured.arm, random);
    AddCovariates(&measured, random);
  }
  measured.references.points.resize(kMeasuredPoints);
  measured.references.planes.resize(kMeasuredPlanes);
  const Eigen::VectorXd of_arm = ValuesWithRotations(measured.arm, 0.4, random);
  measured.values = Eigen::VectorXd::Zero(measured.layout.size());
  measured.values.head(of_arm.size()) = of_arm;
  PlaceReferences(&measured, random);
  for (const MeasurementKind kind : AllKinds()) {
    const bool is_contact = kind == MeasurementKind::kFixedPoint;
    ObservationBlock block =
        MakeBlock(kind, is_contact ? kContactPoints : kMeasuredPoses);
    Measure(measured, &block);
    WeightRows(weighting, &block, random);
    measured.data.blocks.push_back(block);
  }
  return measured;
}

}  // namespace alidade::internal::testing
