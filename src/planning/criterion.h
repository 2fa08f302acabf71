#ifndef ALIDADE_SRC_PLANNING_CRITERION_H_
#define ALIDADE_SRC_PLANNING_CRITERION_H_

#include <Eigen/Core>

#include "alidade/plan.h"
#include "src/planning/pose_rows.h"

namespace alidade::internal {

/// The logarithm of the criterion; of kD, of the p-th root of det M, so that a
/// factor of the information adds its logarithm to every criterion but kO2.
/// (Those in terms of s: half of that.) -infinity where M is not positive
/// definite. `region` is looked at by kG and kI alone.
double CriterionValue(DesignCriterion criterion,
                      const Eigen::MatrixXd& information,
                      const PoseRows& region);

/// A direction in which information is wanted: candidate rows J score
///
///   sum_i weights_i |J f_i|^2,
///
/// f_i the columns of `factor`: the slope of the criterion when J^T J is added.
/// The extreme eigenvalue of kE, kO2, kO3, kO4 and the worst place of kG are
/// taken softly, those near them counting by a power of how near, since a plan
/// that mends only the worst soon has another one as bad.
struct DesignSlope {
  Eigen::MatrixXd factor;   ///< parameters x k
  Eigen::VectorXd weights;  ///< k
};

/// Of a criterion other than kD at a positive definite M.
DesignSlope SlopeOf(DesignCriterion criterion,
                    const Eigen::MatrixXd& information, const PoseRows& region);

/// CriterionValue and SlopeOf of one criterion again and again. What does not
/// change with M is kept. The region outlives the object.
class CriterionEvaluator {
 public:
  CriterionEvaluator(DesignCriterion criterion, const PoseRows& region);

  /// O(p^3); kG: O(places p^2).
  double Value(const Eigen::MatrixXd& information) const;
  DesignSlope Slope(const Eigen::MatrixXd& information) const;

  /// Sets what a pose is to be added to: `information` without it.
  void SetBase(const Eigen::MatrixXd& information);
  /// The value with the pose J^T (p x rows) added to the base. O(p^3); kG:
  /// O(places p) for each row. May be called from several threads.
  double ValueWith(const Eigen::MatrixXd& pose) const;

 private:
  double WorstWith(const Eigen::MatrixXd& pose) const;

  const DesignCriterion criterion_;
  const PoseRows& region_;
  Eigen::MatrixXd moment_;       ///< kI: mean of W_x^T W_x
  Eigen::MatrixXd moment_root_;  ///< F F^T = moment_
  Eigen::MatrixXd base_;
  bool base_is_regular_ = false;  ///< kG: the next two are set
  Eigen::MatrixXd base_inverse_;
  Eigen::VectorXd base_variances_;  ///< of the places
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_PLANNING_CRITERION_H_
