#ifndef ALIDADE_SRC_IDENTIFIABILITY_DATA_ANALYSIS_H_
#define ALIDADE_SRC_IDENTIFIABILITY_DATA_ANALYSIS_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "alidade/identifiability.h"
#include "src/kernel/measurement_model.h"

namespace alidade::internal {

/// What these poses determine of the parameters that some pose could.
struct DataAnalysis {
  RankReport rank;                  ///< of the generically kept columns
  std::vector<Relation> relations;  ///< "not_excited"
  std::vector<std::string> advice;
  /// How large the noise makes what only second-order effects determine; empty
  /// where there is nothing of the kind.
  std::string second_order;

  std::vector<int> columns;         ///< of the factor
  Eigen::MatrixXd whitened_factor;  ///< at the nominal geometry

  /// Predicted standard deviations of some of the columns without priors, all
  /// others held.
  Eigen::VectorXd Deviations(const std::vector<int>& some) const;
};

DataAnalysis AnalyzeData(const MeasurementModel& model, const Dataset& data,
                         const std::vector<int>& kept,
                         const std::vector<int>& weak,
                         const IdentifiabilityOptions& options);

/// The free parameters over these poses.
struct FreeAnalysis {
  RankReport rank;            ///< at the nominal geometry
  RankReport perturbed_rank;  ///< at a perturbed one
  ObservabilityIndices unscaled;
  ObservabilityIndices scaled;
  Eigen::MatrixXd whitened_factor;
  Eigen::VectorXd priors;  ///< set by whoever knows what is fixed

  Eigen::VectorXd Deviations(bool with_priors) const;
};

FreeAnalysis AnalyzeFree(const MeasurementModel& model, const Dataset& data,
                         const std::vector<int>& free,
                         const IdentifiabilityOptions& options);

/// Ranks without a clear gap, and a target on the axis of the last joint.
void WarnAboutFree(const MeasurementModel& model, const Dataset& data,
                   const FreeAnalysis& analysis, IdentifiabilityResult* result);

/// "0.12 mm", "3 mrad".
std::string FormatDeviation(double value, Dimension dimension);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_IDENTIFIABILITY_DATA_ANALYSIS_H_
