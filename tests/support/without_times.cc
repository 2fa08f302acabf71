#include "tests/support/without_times.h"

#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>

#include "tests/support/process.h"

namespace alidade::internal::testing {

std::string WithoutTimes(const std::string& path) {
  nlohmann::json json = nlohmann::json::parse(ReadWhole(path));
  const auto is_volatile = [](const std::string& key) {
    return key == "command" || key.find("time") != std::string::npos ||
           key.find("threads") != std::string::npos;
  };
  std::function<void(nlohmann::json*)> strip = [&](nlohmann::json* node) {
    if (node->is_object()) {
      for (auto it = node->begin(); it != node->end();) {
        it = is_volatile(it.key()) ? node->erase(it) : std::next(it);
      }
    }
    if (node->is_structured()) {
      for (nlohmann::json& child : *node) strip(&child);
    }
  };
  strip(&json);
  // The one row of the study's table that states a time.
  return std::regex_replace(json.dump(1),
                            std::regex("[0-9.]+ m?s, [0-9. ]+ times less"), "");
}

}  // namespace alidade::internal::testing
