#ifndef ALIDADE_DESIGN_CRITERION_H_
#define ALIDADE_DESIGN_CRITERION_H_

#include <Eigen/Core>

#include "alidade/design/options.h"
#include "alidade/design/pose_rows.h"

namespace alidade {

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

}  // namespace alidade

#endif  // ALIDADE_DESIGN_CRITERION_H_
