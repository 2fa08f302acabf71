#ifndef ALIDADE_TESTS_SUPPORT_RANDOM_ERRORS_H_
#define ALIDADE_TESTS_SUPPORT_RANDOM_ERRORS_H_

#include <Eigen/Core>
#include <cmath>

#include "alidade/arm.h"
#include "src/common/random.h"
#include "tests/support/random_arms.h"

namespace alidade::internal::testing {

Load RandomLoad(Random* random);

/// Every error term of an arm, some hundred times as large as those of real
/// ones, so that what is of second order shows, too. The functions' knots cover
/// two thirds of the joints' ranges, that of the second joint is of the value
/// modulo a turn. Moments are of a geometry of their own.
ErrorTerms RandomErrors(const Arm& arm, Random* random);

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_SUPPORT_RANDOM_ERRORS_H_
