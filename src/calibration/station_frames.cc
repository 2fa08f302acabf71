#include "src/calibration/station_frames.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "alidade/error.h"
#include "alidade/rotation.h"
#include "src/initialization/initial_frames.h"
#include "src/kernel/holdout.h"

namespace alidade::internal {
namespace {

using Motion = Eigen::Matrix<double, 6, 1>;

// Positions of a station fewer than these determine no base.
constexpr std::size_t kFewestPoses = 3;

struct Station {
  Eigen::Index row = 0;  // of the data's covariates
  std::vector<Eigen::Index> poses;
};

// The first one has no covariate.
std::vector<Station> ListStations(const Dataset& data,
                                  const std::vector<CovariateUse>& uses) {
  std::vector<Station> stations(1);
  for (const CovariateUse& use : uses) {
    const auto& names = data.covariate_names;
    const auto found = std::find(names.begin(), names.end(), use.name);
    if (!use.is_station || found == names.end()) continue;
    stations.push_back({found - names.begin(), {}});
  }
  for (Eigen::Index pose = 0; pose < data.num_poses(); ++pose) {
    std::size_t station = 0;
    for (std::size_t k = 1; k < stations.size(); ++k) {
      if (data.covariates(stations[k].row, pose) != 0.0) station = k;
    }
    stations[station].poses.push_back(pose);
  }
  return stations;
}

// Whether each measurement says all that a rigid motion makes others of.
bool CanMove(const Dataset& data) {
  for (const ObservationBlock& block : data.blocks) {
    if (block.size() == 0) continue;
    if (!HoldsPosition(block.kind)) return false;
    const auto sigmas = block.sigmas.map().topRows(3).array();
    if (!sigmas.isFinite().all()) return false;
  }
  return true;
}

// What W becomes where errors are turned.
Eigen::MatrixXd TurnedWhitener(const ObservationBlock& block, Eigen::Index i,
                               const Eigen::Matrix3d& turn) {
  const int height = block.rows_each();
  Eigen::MatrixXd whitener = Eigen::MatrixXd::Identity(height, height);
  Whiten(block, i, 1, whitener);
  for (int first = 0; first < height; first += 3) {
    whitener.middleCols<3>(first) *= turn.transpose();
  }
  return whitener;
}

bool IsIsotropic(const ObservationBlock& block, Eigen::Index i) {
  if (!block.whiteners.empty() && block.whiteners[i].size() > 0) return false;
  const auto sigmas = block.sigmas.col(i);
  for (int row = 0; row < block.rows_each(); ++row) {
    if (sigmas[row] != sigmas[Eigen::Index{3} * (row / 3)]) return false;
  }
  return true;
}

void Move(const Eigen::Isometry3d& motion, Eigen::Index i,
          Eigen::MatrixXd* measured, ObservationBlock* block) {
  auto column = measured->col(i);
  column.head<3>() = motion * Eigen::Vector3d(column.head<3>());
  if (block->kind == MeasurementKind::kPose) {
    const Eigen::Matrix3d turned =
        motion.linear() *
        RotationFromVector<double>(Eigen::Vector3d(column.tail<3>()));
    column.tail<3>() = VectorFromRotation(turned);
  }
  if (IsIsotropic(*block, i)) return;
  block->whiteners.resize(static_cast<std::size_t>(block->size()));
  block->whiteners[i] = TurnedWhitener(*block, i, motion.linear());
}

// Of every pose; those of the first station stay.
void MovePoses(const std::vector<Eigen::Isometry3d>& motions,
               const std::vector<Station>& stations, Dataset* data) {
  std::vector<std::size_t> of_pose(data->num_poses(), 0);
  for (std::size_t k = 1; k < stations.size(); ++k) {
    for (const Eigen::Index pose : stations[k].poses) of_pose[pose] = k;
  }
  for (ObservationBlock& block : data->blocks) {
    Eigen::MatrixXd measured = block.measured.map();
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      const std::size_t station = of_pose[block.pose(i)];
      if (station > 0) Move(motions[station], i, &measured, &block);
    }
    block.measured = std::move(measured);
  }
}

// Whether a linear effect would miss a part of the motion of such points.
bool IsFar(const Eigen::Isometry3d& motion, const Dataset& data) {
  constexpr double kTurn = 0.02;  // rad
  constexpr double kMove = 0.02;  // m
  if (Eigen::AngleAxisd(motion.linear()).angle() > kTurn) return true;
  for (const ObservationBlock& block : data.blocks) {
    if (block.size() == 0) continue;
    const Eigen::Vector3d mean =
        block.measured.map().topRows(3).rowwise().mean();
    if ((motion * mean - mean).norm() > kMove) return true;
  }
  return false;
}

// u of error_terms.h with base * Trans(u) Rot(u) the base times `motion`.
Motion EffectOf(const Eigen::Isometry3d& motion) {
  const Eigen::Matrix3d r = motion.linear();
  const double a = std::atan2(-r(1, 2), r(2, 2));
  const double b =
      std::atan2(r(0, 2), std::cos(a) * r(2, 2) - std::sin(a) * r(1, 2));
  const double c = std::atan2(std::cos(a) * r(1, 0) + std::sin(a) * r(2, 0),
                              std::cos(a) * r(1, 1) + std::sin(a) * r(2, 1));
  Motion effect;
  effect << motion.translation(), 2.0 * std::tan(0.5 * a),
      2.0 * std::tan(0.5 * b), 2.0 * std::tan(0.5 * c);
  return effect;
}

Eigen::Isometry3d MotionOf(const Motion& effect) {
  const auto turn = [&](int k) {
    return Eigen::AngleAxisd(2.0 * std::atan(0.5 * effect[3 + k]),
                             Eigen::Vector3d::Unit(k));
  };
  return Eigen::Translation3d(effect.head<3>()) * turn(0) * turn(1) * turn(2);
}

// Effects on the base are added up (error_terms.h), which motions as large as
// these cannot be.
void RefuseMovedBases(const Dataset& data,
                      const std::vector<CovariateUse>& uses) {
  for (const std::string& name : data.covariate_names) {
    const auto use =
        std::find_if(uses.begin(), uses.end(),
                     [&name](const auto& one) { return one.name == name; });
    // One of which nothing is said moves the base.
    if (use != uses.end() && (use->is_station || use->is_approach ||
                              use->is_payload || !use->moves_base)) {
      continue;
    }
    throw InputError({}, "`" + name +
                             "` moves the base, and stations are more than 20 "
                             "mm or 20 mrad apart, which cannot be described "
                             "together: give the data of each station a job of "
                             "its own, or `effects` on something else");
  }
}

}  // namespace

