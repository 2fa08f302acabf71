#ifndef ALIDADE_SRC_CALIBRATION_ADVICE_H_
#define ALIDADE_SRC_CALIBRATION_ADVICE_H_

#include <string>

#include "alidade/calibration_result.h"

namespace alidade::internal {

/// Warnings say what is there and then, mostly, what to do: "the residuals are
/// 5 times as large as the sigmas say: look for wrong units". This gives the
/// finding the two as a sentence each. Where the text does not ask for
/// anything, and for findings of other keys from kAttention on, `next` is the
/// advice of the finding's key.
Finding WithAdvice(Finding finding);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_ADVICE_H_
