// The batched kernel and what is made of its rows, per pose (Google Benchmark;
// "items" are poses). RV-2AJ at the flange, 17 free parameters, position.

#include <benchmark/benchmark.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include "alidade/arm_file.h"
#include "bench/study_columns.h"
#include "src/kernel/aligned.h"
#include "src/kernel/kernel.h"
#include "src/kernel/lane_factor.h"
#include "src/kernel/reduction.h"
#include "src/kernel/sine.h"
#include "src/kernel/tile_rows.h"
#include "src/kernel/tiles.h"
#include "src/model/joint_draw.h"

namespace alidade::internal {
namespace {

struct Problem {
  explicit Problem(int poses)
      : model(LoadArm("configs/robots/rv2aj_flange.yaml")) {
    data.joint_values = DrawJointValues(model.nominal(), poses, 1);
    values = model.NominalValues();
    data.positions() = model.Predict(values, data.joint_values);
    data.sigmas() = Eigen::Matrix3Xd::Constant(3, poses, 2e-5);
    columns = bench::StudyColumns(model.layout());
    for (const int column : columns) values[column] += 1e-4;
  }

  MeasurementModel model;
  Dataset data;
  Eigen::VectorXd values;
  std::vector<int> columns;
};

void Reduce(benchmark::State& state, Factorization factorization) {
  const Problem problem(static_cast<int>(state.range(0)));
  ReducerOptions options;
  options.factorization = factorization;
  Reducer reducer(problem.model, problem.data, problem.columns, {}, options);
  ReducedLeastSquares reduced;
  for (auto unused : state) {
    reducer.Reduce(problem.values, &reduced);
    benchmark::DoNotOptimize(reduced.factor.data());
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}

void Summarize(benchmark::State& state) {
  const Problem problem(static_cast<int>(state.range(0)));
  Reducer reducer(problem.model, problem.data, problem.columns);
  Eigen::VectorXd values = problem.values;
  for (auto unused : state) {
    values[0] += 1e-12;
    benchmark::DoNotOptimize(reducer.Summarize(values).cost);
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}

// One tile, in the first-level cache: what the kernels take by themselves.
struct OneTile {
  OneTile()
      : problem(kTile),
        tiles(problem.model.nominal(), problem.data, 1 << 20),
        columns(problem.model.layout(), problem.columns),
        width(static_cast<int>(problem.columns.size()) + 1),
        rows(&tiles, columns.num_joints(), width),
        triangle(AllocateDoubles(kernel::TriangleSize(width))),
        work(AllocateDoubles(kernel::MergeSize(width))) {
    kernel::ComputeConstants(problem.model.nominal(),
                             problem.model.references(), problem.model.layout(),
                             problem.values, &constants);
    rows.Evaluate(constants, columns, 0);
    std::fill_n(triangle.get(), kernel::TriangleSize(width), 0.0);
  }

  int vectors() const {
    return rows.height() * kTile / static_cast<int>(kernel::Lanes());
  }

  Problem problem;
  Tiles tiles;
  kernel::Columns columns;
  kernel::Constants constants;
  int width;
  TileRows rows;
  AlignedDoubles triangle;
  AlignedDoubles work;
};

void EvaluateTile(benchmark::State& state) {
  OneTile tile;
  for (auto unused : state) {
    tile.rows.Evaluate(tile.constants, tile.columns, 0);
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * kTile);
}

// Transformations of rows that earlier ones have made small: the same work.
void AddRows(benchmark::State& state) {
  OneTile tile;
  for (auto unused : state) {
    kernel::AddRows(tile.width, tile.vectors(), tile.rows.stride(),
                    tile.rows.rows(), tile.triangle.get());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * kTile);
}

void AddProducts(benchmark::State& state) {
  OneTile tile;
  for (auto unused : state) {
    kernel::AddProducts(tile.width, tile.vectors(), tile.rows.stride(),
                        tile.rows.rows(), tile.triangle.get());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * kTile);
}

void MergeLanes(benchmark::State& state) {
  OneTile tile;
  kernel::AddRows(tile.width, tile.vectors(), tile.rows.stride(),
                  tile.rows.rows(), tile.triangle.get());
  Eigen::MatrixXd factor;
  for (auto unused : state) {
    kernel::MergeLanes(tile.width, tile.triangle.get(), tile.work.get(),
                       &factor);
    benchmark::ClobberMemory();
  }
}

void SineAndCosine(benchmark::State& state) {
  alignas(64) double angles[kTile];
  alignas(64) double cosines[kTile];
  for (int t = 0; t < kTile; ++t) angles[t] = 0.1 * t;
  for (auto unused : state) {
    kernel::SineAndCosine(angles, cosines);
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * kTile);
}

BENCHMARK(EvaluateTile);
BENCHMARK(AddRows);
BENCHMARK(AddProducts);
BENCHMARK(MergeLanes);
BENCHMARK(SineAndCosine);
BENCHMARK_CAPTURE(Reduce, orthogonal, Factorization::kOrthogonal)
    ->Arg(56)
    ->Arg(1000)
    ->Arg(10000)
    ->Arg(100000)
    ->Arg(1000000);
BENCHMARK_CAPTURE(Reduce, gram, Factorization::kGram)
    ->Arg(56)
    ->Arg(1000)
    ->Arg(10000)
    ->Arg(100000)
    ->Arg(1000000);
BENCHMARK(Summarize)->Arg(56)->Arg(1000)->Arg(10000)->Arg(100000)->Arg(1000000);

}  // namespace
}  // namespace alidade::internal

// With --without-avx512, given first, as on a machine that has AVX2 at most.
int main(int argc, char** argv) {
  if (argc > 1 && std::string(argv[1]) == "--without-avx512") {
    // The bits of better instruction sets are the lower ones.
    hwy::DisableTargets(HWY_AVX2 - 1);
    argv[1] = argv[0];
    ++argv;
    --argc;
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return EXIT_FAILURE;
  benchmark::AddCustomContext("instructions",
                              alidade::internal::VectorInstructions());
  benchmark::RunSpecifiedBenchmarks();
  return EXIT_SUCCESS;
}
