// Calibrates the real arms of configs/real_arms with configurations held out:
// the tables and figures of docs/real_arms.md.
//
// Usage: real_arms splits SOURCE_DIRECTORY DIRECTORY
//          writes the validation rows of every set and split, for a fit by
//          another program (plain_fit.py)
//        real_arms report SOURCE_DIRECTORY PLAIN.csv IMAGE_DIRECTORY
//          prints the tables, with the other program's results beside ours
//        real_arms errors SOURCE_DIRECTORY [SET...]
//        real_arms few SOURCE_DIRECTORY [SET...]
//        real_arms transfer SOURCE_DIRECTORY
//          print what error terms bring: at 30 % of the poses, from few poses,
//          from one series of an arm to another (docs/error_terms.md)
// ALIDADE_DATA names the folder of the data.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "alidade/error.h"
#include "alidade/units.h"
#include "bench/study_main.h"
#include "src/common/files.h"
#include "src/error_terms/folds.h"
#include "src/job/run_job.h"
#include "src/kernel/holdout.h"
#include "src/report/svg_chart.h"
#include "src/serialization/job_config.h"

namespace alidade::internal {
namespace {

constexpr int kSeeds = 10;  // 1 to 10
constexpr double kValidation = 0.3;
constexpr int kThreads = 2;
constexpr std::array<int, 4> kFewPoses = {10, 15, 20, 30};

const std::vector<std::string>& JobNames() {
  static const auto* const names = new std::vector<std::string>{
      "ur10_A",         "ur10_B",         "irb120",         "irb120_smr1",
      "panda_left",     "panda_right",    "panda_top",      "rokae",
      "rokae_position", "socket_panda_1", "socket_panda_2", "socket_panda_6",
      "column",         "drawwire"};
  return *names;
}

// Of how few poses these can be calibrated is asked too.
const std::vector<std::string>& FewPosesNames() {
  static const auto* const names = new std::vector<std::string>{
      "ur10_B",    "irb120", "panda_left", "panda_right",
      "panda_top", "rokae",  "column"};
  return *names;
}

struct RealArm {
  std::string name;
  JobConfig job;  // data: all poses, none held out
};

RealArm Load(const std::string& root, const std::string& name) {
  return {name, LoadWholeJob(root + "/configs/real_arms/" + name + ".yaml")};
}

std::vector<std::uint64_t> Seeds() {
  std::vector<std::uint64_t> seeds;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) seeds.push_back(seed);
  return seeds;
}

// Rows are counted from 0 after the header, which is the first line.
void WriteSplits(const RealArm& arm, const std::string& directory) {
  for (const std::uint64_t seed : Seeds()) {
    const HoldOut split =
        HoldOutFraction(arm.job.data.training, kValidation, seed);
    std::string text;
    const PoseSources& sources = split.validation.sources;
    for (std::size_t pose = 0; pose < sources.size(); ++pose) {
      text += std::to_string(sources[pose].line - 2) + "\n";
    }
    WriteFileAtomically(
        directory + "/" + arm.name + "_" + std::to_string(seed) + ".txt", text);
  }
}

// Means over splits (mm, deg).
struct Means {
  int done = 0;
  int worse_than_before = 0;
  int warned = 0;  // that the priors cost accuracy
  int rank = 0;
  double before = 0.0;
  double mean = 0.0;
  double median = 0.0;
  double max = 0.0;
  double rotation = 0.0;

  void Add(const CalibrationResult& result) {
    const EvaluatedSet& validation = *result.validation;
    ++done;
    rank = result.identifiability.num_free;
    if (validation.after.mean > validation.before.mean) ++worse_than_before;
    for (const std::string& warning : result.warnings) {
      if (warning.find(" mrad pull") != std::string::npos) ++warned;
    }
    before += validation.before.mean / kMillimetre;
    mean += validation.after.mean / kMillimetre;
    median += validation.after.median / kMillimetre;
    max += validation.after.max / kMillimetre;
    rotation += validation.rotation_after.mean / kDegree;
  }

