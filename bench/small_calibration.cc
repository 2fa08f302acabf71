// The parts of a calibration of 56 poses without files, with the number of
// calls of operator new in each (Google Benchmark). RV-2AJ at the
// flange, 17 free parameters, noise of 0.02 mm.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>
#include <vector>

#include "alidade/arm_file.h"
#include "alidade/units.h"
#include "bench/study_columns.h"
#include "src/common/random.h"
#include "src/identifiability/analysis.h"
#include "src/kernel/reduction.h"
#include "src/model/joint_draw.h"
#include "src/simulation/repeated_calibration.h"
#include "src/solve/solve.h"

namespace {
std::atomic<long> allocations{0};
}  // namespace

// Not inlined: GCC would take new and delete for a mismatched pair.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* const memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace alidade::internal {
namespace {

constexpr double kSigma = 0.02 * kMillimetre;

struct Problem {
  Problem() : model(LoadArm("configs/robots/rv2aj_flange.yaml")) {
    Eigen::VectorXd truth = model.NominalValues();
    columns = bench::StudyColumns(model.layout());
    // All others are held.
    for (int column = 0; column < model.layout().size(); ++column) {
      const Parameter& parameter = model.layout().parameter(column);
      const bool is_free =
          std::binary_search(columns.begin(), columns.end(), column);
      if (ParameterLayout::IsJointKind(parameter.kind) && !is_free) {
        options.fix.push_back(parameter.name);
      }
    }
    Random random(2);
    for (const int column : columns) truth[column] += 1e-3 * random.Normal();
    data.joint_values = DrawJointValues(model.nominal(), 56, 1);
    data.positions() = model.Predict(truth, data.joint_values);
    data.sigmas() = Eigen::Matrix3Xd::Constant(3, 56, kSigma);
    Eigen::MatrixXd noisy = data.positions().map();
    for (double& value : noisy.reshaped()) value += kSigma * random.Normal();
    data.positions() = std::move(noisy);
  }

  MeasurementModel model;
  Dataset data;
  std::vector<int> columns;
  IdentifiabilityOptions options;
};

void CountAllocations(benchmark::State& state, long before) {
  state.counters["allocations"] = static_cast<double>(allocations - before) /
                                  static_cast<double>(state.iterations());
}

void Identify(benchmark::State& state) {
  const Problem problem;
  const long before = allocations;
  for (auto unused : state) {
    benchmark::DoNotOptimize(
        AnalyzeIdentifiability(problem.model, problem.data, problem.options)
            .num_free);
  }
  CountAllocations(state, before);
}

void Solve(benchmark::State& state) {
  const Problem problem;
  SolverOptions options;
  options.initial_trust_region_radius = 1e10;
  const long before = allocations;
  for (auto unused : state) {
    Eigen::VectorXd values = problem.model.NominalValues();
    benchmark::DoNotOptimize(
        SolveLevenbergMarquardt({problem.model, problem.data, problem.columns},
                                options, &values)
            .final_cost);
  }
  CountAllocations(state, before);
}

// A whole calibration of measured values whose poses and sigmas are known
// beforehand: the pass has been made, what is left is the solve, the
// covariance and the degrees of freedom.
void Calibrate(benchmark::State& state) {
  const Problem problem;
  IdentifiabilityOptions kept = problem.options;
  kept.policy = WeakPolicy::kFreeze;
  const RepeatedCalibration calibration(
      problem.model, AnalyzeIdentifiability(problem.model, problem.data, kept),
      {});
  const long before = allocations;
  for (auto unused : state) {
    benchmark::DoNotOptimize(calibration.Run(problem.data).reduced_chi_square);
  }
  CountAllocations(state, before);
}

// What an iteration asks of our own code.
void Reduce(benchmark::State& state) {
  const Problem problem;
  Reducer reducer(problem.model, problem.data, problem.columns);
  Eigen::VectorXd values = problem.model.NominalValues();
  ReducedLeastSquares reduced;
  reducer.Reduce(values, &reduced);
  const long before = allocations;
  for (auto unused : state) {
    values[0] += 1e-12;
    benchmark::DoNotOptimize(reducer.Summarize(values).cost);
    reducer.Reduce(values, &reduced);
  }
  CountAllocations(state, before);
}

void SetUp(benchmark::State& state) {
  const Problem problem;
  const long before = allocations;
  for (auto unused : state) {
    const Reducer reducer(problem.model, problem.data, problem.columns);
    benchmark::DoNotOptimize(&reducer);
  }
  CountAllocations(state, before);
}

BENCHMARK(Identify)->Unit(benchmark::kMicrosecond);
BENCHMARK(SetUp)->Unit(benchmark::kMicrosecond);
BENCHMARK(Reduce)->Unit(benchmark::kMicrosecond);
BENCHMARK(Solve)->Unit(benchmark::kMicrosecond);
BENCHMARK(Calibrate)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace alidade::internal

BENCHMARK_MAIN();
