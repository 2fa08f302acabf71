// What planned poses are worth: the tables and figures of docs/planning.md.
//
// Usage: plan_study rv2aj SOURCE_DIRECTORY
//          the reference case beside random poses and the study's plane, all
//          criteria, and times by the number of candidates
//        plan_study real SOURCE_DIRECTORY IMAGE_DIRECTORY ARM
//          calibrations of a real arm from planned and from random poses, as
//          rows of a table; ARM is a job of configs/real_arms and
//          ALIDADE_DATA names the folder of the data

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <numeric>
#include <string>
#include <vector>

#include "alidade/error.h"
#include "alidade/units.h"
#include "bench/study_main.h"
#include "src/common/files.h"
#include "src/common/random.h"
#include "src/dataio/dataset_csv.h"
#include "src/identifiability/analysis.h"
#include "src/identifiability/rules.h"
#include "src/job/run_job.h"
#include "src/kernel/holdout.h"
#include "src/planning/candidates.h"
#include "src/planning/criterion.h"
#include "src/planning/exchange.h"
#include "src/planning/plan_fields.h"
#include "src/report/svg_chart.h"
#include "src/serialization/job_config.h"
#include "src/serialization/plan_file.h"

namespace alidade::internal {
namespace {

constexpr int kThreads = 2;

std::string Number(double value, const char* format = "%.3f") {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

double CpuSeconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

// The RV-2AJ at its flange, by the plan file that is there for it.
class Rv2ajStudy {
 public:
  explicit Rv2ajStudy(const std::string& root)
      : root_(root),
        config_(LoadPlan(root + "/configs/plans/rv2aj_flange.yaml")),
        model_(config_.job.arm) {
    columns_ = FreeColumns(
        AnalyzeIdentifiability(model_, PlannedData(Draw(1000, true, 1)),
                               config_.job.options.identifiability));
    dense_ = RowsOf(Draw(200000, true, 99));
    problem_ = ProblemOf(config_.candidates.count);
  }

  void Print() {
    const int n = config_.design.num_poses;
    const double bound = config_.measurement.sigma *
                         std::sqrt(static_cast<double>(columns_.size()) / n);
    std::cout << "| " << n << " poses | worst over the candidates [mm] | "
              << "above the bound | worst over the joint limits [mm] | "
                 "above the bound | rms over the joint limits [mm] |\n"
                 "|---|---|---|---|---|---|\n";
    const DesignResult plan = Choose(DesignCriterion::kD, problem_, n);
    PrintPlan("planned, D", plan.information, bound);
    PrintPlan("greedy", InformationOf(problem_.candidates, plan.greedy), bound);
    PrintRandom(n, bound);
    const PoseRows plane = RowsOf(LoadJointValues(
        root_ + "/datasets/rv2aj/flange_56.csv", config_.job.arm));
    std::vector<int> all(plane.size());
    std::iota(all.begin(), all.end(), 0);
    PrintPlan("the study's plane", InformationOf(plane, all), bound);
    std::cout << "\n";
    PrintCriteria(n, bound);
    PrintTimes(n);
  }

 private:
  Eigen::MatrixXd Draw(int count, bool faces, std::uint64_t seed) const {
    CandidateOptions options = config_.candidates;
    options.count = count;
    options.limit_faces = faces;
    options.seed = seed;
    return DrawCandidates(config_.job.arm, {}, options).joint_values;
  }

  Dataset PlannedData(const Eigen::MatrixXd& joint_values) const {
    return MakePlannedData(model_, joint_values, config_.measurement);
  }

  PoseRows RowsOf(const Eigen::MatrixXd& joint_values) const {
    return MakePoseRows(model_, model_.NominalValues(),
                        PlannedData(joint_values), columns_);
  }

  DesignProblem ProblemOf(int count) const {
    DesignProblem problem;
    problem.joint_values = Draw(count, true, config_.seed);
    problem.candidates = RowsOf(problem.joint_values);
    const auto p = static_cast<Eigen::Index>(columns_.size());
    problem.known = Eigen::MatrixXd::Zero(p, p);
    PoseMeasurement metres;
    metres.sigma = 1.0;
    problem.region = MakePoseRows(
        model_, model_.NominalValues(),
        MakePlannedData(model_, Draw(1000, true, 7), metres), columns_);
    return problem;
  }

  DesignResult Choose(DesignCriterion criterion, const DesignProblem& problem,
                      int n) const {
    DesignOptions options = config_.design;
    options.criterion = criterion;
    options.num_poses = n;
    options.seed = config_.seed;
    return ChoosePoses(problem, options);
  }

  double WorstOf(const PoseRows& rows, const Eigen::MatrixXd& m) const {
    return config_.measurement.sigma *
           std::sqrt(PredictedVariances(rows, m, kThreads).maxCoeff());
  }

  double RmsOf(const PoseRows& rows, const Eigen::MatrixXd& m) const {
    return config_.measurement.sigma *
           std::sqrt(PredictedVariances(rows, m, kThreads).mean());
  }

  void PrintRow(const std::string& name, double worst, double dense, double rms,
                double bound) const {
    if (worst > kRankTolerance * bound) {
      std::cout << "| " << name << " | determines less than all | | | | |"
                << std::endl;
      return;
    }
    std::cout << "| " << name << " | " << Number(worst / kMillimetre, "%.4f")
              << " | " << Number(100.0 * (worst / bound - 1.0), "%.1f")
              << " % | " << Number(dense / kMillimetre, "%.4f") << " | "
              << Number(100.0 * (dense / bound - 1.0), "%.1f") << " % | "
              << Number(rms / kMillimetre, "%.4f") << " |" << std::endl;
  }

  void PrintPlan(const std::string& name, const Eigen::MatrixXd& information,
                 double bound) const {
    PrintRow(name, WorstOf(problem_.candidates, information),
             WorstOf(dense_, information), RmsOf(dense_, information), bound);
  }

  // Medians of 50 draws, each number its own.
  void PrintRandom(int n, double bound) const {
    std::array<std::vector<double>, 3> values;
    for (int draw = 1; draw <= 50; ++draw) {
      const PoseRows rows = RowsOf(Draw(n, false, 1000 + draw));
      std::vector<int> all(n);
      std::iota(all.begin(), all.end(), 0);
      const Eigen::MatrixXd information = InformationOf(rows, all);
      values[0].push_back(WorstOf(problem_.candidates, information));
      values[1].push_back(WorstOf(dense_, information));
      values[2].push_back(RmsOf(dense_, information));
    }
    for (std::vector<double>& list : values) {
      std::nth_element(list.begin(), list.begin() + 25, list.end());
    }
    PrintRow("random, median of 50 draws", values[0][25], values[1][25],
             values[2][25], bound);
  }

  void PrintCriteria(int n, double bound) const {
    std::cout
        << "| criterion | worst above the bound | rms over the joint "
           "limits [mm] | condition | time [s] |\n|---|---|---|---|---|\n";
    for (const char* name : {"D", "A", "E", "G", "I", "O2", "O4", "O5"}) {
      const double begin = CpuSeconds();
      const DesignResult plan =
          Choose(ValueOf<DesignCriterion>(name), problem_, n);
      const double time = CpuSeconds() - begin;
      const double condition = std::exp(-CriterionValue(
          DesignCriterion::kO2, plan.information, problem_.region));
      std::cout << "| " << name << " | "
                << Number(100.0 *
                              (WorstOf(dense_, plan.information) / bound - 1.0),
                          "%.1f")
                << " % | "
                << Number(RmsOf(dense_, plan.information) / kMillimetre, "%.4f")
                << " | " << Number(condition, "%.1f") << " | "
                << Number(time, "%.2f") << " |" << std::endl;
    }
    std::cout << "\n";
  }

  void PrintTimes(int n) const {
    std::cout << "| candidates | rows [s] | plan [s] | microseconds a "
                 "candidate |\n|---|---|---|---|\n";
    for (const int count : {1000, 3000, 10000, 30000, 100000}) {
      const double begin = CpuSeconds();
      const DesignProblem problem = ProblemOf(count);
      const double rows = CpuSeconds() - begin;
      Choose(DesignCriterion::kD, problem, n);
      const double total = CpuSeconds() - begin;
      std::cout << "| " << count << " | " << Number(rows) << " | "
                << Number(total - rows) << " | "
                << Number(1e6 * total / count, "%.0f") << " |" << std::endl;
    }
  }

  // Times the bound: the poses leave directions to rounding.
  static constexpr double kRankTolerance = 1e4;

  const std::string root_;
  const PlanConfig config_;
  const MeasurementModel model_;
  std::vector<int> columns_;
  PoseRows dense_;
  DesignProblem problem_;
};

// Poses that are measured before anything is planned: they say where base and
// targets are.
constexpr int kFirstPoses = 8;
constexpr std::array<int, 3> kNumbers = {20, 30, 50};
constexpr int kSplits = 5;
constexpr int kDrawsEach = 10;

struct Errors {
  std::vector<double> means;  // of each calibration (mm)

  double Quantile(double fraction) const {
    std::vector<double> sorted = means;
    std::sort(sorted.begin(), sorted.end());
    return sorted[static_cast<std::size_t>(
        std::lround(fraction * static_cast<double>(sorted.size() - 1)))];
  }
};

class RealArmStudy {
 public:
  RealArmStudy(const std::string& root, const std::string& name)
      : name_(name),
        job_(LoadWholeJob(root + "/configs/real_arms/" + name + ".yaml")) {}

  // Half of the configurations are held out, and poses are taken from the
  // other half.
  void Run(LineChart* chart) {
    constexpr std::array<const char*, 3> kNames = {"random", "planned, D",
                                                   "planned, I"};
    std::array<ChartSeries, 6> series;
    for (const int number : kNumbers) {
      const std::array<Errors, 3> errors = ErrorsOf(number);
      PrintRow(number, errors);
      for (std::size_t i = 0; i < series.size(); ++i) {
        const bool is_median = i < 3;
        series[i].label =
            kNames[i % 3] + std::string(is_median ? ", median" : ", p95");
        series[i].x.push_back(number);
        series[i].y.push_back(errors[i % 3].Quantile(is_median ? 0.5 : 0.95));
        series[i].marker = is_median ? MarkerStyle::kDot : MarkerStyle::kSquare;
      }
    }
    chart->series.insert(chart->series.end(), series.begin(), series.end());
  }

 private:
  void PrintRow(int number, const std::array<Errors, 3>& errors) const {
    std::cout << "| `" << name_ << "` | " << number;
    for (const Errors& list : errors) {
      std::cout << " | " << Number(list.Quantile(0.5)) << " | "
                << Number(list.Quantile(0.05)) << " to "
                << Number(list.Quantile(0.95));
    }
    std::cout << " |" << std::endl;
  }

  // Of random poses, of those planned by D, and by I.
  std::array<Errors, 3> ErrorsOf(int number) const {
    std::array<Errors, 3> errors;
    for (int split = 1; split <= kSplits; ++split) {
      const HoldOut parts = HoldOutFraction(job_.data.training, 0.5, split);
      for (int draw = 0; draw < kDrawsEach; ++draw) {
        Calibrate(parts, DrawPoses(parts.train, number, 100 * split + draw),
                  &errors[0]);
      }
      const std::vector<Eigen::Index> first =
          DrawPoses(parts.train, kFirstPoses, split);
      Calibrate(parts, PlanPoses(parts.train, first, number, "D"), &errors[1]);
      Calibrate(parts, PlanPoses(parts.train, first, number, "I"), &errors[2]);
    }
    return errors;
  }

  static std::vector<Eigen::Index> DrawPoses(const Dataset& pool, int count,
                                             std::uint64_t seed) {
    Random random(seed);
    std::vector<Eigen::Index> all(pool.num_poses());
    std::iota(all.begin(), all.end(), 0);
    for (int i = 0; i < count; ++i) {
      const auto left = static_cast<double>(pool.num_poses() - i);
      std::swap(all[i], all[i + static_cast<int>(random.Uniform() * left)]);
    }
    all.resize(count);
    return all;
  }

  // The first poses, and as many more as the plan says.
  std::vector<Eigen::Index> PlanPoses(const Dataset& pool,
                                      std::vector<Eigen::Index> first,
                                      int number,
                                      const std::string& criterion) const {
    PlanConfig config;
    config.title = name_;
    config.job = job_;
    config.job.data.training = SelectPoses(pool, first);
    config.measurement.sigma = 1e-4;
    config.measurement.rotation_sigma = DefaultRotationSigma(1e-4);
    config.measurement.orientation = pool.Has(MeasurementKind::kPose);
    config.measurement.targets.resize(job_.arm.num_targets());
    std::iota(config.measurement.targets.begin(),
              config.measurement.targets.end(), 0);
    config.given_candidates = pool.joint_values.map();
    config.design.criterion = ValueOf<DesignCriterion>(criterion);
    config.design.num_poses = number - static_cast<int>(first.size());
    config.design.allow_repeats = false;
    config.with_curve = false;
    for (Eigen::Index j = 0; j < pool.joint_values.rows(); ++j) {
      config.region.joint_limits.emplace_back(
          pool.joint_values.row(j).minCoeff(),
          pool.joint_values.row(j).maxCoeff());
    }
    config.job.options.num_threads = kThreads;
    const PlanResult outcome = RunPlan(config, "plan_study");
    if (outcome.status != PlanStatus::kDone) {
      throw InputError({name_, 0, 0, ""}, outcome.message);
    }
    const SharedMatrix& planned = outcome.sheet.joint_values;
    for (Eigen::Index k = 0; k < planned.cols(); ++k) {
      for (Eigen::Index i = 0; i < pool.num_poses(); ++i) {
        if (pool.joint_values.col(i) != planned.col(k) ||
            std::count(first.begin(), first.end(), i) > 0) {
          continue;
        }
        first.push_back(i);
        break;
      }
    }
    return first;
  }

  void Calibrate(const HoldOut& parts, const std::vector<Eigen::Index>& poses,
                 Errors* errors) const {
    JobConfig job = job_;
    job.data.training = SelectPoses(parts.train, poses);
    job.data.validation = parts.validation;
    job.options.num_threads = kThreads;
    const CalibrationResult outcome = RunJob(job, "plan_study");
    if (!outcome.validation) return;
    errors->means.push_back(outcome.validation->after.mean / kMillimetre);
  }

  const std::string name_;
  const JobConfig job_;
};

void RunReal(const std::string& root, const std::string& images,
             const std::string& name) {
  LineChart chart;
  chart.title = "Validation error of " + name + " by the number of poses";
  chart.subtitle =
      "mean error on half of the configurations: medians and 95th "
      "percentiles";
  chart.x.label = "poses fitted";
  chart.y.label = "mean error [mm]";
  RealArmStudy(root, name).Run(&chart);
  WriteFileAtomically(images + "/planning_" + name + ".svg", RenderSvg(chart));
}

bool Run(const std::vector<std::string>& arguments) {
  if (arguments.size() == 2 && arguments[0] == "rv2aj") {
    Rv2ajStudy(arguments[1]).Print();
    return true;
  }
  if (arguments.size() == 4 && arguments[0] == "real") {
    RunReal(arguments[1], arguments[2], arguments[3]);
    return true;
  }
  return false;
}

}  // namespace
}  // namespace alidade::internal

int main(int argc, char** argv) {
  return alidade::internal::bench::StudyMain(
      argc, argv,
      "plan_study rv2aj SOURCE_DIRECTORY\n"
      "       plan_study real SOURCE_DIRECTORY IMAGE_DIRECTORY ARM",
      alidade::internal::Run);
}
