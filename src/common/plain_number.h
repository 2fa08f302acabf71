#ifndef ALIDADE_SRC_COMMON_PLAIN_NUMBER_H_
#define ALIDADE_SRC_COMMON_PLAIN_NUMBER_H_

#include "src/common/numbers.h"

namespace alidade::internal {

/// Reads the cell of a CSV row that begins at `text` and ends at a comma or at
/// `end`, spaces and tabs around the number passed over: the SI value of what
/// ParseQuantity reads, to the same bits. Returns where the cell ends, or null
/// where ParseQuantity gives nothing.
///
/// Most numbers have few digits: an integer w below 2^53 and a power of ten up
/// to 22 are doubles, so that w * 10^e or w / 10^e is rounded once, which is
/// what is asked for (Clinger 1990, "How to read floating point numbers
/// accurately"). The others go to ParseQuantity. Some 10 ns a number.
const char* ParsePlainCell(const char* text, const char* end, const Unit& unit,
                           double* value);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMMON_PLAIN_NUMBER_H_
