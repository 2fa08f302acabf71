#include <ceres/cost_function.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <tuple>
#include <vector>

#include "alidade/dataset.h"
#include "src/common/random.h"
#include "src/kernel/measurement_model.h"
#include "src/kernel/observation_cost.h"
#include "tests/support/cost_evaluation.h"
#include "tests/support/measurement_oracle.h"
#include "tests/support/random_measurements.h"

// Every kind of measurement against the long double oracle.
namespace alidade::internal {
namespace {

using testing::MeasuredArm;
using testing::Weighting;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

std::vector<int> AllColumns(const MeasurementModel& model) {
  std::vector<int> columns(model.layout().size());
  std::iota(columns.begin(), columns.end(), 0);
  return columns;
}

Linearization LinearizeAll(const MeasuredArm& measured,
                           const MeasurementModel& model) {
  Linearization linearization;
  model.Linearize(measured.values, measured.data, AllColumns(model),
                  &linearization);
  return linearization;
}

// All values some millimetres and centiradians off: every residual is far from
// zero, of distances the points are still far.
void MoveAway(MeasuredArm* measured, Random* random) {
  for (double& value : measured->values) {
    value += random->Uniform(-0.03, 0.03);
  }
}

// By how much whitening lets the errors of an observation grow at most.
double LargestWeight(const ObservationBlock& block, Eigen::Index i) {
  return static_cast<double>(testing::OracleWhitener(block, i).norm());
}

// Calls visit(block, i, first row).
template <typename Visit>
void ForEachObservation(const Dataset& data, const Visit& visit) {
  Eigen::Index row = 0;
  for (const ObservationBlock& block : data.blocks) {
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      SCOPED_TRACE("kind " + std::to_string(static_cast<int>(block.kind)) +
                   ", observation " + std::to_string(i));
      visit(block, i, row);
      row += block.rows_each();
    }
  }
}

class MeasurementKindsTest
    : public ::testing::TestWithParam<std::tuple<int, Weighting, bool>> {
 protected:
  int num_joints() const { return std::get<0>(GetParam()); }
  Weighting weighting() const { return std::get<1>(GetParam()); }
  bool is_flexible() const { return std::get<2>(GetParam()); }

  // Another arm for every stream; one in three has prismatic joints only.
  MeasuredArm MakeArm(int stream) {
    random_ = Random(700 + num_joints(), stream);
    const double prismatic_fraction = stream % 3 == 2 ? 1.0 : 0.3;
    return testing::RandomMeasurements(num_joints(), weighting(), &random_,
                                       prismatic_fraction, is_flexible());
  }

  Random random_ = Random(0);
};

constexpr int kArms = 3;

TEST_P(MeasurementKindsTest, ResidualsVanishAtTheTruth) {
  for (int stream = 0; stream < kArms; ++stream) {
    const MeasuredArm measured = MakeArm(stream);
    const MeasurementModel model(measured.arm, measured.references, 1);
    const SharedVector errors = model.Errors(measured.values, measured.data);
    const Eigen::VectorXd residuals = LinearizeAll(measured, model).residuals;
    // Far points are twice the reach away: lengths up to about three of it.
    const double unit = kEpsilon * (3.0 + 3.0 * Reach(measured.arm));
    ForEachObservation(measured.data, [&](const ObservationBlock& block,
                                          Eigen::Index i, Eigen::Index row) {
      const int height = block.rows_each();
      const double largest =
          errors.map().segment(row, height).cwiseAbs().maxCoeff();
      // Three turns for every joint round once each, in either direction.
      EXPECT_LE(largest, 10.0 * unit);
      EXPECT_LE(residuals.segment(row, height).norm(),
                25.0 * unit * LargestWeight(block, i));
    });
    // And not far below what rounding makes of positions: then the measured
    // values would be no others than those that are predicted.
    EXPECT_GT(errors.map().cwiseAbs().maxCoeff(), 0.05 * unit);
  }
}

TEST_P(MeasurementKindsTest, ResidualsAreThoseOfTheOracle) {
  for (int stream = 0; stream < kArms; ++stream) {
    MeasuredArm measured = MakeArm(stream);
    MoveAway(&measured, &random_);
    const MeasurementModel model(measured.arm, measured.references, 1);
    const SharedVector errors = model.Errors(measured.values, measured.data);
    const Eigen::VectorXd residuals = LinearizeAll(measured, model).residuals;
    const testing::VectorXl values = measured.values.cast<long double>();
    const double unit = kEpsilon * (3.0 + 3.0 * Reach(measured.arm));
    EXPECT_GT(errors.map().norm(), 1e-2);
    ForEachObservation(measured.data, [&](const ObservationBlock& block,
                                          Eigen::Index i, Eigen::Index row) {
      const int height = block.rows_each();
      const testing::VectorXl raw =
          testing::OracleResidual(measured, values, block, i);
      const testing::VectorXl whitened =
          testing::OracleWhitener(block, i) * raw;
      for (int k = 0; k < height; ++k) {
        const bool is_measured = std::isfinite(block.sigmas(k, i));
        EXPECT_NEAR(errors[row + k],
                    is_measured ? static_cast<double>(raw[k]) : 0.0,
                    10.0 * unit);
        if (!is_measured) {
          EXPECT_EQ(residuals[row + k], 0.0);
        }
      }
      // Whitening rounds numbers of the residual's own size, too.
      const double rounding =
          25.0 * unit + 10.0 * kEpsilon * static_cast<double>(raw.norm());
      EXPECT_LE(
          (residuals.segment(row, height) - whitened.cast<double>()).norm(),
          rounding * LargestWeight(block, i));
    });
  }
}

TEST_P(MeasurementKindsTest, JacobianIsThatOfTheOracle) {
  for (const int stream : {1, 2}) {
    MeasuredArm measured = MakeArm(stream);
    if (stream % 2 == 1) MoveAway(&measured, &random_);
    const MeasurementModel model(measured.arm, measured.references, 1);
    const Linearization linearization = LinearizeAll(measured, model);
    const testing::VectorXl values = measured.values.cast<long double>();
    ASSERT_EQ(linearization.jacobian.rows(), measured.data.num_rows());
    ForEachObservation(measured.data, [&](const ObservationBlock& block,
                                          Eigen::Index i, Eigen::Index row) {
      const testing::MatrixXl exact =
          testing::OracleWhitener(block, i) *
          testing::OracleJacobian(measured, values, block, i);
      const Eigen::MatrixXd error =
          linearization.jacobian.middleRows(row, block.rows_each()) -
          exact.cast<double>();
      // Some forty roundings of eps, in units of the reach (angles) or of one
      // (lengths, orientations); the differences are good to 1e-14.
      const double tolerance =
          5e-14 * (1.0 + Reach(measured.arm)) * LargestWeight(block, i);
      for (Eigen::Index c = 0; c < error.cols(); ++c) {
        EXPECT_LE(error.col(c).norm(), tolerance)
            << model.layout().parameter(static_cast<int>(c)).name;
      }
      for (int k = 0; k < block.rows_each(); ++k) {
        if (std::isfinite(block.sigmas(k, i))) continue;
        EXPECT_TRUE(linearization.jacobian.row(row + k).isZero(0.0));
      }
    });
  }
}

TEST_P(MeasurementKindsTest, AutodiffCostsAgreeWithLinearize) {
  for (int stream = 0; stream < kArms; ++stream) {
    MeasuredArm measured = MakeArm(stream);
    if (stream % 2 == 1) MoveAway(&measured, &random_);
    const MeasurementModel model(measured.arm, measured.references, 1);
    const Linearization linearization = LinearizeAll(measured, model);
    ForEachObservation(measured.data, [&](const ObservationBlock& block,
                                          Eigen::Index i, Eigen::Index row) {
      const ObservationCost cost =
          MakeObservationCost(model, measured.data, block, i, true);
      ASSERT_EQ(cost.function->num_residuals(), block.rows_each());
      const testing::CostEvaluation autodiff =
          testing::EvaluateCost(cost, model.layout(), measured.values);
      // As above; derivatives by blocks that the cost does not have are zero
      // in both.
      const double scale =
          (1.0 + Reach(measured.arm)) * LargestWeight(block, i);
      const int height = block.rows_each();
      EXPECT_LE(
          (autodiff.residuals - linearization.residuals.segment(row, height))
              .norm(),
          3e-14 * scale);
      const Eigen::MatrixXd difference =
          autodiff.jacobian - linearization.jacobian.middleRows(row, height);
      EXPECT_LE(difference.cwiseAbs().maxCoeff(), 5e-14 * scale);
    });
  }
}

TEST_P(MeasurementKindsTest, CostsWithoutFramesUseTheArmsOwn) {
  MeasuredArm measured = MakeArm(0);
  const MeasurementModel model(measured.arm, measured.references, 1);
  // The rotations of frames are zero and the translations the arm's.
  Eigen::VectorXd values = model.NominalValues();
  const int references = model.layout().Column(ParameterKind::kPoint, 0, 0);
  values.tail(values.size() - references) =
      measured.values.tail(values.size() - references);
  measured.values = values;
  const Linearization linearization = LinearizeAll(measured, model);
  const int base = model.layout().Column(ParameterKind::kBaseTranslation, 0);
  ForEachObservation(measured.data, [&](const ObservationBlock& block,
                                        Eigen::Index i, Eigen::Index row) {
    const ObservationCost cost =
        MakeObservationCost(model, measured.data, block, i, false);
    const testing::CostEvaluation autodiff =
        testing::EvaluateCost(cost, model.layout(), measured.values);
    const double scale = (1.0 + Reach(measured.arm)) * LargestWeight(block, i);
    const int height = block.rows_each();
    EXPECT_LE(
        (autodiff.residuals - linearization.residuals.segment(row, height))
            .norm(),
        3e-14 * scale);
    Eigen::MatrixXd expected = linearization.jacobian.middleRows(row, height);
    if (cost.blocks.size() == 5)
      expected.rightCols(values.size() - base) *= 0.0;
    EXPECT_LE((autodiff.jacobian - expected).cwiseAbs().maxCoeff(),
              5e-14 * scale);
  });
}

INSTANTIATE_TEST_SUITE_P(
    JointsAndWeights, MeasurementKindsTest,
    ::testing::Combine(::testing::Range(1, 8),
                       ::testing::Values(Weighting::kSigmas, Weighting::kMasked,
                                         Weighting::kFull),
                       ::testing::Values(false)));
// Error terms differ from a rigid arm in what the joints do, whatever the
// weights.
INSTANTIATE_TEST_SUITE_P(
    FlexibleArms, MeasurementKindsTest,
    ::testing::Combine(::testing::Range(1, 8),
                       ::testing::Values(Weighting::kMasked),
                       ::testing::Values(true)));

}  // namespace
}  // namespace alidade::internal
