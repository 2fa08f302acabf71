#ifndef ALIDADE_BENCH_STUDY_MAIN_H_
#define ALIDADE_BENCH_STUDY_MAIN_H_

#include <cstdlib>
#include <exception>
#include <functional>
#include <iostream>
#include <string>
#include <vector>

namespace alidade::internal::bench {

/// The main() of a study: `run` gets what stands after the program's name, and
/// returns false where that is not what `usage` says. What goes wrong is told
/// in a line; the exit status is then 2, as of wrong arguments.
inline int StudyMain(
    int argc, char** argv, const std::string& usage,
    const std::function<bool(const std::vector<std::string>&)>& run) {
  try {
    if (run({argv + 1, argv + argc})) return EXIT_SUCCESS;
    std::cerr << "usage: " << usage << "\n";
  } catch (const std::exception& error) {
    std::cerr << argv[0] << ": " << error.what() << "\n";
  }
  return 2;
}

}  // namespace alidade::internal::bench

#endif  // ALIDADE_BENCH_STUDY_MAIN_H_
