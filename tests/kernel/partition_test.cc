// Shares of a data set against the global: the same bits, whoever has what.

#include "src/kernel/partition.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "alidade/robust_loss.h"
#include "src/common/random.h"
#include "src/kernel/holdout.h"
#include "src/kernel/measurement_model.h"
#include "src/kernel/reduction.h"
#include "src/kernel/sigma_totals.h"
#include "src/model/joint_draw.h"
#include "tests/support/classic_arms.h"
#include "tests/support/edit.h"

namespace alidade::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// Positions with noise, and to every third pose a distance from a point.
Dataset Measure(const MeasurementModel& model, int count, std::uint64_t seed,
                bool has_distances) {
  Dataset data;
  data.name = "file" + std::to_string(seed);
  data.files = {data.name};
  data.joint_values = DrawJointValues(model.nominal(), count, seed);
  Random random(seed);
  ObservationBlock positions;
  Eigen::MatrixXd measured =
      model.Predict(model.NominalValues(), data.joint_values);
  Eigen::MatrixXd sigmas = Eigen::MatrixXd::Constant(3, count, 1e-4);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      measured(axis, i) += 1e-3 * random.Normal();
    }
    if (i % 7 == 0) {
      sigmas(1, i) = std::numeric_limits<double>::infinity();
    }
    data.sources.push_back({0, static_cast<int>(i) + 2});
  }
  positions.measured = std::move(measured);
  positions.sigmas = std::move(sigmas);
  ObservationBlock distances;
  distances.kind = MeasurementKind::kDistance;
  for (int i = 0; i < count; i += 3) {
    distances.poses.push_back(i);
    distances.references.push_back(i % 2);
  }
  const auto size = static_cast<Eigen::Index>(distances.poses.size());
  distances.measured = Eigen::MatrixXd::Constant(1, size, 2.0);
  distances.sigmas = Eigen::MatrixXd::Constant(1, size, 2e-4);
  data.blocks.push_back(std::move(positions));
  if (has_distances) data.blocks.push_back(std::move(distances));
  return data;
}

class PartitionTest : public ::testing::Test {
 protected:
  PartitionTest() : model_(testing::Ur10(), TwoPoints(), 1) {
    parts_.push_back(Measure(model_, 3000, 1, false));
    parts_.push_back(Measure(model_, 40, 2, true));
    parts_.push_back(Measure(model_, 1500, 3, true));
    for (int column = 0; column < 20; ++column) columns_.push_back(column);
    values_ = model_.NominalValues();
  }

  static References TwoPoints() {
    References references;
    references.points.resize(2);
    references.points[1].position << 1.0, 2.0, -1.0;
    return references;
  }

  // Consecutive parts of rank `rank`, as one process would merge them; by
  // hand, so that nothing of what is tested makes it.
  Dataset PartsOf(int rank, int size) const {
    Dataset all;
    all.joint_values = Eigen::MatrixXd(6, 0);
    for (std::size_t k = 0; k < parts_.size(); ++k) {
      if (static_cast<int>(k) * size / static_cast<int>(parts_.size()) !=
          rank) {
        continue;
      }
      AppendPart(parts_[k], &all);
    }
    return all;
  }

  static void AppendColumns(const SharedMatrix& more, SharedMatrix* to) {
    Eigen::MatrixXd all(more.rows(), to->cols() + more.cols());
    all << to->map(), more.map();
    *to = std::move(all);
  }

  static void AppendPart(const Dataset& part, Dataset* all) {
    const auto first_pose = static_cast<int>(all->num_poses());
    all->shards.push_back({first_pose, {}});
    for (const MeasurementKind kind :
         {MeasurementKind::kPosition, MeasurementKind::kDistance}) {
      ObservationBlock* to = nullptr;
      for (ObservationBlock& block : all->blocks) {
        if (block.kind == kind) to = &block;
      }
      if (to == nullptr) {
        all->blocks.emplace_back();
        to = &all->blocks.back();
        to->kind = kind;
        to->measured = Eigen::MatrixXd(RowsOf(kind), 0);
        to->sigmas = Eigen::MatrixXd(RowsOf(kind), 0);
      }
      all->shards.back().first_observations.push_back(to->size());
      for (const ObservationBlock& block : part.blocks) {
        if (block.kind != kind) continue;
        AppendColumns(block.measured, &to->measured);
        AppendColumns(block.sigmas, &to->sigmas);
        for (const int pose : block.poses) {
          to->poses.push_back(pose + first_pose);
        }
        for (const int reference : block.references) {
          to->references.push_back(reference);
        }
      }
    }
    AppendColumns(part.joint_values, &all->joint_values);
    all->files.push_back(part.name);
    all->name += (all->name.empty() ? "" : ", ") + part.name;
    for (std::size_t pose = 0; pose < part.sources.size(); ++pose) {
      all->sources.push_back(
          {static_cast<int>(all->files.size()) - 1, part.sources[pose].line});
    }
  }

