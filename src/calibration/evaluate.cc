#include "src/calibration/evaluate.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "alidade/error.h"
#include "alidade/rotation.h"
#include "src/calibration/label_bytes.h"
#include "src/common/bytes.h"
#include "src/kernel/holdout.h"
#include "src/kernel/partition.h"
#include "src/model/joint_draw.h"

namespace alidade::internal {
namespace {

void RequireSameJoints(const Arm& arm, const Arm& reference) {
  bool same = arm.num_joints() == reference.num_joints();
  for (int j = 0; same && j < arm.num_joints(); ++j) {
    same = arm.joints[j].type == reference.joints[j].type;
  }
  if (same) return;
  throw InputError({}, "the arms \"" + arm.name + "\" and \"" + reference.name +
                           "\" differ in the number or the types of their "
                           "joints and cannot be compared");
}

void RequireLimitedTravel(const Arm& arm) {
  for (int j = 0; j < arm.num_joints(); ++j) {
    const Joint& joint = arm.joints[j];
    if (joint.type == JointType::kRevolute) continue;
    if (HasLimits(joint)) continue;
    throw InputError({}, "prismatic joint " + std::to_string(j + 1) +
                             " of the arm \"" + arm.name +
                             "\" has no limits: its workspace is not bounded. "
                             "Add limits to the arm file");
  }
}

// One position of the one target at every pose: nothing to label.
bool IsPlain(const Dataset& data) {
  return data.blocks.size() == 1 && data.blocks[0].poses.empty() &&
         data.blocks[0].targets.empty() &&
         data.blocks[0].kind == MeasurementKind::kPosition;
}

// Calls visit(block, index in it, observation, first row) for every one.
template <typename Visit>
void ForEach(const Dataset& data, const Visit& visit) {
  Eigen::Index count = 0;
  Eigen::Index row = 0;
  for (const ObservationBlock& block : data.blocks) {
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      visit(block, i, count++, row);
      row += block.rows_each();
    }
  }
}

SharedMatrix MeasuredPositions(const Dataset& data) {
  if (IsPlain(data) && data.sigmas().map().allFinite()) return data.positions();
  MatrixBuilder all(3, data.num_observations());
  MatrixBuilder::Map positions = all.map();
  positions.setConstant(std::numeric_limits<double>::quiet_NaN());
  ForEach(data, [&](const ObservationBlock& block, Eigen::Index i,
                    Eigen::Index count, Eigen::Index) {
    if (!HoldsPosition(block.kind)) return;
    if (!block.sigmas.col(i).head<3>().allFinite()) return;
    positions.col(count) = block.measured.col(i).head<3>();
  });
  return all.Freeze();
}

// The first rows of every observation, up to three.
SharedMatrix Lengths(const Dataset& data, const SharedVector& errors) {
  if (IsPlain(data)) return errors.Reshaped(3);
  MatrixBuilder all(3, data.num_observations());
  MatrixBuilder::Map lengths = all.map();
  lengths.setZero();
  ForEach(data, [&](const ObservationBlock& block, Eigen::Index,
                    Eigen::Index count, Eigen::Index row) {
    const Eigen::Index height = std::min(3, block.rows_each());
    lengths.col(count).head(height) = errors.map().segment(row, height);
  });
  return all.Freeze();
}

SharedMatrix Rotations(const Dataset& data, const SharedVector& errors) {
  MatrixBuilder all(3, data.num_observations());
  MatrixBuilder::Map turns = all.map();
  turns.setZero();
  ForEach(data, [&](const ObservationBlock& block, Eigen::Index,
                    Eigen::Index count, Eigen::Index row) {
    if (block.kind != MeasurementKind::kPose) return;
    turns.col(count) = errors.map().segment<3>(row + 3);
  });
  return all.Freeze();
}

using Lists = std::vector<std::vector<double>>;  // one for each block

Accuracy Summarize(const MeasurementModel& model, const Dataset& data,
                   Lists mine) {
  const std::vector<double> norms =
      InOrder(model.communicator(), data, std::move(mine));
  return ComputeOnRoot(model.communicator(), data, [&] {
    return SummarizeErrors(Eigen::Map<const Eigen::VectorXd>(
        norms.data(), static_cast<Eigen::Index>(norms.size())));
  });
}

// The paired t statistic of the lengths.
double ChangeInStandardErrors(const MeasurementModel& model,
                              const Dataset& data, const SharedVector& before,
                              const SharedVector& after) {
  Lists changes = CountedLengths(after, data);
  const Lists before_lengths = CountedLengths(before, data);
  for (std::size_t k = 0; k < changes.size(); ++k) {
    for (std::size_t i = 0; i < changes[k].size(); ++i) {
      changes[k][i] -= before_lengths[k][i];
    }
  }
  const std::vector<double> all =
      InOrder(model.communicator(), data, std::move(changes));
  return ComputeOnRoot(model.communicator(), data, [&] {
    const auto n = static_cast<Eigen::Index>(all.size());
    const Eigen::Map<const Eigen::ArrayXd> change(all.data(), n);
    if (n < 2) return std::numeric_limits<double>::quiet_NaN();
    const auto count = static_cast<double>(n);
    const double variance =
        (change - change.mean()).square().sum() / (count - 1.0);
    return change.mean() / std::sqrt(variance / count);
  });
}

// There is one block of poses at most.
Lists RotationLists(const SharedVector& errors, const Dataset& data) {
  Lists lists(data.blocks.size());
  for (std::size_t k = 0; k < lists.size(); ++k) {
    if (data.blocks[k].kind != MeasurementKind::kPose) continue;
    const SharedVector norms = RotationErrors(errors, data);
    lists[k].assign(norms.data(), norms.data() + norms.size());
  }
  return lists;
}

// Of an EvaluatedSet or of KeptErrors.
template <typename Errors>
void SummarizeBoth(const MeasurementModel& model, const Dataset& data,
                   const SharedVector& before, const SharedVector& after,
                   Errors* errors) {
  errors->before = Summarize(model, data, CountedLengths(before, data));
  errors->after = Summarize(model, data, CountedLengths(after, data));
  errors->change_t = ChangeInStandardErrors(model, data, before, after);
  if (!data.Has(MeasurementKind::kPose)) return;
  errors->rotation_before = Summarize(model, data, RotationLists(before, data));
  errors->rotation_after = Summarize(model, data, RotationLists(after, data));
}

// The labels of the global data set, on the root.
std::vector<ObservationLabel> LabelsInOrder(
    Communicator* communicator, const Dataset& data,
    std::vector<ObservationLabel> mine) {
  if (!data.partition) return mine;
  std::vector<ObservationLabel> all;
  auto label = mine.begin();
  for (const ObservationBlock& block : data.blocks) {
    ByteWriter writer;
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      PutLabel(*label++, &writer);
    }
    for (const std::string& bytes : communicator->GatherToRoot(writer.Take())) {
      ByteReader reader(bytes);
      while (!reader.is_at_end()) all.push_back(GetLabel(&reader));
    }
  }
  return all;
}

