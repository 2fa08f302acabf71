#include "src/error_terms/term_rows.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <string>
#include <vector>

#include "src/error_terms/term_columns.h"
#include "src/error_terms/term_normal.h"
#include "tests/error_terms/term_test_util.h"

namespace alidade::internal {
namespace {

using testing::MeasuredArm;

// Whitened residuals with these coefficients, from the kernel, which
// measurement_kinds_test.cc compares with products of matrices.
Eigen::VectorXd ResidualsWith(const MeasuredArm& measured,
                              const TermColumns& columns,
                              const Eigen::VectorXd& coefficients) {
  Arm arm = measured.arm;
  arm.errors = columns.TermsOf(coefficients, arm.errors, arm.num_joints());
  const MeasurementModel model(arm, measured.references, 1);
  Linearization linearization;
  model.Linearize(measured.values, measured.data, {0}, &linearization);
  return linearization.residuals;
}

TermRows RowsWith(const MeasuredArm& measured, const TermColumns& columns,
                  const Eigen::VectorXd& coefficients) {
  Arm arm = measured.arm;
  arm.errors = columns.TermsOf(coefficients, arm.errors, arm.num_joints());
  const MeasurementModel model(arm, measured.references, 1);
  return MakeTermRows(model, measured.values, measured.data,
                      testing::AllColumnsOf(model.layout()));
}

// Of each column and observation the difference to central differences over
// steps of `step`, relative to the largest entry of the observation's rows.
void ExpectDerivatives(const MeasuredArm& measured, const TermColumns& columns,
                       const Eigen::VectorXd& at, double tolerance) {
  const TermRows rows = RowsWith(measured, columns, at);
  const Eigen::MatrixXd dense = testing::DenseTerms(rows, columns);
  Eigen::MatrixXd differences(dense.rows(), dense.cols());
  constexpr double kStep = 0.05;
  for (int k = 0; k < columns.size(); ++k) {
    const Eigen::VectorXd step =
        kStep * Eigen::VectorXd::Unit(columns.size(), k);
    differences.col(k) = (ResidualsWith(measured, columns, at + step) -
                          ResidualsWith(measured, columns, at - step)) /
                         (2.0 * kStep);
  }
  EXPECT_TRUE(rows.residuals.isApprox(ResidualsWith(measured, columns, at)));
  int with_terms = 0;
  for (const TermRows::Observation& one : rows.observations) {
    const Eigen::MatrixXd error =
        (dense - differences).middleRows(one.first_row, one.height);
    const double size =
        differences.middleRows(one.first_row, one.height).cwiseAbs().maxCoeff();
    EXPECT_LE(error.cwiseAbs().maxCoeff(), tolerance * size)
        << "observation at row " << one.first_row;
    // All but the distances between points.
    EXPECT_EQ(size > 0.0, one.pose >= 0 && one.num_measured > 0);
    if (size > 0.0) ++with_terms;
  }
  EXPECT_GE(with_terms, 25);
}

TEST(TermRowsTest, ColumnsAreDerivativesOfTheResiduals) {
  for (int stream = 0; stream < 4; ++stream) {
    Random random(130, stream);
    const MeasuredArm measured = testing::MeasuredForTerms(&random);
    const TermColumns columns(measured.arm, testing::AllTerms(1.0),
                              measured.data.joint_values.map(),
                              testing::Deviations());
    // Coefficients of 0.05 turn by up to some 1e-4 rad: the differences are
    // good to the square of that, and to rounding over it.
    ExpectDerivatives(measured, columns, Eigen::VectorXd::Zero(columns.size()),
                      1e-6);
  }
}

TEST(TermRowsTest, ColumnsAreThoseOfTheBentArm) {
  Random random(131);
  const MeasuredArm measured = testing::MeasuredForTerms(&random);
  const TermColumns columns(measured.arm, testing::AllTerms(1.0),
                            measured.data.joint_values.map(),
                            testing::Deviations());
  Eigen::VectorXd at(columns.size());
  for (double& value : at) value = random.Uniform(-1.0, 1.0);
  // Turns by some centiradians in all. The axes of the columns are those of the
  // bent arm but for turns of the base, and of the prismatic joint its tilts.
  const TermRows bent = RowsWith(measured, columns, at);
  const TermRows straight =
      RowsWith(measured, columns, Eigen::VectorXd::Zero(columns.size()));
  EXPECT_GT((bent.turns - straight.turns).norm(), 1e-3 * straight.turns.norm());
  ExpectDerivatives(measured, columns, at, 0.1);
}

TEST(TermRowsTest, GeometryIsThatOfTheModel) {
  Random random(132);
  const MeasuredArm measured = testing::MeasuredForTerms(&random);
  const MeasurementModel model(measured.arm, measured.references, 1);
  const std::vector<int> columns = {3, 7, 0, 25};
  const TermRows rows =
      MakeTermRows(model, measured.values, measured.data, columns);
  Linearization linearization;
  model.Linearize(measured.values, measured.data, columns, &linearization);
  EXPECT_TRUE(rows.geometry.isApprox(kTermUnit * linearization.jacobian));
  ASSERT_EQ(static_cast<Eigen::Index>(rows.observations.size()),
            measured.data.num_observations());
  // Distances between points are of no pose, and contacts of planes one length.
  EXPECT_EQ(rows.observations.back().pose, -1);
  EXPECT_EQ(rows.observations.back().num_lengths, 0);
  EXPECT_EQ(rows.observations.front().num_lengths, 3);
}

TEST(TermRowsTest, ThreadsDoNotChangeBits) {
  Random random(133);
  const MeasuredArm measured = testing::MeasuredForTerms(&random);
  const auto rows_by = [&](int threads) {
    const MeasurementModel model(measured.arm, measured.references, threads);
    return MakeTermRows(model, measured.values, measured.data, {1, 2});
  };
  const TermRows one = rows_by(1);
  const TermRows three = rows_by(3);
  EXPECT_EQ(one.geometry, three.geometry);
  EXPECT_EQ(one.turns, three.turns);
  EXPECT_EQ(one.second_turns, three.second_turns);
  EXPECT_EQ(one.moments, three.moments);
}

TEST(TermColumnsTest, CoefficientsComeBackFromTheirTerms) {
  Random random(134);
  const MeasuredArm measured = testing::MeasuredForTerms(&random);
  const TermColumns columns(measured.arm, testing::AllTerms(0.3),
                            measured.data.joint_values.map(),
                            testing::Deviations());
  Eigen::VectorXd coefficients(columns.size());
  for (double& value : coefficients) value = random.Uniform(-1.0, 1.0);
  const ErrorTerms terms =
      columns.TermsOf(coefficients, measured.arm.errors, 4);
  EXPECT_LT((columns.CoefficientsOf(terms) - coefficients).norm(), 1e-12);
  EXPECT_EQ(terms.gravity, measured.arm.errors.gravity);
  EXPECT_FALSE(terms.joints[1].function.empty()) << "of a prismatic joint";
  EXPECT_EQ(terms.joints[1].compliance.z(), 0.0);
  EXPECT_EQ(terms.joints[0].harmonics.size(), 2U);
  EXPECT_EQ(terms.joints[3].harmonics.size(), 3U);
  EXPECT_NE(terms.covariates[1].base[5], 0.0);
  EXPECT_NE(terms.covariates[2].joints[3], 0.0);
  EXPECT_NE(terms.covariates[2].target[5], 0.0);
  EXPECT_TRUE(terms.covariates[1].target.isZero(0.0));
  EXPECT_NE(terms.coupling(2, 1), 0.0);
  EXPECT_NE(terms.coupling(1, 1), 0.0);
  EXPECT_EQ(terms.coupling(1, 2), 0.0);
}

TEST(TermColumnsTest, CoarserFunctionsAreThoseOfTheUnion) {
  Random random(135);
  const MeasuredArm measured = testing::MeasuredForTerms(&random);
  const auto columns_of = [&](double length) {
    TermSet set;
    set.function_length = length;
    return TermColumns(measured.arm, set, measured.data.joint_values.map(),
                       testing::Deviations());
  };
  const TermColumns coarse = columns_of(1.5);
  const TermColumns fine = columns_of(0.1);
  TermSet elastic;
  elastic.elasticity = true;
  const TermColumns all = TermColumns::Union(
      {TermColumns(measured.arm, elastic, measured.data.joint_values.map(), {}),
       fine, coarse});
  EXPECT_EQ(all.num_dense(), 11);
  Eigen::VectorXd coefficients(coarse.size());
  for (double& value : coefficients) value = random.Uniform(-1.0, 1.0);
  const ErrorTerms terms = coarse.TermsOf(coefficients, {}, 4);
  const ErrorTerms same = all.TermsOf(all.From(coarse) * coefficients, {}, 4);
  for (const int j : {0, 1, 2, 3}) {
    const JointFunction& function = terms.joints[j].function;
    for (int k = 0; k < 200; ++k) {
      const double q = random.Uniform(function.first, function.last());
      EXPECT_NEAR(same.joints[j].function.At(q), function.At(q), 1e-15);
    }
  }
}

TEST(TermColumnsTest, KnotsAreWhereTheFunctionIs) {
  // What columns do at a joint value is what the function of their terms is,
  // beyond its knots, too.
  Random random(136);
  const MeasuredArm measured = testing::MeasuredForTerms(&random);
  TermSet set;
  set.function_length = 0.3;
  const TermColumns columns(measured.arm, set, measured.data.joint_values.map(),
                            testing::Deviations());
  Eigen::VectorXd coefficients(columns.size());
  for (double& value : coefficients) value = random.Uniform(-1.0, 1.0);
  const ErrorTerms terms = columns.TermsOf(coefficients, {}, 4);
  const JointFunction& function = terms.joints[0].function;
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(12);
  for (int k = -150; k < 250; ++k) {
    const Eigen::Vector4d q(function.first + 0.11 * function.spacing * k, 1e6,
                            1e6, -1e6);
    double shift = 0.0;
    columns.ForEachAt({q.data(), none.data(), none.data()},
                      [&](int column, int turn, double size) {
                        EXPECT_EQ(turn, 2);
                        shift += size * coefficients[column] * kTermUnit;
                      });
    EXPECT_NEAR(shift, function.At(q[0]), 1e-15) << k;
  }
}

TEST(TermColumnsTest, PrecisionIsTheInverseOfMaternsCovariance) {
  Random random(137);
  const MeasuredArm measured = testing::MeasuredForTerms(&random);
  TermSet set;
  set.function_length = 0.3;
  const TermColumns columns(measured.arm, set, measured.data.joint_values.map(),
                            testing::Deviations());
  const FunctionKnots& knots = columns.functions().front();
  Eigen::MatrixXd covariance(knots.count, knots.count);
  for (int a = 0; a < knots.count; ++a) {
    for (int b = 0; b < knots.count; ++b) {
      const double u = std::abs(a - b) * knots.spacing * std::sqrt(3.0) / 0.3;
      covariance(a, b) = (1.0 + u) * std::exp(-u);
    }
  }
  const Eigen::MatrixXd product = columns.Precision(knots) * covariance;
  // The jitter of 1e-9 over the smallest eigenvalue, some 1e-3.
  EXPECT_LT((product - Eigen::MatrixXd::Identity(knots.count, knots.count))
                .cwiseAbs()
                .maxCoeff(),
            1e-4);
}

TEST(TermColumnsTest, JointThatNeverMovesHasNoFunction) {
  Random random(138);
  MeasuredArm measured = testing::MeasuredForTerms(&random);
  Eigen::MatrixXd q = measured.data.joint_values.map();
  q.row(2).setConstant(0.7);
  TermSet set;
  set.function_length = 0.3;
  const TermColumns columns(measured.arm, set, q, testing::Deviations());
  ASSERT_EQ(columns.functions().size(), 3U);
  EXPECT_EQ(columns.functions()[1].joint, 1);
  EXPECT_EQ(columns.functions()[2].joint, 3);
}

// Columns of functions modulo a turn, of an arm of four joints whose third one
// turns three times; prismatic is the second.
TermColumns TurnedColumns(const MeasuredArm& measured, double length) {
  Eigen::MatrixXd q = measured.data.joint_values.map();
  q.row(2).setLinSpaced(-9.0, 9.5);
  q.row(1).setLinSpaced(-9.0, 9.5);
  TermSet set;
  set.function_length = length;
  set.modulo_turn = true;
  return {measured.arm, set, q, testing::Deviations()};
}

TEST(TermColumnsTest, FunctionsModuloATurnGoOnAfterIt) {
  constexpr double kTurn = 2.0 * M_PI;
  Random random(139);
  const MeasuredArm measured = testing::MeasuredForTerms(&random);
  const TermColumns columns = TurnedColumns(measured, 0.5);
  ASSERT_EQ(columns.functions().size(), 4U);
  const FunctionKnots& knots = columns.functions()[2];
  EXPECT_TRUE(knots.is_periodic);
  EXPECT_NEAR(knots.spacing * knots.count, kTurn, 1e-14);
  for (const int other : {0, 1, 3}) {
    EXPECT_FALSE(columns.functions()[other].is_periodic) << other;
  }
  Eigen::VectorXd coefficients(columns.size());
  for (double& value : coefficients) value = random.Uniform(-1.0, 1.0);
  const ErrorTerms terms = columns.TermsOf(coefficients, {}, 4);
  EXPECT_LT((columns.CoefficientsOf(terms) - coefficients).norm(), 1e-11);
  const JointFunction& function = terms.joints[2].function;
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(12);
  for (int k = 0; k < 300; ++k) {
    const double value = random.Uniform(-20.0, 20.0);
    const Eigen::Vector4d q(1e6, 1e6, value, 1e6);
    double shift = 0.0;
    columns.ForEachAt({q.data(), none.data(), none.data()},
                      [&](int column, int /*turn*/, double size) {
                        shift += size * coefficients[column] * kTermUnit;
                      });
    EXPECT_NEAR(shift, function.At(value), 1e-15) << value;
    EXPECT_NEAR(function.At(value + kTurn), function.At(value), 1e-14);
    EXPECT_LT(VarianceBesideKnots(knots, 0.5, value), 0.1);
  }
  EXPECT_NEAR(VarianceBesideKnots(knots, 0.5, knots.first - kTurn), 0.0, 1e-12);
  // Finer ones express it.
  const TermColumns fine = TurnedColumns(measured, 0.1);
  const TermColumns all = TermColumns::Union({columns, fine});
  EXPECT_GT(all.size(), columns.size());
  const ErrorTerms same = all.TermsOf(all.From(columns) * coefficients, {}, 4);
  for (int k = 0; k < 100; ++k) {
    const double value = random.Uniform(-10.0, 10.0);
    EXPECT_NEAR(same.joints[2].function.At(value), function.At(value), 1e-14);
  }
}

TEST(TermColumnsTest, PriorModuloATurnIsMaternsAlongTheChords) {
  Random random(140);
  const MeasuredArm measured = testing::MeasuredForTerms(&random);
  const TermColumns columns = TurnedColumns(measured, 0.5);
  const FunctionKnots& knots = columns.functions()[2];
  Eigen::MatrixXd covariance(knots.count, knots.count);
  for (int a = 0; a < knots.count; ++a) {
    for (int b = 0; b < knots.count; ++b) {
      // Between points of a circle of radius 1.
      const double angle = 2.0 * M_PI * (a - b) / knots.count;
      const double chord = std::hypot(std::cos(angle) - 1.0, std::sin(angle));
      const double u = chord * std::sqrt(3.0) / 0.5;
      covariance(a, b) = (1.0 + u) * std::exp(-u);
    }
  }
  EXPECT_GT(covariance.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(),
            0.0);
  const Eigen::MatrixXd product = columns.Precision(knots) * covariance;
  EXPECT_LT((product - Eigen::MatrixXd::Identity(knots.count, knots.count))
                .cwiseAbs()
                .maxCoeff(),
            1e-4);
}

TEST(TermColumnsTest, NamesSayWhatMoves) {
  Random random(141);
  MeasuredArm measured = testing::MeasuredForTerms(&random);
  TermSet set;
  set.covariates = true;
  set.uses = {{"temperature", false, true, {}},
              {"humidity", false, false, {0, 2}},
              {"tilt", false, false, {}}};
  set.uses[1].is_approach = true;
  set.uses[2].is_payload = true;
  const TermColumns columns(measured.arm, set, measured.data.joint_values.map(),
                            testing::Deviations());
  std::vector<std::string> names;
  for (const DenseTerm& term : columns.dense()) {
    names.push_back(NameOf(term, 4));
  }
  EXPECT_EQ(names, (std::vector<std::string>{
                       "c1_tool_x", "c1_tool_y", "c1_tool_z", "c1_tool_rx",
                       "c1_tool_ry", "c1_tool_rz", "c2_b1", "c2_b3"}));
  EXPECT_EQ(columns.dense()[6].group, TermGroup::kBacklash);
  // Stations have a base of their own in every set.
  set.covariates = false;
  set.uses[0].is_station = true;
  set.uses[0].moves_base = true;
  set.uses[0].moves_target = false;
  const TermColumns station(measured.arm, set, measured.data.joint_values.map(),
                            testing::Deviations());
  ASSERT_EQ(station.num_dense(), 6);
  EXPECT_EQ(NameOf(station.dense()[5], 4), "c1_rz");
  EXPECT_EQ(station.num_groups(), 1);
}

}  // namespace
}  // namespace alidade::internal
