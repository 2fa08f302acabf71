#ifndef ALIDADE_SRC_PLANNING_PLANNED_TERMS_H_
#define ALIDADE_SRC_PLANNING_PLANNED_TERMS_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "alidade/calibration_options.h"
#include "src/error_terms/term_columns.h"
#include "src/planning/pose_rows.h"

namespace alidade::internal {

/// Error terms that a plan is to determine beside the parameters, each in units
/// that move the target at the end of the arm's reach by a metre, as those of
/// the parameters do. Of their priors, which have this size, it is half a
/// millimetre. A joint's function is represented by
/// knots 0.8 rad apart, so that it is determined where all of the joint's range
/// is measured.
class PlannedTerms {
 public:
  /// Of the candidates' joint values (n x N). Nothing where no terms are asked
  /// for; `auto` asks for elasticity and functions.
  static std::optional<PlannedTerms> Of(const MeasurementModel& model,
                                        const ErrorTermOptions& options,
                                        const Eigen::MatrixXd& joint_values);

  static constexpr double kPrior = 0.5e-3;  ///< in these units

  int size() const { return columns_.size(); }
  /// What is known of them beforehand, in their units.
  const Eigen::MatrixXd& known() const { return known_; }
  /// Appends their columns to rows of `data`, which MakePlannedData made.
  void Append(const MeasurementModel& model, const Eigen::VectorXd& values,
              const Dataset& data, PoseRows* rows) const;

  /// One entry per compliance or harmonic, and one per joint function.
  struct Entry {
    std::string name;  ///< "k2_z", "e3"
    std::string unit;
    double prior_std = 0.0;  ///< (SI)
    int first = 0;           ///< of the terms
    int count = 1;
  };
  const std::vector<Entry>& entries() const { return entries_; }

 private:
  explicit PlannedTerms(TermColumns columns) : columns_(std::move(columns)) {}

  void SetScales(const MeasurementModel& model,
                 const Eigen::MatrixXd& joint_values);
  void ListEntries(const Arm& arm);

  TermColumns columns_;
  Eigen::VectorXd scales_;  // units of terms, in those of the columns
  Eigen::MatrixXd known_;
  std::vector<Entry> entries_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_PLANNING_PLANNED_TERMS_H_