// A number that poses of the same joint values have in common, and hardly any
// others.
std::uint64_t Fingerprint(const Eigen::Ref<const Eigen::VectorXd>& joints) {
  std::uint64_t print = 0;
  for (const double joint : joints) {
    const double value = joint + 0.0;  // -0 is 0
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof(bits));
    // The finisher of MurmurHash3 (Appleby), which spreads every bit.
    print ^= bits + 0x9e3779b97f4a7c15U + (print << 6U) + (print >> 2U);
    print = (print ^ (print >> 33U)) * 0xff51afd7ed558ccdU;
    print = (print ^ (print >> 33U)) * 0xc4ceb9fe1a85ec53U;
    print ^= print >> 33U;
  }
  return print;
}

// The fingerprints of all ranks' poses that are there more than once, in
// order.
std::vector<std::uint64_t> RepeatedPrints(Communicator* communicator,
                                          const Dataset& data) {
  std::vector<std::vector<std::uint64_t>> lists(data.blocks.size());
  if (lists.empty()) return {};
  lists.front().reserve(static_cast<std::size_t>(data.num_poses()));
  for (Eigen::Index i = 0; i < data.num_poses(); ++i) {
    lists.front().push_back(Fingerprint(data.joint_values.col(i)));
  }
  std::vector<std::uint64_t> all =
      InOrder(communicator, data, std::move(lists));
  std::sort(all.begin(), all.end());
  std::vector<std::uint64_t> repeated;
  for (std::size_t i = 1; i < all.size(); ++i) {
    if (all[i] == all[i - 1]) repeated.push_back(all[i]);
  }
  ByteWriter answer;
  answer.PutList(repeated);
  const std::string bytes =
      HoldersOf(communicator, data)->Broadcast(answer.Take());
  return ByteReader(bytes).GetList<std::uint64_t>();
}

// Poses that others, here or at other ranks, repeat; with few that only seem
// to.
std::vector<Eigen::Index> RepeatedPoses(Communicator* communicator,
                                        const Dataset& data) {
  const std::vector<std::uint64_t> repeated =
      RepeatedPrints(communicator, data);
  std::vector<Eigen::Index> poses;
  for (Eigen::Index i = 0; i < data.num_poses() && !repeated.empty(); ++i) {
    const std::uint64_t print = Fingerprint(data.joint_values.col(i));
    if (std::binary_search(repeated.begin(), repeated.end(), print)) {
      poses.push_back(i);
    }
  }
  return poses;
}

