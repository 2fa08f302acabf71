// Whether parameters from different series of the same real arm agree within
// their intervals: the table of docs/real_arms.md.
//
// Usage: series_agreement SOURCE_DIRECTORY
// ALIDADE_DATA names the folder of the data.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <string>
#include <vector>

#include "alidade/parameter_layout.h"
#include "bench/study_main.h"
#include "src/job/run_job.h"
#include "src/kernel/holdout.h"
#include "src/serialization/job_config.h"

namespace alidade::internal {
namespace {

constexpr double kWithin = 1.959964;

// Differences of the geometry of two fits in their standard deviations: the
// usual ones, those with what the model lacks, the sandwich.
struct Differences {
  std::array<std::vector<double>, 3> z;

  void Add(const CalibrationResult& a, const CalibrationResult& b) {
    // Of parameters that the prior decides a difference says nothing.
    constexpr double kOfData = 0.5;
    const ParameterLayout layout(a.arm);
    for (std::size_t i = 0; i < a.uncertainty->parameters.size(); ++i) {
      const ParameterUncertainty& mine = a.uncertainty->parameters[i];
      const auto column = layout.Find(mine.name);
      if (!column ||
          !ParameterLayout::IsJointKind(layout.parameter(*column).kind)) {
        continue;
      }
      for (std::size_t k = 0; k < b.uncertainty->parameters.size(); ++k) {
        const ParameterUncertainty& other = b.uncertainty->parameters[k];
        if (other.name != mine.name || mine.prior_share > kOfData ||
            other.prior_share > kOfData) {
          continue;
        }
        const double difference =
            a.Parameter(mine.name).value - b.Parameter(mine.name).value;
        const std::array<double, 3> of_mine = Deviations(*a.uncertainty, i);
        const std::array<double, 3> of_other = Deviations(*b.uncertainty, k);
        for (std::size_t way = 0; way < z.size(); ++way) {
          z[way].push_back(std::abs(difference) /
                           std::hypot(of_mine[way], of_other[way]));
        }
      }
    }
  }

  static std::array<double, 3> Deviations(const UncertaintyResult& of,
                                          std::size_t i) {
    const auto k = static_cast<Eigen::Index>(i);
    const bool has_lack = of.prediction_covariance.size() > 0;
    return {of.parameters[i].std,
            has_lack ? std::sqrt(of.prediction_covariance(k, k))
                     : of.parameters[i].std,
            of.parameters[i].robust_std};
  }

  std::string Cell(std::size_t way) const {
    std::vector<double> sorted = z[way];
    std::sort(sorted.begin(), sorted.end());
    const auto within = std::count_if(sorted.begin(), sorted.end(),
                                      [](double x) { return x <= kWithin; });
    std::array<char, 64> text{};
    std::snprintf(
        text.data(), text.size(), "%.0f %% (%.2f)",
        100.0 * static_cast<double>(within) /
            static_cast<double>(std::max<std::size_t>(1, sorted.size())),
        sorted.empty() ? 0.0 : sorted[sorted.size() / 2]);
    return text.data();
  }

  void Print(const std::string& name, const std::string& series) const {
    std::cout << "| `" << name << "` | " << series << " | " << z[0].size()
              << " | " << Cell(0) << " | " << Cell(1) << " | " << Cell(2)
              << " |" << std::endl;
  }
};

CalibrationResult Fit(JobConfig job, Dataset data) {
  job.data.training = std::move(data);
  job.data.validation.reset();
  job.options.uncertainty.map_configurations = 0;
  return RunJob(job, "series_agreement");
}

void Compare(const JobConfig& job, HoldOut series, Differences* differences) {
  const CalibrationResult a = Fit(job, std::move(series.train));
  const CalibrationResult b = Fit(job, std::move(series.validation));
  if (a.IsUsable() && b.IsUsable()) differences->Add(a, b);
}

JobConfig Load(const std::string& root, const std::string& name) {
  return LoadWholeJob(root + "/configs/real_arms/" + name + ".yaml");
}

// One series cut in two: by chance, ten times, and in the order of rows.
void CompareHalves(const std::string& root, const std::string& name) {
  const JobConfig job = Load(root, name);
  const Dataset& data = job.data.training;
  Differences by_chance;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Compare(job, HoldOutFraction(data, 0.5, seed), &by_chance);
  }
  by_chance.Print(name, "halves by chance");
  std::vector<bool> is_second(static_cast<std::size_t>(data.num_poses()));
  std::fill(is_second.begin() + data.num_poses() / 2, is_second.end(), true);
  Differences in_order;
  Compare(job, HoldOutPoses(data, is_second), &in_order);
  in_order.Print(name, "first and second half");
}

bool Run(const std::vector<std::string>& arguments) {
  if (arguments.size() != 1) return false;
  const std::string& root = arguments[0];
  std::cout << "| set | series | differences | usual | with what the model "
               "lacks | sandwich |\n|---|---|---|---|---|---|"
            << std::endl;
  const JobConfig a = Load(root, "ur10_A");
  Differences of_ur10;
  Compare(a, {a.data.training, Load(root, "ur10_B").data.training}, &of_ur10);
  of_ur10.Print("ur10", "A and B");
  for (const char* name : {"ur10_A", "ur10_B", "irb120_smr1", "panda_left",
                           "panda_right", "panda_top", "column"}) {
    CompareHalves(root, name);
  }
  return true;
}

}  // namespace
}  // namespace alidade::internal

int main(int argc, char** argv) {
  return alidade::internal::bench::StudyMain(
      argc, argv, "series_agreement SOURCE_DIRECTORY", alidade::internal::Run);
}
