#include "src/common/distributions.h"

#include <boost/math/distributions/beta.hpp>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>

#include "src/common/constants.h"

namespace alidade::internal {
namespace {

using boost::math::complement;
using boost::math::policies::domain_error;
using boost::math::policies::ignore_error;
using boost::math::policies::overflow_error;
using boost::math::policies::policy;
using boost::math::policies::promote_double;

// Long doubles would take several times as long for digits that are not asked
// for. Nothing throws: NaN comes of NaN, and the ends of ranges are infinite.
using Policy = policy<promote_double<false>, domain_error<ignore_error>,
                      overflow_error<ignore_error>>;
using Beta = boost::math::beta_distribution<double, Policy>;
using ChiSquare = boost::math::chi_squared_distribution<double, Policy>;
using Fisher = boost::math::fisher_f_distribution<double, Policy>;
using Normal = boost::math::normal_distribution<double, Policy>;
using StudentT = boost::math::students_t_distribution<double, Policy>;

constexpr double kAsGoodAsInfinite = 1e8;

}  // namespace

double NormalCdf(double z) { return cdf(Normal(), z); }

double NormalQuantile(double probability) {
  return quantile(Normal(), probability);
}

double ChiSquareCdf(double x, double dof) {
  if (x <= 0.0) return 0.0;
  return x == kInfinity ? 1.0 : cdf(ChiSquare(dof), x);
}

double ChiSquareSurvival(double x, double dof) {
  if (x <= 0.0) return 1.0;
  return x == kInfinity ? 0.0 : cdf(complement(ChiSquare(dof), x));
}

double ChiSquareQuantile(double probability, double dof) {
  return probability == 1.0 ? kInfinity : quantile(ChiSquare(dof), probability);
}

double ChiSquareUpperQuantile(double survival, double dof) {
  return survival == 0.0 ? kInfinity
                         : quantile(complement(ChiSquare(dof), survival));
}

double StudentTQuantile(double probability, double dof) {
  return dof < kAsGoodAsInfinite ? quantile(StudentT(dof), probability)
                                 : NormalQuantile(probability);
}

double FisherQuantile(double probability, double dof1, double dof2) {
  return dof2 < kAsGoodAsInfinite ? quantile(Fisher(dof1, dof2), probability)
                                  : ChiSquareQuantile(probability, dof1) / dof1;
}

double FisherSurvival(double f, double dof1, double dof2) {
  if (!(f > 0.0)) return 1.0;
  return dof2 < kAsGoodAsInfinite ? cdf(complement(Fisher(dof1, dof2), f))
                                  : ChiSquareSurvival(f * dof1, dof1);
}

std::pair<double, double> RateInterval(std::int64_t held, std::int64_t n,
                                       double confidence) {
  if (n == 0) return {0.0, 1.0};
  const double tail = 0.5 * (1.0 - confidence);
  const auto k = static_cast<double>(held);
  const auto rest = static_cast<double>(n - held);
  return {held == 0 ? 0.0 : quantile(Beta(k, rest + 1.0), tail),
          held == n ? 1.0 : quantile(complement(Beta(k + 1.0, rest), tail))};
}

}  // namespace alidade::internal
