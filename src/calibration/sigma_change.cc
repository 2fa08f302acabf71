#include "src/calibration/sigma_change.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "src/kernel/partition.h"

namespace alidade::internal {
namespace {

bool IsOf(RowClass which, int row) {
  return (row < 3) == (which == RowClass::kLength);
}

// Distances of reference points are known a priori; no residual shows how
// well.
bool IsEstimated(const ObservationBlock& block) {
  return block.kind != MeasurementKind::kPointDistance;
}

// Rows that were measured, whose columns of the whitener are not zero.
std::vector<Eigen::Index> MeasuredRows(const Eigen::MatrixXd& whitener) {
  std::vector<Eigen::Index> rows;
  for (Eigen::Index row = 0; row < whitener.cols(); ++row) {
    if (!whitener.col(row).isZero(0.0)) rows.push_back(row);
  }
  return rows;
}

Eigen::MatrixXd Inverse(const Eigen::MatrixXd& matrix) {
  return matrix.llt().solve(
      Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()));
}

// The whitener of an observation after its covariance has changed.
Eigen::MatrixXd ChangedWhitener(const Eigen::MatrixXd& whitener, RowClass which,
                                const SigmaChange& change) {
  const std::vector<Eigen::Index> measured = MeasuredRows(whitener);
  const Eigen::MatrixXd information = whitener.transpose() * whitener;
  Eigen::MatrixXd covariance = Inverse(information(measured, measured));
  for (std::size_t k = 0; k < measured.size(); ++k) {
    if (!IsOf(which, static_cast<int>(measured[k]))) continue;
    const auto row = static_cast<Eigen::Index>(k);
    covariance(row, row) += change.added * change.added;
    covariance.row(row) *= change.scale;
    covariance.col(row) *= change.scale;
  }
  const Eigen::MatrixXd changed = Inverse(covariance).llt().matrixU();
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(whitener.rows(), whitener.cols());
  all(measured, measured) = changed;
  return all;
}

// The one sigma of all measured rows; nothing where they differ.
std::optional<double> CommonSigma(RowClass which, const Dataset& data) {
  std::optional<double> common;
  for (const ObservationBlock& block : data.blocks) {
    if (!IsEstimated(block)) continue;
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      for (int row = 0; row < block.rows_each(); ++row) {
        const double sigma = block.sigmas(row, i);
        if (!IsOf(which, row) || !std::isfinite(sigma)) continue;
        if (common && *common != sigma) return std::nullopt;
        common = sigma;
      }
    }
  }
  return common;
}

}  // namespace

Dataset RowsOfClass(const Dataset& data, RowClass which) {
  Dataset rows = data;
  for (ObservationBlock& block : rows.blocks) {
    block.whiteners.clear();
    MatrixBuilder sigmas(block.sigmas);
    for (int row = 0; row < block.rows_each(); ++row) {
      if (IsOf(which, row) && IsEstimated(block)) continue;
      sigmas.map().row(row).setConstant(
          std::numeric_limits<double>::infinity());
    }
    block.sigmas = sigmas.Freeze();
  }
  return rows;
}

void ChangeSigmas(RowClass which, const SigmaChange& change, Dataset* data) {
  for (ObservationBlock& block : data->blocks) {
    if (!IsEstimated(block)) continue;
    MatrixBuilder changed(block.sigmas);
    for (int row = 0; row < block.rows_each(); ++row) {
      if (!IsOf(which, row)) continue;
      MatrixBuilder::Map all = changed.map();
      auto sigmas = all.row(row).array();
      sigmas =
          change.scale * (sigmas.square() + change.added * change.added).sqrt();
    }
    block.sigmas = changed.Freeze();
    for (Eigen::MatrixXd& whitener : block.whiteners) {
      if (whitener.size() == 0) continue;
      whitener = ChangedWhitener(whitener, which, change);
    }
  }
}

void ScaleSigmas(double factor, Dataset* data) {
  ChangeSigmas(RowClass::kLength, {factor, 0.0}, data);
  ChangeSigmas(RowClass::kRotation, {factor, 0.0}, data);
}

double MedianSigma(RowClass which, const Dataset& data,
                   Communicator* communicator) {
  if (!data.partition) {
    const std::optional<double> common = CommonSigma(which, data);
    if (common) return *common;
  }
  std::vector<std::vector<double>> lists(data.blocks.size());
  for (std::size_t k = 0; k < lists.size(); ++k) {
    const ObservationBlock& block = data.blocks[k];
    if (!IsEstimated(block)) continue;
    for (int row = 0; row < block.rows_each(); ++row) {
      if (!IsOf(which, row)) continue;
      for (const double sigma : block.sigmas.row(row)) {
        if (std::isfinite(sigma)) lists[k].push_back(sigma);
      }
    }
  }
  std::vector<double> sigmas = InOrder(communicator, data, std::move(lists));
  return ComputeOnRoot(communicator, data, [&] {
    if (sigmas.empty()) return 0.0;
    const auto middle =
        sigmas.begin() + static_cast<std::ptrdiff_t>(sigmas.size() / 2);
    std::nth_element(sigmas.begin(), middle, sigmas.end());
    return *middle;
  });
}

}  // namespace alidade::internal