  // work(model, part) on every rank of 1 to 4.
  void OnRanks(const std::function<void(const MeasurementModel&,
                                        const Dataset&)>& work) const {
    for (const int size : {1, 2, 3, 4}) {
      SCOPED_TRACE(size);
      RunOnThreads(size, [&](Communicator* communicator) {
        Dataset part = PartsOf(communicator->rank(), size);
        MakePartition(communicator, &part);
        work(MeasurementModel(model_.nominal(), model_.references(),
                              {1, communicator}),
             part);
      });
    }
  }

  const MeasurementModel model_;
  std::vector<Dataset> parts_;
  std::vector<int> columns_;
  Eigen::VectorXd values_;
};

TEST_F(PartitionTest, FactorsHaveTheBitsOfOneProcess) {
  const Dataset global = PartsOf(0, 1);
  const Eigen::MatrixXd expected =
      JacobianFactor(model_, values_, global, columns_);
  Linearization rows;
  model_.Linearize(values_, global, columns_, &rows);
  const Eigen::MatrixXd squares = rows.jacobian.transpose() * rows.jacobian;
  // Some thousand rows, each of rounding 1e-16.
  EXPECT_LE((expected.transpose() * expected - squares).norm(),
            1e-12 * squares.norm());
  OnRanks([&](const MeasurementModel& model, const Dataset& part) {
    EXPECT_EQ(JacobianFactor(model, values_, part, columns_), expected);
  });
}

TEST_F(PartitionTest, ReducedProblemsHaveTheBitsOfOneProcess) {
  const Dataset global = PartsOf(0, 1);
  for (const LossKind kind : {LossKind::kNone, LossKind::kHuber}) {
    const std::vector<RobustLoss> losses = TunedLosses(kind);
    Reducer reducer(model_, global, columns_, losses);
    ReducedLeastSquares first;
    ReducedLeastSquares second;
    reducer.Reduce(values_, &first);
    reducer.Reduce(values_, &second);
    OnRanks([&](const MeasurementModel& model, const Dataset& part) {
      Reducer mine(model, part, columns_, losses);
      ReducedLeastSquares problem;
      // The second may be by products.
      for (const ReducedLeastSquares* expected : {&first, &second}) {
        mine.Reduce(values_, &problem);
        EXPECT_EQ(mine.used_gram(), expected == &second && reducer.used_gram());
        EXPECT_EQ(problem.factor, expected->factor);
        EXPECT_EQ(problem.projected, expected->projected);
        EXPECT_EQ(problem.cost, expected->cost);
      }
      EXPECT_EQ(mine.Summarize(values_).rms_error,
                reducer.Summarize(values_).rms_error);
      EXPECT_EQ(mine.Summarize(values_).max_error,
                reducer.Summarize(values_).max_error);
    });
  }
}

TEST_F(PartitionTest, NumbersComeInTheGlobalOrder) {
  const Dataset global = PartsOf(0, 1);
  const SharedVector expected =
      LengthErrors(model_.Errors(values_, global), global);
  const SigmaTotals totals = SumSigmas(global, 2);
  EXPECT_EQ(totals.equations, global.num_equations());
  OnRanks([&](const MeasurementModel& model, const Dataset& part) {
    const SharedVector mine = LengthErrors(model_.Errors(values_, part), part);
    const SharedVector all = EntriesInOrder(model.communicator(), part, mine);
    EXPECT_EQ(part.global_observations(), expected.size());
    if (model.communicator()->is_root()) {
      EXPECT_EQ(all, expected);
    }
    const SigmaTotals sums = SumSigmas(part, model.execution());
    EXPECT_EQ(sums.equations, totals.equations);
    EXPECT_EQ(sums.length_information, totals.length_information);
    EXPECT_EQ(part.name, "file1, file2, file3");
    if (part.num_poses() == 0) return;
    EXPECT_EQ(SourceOf(part, 0),
              SourceOf(global, static_cast<int>(part.partition->first_pose)));
  });
}

TEST_F(PartitionTest, FractionsAreHeldOutAlike) {
  const Dataset global = PartsOf(0, 1);
  const HoldOut expected = HoldOutFraction(global, 0.3, 9);
  OnRanks([&](const MeasurementModel& model, const Dataset& part) {
    const HoldOut split = HoldOutFraction(part, 0.3, 9, model.communicator());
    EXPECT_EQ(split.train.global_poses(), expected.train.num_poses());
    const SharedMatrix validation = PosesInOrder(
        model.communicator(), split.validation, split.validation.joint_values);
    if (model.communicator()->is_root()) {
      EXPECT_EQ(validation, expected.validation.joint_values);
    }
    // Shards stay where they were.
    EXPECT_EQ(JacobianFactor(model, values_, split.train, columns_),
              JacobianFactor(model_, values_, expected.train, columns_));
  });
}