  void Divide() {
    for (double* sum : {&before, &mean, &median, &max, &rotation}) {
      *sum /= std::max(done, 1);
    }
  }
};

// The job on splits that leave `share` of the configurations out.
Means OverSeeds(const RealArm& arm, const JobConfig& options, double share) {
  Means means;
  JobConfig job = options;
  for (const std::uint64_t seed : Seeds()) {
    HoldOut split = HoldOutFraction(arm.job.data.training, share, seed);
    job.data.training = std::move(split.train);
    job.data.validation = std::move(split.validation);
    job.options.num_threads = kThreads;
    const CalibrationResult outcome = RunJob(job, "real_arms");
    if (outcome.validation) means.Add(outcome);
  }
  means.Divide();
  return means;
}

// What plain_fit.py wrote, means over its splits by set.
struct PlainFit {
  int done = 0;
  double before = 0.0;
  double mean = 0.0;
  double median = 0.0;
  double max = 0.0;
};

std::map<std::string, PlainFit> ReadPlainFits(const std::string& path) {
  std::istringstream lines(ReadFile(path));
  std::string line;
  std::getline(lines, line);
  std::map<std::string, PlainFit> fits;
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    std::vector<std::string> row;
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(cell);
    PlainFit& fit = fits[row.at(0)];
    ++fit.done;
    fit.before += std::stod(row.at(4));
    fit.mean += std::stod(row.at(6));
    fit.median += std::stod(row.at(8));
    fit.max += std::stod(row.at(9));
  }
  for (auto& [name, fit] : fits) {
    for (double* sum : {&fit.before, &fit.mean, &fit.median, &fit.max}) {
      *sum /= fit.done;
    }
  }
  return fits;
}

std::string Number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3f", value);
  return text.data();
}

JobConfig WithEstimatedPriors(JobConfig job) {
  job.options.prior_scale = PriorScale::kEstimated;
  return job;
}

void PrintAccuracy(const RealArm& arm, const PlainFit& plain) {
  const Means ours = OverSeeds(arm, arm.job, kValidation);
  const Means estimated =
      OverSeeds(arm, WithEstimatedPriors(arm.job), kValidation);
  const std::string rotation =
      ours.rotation > 0.0 ? Number(ours.rotation) : "-";
  std::cout << "| `" << arm.name << "` | " << arm.job.data.training.num_poses()
            << " | " << ours.rank << " | " << Number(ours.before) << " | "
            << Number(plain.mean) << " | " << Number(ours.mean) << " | "
            << Number(estimated.mean) << " | " << ours.warned << " | "
            << Number(plain.median) << " | " << Number(ours.median) << " | "
            << Number(plain.max) << " | " << Number(ours.max) << " | "
            << rotation << " |" << std::endl;
}

std::string Cell(const Means& means) {
  if (means.done == 0) return "refused";
  std::string text = Number(means.mean);
  if (means.done < kSeeds) {
    text += " (" + std::to_string(means.done) + " of " +
            std::to_string(kSeeds) + ")";
  }
  return text;
}

JobConfig WithoutPriors(JobConfig job) {
  job.options.identifiability.policy = WeakPolicy::kKeep;
  return job;
}

ChartSeries SeriesOf(const RealArm& arm) {
  ChartSeries series;
  series.label = arm.name;
  series.marker = MarkerStyle::kDot;
  return series;
}

// `before`: the mean error of the arm that is not calibrated (mm).
void AddPoint(int poses, const Means& means, double before,
              ChartSeries* series) {
  if (means.done == 0) return;
  series->x.push_back(poses);
  series->y.push_back(means.mean / before);
}

// The error on all other configurations where only so many are fitted.
void PrintFewPoses(const RealArm& arm, LineChart* with_priors,
                   LineChart* without) {
  ChartSeries with_series = SeriesOf(arm);
  ChartSeries without_series = SeriesOf(arm);
  for (const int poses : kFewPoses) {
    const double share =
        1.0 - static_cast<double>(poses) /
                  static_cast<double>(arm.job.data.training.num_poses());
    if (share <= 0.05) continue;
    const Means ours = OverSeeds(arm, arm.job, share);
    const Means estimated = OverSeeds(arm, WithEstimatedPriors(arm.job), share);
    const Means keep = OverSeeds(arm, WithoutPriors(arm.job), share);
    std::cout << "| `" << arm.name << "` | " << poses << " | "
              << Number(ours.before) << " | " << Cell(ours) << " | "
              << ours.worse_than_before << " | " << ours.warned << " | "
              << Cell(estimated) << " | " << Cell(keep) << " | "
              << keep.worse_than_before << " |" << std::endl;
    AddPoint(poses, ours, ours.before, &with_series);
    AddPoint(poses, keep, ours.before, &without_series);
  }
  with_priors->series.push_back(std::move(with_series));
  without->series.push_back(std::move(without_series));
}

LineChart FewPosesChart(const std::string& priors) {
  LineChart chart;
  chart.title = "Calibration from few poses, " + priors;
  chart.subtitle = "error on all other poses, means of 10 draws";
  chart.x.label = "poses fitted";
  chart.y.label = "mean error after / before";
  chart.y.logarithmic = true;
  chart.references.push_back({1.0, "not calibrated"});
  return chart;
}

