#ifndef ALIDADE_SRC_UNCERTAINTY_ROW_SPREAD_H_
#define ALIDADE_SRC_UNCERTAINTY_ROW_SPREAD_H_

#include <Eigen/Core>
#include <optional>

#include "src/error_terms/term_rows.h"
#include "src/uncertainty/covariance.h"

namespace alidade::internal {

/// What is not known of the rows of observations: S with S S^T their
/// covariance, whitened, from the parameters and, where there are any, the
/// error terms. Holds references.
class RowSpread {
 public:
  /// O(N (columns + joints)) time and memory where there are error terms.
  RowSpread(const MeasurementModel& model, const Eigen::VectorXd& values,
            const ParameterCovariance& covariance, const Dataset& data)
      : covariance_(covariance) {
    if (covariance.terms) {
      rows_ = MakeTermRows(model, values, data, covariance.columns);
    }
  }

  Eigen::Index width() const {
    return covariance_.terms ? covariance_.terms->width() : covariance_.size();
  }
  /// `derivatives`: whitened, of observation i.
  Eigen::MatrixXd Of(
      Eigen::Index i,
      const Eigen::Ref<const Eigen::MatrixXd>& derivatives) const {
    return rows_ ? covariance_.terms->Spread(*rows_, rows_->observations[i])
                 : Eigen::MatrixXd(derivatives * covariance_.root);
  }

 private:
  const ParameterCovariance& covariance_;
  std::optional<TermRows> rows_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_UNCERTAINTY_ROW_SPREAD_H_