// Adds the squares about the mean of repeated measurements.
void AddSpread(const ObservationBlock& block,
               const std::vector<Eigen::Index>& repeats, RepeatSpread* spread) {
  const auto n = static_cast<std::int64_t>(repeats.size());
  if (n < 2) return;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Index i : repeats) mean += block.measured.col(i).head<3>();
  mean /= static_cast<double>(n);
  for (const Eigen::Index i : repeats) {
    spread->length += (block.measured.col(i).head<3>() - mean).squaredNorm();
  }
  spread->length_degrees_of_freedom += 3 * (n - 1);
  if (block.kind != MeasurementKind::kPose) return;
  // Rotation vectors from the first, which are small, less their mean.
  const Eigen::Vector3d first = block.measured.col(repeats[0]).tail<3>();
  Eigen::Matrix3Xd turns(3, n);
  for (std::int64_t k = 0; k < n; ++k) {
    const Eigen::Vector3d mine = block.measured.col(repeats[k]).tail<3>();
    turns.col(k) = VectorFromRotation(RotationFromVector<double>(mine) *
                                      RotationFromVector<double>(-first));
  }
  spread->rotation += (turns.colwise() - turns.rowwise().mean()).squaredNorm();
  spread->rotation_degrees_of_freedom += 3 * (n - 1);
}

}  // namespace

ObservationLabel LabelOf(const Arm& arm, const Dataset& data, std::size_t block,
                         Eigen::Index i) {
  const ObservationBlock& mine = data.blocks[block];
  ObservationLabel label;
  label.kind = NameOf(mine.kind);
  const Eigen::Index lengths = std::min(3, mine.rows_each());
  const auto is_measured = mine.sigmas.col(i).array().isFinite().eval();
  label.has_length = is_measured.head(lengths).any();
  label.has_rotation = is_measured.tail(mine.rows_each() - lengths).any();
  if (mine.kind == MeasurementKind::kPointDistance) {
    label.pose = -1;
  } else {
    label.pose =
        mine.pose(i) +
        static_cast<int>(data.partition ? data.partition->first_pose : 0);
    label.target = arm.targets[mine.target(i)].name;
    label.where = SourceOf(data, mine.pose(i));
  }
  return label;
}

std::vector<ObservationLabel> LabelsOf(const Arm& arm, const Dataset& data) {
  std::vector<ObservationLabel> labels;
  for (std::size_t k = 0; k < data.blocks.size(); ++k) {
    for (Eigen::Index i = 0; i < data.blocks[k].size(); ++i) {
      labels.push_back(LabelOf(arm, data, k, i));
    }
  }
  return labels;
}

EvaluatedSet EvaluateSet(const MeasurementModel& model_before,
                         const Eigen::VectorXd& before,
                         const MeasurementModel& model,
                         const Eigen::VectorXd& after, const Dataset& data,
                         const Dataset* kept) {
  Communicator* const communicator = model.communicator();
  EvaluatedSet set;
  set.name = data.name;
  set.joint_dimensions = model.nominal().JointDimensions();
  set.joint_values = PosesInOrder(communicator, data, data.joint_values);
  if (!IsPlain(data)) {
    set.labels =
        LabelsInOrder(communicator, data, LabelsOf(model.nominal(), data));
  }
  set.positions =
      ObservationsInOrder(communicator, data, MeasuredPositions(data));
  const SharedVector errors_before = model_before.Errors(before, data);
  const SharedVector errors_after = model.Errors(after, data);
  set.residual_before =
      ObservationsInOrder(communicator, data, Lengths(data, errors_before));
  set.residual_after =
      ObservationsInOrder(communicator, data, Lengths(data, errors_after));
  if (data.Has(MeasurementKind::kPose)) {
    set.rotation_residual_before =
        ObservationsInOrder(communicator, data, Rotations(data, errors_before));
    set.rotation_residual_after =
        ObservationsInOrder(communicator, data, Rotations(data, errors_after));
  }
  SummarizeBoth(model, data, errors_before, errors_after, &set);
  if (kept != nullptr) {
    SummarizeBoth(model, *kept, errors_before, errors_after,
                  &set.kept.emplace());
  }
  return set;
}

Lists CountedLengths(const SharedVector& errors, const Dataset& data) {
  const SharedVector norms = LengthErrors(errors, data);
  Lists counted(data.blocks.size());
  Eigen::Index count = 0;
  for (std::size_t k = 0; k < counted.size(); ++k) {
    const ObservationBlock& block = data.blocks[k];
    const Eigen::Index height = std::min(3, block.rows_each());
    counted[k].reserve(static_cast<std::size_t>(block.size()));
    for (Eigen::Index i = 0; i < block.size(); ++i, ++count) {
      if (block.kind == MeasurementKind::kPointDistance) continue;
      if (block.sigmas.col(i).head(height).array().isFinite().any()) {
        counted[k].push_back(norms[count]);
      }
    }
  }
  return counted;
}

