// Calibrates the real arms of configs/real_arms with configurations held out,
// by Alidade as the job says and by a plain least-squares fit on the same
// splits: the tables and the figure of docs/real_arms.md.
//
// Usage: real_arms SOURCE_DIRECTORY OUTPUT.svg   (ALIDADE_DATA is set)

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/units.h"
#include "alidade/batch/job.h"
#include "alidade/io/files.h"
#include "alidade/io/job_file.h"
#include "alidade/measurement/holdout.h"
#include "alidade/report/svg_chart.h"

namespace alidade {
namespace {

constexpr int kSeeds = 10;
constexpr double kHeldOut = 0.3;
constexpr int kThreads = 2;
constexpr std::array<int, 4> kFewPoses = {10, 15, 20, 30};

const std::array<const char*, 6> kJobs = {"irb120_smr1", "lifting_column",
                                          "panda_left",  "panda_right",
                                          "panda_top",   "rokae_position"};

Dataset Joined(const Dataset& a, const Dataset& b) {
  Dataset all = a;
  const auto join = [](const auto& left, const auto& right, auto* out) {
    out->resize(left.rows(), left.cols() + right.cols());
    out->leftCols(left.cols()) = left;
    out->rightCols(right.cols()) = right;
  };
  join(a.joint_values, b.joint_values, &all.joint_values);
  join(a.positions, b.positions, &all.positions);
  join(a.sigmas, b.sigmas, &all.sigmas);
  return all;
}

// The same job without priors, outlier treatment or weights.
JobConfig Plain(JobConfig job) {
  job.loss = LossKind::kNone;
  job.identifiability.policy = WeakPolicy::kKeep;
  return job;
}

struct Means {
  int done = 0;
  int rank = 0;
  double before = 0.0;
  double mean = 0.0;
  double median = 0.0;
  double max = 0.0;

  void Add(const JobResult& result) {
    ++done;
    rank = result.identifiability.num_free;
    before += result.heldout->before.mean;
    mean += result.heldout->after.mean;
    median += result.heldout->after.median;
    max += result.heldout->after.max;
  }
};

// The job on splits that leave `share` of the configurations out.
Means OverSeeds(JobConfig job, const Dataset& all, double share) {
  Means means;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    HoldOut split = HoldOutFraction(all, share, seed);
    job.data = std::move(split.train);
    job.validation = std::move(split.heldout);
    const JobOutcome outcome = RunJob(job, "real_arms", kThreads);
    if (outcome.result.heldout) means.Add(outcome.result);
  }
  if (means.done > 0) {
    for (double* value :
         {&means.before, &means.mean, &means.median, &means.max}) {
      *value /= means.done * kMillimetre;
    }
  }
  return means;
}

struct RealArm {
  std::string name;
  JobConfig job;
  Dataset all;
};

RealArm Load(const std::string& root, const std::string& name) {
  RealArm arm{name, LoadJob(root + "/configs/real_arms/" + name + ".yaml"), {}};
  arm.all = Joined(arm.job.data, *arm.job.validation);
  return arm;
}

void PrintAccuracy(const RealArm& arm) {
  const Means plain = OverSeeds(Plain(arm.job), arm.all, kHeldOut);
  const Means ours = OverSeeds(arm.job, arm.all, kHeldOut);
  std::printf("%-15s %5d %5d %8.3f %8.3f %8.3f %8.3f %8.3f %8.3f\n",
              arm.name.c_str(), static_cast<int>(arm.all.num_poses()),
              ours.rank, ours.before, plain.mean, plain.median, ours.mean,
              ours.median, ours.max);
  std::fflush(stdout);
}

std::string Cell(const Means& means) {
  if (means.done < kSeeds) {
    return std::to_string(means.done) + "/" + std::to_string(kSeeds) + " done";
  }
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.3f", means.mean);
  return text.data();
}

// The error on all other configurations where only so many are fitted.
void PrintFewPoses(const RealArm& arm, LineChart* chart) {
  ChartSeries with_priors{arm.name, {}, {}, true, MarkerStyle::kDot};
  for (const int poses : kFewPoses) {
    const double share = 1.0 - static_cast<double>(poses) /
                                   static_cast<double>(arm.all.num_poses());
    if (share <= 0.05) continue;
    const Means ours = OverSeeds(arm.job, arm.all, share);
    const Means plain = OverSeeds(Plain(arm.job), arm.all, share);
    std::printf("%-15s %5d %8.3f %10s %12s\n", arm.name.c_str(), poses,
                ours.before, Cell(ours).c_str(), Cell(plain).c_str());
    std::fflush(stdout);
    if (ours.done == 0) continue;
    with_priors.x.push_back(poses);
    with_priors.y.push_back(ours.mean / ours.before);
  }
  chart->series.push_back(std::move(with_priors));
}

int Run(const std::string& root, const std::string& figure) {
  std::vector<RealArm> arms;
  for (const char* name : kJobs) arms.push_back(Load(root, name));
  std::printf(
      "Held-out position error [mm], means over %d splits (30 %% of the "
      "configurations held out, seeds 0 to %d)\n\n"
      "%-15s %5s %5s %8s %8s %8s %8s %8s %8s\n"
      "%-15s %5s %5s %8s %8s %8s %8s %8s %8s\n",
      kSeeds, kSeeds - 1, "", "", "", "before", "plain", "plain", "Alidade",
      "Alidade", "Alidade", "set", "N", "free", "mean", "mean", "median",
      "mean", "median", "max");
  for (const RealArm& arm : arms) PrintAccuracy(arm);
  std::printf(
      "\nFew poses: mean held-out error [mm] over %d draws\n\n"
      "%-15s %5s %8s %10s %12s\n",
      kSeeds, "set", "poses", "before", "priors", "no priors");
  LineChart chart;
  chart.title = "Calibration from few poses";
  chart.subtitle =
      "error on all other poses, priors of 5 mrad and 1 mm, mean "
      "of 10 draws";
  chart.x.label = "poses fitted";
  chart.y.label = "mean error after / before";
  chart.references.push_back({1.0, "not calibrated"});
  for (const RealArm& arm : arms) PrintFewPoses(arm, &chart);
  WriteFileAtomically(figure, RenderSvg(chart));
  return EXIT_SUCCESS;
}

}  // namespace
}  // namespace alidade

int main(int argc, char** argv) {
  if (argc != 3 || std::getenv("ALIDADE_DATA") == nullptr) {
    std::fprintf(stderr,
                 "usage: ALIDADE_DATA=DIR real_arms SOURCE_DIRECTORY "
                 "OUTPUT.svg\n");
    return 2;
  }
  try {
    return alidade::Run(argv[1], argv[2]);
  } catch (const alidade::InputError& error) {
    std::fprintf(stderr, "real_arms: %s\n", error.what());
    return 2;
  }
}
