#include "src/uncertainty/lack_of_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "src/common/distributions.h"
#include "src/common/random.h"
#include "src/model/joint_draw.h"
#include "src/uncertainty/looks.h"
#include "src/uncertainty/residual_gram.h"
#include "src/uncertainty/residual_structure.h"
#include "src/uncertainty/structure_columns.h"
#include "tests/support/matrix_kinematics.h"
#include "tests/support/noisy_positions.h"
#include "tests/support/reference_solution.h"
#include "tests/support/rv2aj_arms.h"
#include "tests/support/study.h"

namespace alidade::internal {
namespace {

constexpr double kSigma = 0.02e-3;
const StatedNoise kGiven = std::array<double, 2>{1.0, 1.0};

Eigen::Vector3d PositionOf(const Arm& arm, const Eigen::VectorXd& joints) {
  return testing::MatrixPosition(arm, joints.data()).cast<double>();
}

// What the real arm does at joint values, of row i.
using RealArm = std::function<Eigen::Vector3d(const Eigen::VectorXd&, int)>;

// An RV-2AJ fitted to what a real arm did, each pose measured `repeats` times.
class Fitted {
 public:
  Fitted(int poses, int repeats, std::uint64_t seed, const RealArm& real,
         double noise = kSigma)
      : model_(testing::Rv2ajFlange()),
        columns_(testing::FlangeFreeColumns(ParameterLayout(5))) {
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
    values_ = testing::SolveReference(
                  model_.nominal(), model_.NominalValues().cast<long double>(),
                  data_, columns_)
                  .values.cast<double>();
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

Eigen::Vector3d Rigid(const Eigen::VectorXd& joints, int /*row*/) {
  return PositionOf(testing::Rv2ajFlange(), joints);
}

// Off by a draw of so much in each axis, the same at each visit of a pose.
RealArm OffBy(double size, std::uint64_t seed) {
  return [=](const Eigen::VectorXd& joints, int row) {
    Random random(seed, static_cast<std::uint64_t>(row));
    Eigen::Vector3d off;
    for (double& value : off) value = size * random.Normal();
    return Eigen::Vector3d(Rigid(joints, row) + off);
  };
}

// The derivative of the heights of the frames beyond joint j and of the target
// by the joint's value: what the moment of unit weights is, up to its sign.
double MomentByHeights(const Arm& arm, const Eigen::VectorXd& joints, int j) {
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

// Of an arm that stands, and of one that hangs on a wall.
class GravityMomentsTest : public ::testing::TestWithParam<Eigen::Vector3d> {};

INSTANTIATE_TEST_SUITE_P(Directions, GravityMomentsTest,
                         ::testing::Values(Eigen::Vector3d(0.0, 0.0, -1.0),
                                           Eigen::Vector3d(0.6, -0.8, 0.0)));

TEST_P(GravityMomentsTest, AreSlopesOfHeights) {
  Arm arm = testing::Rv2ajFlange();
  arm.errors.gravity = GetParam();
  arm.last_from_target().translation() << 0.03, -0.02, 0.05;
  const MeasurementModel model(arm);
  const Dataset data = testing::NoisyPositions(arm, 20, kSigma, 3);
  const StructureColumns columns(model, model.NominalValues(), data, 60, true);
  Linearization rows;
  model.Linearize(model.NominalValues(), data, columns.directions(), &rows);
  int checked = 0;
  for (const StructureFamily& family : columns.families()) {
    if (family.kind != StructureKind::kGravityMoment || family.joint == 0) {
      continue;
    }
    const int theta =
        model.layout().Column(ParameterKind::kTheta, family.joint - 1);
    const auto place = std::find(columns.directions().begin(),
                                 columns.directions().end(), theta) -
                       columns.directions().begin();
    for (int i = 0; i < 20; ++i) {
      Eigen::MatrixXd filled(3, columns.size());
      const Eigen::MatrixXd mine = rows.jacobian.middleRows(3 * i, 3);
      columns.Fill(i, 0, mine, filled);
      const double moment =
          MomentByHeights(arm, data.joint_values.col(i), family.joint - 1);
      const Eigen::Vector3d expected = -moment * mine.col(place);
      EXPECT_LT((filled.col(family.columns.front()) - expected).norm(),
                1e-6 * mine.col(place).norm())
          << "joint " << family.joint;
      ++checked;
    }
  }
  EXPECT_EQ(checked, 100);
}

// Against least squares of the dense rows by a singular value decomposition.
TEST(StructureFitTest, GainsAreThoseOfLeastSquares) {
  const Fitted fitted(40, 1, 5, Rigid);
  const FittedProblem problem = fitted.problem();
  const Looks looks = TakeLooks(problem);
  const StructureColumns columns(fitted.model(), problem.values, looks.data,
                                 looks.residuals.size(), true);
  const ResidualGram gram =
      SumLooks(problem, looks, columns, CovarianceOf(problem).root);
  const StructureFit fit(problem, gram);
  Linearization directions;
  fitted.model().Linearize(problem.values, fitted.data(), columns.directions(),
                           &directions);
  Eigen::MatrixXd dense(120, columns.size());
  for (int i = 0; i < 40; ++i) {
    columns.Fill(i, 0, directions.jacobian.middleRows(3 * i, 3),
                 dense.middleRows(3 * i, 3));
  }
  const Linearization rows = fitted.Rows();
  const auto squares = [&](const std::vector<int>& with) {
    Eigen::MatrixXd all(
        120, rows.jacobian.cols() + static_cast<Eigen::Index>(with.size()));
    all << rows.jacobian, dense(Eigen::all, with);
    const double nothing = 1e-8 * all.colwise().norm().maxCoeff();
    for (auto column : all.colwise()) {
      column /= std::max(nothing, column.norm());
    }
    const Eigen::BDCSVD<Eigen::MatrixXd> svd =
        Eigen::BDCSVD<Eigen::MatrixXd>(
            all, Eigen::ComputeThinU | Eigen::ComputeThinV)
            .setThreshold(1e-3);
    return (rows.residuals - all * svd.solve(rows.residuals)).squaredNorm();
  };
  EXPECT_NEAR(fit.AllSquares(), squares({}), 1e-6 * squares({}));
  EXPECT_NEAR(fit.AllFreedom(), 120.0 - 18.0, 1e-6);
  for (const StructureFamily& family : columns.families()) {
    const double expected = squares({}) - squares(family.columns);
    EXPECT_NEAR(fit.GainOf(family.columns).squares, expected, 1e-3)
        << NameOf(StructureTest{family.kind, family.joint, family.covariate});
  }
}

// Densely, of two looks at each of twenty configurations: means, and what each
// sum says of them.
TEST(ResidualGramTest, SumsAreThoseOfTheRows) {
  const Fitted fitted(20, 2, 5, Rigid);
  const FittedProblem problem = fitted.problem();
  const Looks looks = TakeLooks(problem);
  const StructureColumns columns(fitted.model(), problem.values, looks.data,
                                 looks.residuals.size(), false);
  const Eigen::MatrixXd root = CovarianceOf(problem).root;
  const ResidualGram gram = SumLooks(problem, looks, columns, root);
  EXPECT_DOUBLE_EQ(gram.rows[kLengths], 60.0);
  EXPECT_DOUBLE_EQ(gram.inverse_counts[kLengths], 30.0);
  EXPECT_NEAR(gram.precision[kLengths] * kSigma * kSigma, 60.0, 1e-9);
  EXPECT_EQ(gram.rows[kRotations], 0.0);
  const Linearization all = fitted.Rows();
  const Eigen::MatrixXd information = all.jacobian.transpose() * all.jacobian;
  EXPECT_LT((gram.information - information).norm(),
            1e-12 * information.norm());
  Eigen::MatrixXd common = Eigen::MatrixXd::Zero(18, 18);
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(18, 18);
  ASSERT_EQ(gram.scores.cols(), 20);
  for (int i = 0; i < 20; ++i) {
    const Eigen::MatrixXd free = all.jacobian.middleRows(6 * i, 3);
    products += free.transpose() * free;
    common += 4.0 / (kSigma * kSigma) * free.transpose() * free;
    const Eigen::Vector3d mean = 0.5 * (all.residuals.segment<3>(6 * i) +
                                        all.residuals.segment<3>(6 * i + 3));
    const Eigen::Matrix3d rest =
        Eigen::Matrix3d::Identity() -
        2.0 * free * root * root.transpose() * free.transpose();
    const Eigen::Matrix3d freed =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(rest)
            .operatorInverseSqrt();
    const Eigen::VectorXd score = 2.0 * free.transpose() * (freed * mean);
    EXPECT_LT((gram.scores.col(i) - score).norm(), 1e-9 * score.norm());
  }
  EXPECT_LT((gram.common[kLengths] - common).norm(), 1e-12 * common.norm());
  EXPECT_LT((gram.products[kLengths].topLeftCorner(18, 18) - products).norm(),
            1e-12 * products.norm());
}

// F of each family by its gain, and Holm's correction: the smallest of k
// p-values times k, the next times k - 1, and none below the one before.
TEST(FindStructureTest, StatisticsAreFAndPValuesHolms) {
  const Fitted fitted(60, 1, 5, Rigid);
  const FittedProblem problem = fitted.problem();
  const Looks looks = TakeLooks(problem);
  const StructureColumns columns(fitted.model(), problem.values, looks.data,
                                 looks.residuals.size(), true);
  const ResidualGram gram =
      SumLooks(problem, looks, columns, CovarianceOf(problem).root);
  StructureFit fit(problem, gram);
  const double all = fit.AllSquares();
  const std::vector<StructureTest> tests =
      FindStructure(columns.families(), &fit);
  // But those of columns that are zero.
  ASSERT_GE(tests.size(), 20U);
  double least = 0.0;
  for (std::size_t k = 0; k < tests.size(); ++k) {
    SCOPED_TRACE(NameOf(tests[k]));
    EXPECT_FALSE(tests[k].is_found);
    // The same kind may be of several families: one has this statistic.
    double nearest = 1e9;
    StructureFit::Gain best;
    const auto f_of = [&](const StructureFit::Gain& gain) {
      return gain.squares / gain.rank /
             ((all - gain.squares) / (162.0 - gain.rank));
    };
    for (const StructureFamily& family : columns.families()) {
      if (family.kind != tests[k].kind || family.joint != tests[k].joint) {
        continue;
      }
      const StructureFit::Gain gain = fit.GainOf(family.columns);
      const double off = std::abs(f_of(gain) - tests[k].statistic);
      if (!(off < nearest)) continue;
      nearest = off;
      best = gain;
    }
    EXPECT_EQ(tests[k].degrees_of_freedom, best.rank);
    EXPECT_NEAR(tests[k].explained, best.squares / all, 1e-12);
    const double p = FisherSurvival(f_of(best), best.rank, 162.0 - best.rank);
    const auto rest = static_cast<double>(tests.size() - k);
    least = std::max(least, std::min(1.0, rest * p));
    EXPECT_LT(nearest, 1e-9);
    EXPECT_NEAR(tests[k].p_value, least, 1e-9);
  }
}

TEST(LooksTest, ASampleIsOfWholeConfigurations) {
  constexpr int kRepeats = 4;
  const MeasurementModel model(testing::Rv2ajFlange());
  const Eigen::MatrixXd drawn = DrawJointValues(model.nominal(), 2000, 3);
  Eigen::MatrixXd joints(5, kRepeats * drawn.cols());
  for (Eigen::Index i = 0; i < joints.cols(); ++i) {
    joints.col(i) = drawn.col(i / kRepeats);
  }
  const Dataset data =
      MakePositions(joints, Eigen::Matrix3Xd::Zero(3, joints.cols()), kSigma);
  const std::vector<int> columns =
      testing::FlangeFreeColumns(ParameterLayout(5));
  const Eigen::VectorXd no_priors;
  const std::vector<RobustLoss> losses;
  const Eigen::VectorXd values = model.NominalValues();
  const Looks looks =
      TakeLooks({model, data, columns, no_priors, losses, values});
  EXPECT_TRUE(looks.is_sample);
  // 5000 of 8000 poses, four of each configuration.
  EXPECT_EQ(looks.counts, std::vector<int>(1250, kRepeats));
  EXPECT_EQ(looks.repeat_freedom[kLengths], 3.0 * 1250 * (kRepeats - 1));
}

TEST(LackOfFitTest, CleanDataLackNothing) {
  const Fitted fitted(60, 1, 5, Rigid);
  const LackAssessment found = fitted.Assess(kGiven);
  EXPECT_EQ(found.lack.source, NoiseSource::kStated);
  EXPECT_GT(found.lack.p_value, 0.05);
  EXPECT_EQ(found.lack.excess_variance, 0.0);
  EXPECT_FALSE(found.differs);
  EXPECT_TRUE(found.warnings.empty());
  EXPECT_NEAR(found.lack.residual, kSigma, 0.15 * kSigma);
  // Two estimates of the same: that of 60 configurations is good to 20 %.
  const Eigen::VectorXd usual = CovarianceOf(fitted.problem()).Deviations();
  EXPECT_NEAR((found.robust_std.array() / usual.array()).mean(), 1.0, 0.15);
}

// Repeats know the noise, whatever is stated, and count as one look.
TEST(LackOfFitTest, RepeatsTellNoiseFromWhatTheModelLacks) {
  constexpr double kOff = 0.05e-3;
  for (const StatedNoise& stated : {kGiven, StatedNoise()}) {
    const Fitted fitted(80, 3, 6, OffBy(kOff, 9));
    const LackAssessment found = fitted.Assess(stated);
    EXPECT_EQ(found.lack.source, NoiseSource::kRepeats);
    EXPECT_EQ(found.lack.looks, 80);
    EXPECT_NEAR(found.lack.noise, kSigma, 0.1 * kSigma);
    EXPECT_NEAR(std::sqrt(found.lack.excess_variance / 3.0), kOff, 0.1 * kOff);
    EXPECT_LT(found.lack.p_value, 1e-12);
    ASSERT_FALSE(found.warnings.empty());
    EXPECT_NE(found.warnings[0].find("times the repeatability"),
              std::string::npos);
  }
}

// The model lacks nothing and measurements scatter five times as much as their
// sigma says: so do estimates.
TEST(LackOfFitTest, RepeatsThatContradictTheSigmaWidenPredictions) {
  const Fitted fitted(60, 3, 5, Rigid, 5.0 * kSigma);
  const LackAssessment found = fitted.Assess(kGiven);
  EXPECT_EQ(found.lack.source, NoiseSource::kRepeats);
  ASSERT_EQ(found.lack.excess_variance, 0.0);
  EXPECT_TRUE(found.differs);
  const double ratio = found.lack.noise / kSigma;
  EXPECT_NEAR(ratio, 5.0, 0.5);
  const Eigen::VectorXd usual = CovarianceOf(fitted.problem()).Deviations();
  EXPECT_LT((found.prediction.Deviations() - ratio * usual)
                .cwiseQuotient(ratio * usual)
                .cwiseAbs()
                .maxCoeff(),
            1e-6);
  EXPECT_FALSE(Fitted(60, 3, 5, Rigid).Assess(kGiven).differs);
}

// By its definition, densely: what noise and the errors of poses do to the
// estimate.
TEST(LackOfFitTest, PredictionsTakeErrorsOfPosesOnce) {
  const Fitted fitted(50, 2, 6, OffBy(0.05e-3, 9));
  const LackAssessment found = fitted.Assess(kGiven);
  ASSERT_TRUE(found.differs);
  const Eigen::MatrixXd jacobian = fitted.Rows().jacobian;
  const Eigen::MatrixXd estimator =
      (jacobian.transpose() * jacobian).inverse() * jacobian.transpose();
  const double noise = found.lack.noise / kSigma;
  const double excess = std::sqrt(found.lack.excess_variance / 3.0) / kSigma;
  Eigen::MatrixXd errors = noise * noise * Eigen::MatrixXd::Identity(300, 300);
  for (int i = 0; i < 100; ++i) {
    for (int k = 0; k < 100; ++k) {
      if (i / 2 != k / 2) continue;
      errors.block(3 * i, 3 * k, 3, 3) +=
          excess * excess * Eigen::Matrix3d::Identity();
    }
  }
  const Eigen::MatrixXd expected = estimator * errors * estimator.transpose();
  const Eigen::VectorXd deviations = found.prediction.Deviations();
  for (Eigen::Index k = 0; k < expected.rows(); ++k) {
    const double std = std::sqrt(expected(k, k));
    EXPECT_NEAR(deviations[k], std, 1e-5 * std);
    // Usual ones take repeats for looks, and know of noise alone.
    EXPECT_GT(found.robust_std[k],
              1.5 * CovarianceOf(fitted.problem()).Deviations()[k]);
  }
  EXPECT_NEAR(
      (found.robust_std.array() / expected.diagonal().array().sqrt()).mean(),
      1.0, 0.2);
}

// Joint 2 gives way by its gravity moment.
Eigen::Vector3d Bent(const Eigen::VectorXd& joints, int row) {
  Eigen::VectorXd moved = joints;
  moved[1] -= 4e-4 * MomentByHeights(testing::Rv2ajFlange(), joints, 1);
  return Rigid(moved, row);
}

// What is alike at neighbouring configurations does not average out as errors
// of each do, by which the usual deviations and those of predictions go.
TEST(LackOfFitTest, RobustDeviationsAreThoseOfBlocks) {
  const auto mean_ratio = [](const RealArm& real) {
    const LackAssessment found = Fitted(300, 1, 8, real).Assess(kGiven);
    return (found.robust_std.array() / found.prediction.Deviations().array())
        .mean();
  };
  EXPECT_NEAR(mean_ratio(Rigid), 1.05, 0.15);
  EXPECT_NEAR(mean_ratio(OffBy(0.05e-3, 9)), 1.05, 0.15);
  EXPECT_GT(mean_ratio(Bent), 1.3);
}

// Without anything stated, what is left beside the structure is the noise.
TEST(LackOfFitTest, StructureIsNamedAndTakenForTheExcess) {
  const LackAssessment found = Fitted(60, 1, 8, Bent).Assess(StatedNoise());
  EXPECT_EQ(found.lack.source, NoiseSource::kStructure);
  ASSERT_FALSE(found.lack.structure.empty());
  EXPECT_TRUE(found.lack.structure[0].is_found);
  EXPECT_EQ(found.lack.structure[0].kind, StructureKind::kGravityMoment);
  EXPECT_EQ(found.lack.structure[0].joint, 2);
  EXPECT_NEAR(found.lack.noise, kSigma, 0.15 * kSigma);
  ASSERT_FALSE(found.warnings.empty());
  EXPECT_NE(found.warnings[0].find("the gravity moment of joint 2"),
            std::string::npos);
}

// A temperature, recorded in no order, by which the arm grows.
TEST(LackOfFitTest, CovariateIsNamed) {
  const auto temperature = [](int row) {
    return 20.0 + 10.0 * std::sin(2.4 * row);
  };
  const RealArm grows = [&](const Eigen::VectorXd& joints, int row) {
    const double growth = 2e-5 * (temperature(row) - 20.0);
    return Eigen::Vector3d((1.0 + growth) * Rigid(joints, row));
  };
  Fitted fitted(60, 1, 8, grows);
  Eigen::MatrixXd values(1, 60);
  for (int i = 0; i < 60; ++i) values(0, i) = temperature(i);
  fitted.AddCovariate("t_c", values);
  const LackAssessment found = fitted.Assess(kGiven);
  ASSERT_FALSE(found.lack.structure.empty());
  EXPECT_TRUE(found.lack.structure[0].is_found);
  EXPECT_EQ(found.lack.structure[0].kind, StructureKind::kCovariate);
  EXPECT_EQ(found.lack.structure[0].covariate, "t_c");
  ASSERT_FALSE(found.warnings.empty());
  EXPECT_NE(found.warnings.back().find("depend on `t_c`"), std::string::npos);
}

// 50 data sets without any: both tests fail at most 0.5 % of them.
TEST(LackOfFitTest, NothingIsNamedWhereNothingIs) {
  int alarms = 0;
  for (std::uint64_t seed = 100; seed < 150; ++seed) {
    if (!Fitted(30, 1, seed, Rigid).Assess(kGiven).warnings.empty()) ++alarms;
  }
  EXPECT_LE(alarms, 3);
}

}  // namespace
}  // namespace alidade::internal
