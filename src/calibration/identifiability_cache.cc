#include "src/calibration/identifiability_cache.h"

#include <algorithm>
#include <cstdint>

#include "src/common/bytes.h"
#include "src/identifiability/analysis.h"

namespace alidade::internal {
namespace {

// Of the passes of several arms or sets of poses that take turns.
constexpr std::size_t kMostKnown = 16;

// With more poses than that the pass is no longer what takes the time, and its
// question too long to keep.
constexpr Eigen::Index kMostPoses = 2000;

// Structures are taken apart by name, so that one which gets another member
// does not compile here before it is thought of.

void PutFrame(const Eigen::Isometry3d& frame, ByteWriter* writer) {
  writer->PutMatrix(frame.matrix());
}

void PutErrors(const ErrorTerms& errors, ByteWriter* writer) {
  const auto& [joints, coupling, covariates, gravity, links, payload,
               load_geometry, load_target] = errors;
  for (const auto& [name, reference, base, on_joints, target, load] :
       covariates) {
    writer->PutText(name);
    writer->Put(reference);
    writer->PutMatrix(base);
    writer->PutMatrix(on_joints);
    writer->PutMatrix(target);
    writer->Put(load);
  }
  writer->Put(joints.size());
  for (const auto& [compliance, function, harmonics, backlash] : joints) {
    writer->PutMatrix(compliance);
    writer->Put(function.first);
    writer->Put(function.spacing);
    writer->Put(function.is_periodic ? 1 : 0);
    writer->PutMatrix(function.values);
    writer->PutList(harmonics);
    writer->Put(backlash);
  }
  std::vector<Load> loads = links;
  loads.push_back(payload);
  for (const auto& [mass, centre] : loads) {
    writer->Put(mass);
    writer->PutMatrix(centre);
  }
  for (const Eigen::MatrixXd& matrix :
       {coupling, Eigen::MatrixXd(gravity), load_geometry,
        Eigen::MatrixXd(load_target)}) {
    writer->PutMatrix(matrix);
  }
}

void PutArm(const Arm& arm, ByteWriter* writer) {
  const auto& [name, joints, instrument_from_base, targets, joints_from_motors,
               motor_offsets, errors] = arm;
  writer->PutText(name);
  writer->Put(joints.size());
  for (const auto& [type, beta, alpha, d, theta, r, lower, upper] : joints) {
    writer->Put(type);
    for (const double number : {beta, alpha, d, theta, r, lower, upper}) {
      writer->Put(number);
    }
  }
  PutFrame(instrument_from_base, writer);
  writer->Put(targets.size());
  for (const auto& [target_name, last_from_target] : targets) {
    writer->PutText(target_name);
    PutFrame(last_from_target, writer);
  }
  writer->PutMatrix(joints_from_motors);
  writer->PutMatrix(motor_offsets);
  PutErrors(errors, writer);
}

void PutReferences(const References& references, ByteWriter* writer) {
  const auto& [points, planes] = references;
  writer->Put(points.size());
  for (const auto& [name, position, is_known] : points) {
    writer->PutText(name);
    writer->PutMatrix(position);
    writer->Put(is_known);
  }
  writer->Put(planes.size());
  for (const auto& [name, normal, offset, is_known] : planes) {
    writer->PutText(name);
    writer->PutMatrix(normal);
    writer->Put(offset);
    writer->Put(is_known);
  }
}

void PutBlock(const ObservationBlock& block, ByteWriter* writer) {
  const auto& [kind, poses, targets, references, seconds, measured, sigmas,
               whiteners] = block;
  writer->Put(kind);
  for (const std::vector<int>* list :
       {&poses, &targets, &references, &seconds}) {
    writer->PutList(*list);
  }
  // The derivative of a position does not depend on where it was measured; of
  // an orientation or a distance it does.
  writer->Put(measured.cols());
  if (kind != MeasurementKind::kPosition) writer->PutMatrix(measured);
  writer->PutMatrix(sigmas);
  writer->Put(whiteners.size());
  for (const Eigen::MatrixXd& whitener : whiteners) writer->PutMatrix(whitener);
}

void PutData(const Dataset& data, ByteWriter* writer) {
  // Names, files and lines are for messages of the reader; a part is not kept.
  const auto& [name, joint_values, covariate_names, covariates, blocks, sources,
               files, shards, partition] = data;
  writer->PutMatrix(joint_values);
  writer->PutTexts(covariate_names);
  writer->PutMatrix(covariates);
  writer->Put(blocks.size());
  for (const ObservationBlock& block : blocks) PutBlock(block, writer);
  writer->Put(shards.size());
  for (const auto& [first_pose, first_observations] : shards) {
    writer->Put(first_pose);
    writer->PutList(first_observations);
  }
}

void PutOptions(const IdentifiabilityOptions& options, ByteWriter* writer) {
  const auto& [method, policy, candidates, prefer, free, priors, fix,
               proceed_beyond_rank, angle_tolerance, relative_tolerance,
               perturbation, seed] = options;
  writer->Put(method);
  writer->Put(policy);
  const auto& [joints, base, tool] = candidates;
  for (const bool flag : {joints, base, tool, proceed_beyond_rank}) {
    writer->Put(flag);
  }
  for (const std::vector<std::string>* names : {&prefer, &free, &fix}) {
    writer->PutTexts(*names);
  }
  const auto& [beta, alpha, d, theta, r, frame_length, frame_angle] = priors;
  for (const double number :
       {beta, alpha, d, theta, r, frame_length, frame_angle, angle_tolerance,
        relative_tolerance, perturbation}) {
    writer->Put(number);
  }
  writer->Put(seed);
}

std::string QuestionOf(const MeasurementModel& model, const Dataset& data,
                       const IdentifiabilityOptions& options) {
  ByteWriter writer;
  PutArm(model.nominal(), &writer);
  PutReferences(model.references(), &writer);
  PutData(data, &writer);
  PutOptions(options, &writer);
  return writer.Take();
}

}  // namespace

IdentifiabilityResult IdentifiabilityCache::Analyze(
    const MeasurementModel& model, const Dataset& data,
    const IdentifiabilityOptions& options) {
  if (data.partition || data.num_poses() > kMostPoses) {
    return AnalyzeIdentifiability(model, data, options);
  }
  std::string question = QuestionOf(model, data, options);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = std::find_if(
        known_.begin(), known_.end(),
        [&](const auto& known) { return known.first == question; });
    if (found != known_.end()) return found->second;
  }
  // Others may ask the same meanwhile: better than to wait.
  IdentifiabilityResult result = AnalyzeIdentifiability(model, data, options);
  const std::lock_guard<std::mutex> lock(mutex_);
  ++num_made_;
  known_.emplace_back(std::move(question), result);
  if (known_.size() > kMostKnown) known_.pop_front();
  return result;
}

std::size_t IdentifiabilityCache::num_made() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return num_made_;
}

}  // namespace alidade::internal
