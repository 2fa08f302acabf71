#include "src/job/calibrated_arm.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <vector>

#include "alidade/arm_file.h"
#include "alidade/error.h"
#include "src/common/scaled_eigensystem.h"
#include "src/job/result_directory.h"
#include "src/kernel/measurement_model.h"
#include "src/serialization/result_json.h"
#include "src/uncertainty/prediction.h"

namespace alidade::internal {
namespace {

namespace fs = std::filesystem;

// Positions known as exactly as they can be: no noise but that of the
// calibration.
constexpr double kExact = 1e-9;

// A file may hold anything: square, one row a parameter, no negative variance,
// and numbers for all parameters that are known at all.
void RequireCovariance(const std::string& path, const std::string& key,
                       const std::vector<ParameterUncertainty>& parameters,
                       const Eigen::MatrixXd& matrix) {
  const auto p = static_cast<Eigen::Index>(parameters.size());
  bool is_covariance = matrix.rows() == p && matrix.cols() == p &&
                       !(matrix.diagonal().array() < 0.0).any();
  const auto is_known = [&](Eigen::Index k) {
    return std::isfinite(parameters[static_cast<std::size_t>(k)].std);
  };
  for (Eigen::Index k = 0; is_covariance && k < p * p; ++k) {
    is_covariance = std::isfinite(matrix(k % p, k / p)) || !is_known(k % p) ||
                    !is_known(k / p);
  }
  if (is_covariance) return;
  throw InputError({path, 0, 0, "uncertainty." + key},
                   "expected a covariance of the " + std::to_string(p) +
                       " parameters, found " + std::to_string(matrix.rows()) +
                       " x " + std::to_string(matrix.cols()) +
                       " numbers, one that is none, or a negative variance");
}

// The covariance of the parameters that `arm` has; a root of it by its
// eigenvalues, those below zero by rounding being none.
ParameterCovariance CovarianceOf(const UncertaintyResult& uncertainty,
                                 const ParameterLayout& layout) {
  ParameterCovariance covariance;
  covariance.degrees_of_freedom = uncertainty.degrees_of_freedom;
  std::vector<int> kept;
  std::vector<int> null_space;
  for (std::size_t k = 0; k < uncertainty.parameters.size(); ++k) {
    const auto column = layout.Find(uncertainty.parameters[k].name);
    if (!column) continue;
    covariance.columns.push_back(*column);
    kept.push_back(static_cast<int>(k));
    if (!std::isfinite(uncertainty.parameters[k].std)) {
      null_space.push_back(static_cast<int>(kept.size()) - 1);
    }
  }
  // What the model lacks is part of every prediction.
  const LackOfFit& lack = uncertainty.lack_of_fit;
  covariance.excess.length = lack.excess_variance / 3.0;
  covariance.excess.rotation = lack.rotation_excess_variance / 3.0;
  covariance.excess.noise = lack.noise;
  const bool is_other = uncertainty.prediction_covariance.size() > 0;
  Eigen::MatrixXd matrix = is_other
                               ? uncertainty.prediction_covariance(kept, kept)
                               : uncertainty.covariance(kept, kept);
  const auto p = static_cast<Eigen::Index>(kept.size());
  covariance.null_space =
      Eigen::MatrixXd::Zero(p, static_cast<Eigen::Index>(null_space.size()));
  for (std::size_t k = 0; k < null_space.size(); ++k) {
    matrix.row(null_space[k]).setZero();
    matrix.col(null_space[k]).setZero();
    covariance.null_space(null_space[k], static_cast<Eigen::Index>(k)) = 1.0;
  }
  covariance.null_space_parameters = null_space;
  covariance.root = ScaledEigensystem(matrix).Root();
  return covariance;
}

}  // namespace

bool IsResult(const std::string& path) {
  if (fs::is_directory(path)) return true;
  if (fs::path(path).extension() != ".json") return false;
  // Arm files may be JSON as well. Both kinds begin with their format.
  std::array<char, 100> begin{};
  std::ifstream(path).read(begin.data(), begin.size() - 1);
  return std::string(begin.data()).find("\"alidade-arm-") == std::string::npos;
}

std::optional<CalibratedArm> LoadCalibratedArm(const std::string& path) {
  const std::string json = ResultJsonOf(path);
  const CalibrationResult result = LoadResultJson(json);
  if (!result.uncertainty) return std::nullopt;
  const UncertaintyResult& uncertainty = *result.uncertainty;
  RequireCovariance(json, "covariance", uncertainty.parameters,
                    uncertainty.covariance);
  if (uncertainty.prediction_covariance.size() > 0) {
    RequireCovariance(json, "prediction_covariance", uncertainty.parameters,
                      uncertainty.prediction_covariance);
  }
  CalibratedArm calibrated;
  calibrated.arm =
      LoadArm((fs::path(json).parent_path() / "arm.yaml").string());
  calibrated.covariance =
      CovarianceOf(uncertainty, MeasurementModel(calibrated.arm).layout());
  calibrated.confidence = result.uncertainty->confidence;
  const LackOfFit& lack = result.uncertainty->lack_of_fit;
  calibrated.sigma = lack.excess_variance > 0.0 ? lack.noise : result.sigma;
  for (const InputFile& input : result.inputs) {
    const bool is_validation = result.validation &&
                               result.validation->name == input.path &&
                               result.validation->name != result.train.name;
    if (!is_validation) calibrated.inputs.push_back(input);
  }
  return calibrated;
}

PredictionCheck CheckAgainst(const CalibratedArm& calibrated,
                             const Dataset& data, int num_threads) {
  const MeasurementModel model(calibrated.arm, num_threads);
  return CheckPrediction(model, model.NominalValues(), calibrated.covariance,
                         data, calibrated.confidence);
}

PredictedMap MapOf(const CalibratedArm& calibrated, int count,
                   std::uint64_t seed) {
  const MeasurementModel model(calibrated.arm);
  return MapPrediction(model, model.NominalValues(), calibrated.covariance,
                       count, seed, {});
}

ArmCheck CheckAgainst(const CalibratedArm& calibrated, const Arm& truth,
                      int count, std::uint64_t seed) {
  ArmCheck result;
  result.map = MapOf(calibrated, count, seed);
  const MeasurementModel model(truth);
  const Eigen::Matrix3Xd positions =
      model.Predict(model.NominalValues(), result.map.joint_values);
  result.map.true_error = (positions - result.map.positions).colwise().norm();
  result.map.true_summary = SummarizeErrors(result.map.true_error);
  result.check =
      CheckAgainst(calibrated,
                   MakePositions(result.map.joint_values, positions,
                                 Eigen::Matrix3Xd::Constant(3, count, kExact)),
                   1);
  return result;
}

}  // namespace alidade::internal
