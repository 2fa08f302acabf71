#ifndef ALIDADE_STUDIES_RV2AJ_FORMAT_H_
#define ALIDADE_STUDIES_RV2AJ_FORMAT_H_

#include <cstdint>
#include <string>
#include <vector>

namespace alidade::rv2aj {

/// "-1.50": so many decimals; "0.00" also for what rounds to minus zero.
std::string Fixed(double value, int decimals);
/// "0.004000", "2.3e-13": so many significant digits.
std::string Significant(double value, int digits);
/// "4.000e-04 mm".
std::string Millimetres(double metres, int digits);
/// "16.8 ms", "59.1 min".
std::string Duration(double seconds);
/// "1 pose", "56 poses".
std::string Count(std::int64_t number, const std::string& singular);
std::string Join(const std::vector<std::string>& parts,
                 const std::string& separator);

}  // namespace alidade::rv2aj

#endif  // ALIDADE_STUDIES_RV2AJ_FORMAT_H_
