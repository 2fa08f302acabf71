// Time of the identifiability analysis: the RV-2AJ study's 56 poses, and a
// six-axis arm with base and tool (42 candidates) at up to 100 000 poses.
// Medians of several runs on one thread. Run by scripts/identify_speed.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include "alidade/units.h"
#include "bench/study_main.h"
#include "src/identifiability/analysis.h"
#include "src/model/joint_draw.h"
#include "src/serialization/job_config.h"

namespace alidade::internal {
namespace {

double MedianTime(const MeasurementModel& model, const Dataset& data,
                  const IdentifiabilityOptions& options, int runs) {
  std::vector<double> seconds;
  for (int run = 0; run < runs; ++run) {
    const auto start = std::chrono::steady_clock::now();
    const IdentifiabilityResult result =
        AnalyzeIdentifiability(model, data, options);
    seconds.push_back(
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start)
            .count());
    if (result.num_free == 0) std::printf("nothing free\n");
  }
  std::sort(seconds.begin(), seconds.end());
  return seconds[seconds.size() / 2];
}

void Print(const std::string& what, const Dataset& data, double seconds) {
  std::printf("%-32s %8ld poses %10.2f ms\n", what.c_str(),
              static_cast<long>(data.num_poses()), 1e3 * seconds);
}

Arm SixAxes() {
  Arm arm;
  arm.joints.resize(6);
  const double alpha_deg[] = {0, 90, 0, 0, 90, -90};
  const double d_mm[] = {0, 0, -612, -572.3, 0, 0};
  const double r_mm[] = {127.3, 0, 0, 163.9, 115.7, 92.2};
  for (int j = 0; j < 6; ++j) {
    arm.joints[j].alpha = alpha_deg[j] * kDegree;
    arm.joints[j].d = d_mm[j] * kMillimetre;
    arm.joints[j].r = r_mm[j] * kMillimetre;
  }
  arm.last_from_target().translation() =
      Eigen::Vector3d(10.0, 20.0, 130.0) * kMillimetre;
  return arm;
}

Dataset RandomData(const Arm& arm, int poses) {
  const MeasurementModel model(arm);
  Dataset data;
  data.joint_values = DrawJointValues(arm, poses, 1);
  data.positions() = model.Predict(model.NominalValues(), data.joint_values);
  data.sigmas() = Eigen::Matrix3Xd::Constant(3, poses, 0.05 * kMillimetre);
  return data;
}

bool Run(const std::vector<std::string>& arguments) {
  if (arguments.size() != 1) return false;
  const std::string& root = arguments[0];
  for (const char* name : {"rv2aj_study", "rv2aj_noise"}) {
    const JobConfig job = LoadJob(root + "/configs/jobs/" + name + ".yaml");
    Print(std::string(name) + ", 25 candidates", job.data.training,
          MedianTime(MeasurementModel(job.arm), job.data.training,
                     job.options.identifiability, 21));
  }
  IdentifiabilityOptions options;
  options.candidates = {true, true, true};
  const Arm arm = SixAxes();
  for (const int poses : {56, 1000, 10000, 100000}) {
    const Dataset data = RandomData(arm, poses);
    Print("six axes, 42 candidates", data,
          MedianTime(MeasurementModel(arm), data, options, 5));
  }
  return true;
}

}  // namespace
}  // namespace alidade::internal

int main(int argc, char** argv) {
  return alidade::internal::bench::StudyMain(
      argc, argv, "identify_speed SOURCE_DIRECTORY", alidade::internal::Run);
}
