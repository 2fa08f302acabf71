#ifndef ALIDADE_SRC_UNCERTAINTY_BUDGET_H_
#define ALIDADE_SRC_UNCERTAINTY_BUDGET_H_

#include <Eigen/Core>
#include <optional>

#include "alidade/uncertainty.h"
#include "src/kernel/measurement_model.h"
#include "src/uncertainty/covariance.h"

namespace alidade::internal {

/// What is known of single measurements besides the fit.
struct MeasurementKnowledge {
  /// Standard deviation of a coordinate, as it is stated (m); nothing where it
  /// was estimated from the residuals.
  std::optional<double> stated_sigma = {};
  /// Standard deviation of a coordinate of repeated configurations (m), the
  /// instrument and the arm together; 0 degrees of freedom: none was repeated.
  double repeat_std = 0.0;
  double repeat_freedom = 0.0;
};

struct BudgetInput {
  const MeasurementModel& model;
  const Eigen::VectorXd& values;
  const ParameterCovariance& prediction;  ///< with what the model lacks
  const LackOfFit& lack;
  const MeasurementKnowledge& measurement;
  const UncertaintyOptions& options;
};

/// The uncertainty budget of the first target's position over a task region
/// (JCGM 100:2008). At configurations i = 1..N drawn in the region, with axes a
///
///   u_i,a^2 = (J_i C J_i^T)_a,a + u_model^2 + u_repeat^2      (5.1.2, 5.2.2)
///   u_c^2   = mean of u_i,a^2 over i and a
///   nu      = u_c^4 / sum_k u_k^4 / nu_k                      (G.4.1)
///
/// u_k the root mean squares of the contributions. `measured` has the
/// instrument's u^2 besides. As u_i,a differ over the region, the expanded
/// uncertainty U is what holds at the stated rate over all of it, the mean over
/// i and a of P(|t_nu| <= U / u_i,a), and the coverage factor k = U / u_c:
/// where all u_i,a are alike, k is the quantile of Student's t (G.3.2). The
/// radius is that of distances likewise, whose squares are taken as multiples
/// of Fisher's F with the same mean and variance (Box 1954).
///
/// No variance counts twice. Repeats contain the instrument: with a stated
/// sigma u_repeat^2 = s_r^2 - sigma^2 (not negative), of nu_r (u_repeat /
/// s_r)^4 degrees of freedom; without, u_repeat = s_r. What the model lacks
/// contains the repeatability where the noise is not that of repeats. Without a
/// stated sigma and repeats, residuals are one contribution.
///
/// Nothing where no configuration within the joint limits is in the region.
/// O(N p^2).
std::optional<UncertaintyBudget> MakeBudget(const BudgetInput& input);

/// Effective degrees of freedom of contributions together.
double WelchSatterthwaite(const std::vector<BudgetContribution>& contributions);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_UNCERTAINTY_BUDGET_H_