TEST_F(PartitionTest, KindsThatOnlySomeHaveAreEmptyBlocksOfOthers) {
  RunOnThreads(2, [&](Communicator* communicator) {
    Dataset data = parts_[communicator->is_root() ? 0 : 1];
    MakePartition(communicator, &data);
    ASSERT_EQ(data.blocks.size(), 2U);
    EXPECT_EQ(data.blocks[1].kind, MeasurementKind::kDistance);
    EXPECT_EQ(data.blocks[1].size(), communicator->is_root() ? 0 : 14);
    EXPECT_TRUE(data.Has(MeasurementKind::kDistance));
    EXPECT_FALSE(data.Has(MeasurementKind::kPlane));
    EXPECT_EQ(GlobalObservation(data, 1, 2), 3040 + 2);
    const std::vector<int> all =
        InOrder<int>(communicator, data,
                     {{communicator->rank()}, {10 + communicator->rank()}});
    if (communicator->is_root()) {
      EXPECT_THAT(all, ElementsAre(0, 1, 10, 11));
    } else {
      EXPECT_THAT(all, IsEmpty());
    }
  });
}

TEST_F(PartitionTest, GatheredDataAreThoseOfAllRanks) {
  RunOnThreads(2, [&](Communicator* communicator) {
    Dataset data = parts_[communicator->is_root() ? 1 : 2];
    const double first = communicator->is_root() ? 0.0 : 40.0;
    data.covariate_names = {"t_c"};
    data.covariates = Eigen::MatrixXd(Eigen::RowVectorXd::LinSpaced(
        data.num_poses(), first,
        first + static_cast<double>(data.num_poses() - 1)));
    MakePartition(communicator, &data);
    const Dataset all = GatherData(communicator, data, data);
    ASSERT_EQ(all.num_poses(), 1540);
    Eigen::MatrixXd joint_values(6, 1540);
    joint_values << parts_[1].joint_values.map(), parts_[2].joint_values.map();
    EXPECT_EQ(all.joint_values, SharedMatrix(joint_values));
    Eigen::MatrixXd measured(3, 1540);
    measured << parts_[1].blocks[0].measured.map(),
        parts_[2].blocks[0].measured.map();
    EXPECT_EQ(all.blocks[0].measured, SharedMatrix(measured));
    EXPECT_EQ(all.covariate_names, std::vector<std::string>{"t_c"});
    for (const int pose : {0, 39, 40, 1539}) {
      EXPECT_EQ(all.covariates(0, pose), pose);
    }
    EXPECT_EQ(SourceOf(all, 39), "file2:41");
    EXPECT_EQ(SourceOf(all, 40), "file3:2");
    EXPECT_EQ(SourceOf(all, 1539), "file3:1501");
  });
}

// Where one rank has observed some poses, the others list theirs.
TEST_F(PartitionTest, AListOfOneRankIsAListOfAll) {
  RunOnThreads(2, [&](Communicator* communicator) {
    Dataset data = parts_[0];
    if (!communicator->is_root()) {
      ObservationBlock& positions = data.blocks.front();
      positions.poses = {4, 7};
      positions.measured = positions.measured.map().leftCols(2).eval();
      positions.sigmas = positions.sigmas.map().leftCols(2).eval();
    }
    MakePartition(communicator, &data);
    const std::vector<int>& poses = data.blocks.front().poses;
    if (!communicator->is_root()) {
      EXPECT_THAT(poses, ElementsAre(4, 7));
      return;
    }
    ASSERT_EQ(poses.size(), 3000U);
    EXPECT_EQ(poses[0], 0);
    EXPECT_EQ(poses[2999], 2999);
  });
}

// Of two poses, a row of which was not measured, and of two positions.
TEST(SigmaTotalsTest, LengthsAndOrientationsAreSummedApart) {
  Dataset data;
  data.joint_values = Eigen::MatrixXd::Zero(6, 2);
  ObservationBlock poses;
  poses.kind = MeasurementKind::kPose;
  poses.measured = Eigen::MatrixXd::Zero(6, 2);
  Eigen::MatrixXd sigmas(6, 2);
  sigmas << 0.5, 0.5, 1.0, 1.0, 2.0, std::numeric_limits<double>::infinity(),
      0.1, 0.1, 0.2, 0.2, 0.5, 0.5;
  poses.sigmas = sigmas;
  data.blocks.push_back(poses);
  ObservationBlock positions;
  positions.measured = Eigen::MatrixXd::Zero(3, 2);
  positions.sigmas = Eigen::MatrixXd::Constant(3, 2, 0.25);
  data.blocks.push_back(positions);
  const SigmaTotals totals = SumSigmas(data, 1);
  EXPECT_TRUE(totals.are_positive);
  EXPECT_EQ(totals.equations, 17);
  EXPECT_DOUBLE_EQ(totals.length_information, 2.0 * 5.0 + 0.25 + 6.0 * 16.0);
  EXPECT_DOUBLE_EQ(totals.rotation_information, 2.0 * (100.0 + 25.0 + 4.0));
}

}  // namespace
}  // namespace alidade::internal
