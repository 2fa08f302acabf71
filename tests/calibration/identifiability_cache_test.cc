#include "src/calibration/identifiability_cache.h"

#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "alidade/arm_file.h"
#include "src/identifiability/analysis.h"
#include "src/model/joint_draw.h"
#include "tests/support/edit.h"

namespace alidade::internal::identifiability_cache_test {
namespace {

// What the cache is asked.
struct Question {
  Arm arm = LoadArm(std::string(ALIDADE_SOURCE_DIR) +
                    "/configs/robots/rv2aj_flange.yaml");
  Dataset data;
  IdentifiabilityOptions options;

  Question() {
    const Eigen::MatrixXd joint_values = DrawJointValues(arm, 20, 1);
    data.joint_values = joint_values;
    ObservationBlock block;
    block.measured = MeasurementModel(arm).Predict(
        MeasurementModel(arm).NominalValues(), joint_values);
    block.sigmas = Eigen::MatrixXd::Constant(3, 20, 2e-5);
    data.blocks.push_back(block);
  }

  IdentifiabilityResult Ask(IdentifiabilityCache* cache) const {
    return cache->Analyze(MeasurementModel(arm), data, options);
  }
  IdentifiabilityResult Analyze() const {
    return AnalyzeIdentifiability(MeasurementModel(arm), data, options);
  }
};

// The numbers of a result, bit by bit.
std::vector<double> NumbersOf(const IdentifiabilityResult& result) {
  std::vector<double> numbers = {
      static_cast<double>(result.num_free),
      static_cast<double>(result.num_candidates),
      static_cast<double>(result.generic_rank.rank),
      static_cast<double>(result.structural_rank.rank)};
  for (const ParameterDecision& decision : result.decisions) {
    numbers.push_back(static_cast<double>(decision.state));
    if (decision.state != ParameterState::kFree) continue;
    numbers.push_back(decision.predicted_std);
    numbers.push_back(decision.prior_std);
  }
  const Eigen::VectorXd& values = result.nominal_rank.singular_values;
  numbers.insert(numbers.end(), values.data(), values.data() + values.size());
  return numbers;
}

// NaN is where there is no number, and equals itself.
bool AreSame(const IdentifiabilityResult& a, const IdentifiabilityResult& b) {
  const std::vector<double> x = NumbersOf(a);
  const std::vector<double> y = NumbersOf(b);
  return x.size() == y.size() &&
         std::equal(x.begin(), x.end(), y.begin(), [](double p, double q) {
           return p == q || (p != p && q != q);
         });
}

TEST(IdentifiabilityCacheTest, NoiseAsksTheSameQuestion) {
  IdentifiabilityCache cache;
  Question question;
  question.Ask(&cache);
  testing::Edit(&question.data.blocks[0].measured)->array() += 1e-3;
  EXPECT_TRUE(AreSame(question.Ask(&cache), question.Analyze()));
  EXPECT_EQ(cache.num_made(), 1U);
}

// Whatever else changes is another question, with another answer or not.
TEST(IdentifiabilityCacheTest, AllElseIsAnotherQuestion) {
  const std::vector<std::function<void(Question*)>> changes = {
      [](Question* q) { q->arm.joints[1].d += 1e-3; },
      [](Question* q) { q->arm.joints[2].lower += 1e-3; },
      [](Question* q) { q->arm.instrument_from_base.translation()[0] = 1.0; },
      [](Question* q) {
        q->arm.targets[0].last_from_target.translation()[0] += 0.1;
      },
      [](Question* q) {
        testing::Edit(&q->data.joint_values).at(0, 0) += 1e-6;
      },
      [](Question* q) {
        testing::Edit(&q->data.blocks[0].sigmas).at(1, 3) *= 2.0;
      },
      [](Question* q) { q->data.blocks[0].targets.assign(20, 0); },
      [](Question* q) {
        q->data.blocks[0].whiteners.assign(20, Eigen::Matrix3d::Identity());
      },
      [](Question* q) {
        q->data.shards = {{0, {0}}, {10, {10}}};
      },
      [](Question* q) { q->options.policy = WeakPolicy::kFreeze; },
      [](Question* q) { q->options.fix = {"d2"}; },
      [](Question* q) { q->options.prefer = {"theta2"}; },
      [](Question* q) { q->options.candidates.tool = true; },
      [](Question* q) { q->options.priors.alpha *= 2.0; },
      [](Question* q) { q->options.relative_tolerance *= 2.0; },
      [](Question* q) { q->options.seed = 5; },
      [](Question* q) { q->options.proceed_beyond_rank = true; },
      [](Question* q) { q->options.method = IdentifiabilityMethod::kRules; }};
  IdentifiabilityCache cache;
  Question().Ask(&cache);
  for (std::size_t i = 0; i < changes.size(); ++i) {
    Question changed;
    changes[i](&changed);
    EXPECT_TRUE(AreSame(changed.Ask(&cache), changed.Analyze())) << i;
    EXPECT_EQ(cache.num_made(), i + 2) << i;
  }
}

// A rotation's residual is part of its derivative.
TEST(IdentifiabilityCacheTest, MeasuredOrientationsArePartOfTheQuestion) {
  IdentifiabilityCache cache;
  Question question;
  ObservationBlock& block = question.data.blocks[0];
  block.kind = MeasurementKind::kPose;
  Eigen::MatrixXd poses = Eigen::MatrixXd::Constant(6, 20, 0.1);
  poses.topRows(3) = block.measured.map();
  block.measured = poses;
  block.sigmas = Eigen::MatrixXd::Constant(6, 20, 1e-4);
  question.Ask(&cache);
  testing::Edit(&block.measured).at(4, 2) = 0.2;
  EXPECT_TRUE(AreSame(question.Ask(&cache), question.Analyze()));
  EXPECT_EQ(cache.num_made(), 2U);
}

}  // namespace
}  // namespace alidade::internal::identifiability_cache_test
