#ifndef ALIDADE_SRC_ERROR_TERMS_RUNG_FITS_H_
#define ALIDADE_SRC_ERROR_TERMS_RUNG_FITS_H_

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "alidade/robust_loss.h"
#include "src/error_terms/folds.h"
#include "src/error_terms/stacking.h"
#include "src/error_terms/term_columns.h"
#include "src/error_terms/term_normal.h"
#include "src/kernel/measurement_model.h"

namespace alidade::internal {

/// A geometric fit, and what it is to be extended by.
struct ErrorFitInput {
  const MeasurementModel& model;
  const Dataset& data;  ///< of one process
  const std::vector<int>& columns;
  const Eigen::VectorXd& values;  ///< of the geometric fit
  const Eigen::VectorXd& priors;  ///< as CalibrationProblem has them
  std::vector<RobustLoss> losses;
  std::vector<TermSet> sets;            ///< rungs beside the geometry alone
  std::vector<CovariateUse> uses = {};  ///< of those that have covariates
  /// Rungs are put together by their evidence within the data (stacking.h), the
  /// best of them with the harmonics that its residuals have too; else there is
  /// one, and it is taken.
  bool selects = true;
};

/// One set of terms, fitted to all data.
struct RungFit {
  TermSet set;
  TermColumns columns;
  LogPrecisions precisions = {};
  double criterion = 0.0;       ///< ChosenScales
  bool is_weighed = true;       ///< DropWithoutEvidence kept it
  double variance = 1.0;        ///< of whitened residuals
  Eigen::VectorXd values = {};  ///< of the layout
  ErrorTerms terms = {};
  double weight = 0.0;
  double region_error = 0.0;  ///< mean over regions left out, whitened
  double random_error = 0.0;  ///< mean over random folds

  /// Prior standard deviation of a group's coefficients, in SI; 0 where there
  /// are none.
  double PriorDeviation(TermGroup group) const;
};

/// The covariates of `data` that have an effect, none known yet: those that
/// vary, and masses.
std::vector<CovariateEffect> EffectsOf(const Dataset& data,
                                       const std::vector<CovariateUse>& uses);

/// How likely the -2 log likelihood is smaller by `gain` or more if `variances`
/// more variances are all zero: on the edge of what they may be, it is a
/// mixture of chi-squares (Self and Liang 1987; Stram and Lee 1994),
///
///   sum_i C(variances, i) 2^-variances P(chi2_i >= gain)
double ChanceOfGain(double gain, int variances);

/// A larger set of terms is weighed where its gain is less likely than that
/// without its terms; the folds have the last word.
constexpr double kEvidenceLevel = 0.05;

/// Fits of several sets of terms to the same rows, which are linear about one
/// estimate of geometry and terms.
class RungFits {
 public:
  /// Geometry alone, then those of the input, which outlives the object. Begins
  /// at the geometric fit, linearised there, and where there are losses with
  /// the weights that they leave.
  explicit RungFits(const ErrorFitInput& input);

  std::vector<RungFit>& rungs() { return rungs_; }
  const std::vector<RungFit>& rungs() const { return rungs_; }
  const TermSolution& solution(std::size_t k) const { return solutions_[k]; }
  const Eigen::MatrixXd& gram(std::size_t k) const { return grams_[k]; }
  TermRidge RidgeOf(const RungFit& rung) const;
  const Arm& arm() const { return arm_; }
  const Eigen::VectorXd& values() const { return values_; }
  const ErrorTerms& terms() const { return terms_; }
  const Eigen::VectorXd& weights() const { return weights_; }
  WeightedRows Data() const { return {rows_, weights_}; }

  /// Each rung's scales, and its estimate from all data. Functions of joints
  /// that turn more than once are of the value modulo a turn where that is
  /// more likely.
  void ChooseScales();
  /// Takes out the rungs whose likelihood is by chance (kEvidenceLevel) larger
  /// than that of a smaller one which is left and whose terms they have, too:
  /// they would describe the same arm with more terms. Returns them, and their
  /// places.
  std::vector<std::pair<std::size_t, RungFit>> DropWithoutEvidence();
  /// Writes down the estimate of a rung, as an arm has it.
  void Describe(std::size_t k);
  /// Another rung, in place of the last one or behind it, with scales that are
  /// sought from those of rung `like`. Folds are left out as of the others.
  void AddRung(const TermSet& set, std::size_t like, bool replaces_last);
  /// What the rungs from `first` on leave of every fold that they are fitted
  /// without.
  void LeaveOut(std::size_t first);
  const std::vector<FoldErrors>& fold_errors() const { return fold_errors_; }

  /// Takes another estimate, linearises there and solves every rung again with
  /// the same scales.
  void MoveTo(const Eigen::VectorXd& values, const ErrorTerms& terms);
  /// Values after a step of the geometry (mm, mrad).
  Eigen::VectorXd Moved(const Eigen::VectorXd& step) const;
  /// The geometry that moments are taken of at some values, as ErrorTerms has
  /// it.
  Eigen::MatrixXd LoadGeometryAt(const Eigen::VectorXd& values,
                                 Eigen::Vector3d* target) const;
  /// In mm and mrad, of the input's columns.
  Eigen::VectorXd InUnits(const Eigen::VectorXd& values) const;

  /// Residuals of all rows with the estimate of a rung.
  Eigen::VectorXd LeftBy(std::size_t rung) const;
  /// With the estimate that all is linear about.
  Eigen::VectorXd LeftByEstimate() const;

 private:
  void Linearize();
  void Reweight();
  void WeighBy(const Eigen::VectorXd& left);
  void Choose(std::size_t k, const LogPrecisions& from);
  void TryModuloTurn();
  void Solve(const TermRidge& ridge, std::size_t k);
  void LeaveOut(std::size_t first, std::size_t f, FoldErrors* fold) const;
  std::vector<int> LeftOut(const std::vector<bool>& poses) const;
  Eigen::VectorXd LeftBy(const TermColumns& columns,
                         const TermSolution& solution) const;
  Eigen::VectorXd Bent(const TermRows::Observation& one, int pose,
                       const TermRows::RowMatrix& turns) const;
  Eigen::VectorXd Deviations() const;
  Eigen::VectorXd Priors() const;
  double Equations() const;

  const ErrorFitInput& input_;
  Arm arm_;
  const TrainingFolds folds_;
  Eigen::VectorXd values_;
  ErrorTerms terms_;
  bool has_terms_ = false;
  TermRows rows_;
  Eigen::VectorXd weights_;
  std::vector<RungFit> rungs_;
  std::vector<Eigen::MatrixXd> grams_;
  std::vector<TermSolution> solutions_;
  std::vector<FoldErrors> fold_errors_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_ERROR_TERMS_RUNG_FITS_H_
