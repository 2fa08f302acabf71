#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "src/common/text.h"
#include "src/report/report.h"
#include "src/report/rows.h"

namespace alidade::internal {
namespace {

struct JointColumn {
  std::string title;
  double unit;
};

std::vector<JointColumn> JointColumns(const EvaluatedSet& set) {
  std::vector<JointColumn> columns;
  for (std::size_t j = 0; j < set.joint_dimensions.size(); ++j) {
    const bool angle = set.joint_dimensions[j] == Dimension::kAngle;
    columns.push_back({"q" + std::to_string(j + 1) + (angle ? "_deg" : "_mm"),
                       angle ? kDegree : kMillimetre});
  }
  return columns;
}

std::string Header(const EvaluatedSet& set,
                   const std::vector<JointColumn>& joints) {
  std::string text = "pose";
  if (!set.labels.empty()) text += ",kind,target,where";
  for (const JointColumn& joint : joints) text += "," + joint.title;
  text +=
      ",x_mm,y_mm,z_mm"
      ",before_dx_mm,before_dy_mm,before_dz_mm,before_error_mm"
      ",after_dx_mm,after_dy_mm,after_dz_mm,after_error_mm";
  if (set.rotation_residual_after.cols() > 0) {
    text += ",before_rotation_deg,after_rotation_deg";
  }
  return text + "\n";
}

void AppendCell(double value, std::string* row) {
  *row += ',';
  AppendShortest(value, row);
}

void AppendVector(const Eigen::Vector3d& metres, std::string* row) {
  for (const double coordinate : metres) {
    AppendCell(coordinate / kMillimetre, row);
  }
}

void AppendLabel(const ObservationLabel& label, std::string* row) {
  *row += ',';
  *row += label.kind;
  *row += ',';
  AppendTextCell(label.target, row);
  *row += ',';
  AppendTextCell(label.where, row);
}

void AppendJoints(const EvaluatedSet& set,
                  const std::vector<JointColumn>& joints, int pose,
                  std::string* row) {
  if (pose < 0) {
    row->append(joints.size(), ',');
    return;
  }
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const double value = set.joint_values(static_cast<Eigen::Index>(j), pose);
    AppendCell(value / joints[j].unit, row);
  }
}

void AppendMeasured(const Eigen::Vector3d& position, std::string* row) {
  if (position.allFinite()) {
    AppendVector(position, row);
  } else {
    *row += ",,,";
  }
}

void AppendError(const Eigen::Vector3d& error, bool is_measured,
                 std::string* row) {
  if (is_measured) {
    AppendVector(error, row);
    AppendCell(error.norm() / kMillimetre, row);
  } else {
    *row += ",,,,";
  }
}

void AppendRotations(const EvaluatedSet& set, Eigen::Index i,
                     std::string* row) {
  const bool has_rotation = !set.labels.empty() && set.labels[i].has_rotation;
  for (const auto* turns :
       {&set.rotation_residual_before, &set.rotation_residual_after}) {
    if (has_rotation) {
      AppendCell(turns->col(i).norm() / kDegree, row);
    } else {
      *row += ',';
    }
  }
}

void AppendObservation(const EvaluatedSet& set,
                       const std::vector<JointColumn>& joints, Eigen::Index i,
                       std::string* row) {
  const ObservationLabel* const label =
      set.labels.empty() ? nullptr : &set.labels[i];
  const int pose = label == nullptr ? static_cast<int>(i) : label->pose;
  if (pose >= 0) *row += std::to_string(pose + 1);
  if (label != nullptr) AppendLabel(*label, row);
  AppendJoints(set, joints, pose, row);
  AppendMeasured(set.positions.col(i), row);
  const bool has_length = label == nullptr || label->has_length;
  AppendError(set.residual_before.col(i), has_length, row);
  AppendError(set.residual_after.col(i), has_length, row);
  if (set.rotation_residual_after.cols() > 0) AppendRotations(set, i, row);
  *row += '\n';
}

// Refers to `set`.
TextSource FormatObservations(const EvaluatedSet& set) {
  std::vector<JointColumn> joints = JointColumns(set);
  std::string header = Header(set, joints);
  return MakeRows(
      std::move(header), set.residual_after.cols(),
      [&set, joints = std::move(joints)](std::int64_t i, std::string* row) {
        AppendObservation(set, joints, i, row);
      });
}

// Solver names are identifiers, so that no cell needs quotes.
std::string FormatIterations(const std::vector<SolverRun>& runs) {
  std::string text =
      "solver,iteration,cost,max_error_mm,rms_error_mm,step_norm,accepted,"
      "time_s\n";
  for (const SolverRun& run : runs) {
    for (const IterationRecord& record : run.summary.iterations) {
      AppendCsvCells(&text, run.summary.solver, record.iteration, record.cost,
                     record.max_error / kMillimetre,
                     record.rms_error / kMillimetre, record.step_norm,
                     record.accepted);
      EndCsvRow(&text, record.time_s);
    }
  }
  return text;
}

}  // namespace

std::vector<ReportFile> MakeCsvFiles(const CalibrationResult& result) {
  std::vector<ReportFile> files;
  files.emplace_back("residuals.csv", FormatObservations(result.train));
  if (result.validation) {
    files.emplace_back("validation.csv",
                       FormatObservations(*result.validation));
  }
  files.emplace_back("iterations.csv", FormatIterations(result.runs));
  return files;
}

}  // namespace alidade::internal