std::vector<std::string> SmallStations(const CalibrationTask& task) {
  const Dataset& data = task.data.training;
  const std::vector<Station> stations =
      ListStations(data, task.options.errors.uses);
  std::vector<std::string> small;
  for (std::size_t k = 0; k < stations.size() && stations.size() > 1; ++k) {
    if (stations[k].poses.size() >= kFewestPoses) continue;
    small.push_back(k == 0 ? "the first station"
                           : data.covariate_names[stations[k].row]);
  }
  return small;
}

// An arm that is to stay rigid has a base at each station all the same.
void EstimateStationBases(CalibrationTask* task) {
  ErrorTermOptions& errors = task->options.errors;
  const bool has_stations_alone =
      !errors.uses.empty() &&
      errors.uses.size() == task->data.training.covariate_names.size() &&
      std::all_of(errors.uses.begin(), errors.uses.end(),
                  [](const CovariateUse& use) { return use.is_station; });
  if (errors.selection != ErrorTermSelection::kNone || !has_stations_alone ||
      !task->arm.errors.empty()) {
    return;
  }
  errors.selection = ErrorTermSelection::kStated;
  errors.covariates = true;
}

std::vector<MovedStation> AlignStations(CalibrationTask* task) {
  EstimateStationBases(task);
  const CalibrationOptions& options = task->options;
  CandidateGroups candidates = options.identifiability.candidates;
  Dataset& training = task->data.training;
  if (options.errors.selection == ErrorTermSelection::kNone ||
      !candidates.base || training.partition || !CanMove(training) ||
      (task->data.validation && !CanMove(*task->data.validation))) {
    return {};
  }
  const std::vector<Station> stations =
      ListStations(training, options.errors.uses);
  const auto largest = std::max_element(
      stations.begin(), stations.end(), [](const auto& a, const auto& b) {
        return a.poses.size() < b.poses.size();
      });
  if (stations.size() < 2 || stations.front().poses.size() < kFewestPoses) {
    return {};
  }
  const auto find = [&](const Arm& arm, const Station& station) {
    return FindInitialFrames(arm, task->data.references,
                             SelectPoses(training, station.poses), candidates)
        .arm;
  };
  Arm arm = task->arm;
  arm.errors.Clear();
  arm = find(arm, *largest);
  // One target for all, so that no base makes up for another one.
  candidates.tool = false;
  const Eigen::Isometry3d first =
      find(arm, stations.front()).instrument_from_base;
  std::vector<MovedStation> moved;
  std::vector<Eigen::Isometry3d> motions(stations.size(),
                                         Eigen::Isometry3d::Identity());
  for (std::size_t k = 1; k < stations.size(); ++k) {
    if (stations[k].poses.size() < kFewestPoses) continue;
    const Eigen::Isometry3d motion =
        first * find(arm, stations[k]).instrument_from_base.inverse();
    if (!IsFar(motion, SelectPoses(training, stations[k].poses))) continue;
    motions[k] = motion;
    moved.push_back({training.covariate_names[stations[k].row], motion});
  }
  if (moved.empty()) return {};
  RefuseMovedBases(training, options.errors.uses);
  MovePoses(motions, stations, &training);
  if (std::optional<Dataset>& validation = task->data.validation) {
    MovePoses(motions, ListStations(*validation, options.errors.uses),
              &*validation);
  }
  return moved;
}

void RestoreStations(const std::vector<MovedStation>& stations, Arm* arm) {
  const Eigen::Isometry3d& base = arm->instrument_from_base;
  for (const MovedStation& station : stations) {
    std::vector<CovariateEffect>& effects = arm->errors.covariates;
    auto found = std::find_if(
        effects.begin(), effects.end(),
        [&](const auto& effect) { return effect.name == station.name; });
    if (found == effects.end()) {
      effects.push_back({station.name});
      found = effects.end() - 1;
    }
    found->base =
        EffectOf(base.inverse() * station.first_from_station.inverse() * base *
                 MotionOf(found->base));
  }
}

}  // namespace alidade::internal
