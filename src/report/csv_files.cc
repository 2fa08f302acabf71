#include <string>
#include <vector>

#include "alidade/report/report.h"
#include "src/report/text.h"

namespace alidade {
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

std::string Millimetres(double metres) {
  return ShortestNumber(metres / kMillimetre);
}

std::string VectorCells(const Eigen::Vector3d& metres) {
  std::string cells;
  for (const double coordinate : metres) {
    cells += "," + Millimetres(coordinate);
  }
  return cells;
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

std::string JointCells(const EvaluatedSet& set,
                       const std::vector<JointColumn>& joints, int pose) {
  std::string text;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    text += ",";
    if (pose < 0) continue;
    const double value = set.joint_values(static_cast<Eigen::Index>(j), pose);
    text += ShortestNumber(value / joints[j].unit);
  }
  return text;
}

std::string MeasuredCells(const Eigen::Vector3d& position) {
  if (!position.allFinite()) return ",,,";
  return VectorCells(position);
}

std::string ErrorCells(const Eigen::Vector3d& error, bool is_measured) {
  if (!is_measured) return ",,,,";
  return VectorCells(error) + "," + Millimetres(error.norm());
}

std::string FormatObservations(const EvaluatedSet& set) {
  const std::vector<JointColumn> joints = JointColumns(set);
  std::string text = Header(set, joints);
  for (Eigen::Index i = 0; i < set.residual_after.cols(); ++i) {
    int pose = static_cast<int>(i);
    std::string label;
    if (!set.labels.empty()) {
      const ObservationLabel& mine = set.labels[i];
      pose = mine.pose;
      label = "," + mine.kind + "," + TextCell(mine.target) + "," +
              TextCell(mine.where);
    }
    if (pose >= 0) text += std::to_string(pose + 1);
    text += label + JointCells(set, joints, pose);
    text += MeasuredCells(set.positions.col(i));
    const bool has_length = set.labels.empty() || set.labels[i].has_length;
    text += ErrorCells(set.residual_before.col(i), has_length);
    text += ErrorCells(set.residual_after.col(i), has_length);
    if (set.rotation_residual_after.cols() > 0) {
      const bool has_rotation =
          !set.labels.empty() && set.labels[i].has_rotation;
      for (const LargeMatrix* turns :
           {&set.rotation_residual_before, &set.rotation_residual_after}) {
        text += ",";
        if (has_rotation)
          text += ShortestNumber(turns->col(i).norm() / kDegree);
      }
    }
    text += "\n";
  }
  return text;
}

// Solver names are identifiers, so that no cell needs quotes.
std::string FormatIterations(const std::vector<SolverRun>& runs) {
  std::string text =
      "solver,iteration,cost,max_error_mm,rms_error_mm,step_norm,accepted,"
      "time_s\n";
  for (const SolverRun& run : runs) {
    for (const IterationRecord& record : run.summary.iterations) {
      text += run.summary.solver + "," + std::to_string(record.iteration) +
              "," + ShortestNumber(record.cost) + "," +
              Millimetres(record.max_error) + "," +
              Millimetres(record.rms_error) + "," +
              ShortestNumber(record.step_norm) + "," +
              (record.accepted ? "true" : "false") + "," +
              ShortestNumber(record.time_s) + "\n";
    }
  }
  return text;
}

}  // namespace

std::vector<ReportFile> MakeCsvFiles(const JobResult& result) {
  std::vector<ReportFile> files;
  files.push_back({"residuals.csv", FormatObservations(result.train)});
  if (result.heldout) {
    files.push_back({"heldout.csv", FormatObservations(*result.heldout)});
  }
  files.push_back({"iterations.csv", FormatIterations(result.runs)});
  return files;
}

}  // namespace alidade
