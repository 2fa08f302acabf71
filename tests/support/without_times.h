#ifndef ALIDADE_TESTS_SUPPORT_WITHOUT_TIMES_H_
#define ALIDADE_TESTS_SUPPORT_WITHOUT_TIMES_H_

#include <string>

namespace alidade::internal::testing {

/// A result.json without what differs from run to run (times) and from call to
/// call (the command, the number of threads); nothing else may.
std::string WithoutTimes(const std::string& path);

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_SUPPORT_WITHOUT_TIMES_H_