Accuracy EvaluateAccuracy(const MeasurementModel& model, const Dataset& data,
                          const Eigen::VectorXd& values) {
  return Summarize(model, data,
                   CountedLengths(model.Errors(values, data), data));
}

Accuracy EvaluateRotations(const MeasurementModel& model, const Dataset& data,
                           const Eigen::VectorXd& values) {
  if (!data.Has(MeasurementKind::kPose)) return {};
  return Summarize(model, data,
                   RotationLists(model.Errors(values, data), data));
}

namespace {

// The station of each pose, counted from 0: poses whose columns of stations
// have the same values are of one.
std::vector<int> NumberStations(const Dataset& data,
                                const std::vector<CovariateUse>& covariates) {
  std::vector<Eigen::Index> rows;
  for (const CovariateUse& use : covariates) {
    if (!use.is_station) continue;
    const auto& names = data.covariate_names;
    const auto found = std::find(names.begin(), names.end(), use.name);
    if (found != names.end()) rows.push_back(found - names.begin());
  }
  std::map<std::vector<double>, int> known;
  std::vector<int> stations(static_cast<std::size_t>(data.num_poses()), 0);
  for (std::size_t pose = 0; pose < stations.size(); ++pose) {
    std::vector<double> values;
    for (const Eigen::Index row : rows) {
      values.push_back(data.covariates(row, static_cast<Eigen::Index>(pose)));
    }
    stations[pose] =
        known.emplace(std::move(values), static_cast<int>(known.size()))
            .first->second;
  }
  return stations;
}

}  // namespace

RepeatSpread MeasureRepeats(const Dataset& data, Communicator* communicator,
                            const std::vector<CovariateUse>& covariates) {
  const Dataset poses = GatherData(
      communicator, data, SelectPoses(data, RepeatedPoses(communicator, data)));
  const std::vector<int> groups = GroupByJointValues(poses);
  const std::vector<int> stations = NumberStations(poses, covariates);
  RepeatSpread spread;
  for (const ObservationBlock& block : poses.blocks) {
    if (!HoldsPosition(block.kind)) continue;
    const auto key = [&](Eigen::Index i) {
      const auto pose = static_cast<std::size_t>(block.pose(i));
      return std::make_tuple(groups[pose], stations[pose], block.target(i));
    };
    std::vector<Eigen::Index> full;
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      if (block.Dimension(i) == block.rows_each()) full.push_back(i);
    }
    std::sort(full.begin(), full.end(), [&](Eigen::Index a, Eigen::Index b) {
      return std::make_pair(key(a), a) < std::make_pair(key(b), b);
    });
    for (auto first = full.begin(); first != full.end();) {
      const auto end = std::find_if(first, full.end(), [&](Eigen::Index i) {
        return key(i) != key(*first);
      });
      AddSpread(block, {first, end}, &spread);
      first = end;
    }
  }
  const auto root = [](double squares, std::int64_t freedom) {
    return freedom > 0 ? std::sqrt(squares / static_cast<double>(freedom))
                       : 0.0;
  };
  spread.length = root(spread.length, spread.length_degrees_of_freedom);
  spread.rotation = root(spread.rotation, spread.rotation_degrees_of_freedom);
  return spread;
}

namespace {

// Of the reference, where both are given the same commands: zeros of joints and
// couplings may be what the two differ in.
Eigen::MatrixXd CommandedAlike(const Arm& arm, const Arm& reference,
                               const Eigen::MatrixXd& joint_values) {
  const auto is_same = [](const auto& a, const auto& b) {
    return a.rows() == b.rows() && a.cols() == b.cols() && a == b;
  };
  if (is_same(arm.joints_from_motors, reference.joints_from_motors) &&
      is_same(arm.motor_offsets, reference.motor_offsets)) {
    return joint_values;
  }
  Eigen::MatrixXd motors = joint_values;
  if (HasMotorMap(arm)) motors = MotorsFromJoints(arm, joint_values);
  return HasMotorMap(reference) ? JointsFromMotors(reference, motors) : motors;
}

}  // namespace

Accuracy CompareArms(const Arm& arm, const Arm& reference, int count,
                     std::uint64_t seed) {
  RequireSameJoints(arm, reference);
  RequireLimitedTravel(arm);
  const Eigen::MatrixXd joint_values = DrawJointValues(arm, count, seed);
  const MeasurementModel model(arm);
  const MeasurementModel reference_model(reference);
  const Eigen::Matrix3Xd difference =
      model.Predict(model.NominalValues(), joint_values) -
      reference_model.Predict(reference_model.NominalValues(),
                              CommandedAlike(arm, reference, joint_values));
  return SummarizeErrors(difference.colwise().norm().transpose());
}

}  // namespace alidade::internal