void Report(const std::string& root, const std::string& plain_path,
            const std::string& images) {
  std::map<std::string, PlainFit> plain = ReadPlainFits(plain_path);
  std::cout << "| set | N | free | before | plain, mean | Alidade, mean | "
               "estimated priors, mean | warned | "
               "plain, median | Alidade, median | plain, max | Alidade, max | "
               "Alidade, orientation [deg] |\n"
               "|---|---|---|---|---|---|---|---|---|---|---|---|---|"
            << std::endl;
  for (const std::string& name : JobNames()) {
    PrintAccuracy(Load(root, name), plain[name]);
  }
  std::cout << "\n| set | poses | before | with priors | worse than before | "
               "warned | estimated priors | without | worse than before |\n"
               "|---|---|---|---|---|---|---|---|---|"
            << std::endl;
  LineChart with_priors = FewPosesChart("priors of 5 mrad and 1 mm");
  LineChart without = FewPosesChart("no priors");
  for (const std::string& name : FewPosesNames()) {
    PrintFewPoses(Load(root, name), &with_priors, &without);
  }
  WriteFileAtomically(images + "/real_arms_few_poses.svg",
                      RenderSvg(with_priors));
  WriteFileAtomically(images + "/real_arms_few_poses_no_priors.svg",
                      RenderSvg(without));
}

// Of one set with error terms, over splits of one kind; of which the geometry
// alone, as the first rung has it.
struct ErrorMeans {
  int done = 0;
  double geometry = 0.0;
  double geometry_max = 0.0;
  double geometry_rotation = 0.0;
  double mean = 0.0;
  double max = 0.0;
  double rotation = 0.0;
  double share = 0.0;
  double predicted = 0.0;  // over observed, RMS of positions

  void Add(const CalibrationResult& result) {
    ++done;
    if (result.error_terms->rungs.empty()) {
      --done;
      return;
    }
    const ErrorRung& first = result.error_terms->rungs.front();
    geometry += first.validation.mean / kMillimetre;
    geometry_max += first.validation.max / kMillimetre;
    geometry_rotation += first.validation_rotation.mean / kDegree;
    mean += result.validation->after.mean / kMillimetre;
    max += result.validation->after.max / kMillimetre;
    rotation += result.validation->rotation_after.mean / kDegree;
    share += result.error_terms->share;
    predicted += 1.0 / result.uncertainty->validation->rms_z;
  }
  void Divide() {
    for (double* sum : {&geometry, &geometry_max, &geometry_rotation, &mean,
                        &max, &rotation, &share, &predicted}) {
      *sum /= std::max(done, 1);
    }
  }
};

// Of orientations, which not all sets have.
std::string NumberOrDash(double value) {
  return value > 0.0 ? Number(value) : "-";
}

enum class SplitKind { kRandom, kRegion };

ErrorMeans WithErrors(const RealArm& arm, SplitKind kind, int count,
                      double share = kValidation) {
  ErrorMeans means;
  JobConfig job = arm.job;
  job.options.errors.selection = ErrorTermSelection::kAuto;
  job.options.num_threads = kThreads;
  const Dataset& all = arm.job.data.training;
  for (int seed = 1; seed <= count; ++seed) {
    HoldOut split = kind == SplitKind::kRandom
                        ? HoldOutFraction(all, share, seed)
                        : HoldOutPoses(all, RegionOf(all, share, seed));
    job.data.training = std::move(split.train);
    job.data.validation = std::move(split.validation);
    const CalibrationResult result = RunJob(job, "real_arms");
    if (result.validation) means.Add(result);
  }
  means.Divide();
  return means;
}

void PrintErrorTerms(const RealArm& arm) {
  constexpr int kRegions = 5;
  const auto print = [&](const char* kind, const ErrorMeans& means) {
    std::cout << "| `" << arm.name << "` | " << kind << " | "
              << Number(means.geometry) << " | " << Number(means.mean) << " | "
              << Number(means.mean / means.geometry) << " | "
              << Number(means.geometry_max) << " | " << Number(means.max)
              << " | " << NumberOrDash(means.geometry_rotation) << " | "
              << NumberOrDash(means.rotation) << " | " << Number(means.share)
              << " | " << Number(means.predicted) << " |" << std::endl;
  };
  print("random", WithErrors(arm, SplitKind::kRandom, kSeeds));
  print("region", WithErrors(arm, SplitKind::kRegion, kRegions));
}

