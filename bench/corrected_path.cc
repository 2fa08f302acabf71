// The error of a simulated RV-2AJ along a straight path: as programmed, and as
// corrected after a calibration from 56 positions measured with 0.02 mm.
//
// Usage: corrected_path SOURCE_DIRECTORY IMAGE.svg

#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "alidade/correction.h"
#include "alidade/error.h"
#include "alidade/forward_kinematics.h"
#include "alidade/inverse_kinematics.h"
#include "alidade/units.h"
#include "bench/study_main.h"
#include "src/common/files.h"
#include "src/common/format.h"
#include "src/common/random.h"
#include "src/job/run_job.h"
#include "src/report/svg_chart.h"
#include "src/serialization/job_config.h"
#include "tests/support/rv2aj_arms.h"

namespace alidade::internal::bench {
namespace {

constexpr double kNoise = 0.02 * kMillimetre;
constexpr int kPoints = 201;
constexpr double kHalfLength = 0.2;  // m

Arm Calibrated(const std::string& root) {
  JobConfig job = LoadWholeJob(root + "/configs/jobs/rv2aj_flange.yaml");
  ObservationBlock& block = job.data.training.blocks.front();
  Eigen::MatrixXd measured = block.measured.map();
  Random random(1);
  for (double& entry : measured.reshaped()) entry += kNoise * random.Normal();
  block.measured = std::move(measured);
  // As Alidade does it by itself: the study's rules trust such data too much.
  job.options.identifiability = {};
  job.options.true_values.reset();
  return RunJob(std::move(job), "corrected_path").arm;
}

// Joint values of the nominal arm, its flange down, along the path.
Eigen::MatrixXd Programmed(const Arm& nominal) {
  Eigen::MatrixXd joints(nominal.num_joints(), kPoints);
  Eigen::VectorXd start(5);
  start << 0.0, 40.0, 80.0, 40.0, 0.0;
  start *= kDegree;
  for (int i = 0; i < kPoints; ++i) {
    PointingTask task;
    task.position = {0.3, kHalfLength * (2.0 * i / (kPoints - 1) - 1.0), 0.215};
    task.direction = -Eigen::Vector3d::UnitZ();
    const auto found = SolveInverseKinematics(nominal, task, start);
    if (!found) throw InputError({}, "a point of the path is out of reach");
    joints.col(i) = start = *found;
  }
  return joints;
}

ChartSeries Errors(const std::string& label, const Arm& real,
                   const Eigen::MatrixXd& joints, const Correction& asked) {
  ChartSeries series;
  double sum = 0.0;
  for (int i = 0; i < kPoints; ++i) {
    const double error = (TargetPose(real, joints.col(i)).translation() -
                          asked.targets[i].translation())
                             .norm();
    series.x.push_back(2.0 * kHalfLength * i / (kPoints - 1) / kMillimetre);
    series.y.push_back(error / kMillimetre);
    sum += error / kMillimetre;
  }
  series.label =
      label + ": " + FormatSignificant(sum / kPoints, 2) + " mm in the mean";
  std::printf("%s\n", series.label.c_str());
  return series;
}

bool Run(const std::vector<std::string>& arguments) {
  if (arguments.size() != 2) return false;
  const Arm nominal = testing::Rv2ajFlange();
  const Arm real = testing::WithRv2ajDeviations(nominal);
  const CorrectionArms arms =
      MakeCorrectionArms(nominal, Calibrated(arguments[0]));
  const Correction correction = CorrectJoints(arms, Programmed(nominal));
  LineChart chart;
  chart.title = "RV-2AJ along a straight path";
  chart.subtitle =
      "calibrated from 56 positions measured with 0.02 mm (simulated)";
  chart.x.label = "way along the path [mm]";
  chart.y.label = "error of the real arm [mm]";
  chart.y.logarithmic = true;
  chart.series = {
      Errors("as programmed", real, correction.asked_motors, correction),
      Errors("corrected", real, correction.motors, correction)};
  WriteFileAtomically(arguments[1], RenderSvg(chart));
  return true;
}

}  // namespace
}  // namespace alidade::internal::bench

int main(int argc, char** argv) {
  return alidade::internal::bench::StudyMain(
      argc, argv, "corrected_path SOURCE_DIRECTORY IMAGE.svg",
      alidade::internal::bench::Run);
}
