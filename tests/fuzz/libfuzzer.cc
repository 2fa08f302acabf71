// libFuzzer's entries. The target is named by the first argument,
// "--target=arm": libFuzzer itself passes over what begins with "--".

#include <glog/logging.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/fuzz/fuzz_target.h"

namespace {

const alidade::internal::fuzz::FuzzTarget* chosen = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  FLAGS_minloglevel = google::GLOG_FATAL;
  const std::string argument = *argc > 1 ? (*argv)[1] : "";
  for (const auto& target : alidade::internal::fuzz::FuzzTargets()) {
    if (argument == std::string("--target=") + target.name) chosen = &target;
  }
  if (chosen != nullptr) return 0;
  std::fprintf(stderr,
               "usage: alidade_fuzz --target=NAME [FLAGS] [CORPUS...]\n");
  std::exit(2);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data,
                                      std::size_t size) {
  alidade::internal::fuzz::RunTarget(
      *chosen, std::string(reinterpret_cast<const char*>(data), size));
  return 0;
}