// The same where only so many poses are fitted.
void ReportFewPoses(const std::string& root,
                    const std::vector<std::string>& names) {
  constexpr std::array<int, 6> kPoses = {10, 12, 15, 20, 30, 50};
  std::cout << "| set | poses | geometry, mean | error terms, mean | ratio | "
               "share |\n|---|---|---|---|---|---|"
            << std::endl;
  for (const std::string& name : names) {
    const RealArm arm = Load(root, name);
    for (const int poses : kPoses) {
      const double share =
          1.0 - static_cast<double>(poses) /
                    static_cast<double>(arm.job.data.training.num_poses());
      if (share <= 0.05) continue;
      const ErrorMeans means =
          WithErrors(arm, SplitKind::kRandom, kSeeds, share);
      std::cout << "| `" << name << "` | " << poses << " | "
                << Number(means.geometry) << " | " << Number(means.mean)
                << " | " << Number(means.mean / means.geometry) << " | "
                << Number(means.share) << " |" << std::endl;
    }
  }
}

// Mean error over all poses of one series with the arm of another, of which
// only base and tool are fitted again (mm).
double ErrorOn(const RealArm& other, const Arm& arm) {
  JobConfig job = other.job;
  job.arm = arm;
  job.options.errors.selection = ErrorTermSelection::kNone;
  job.options.identifiability.candidates.joints = false;
  job.options.num_threads = kThreads;
  return RunJob(job, "real_arms").train.after.mean / kMillimetre;
}

void ReportTransfer(const std::string& root) {
  std::cout << "| calibrated on | frames refitted on | geometry | "
               "with error terms |\n|---|---|---|---|"
            << std::endl;
  const std::array<RealArm, 2> series = {Load(root, "ur10_A"),
                                         Load(root, "ur10_B")};
  for (const int first : {0, 1}) {
    std::array<double, 2> errors{};
    for (const bool with_terms : {false, true}) {
      JobConfig job = series[first].job;
      job.options.num_threads = kThreads;
      job.options.errors.selection =
          with_terms ? ErrorTermSelection::kAuto : ErrorTermSelection::kNone;
      errors[with_terms ? 1 : 0] =
          ErrorOn(series[1 - first], RunJob(job, "real_arms").arm);
    }
    std::cout << "| `" << series[first].name << "` | `"
              << series[1 - first].name << "` | " << Number(errors[0]) << " | "
              << Number(errors[1]) << " |" << std::endl;
  }
}

void ReportErrorTerms(const std::string& root,
                      const std::vector<std::string>& names) {
  std::cout << "| set | left out | geometry, mean | error terms, mean | ratio "
               "| geometry, max | error terms, max | geometry, orientation "
               "[deg] | error terms, orientation [deg] | share | predicted / "
               "observed |\n|---|---|---|---|---|---|---|---|---|---|---|"
            << std::endl;
  for (const std::string& name : names) PrintErrorTerms(Load(root, name));
}

void Splits(const std::string& root, const std::string& directory) {
  for (const std::string& name : JobNames()) {
    WriteSplits(Load(root, name), directory);
  }
}

bool Run(const std::vector<std::string>& arguments) {
  if (arguments.size() == 3 && arguments[0] == "splits") {
    Splits(arguments[1], arguments[2]);
    return true;
  }
  if (arguments.size() == 4 && arguments[0] == "report") {
    Report(arguments[1], arguments[2], arguments[3]);
    return true;
  }
  if (arguments.size() >= 2 && arguments[0] == "errors") {
    std::vector<std::string> names(arguments.begin() + 2, arguments.end());
    ReportErrorTerms(arguments[1], names.empty() ? JobNames() : names);
    return true;
  }
  if (arguments.size() == 2 && arguments[0] == "transfer") {
    ReportTransfer(arguments[1]);
    return true;
  }
  if (arguments.size() >= 2 && arguments[0] == "few") {
    std::vector<std::string> names(arguments.begin() + 2, arguments.end());
    ReportFewPoses(arguments[1], names.empty() ? FewPosesNames() : names);
    return true;
  }
  return false;
}

}  // namespace
}  // namespace alidade::internal

int main(int argc, char** argv) {
  return alidade::internal::bench::StudyMain(
      argc, argv,
      "real_arms splits SOURCE_DIRECTORY DIRECTORY\n"
      "       real_arms report SOURCE_DIRECTORY PLAIN.csv IMAGE_DIRECTORY\n"
      "       real_arms errors SOURCE_DIRECTORY [SET...]\n"
      "       real_arms few SOURCE_DIRECTORY [SET...]\n"
      "       real_arms transfer SOURCE_DIRECTORY",
      alidade::internal::Run);
}
