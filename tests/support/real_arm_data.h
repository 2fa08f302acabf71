#ifndef ALIDADE_TESTS_SUPPORT_REAL_ARM_DATA_H_
#define ALIDADE_TESTS_SUPPORT_REAL_ARM_DATA_H_

#include <cstdlib>
#include <filesystem>
#include <string>

#include "src/common/files.h"

namespace alidade::internal::testing {

/// Why a job of configs/real_arms cannot be loaded, as a test that skips it
/// says: ALIDADE_DATA is not set, or its own files are not in the folder that
/// it names. Empty where all are there, as for jobs that do not use it.
inline std::string WhatDataLack(const std::string& job_path) {
  const std::string variable = "${ALIDADE_DATA}";
  const std::string text = ReadFile(job_path);
  for (std::size_t at = text.find(variable); at != std::string::npos;
       at = text.find(variable, at + 1)) {
    const char* const folder = std::getenv("ALIDADE_DATA");
    if (folder == nullptr) {
      return "ALIDADE_DATA is not set: it names the folder of measured data "
             "(docs/real_arms.md)";
    }
    const std::size_t begin = at + variable.size();
    const std::string file =
        folder + text.substr(begin, text.find('"', begin) - begin);
    if (!std::filesystem::exists(file)) {
      return "there is no " + file + "; ALIDADE_DATA names its folder";
    }
  }
  return "";
}

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_SUPPORT_REAL_ARM_DATA_H_
