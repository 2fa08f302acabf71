#include "src/calibration/own_references.h"

#include <utility>
#include <vector>

#include "alidade/error.h"
#include "src/common/names.h"
#include "src/kernel/partition.h"

namespace alidade::internal {
namespace {

// Which points and planes observations are of, those of all ranks.
struct Mentioned {
  std::vector<bool> points;
  std::vector<bool> planes;

  Mentioned(const References& references, const Dataset& data,
            Communicator* communicator)
      : points(references.points.size()), planes(references.planes.size()) {
    for (const ObservationBlock& block : data.blocks) {
      std::vector<bool>& list =
          block.kind == MeasurementKind::kPlane ? planes : points;
      for (const int i : block.references) list[i] = true;
      if (block.kind != MeasurementKind::kPointDistance) continue;
      for (const int i : block.seconds) list[i] = true;
    }
    for (std::vector<bool>* list : {&points, &planes}) {
      for (auto&& is_mentioned : *list) {
        is_mentioned = !OnAllRanks(communicator, data, !is_mentioned);
      }
    }
  }
};

// Calls use(reference) for each that validation poses alone are measured
// against.
template <typename Use>
void ForEachOwn(CalibrationTask* task, const Use& use) {
  CalibrationData& data = task->data;
  References& references = data.references;
  if (!data.validation ||
      (references.points.empty() && references.planes.empty())) {
    return;
  }
  const Mentioned fitted(references, data.training, task->communicator);
  const Mentioned validated(references, *data.validation, task->communicator);
  const auto visit = [&use](auto* all, const std::vector<bool>& is_validated,
                            const std::vector<bool>& is_fitted) {
    for (std::size_t i = 0; i < all->size(); ++i) {
      auto& reference = (*all)[i];
      if (is_validated[i] && !is_fitted[i] && !reference.is_known) {
        use(&reference);
      }
    }
  };
  visit(&references.points, validated.points, fitted.points);
  visit(&references.planes, validated.planes, fitted.planes);
}

// With the arm as it is; all but its own references count as known.
CalibrationTask ReferencesTask(const CalibrationTask& task, const Arm& arm,
                               const std::vector<ReferenceResult>& found) {
  CalibrationTask fit;
  fit.arm = arm;
  fit.communicator = task.communicator;
  fit.data.training = *task.data.validation;
  fit.data.references = task.data.references;
  std::size_t next = 0;
  for (ReferencePoint& point : fit.data.references.points) {
    point.position = found[next++].vector;
    point.is_known = true;
  }
  for (ReferencePlane& plane : fit.data.references.planes) {
    plane.normal = found[next].vector;
    plane.offset = found[next++].offset;
    plane.is_known = true;
  }
  CalibrationOptions& options = fit.options;
  options.identifiability.candidates = {false, false, false};
  options.num_threads = task.options.num_threads;
  options.uncertainty.map_configurations = 0;
  options.uncertainty.region_configurations = 0;
  return fit;
}

// Measurements against the point or plane of a name.
Eigen::Index CountEquations(const CalibrationData& data,
                            const std::string& name) {
  Eigen::Index count = 0;
  for (const ObservationBlock& block : data.validation->blocks) {
    const bool is_plane = block.kind == MeasurementKind::kPlane;
    const auto is_it = [&](const std::vector<int>& indices, Eigen::Index i) {
      if (indices.empty()) return false;
      const int at = indices[static_cast<std::size_t>(i)];
      return (is_plane ? data.references.planes[at].name
                       : data.references.points[at].name) == name;
    };
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      if (is_it(block.references, i)) count += block.Dimension(i);
    }
    if (block.kind != MeasurementKind::kPointDistance) continue;
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      if (is_it(block.seconds, i)) count += block.Dimension(i);
    }
  }
  return count;
}

[[noreturn]] void Fail(const CalibrationTask& task, const std::string& names,
                       const std::string& reason) {
  SourceLocation location;
  location.file = task.data.validation->name;
  throw InputError(location,
                   names +
                       ", measured against at validation poses alone, "
                       "cannot be found from them: " +
                       reason + ". State `known: true` of it in `references`");
}

// A point that was touched once lies wherever the arm says: its error is zero
// and says nothing.
void RefuseUnchecked(const CalibrationTask& task,
                     const std::vector<std::string>& names) {
  constexpr Eigen::Index kUnknowns = 3;  // of a point as of a plane
  for (const std::string& name : names) {
    if (CountEquations(task.data, name) > kUnknowns) continue;
    Fail(task, name,
         "it is found from as many numbers as it has, which any arm would fit. "
         "Measure it more often");
  }
}

}  // namespace

bool HoldOwnReferences(CalibrationTask* task) {
  bool are_there = false;
  ForEachOwn(task, [&are_there](auto* reference) {
    are_there = true;
    reference->is_known = true;
  });
  return are_there;
}

std::string FitOwnReferences(CalibrationTask* task) {
  std::vector<std::string> names;
  ForEachOwn(task,
             [&names](auto* reference) { names.push_back(reference->name); });
  if (names.empty()) return "";
  if (!task->data.validation->partition) RefuseUnchecked(*task, names);
  CalibrationTask training = *task;
  HoldOwnReferences(&training);
  training.data.validation.reset();
  CalibrationOptions& options = training.options;
  options.holdout.reset();
  options.folds.reset();
  options.compare_with.clear();
  options.acceptance = {};
  options.uncertainty.map_configurations = 0;
  options.uncertainty.region_configurations = 0;
  const CalibrationResult calibrated = Calibrate(std::move(training));
  // What stops this stops the calibration itself, which then says so.
  if (!calibrated.IsUsable()) {
    HoldOwnReferences(task);
    return "";
  }
  CalibrationTask fit =
      ReferencesTask(*task, calibrated.arm, calibrated.references);
  ForEachOwn(task, [&](auto* reference) {
    const auto release = [&](auto* all) {
      for (auto& other : *all) {
        if (other.name == reference->name) other.is_known = false;
      }
    };
    release(&fit.data.references.points);
    release(&fit.data.references.planes);
  });
  const CalibrationResult found = Calibrate(std::move(fit));
  const std::string list = JoinNames(names);
  if (!found.IsUsable()) Fail(*task, list, found.message);
  for (const ParameterResult& parameter : found.parameters) {
    if (parameter.assessment == ParameterAssessment::kKnown ||
        parameter.assessment == ParameterAssessment::kEstimated) {
      continue;
    }
    Fail(*task, list, "they do not determine " + parameter.name);
  }
  for (const ReferenceResult& result : found.references) {
    for (ReferencePoint& point : task->data.references.points) {
      if (point.name != result.name || result.is_known) continue;
      point.position = result.vector;
      point.is_known = true;
    }
    for (ReferencePlane& plane : task->data.references.planes) {
      if (plane.name != result.name || result.is_known) continue;
      plane.normal = result.vector;
      plane.offset = result.offset;
      plane.is_known = true;
    }
  }
  return list +
         " of the validation data alone: found from these, the calibrated arm "
         "held. Validation errors are smaller by what that takes up, and those "
         "before calibration are to the same places";
}

}  // namespace alidade::internal
