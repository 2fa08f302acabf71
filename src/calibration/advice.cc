#include "src/calibration/advice.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include "src/common/text.h"

namespace alidade::internal {
namespace {

// Words that a request begins with.
constexpr std::array<std::string_view, 23> kRequests = {
    "add",    "allow",   "approach", "ask",  "calibrate", "check",
    "choose", "correct", "empty",    "give", "have",      "identify",
    "invert", "leave",   "let",      "look", "measure",   "mend",
    "move",   "mount",   "state",    "use",  "widen"};

bool IsRequest(std::string_view text) {
  std::string word(text.substr(0, text.find(' ')));
  if (word.empty() || word.size() == text.size()) return false;
  word[0] =
      static_cast<char>(std::tolower(static_cast<unsigned char>(word[0])));
  return std::find(kRequests.begin(), kRequests.end(), word) != kRequests.end();
}

// Where the first clause that asks for something begins, not in a quotation of
// a file; npos where there is none.
std::size_t FindRequest(const std::string& text) {
  bool is_quoted = false;
  for (std::size_t i = 0; i + 2 < text.size(); ++i) {
    if (text[i] == '`') is_quoted = !is_quoted;
    const bool ends =
        text[i + 1] == ' ' &&
        std::string_view(":;.").find(text[i]) != std::string_view::npos;
    if (!is_quoted && ends && IsRequest(std::string_view(text).substr(i + 2))) {
      return i + 2;
    }
  }
  return std::string::npos;
}

std::string AdviceOn(const Finding& finding) {
  const std::array<std::pair<std::string_view, std::string_view>, 6> advices = {
      {
          {"solver",
           "Look for what is wrong with the data or the arm file, identify "
           "fewer parameters, or measure more poses."},
          {"improvement",
           finding.level == FindingLevel::kFailed
               ? "Keep the nominal arm, and look for what is wrong with the "
                 "data or the arm file."
               : "Nothing is wrong where the arm had been calibrated before; "
                 "else look for errors that the parameters do not describe."},
          {"acceptance",
           "Look at the warnings, measure more poses or more exactly, or "
           "reconsider the limit."},
          {"validation_outliers",
           "Look at these measurements, and measure the poses again."},
          {"cross_validation",
           "Measure more poses, or identify fewer parameters."},
          {"warning", "Decide whether this matters where the arm is used."},
      }};
  for (const auto& [key, advice] : advices) {
    if (finding.key.compare(0, key.size(), key) == 0) {
      return std::string(advice);
    }
  }
  return "";
}

}  // namespace

Finding WithAdvice(Finding finding) {
  const std::size_t request = FindRequest(finding.sentence);
  if (request != std::string::npos) {
    finding.next = finding.sentence.substr(request);
    finding.next[0] = static_cast<char>(
        std::toupper(static_cast<unsigned char>(finding.next[0])));
    finding.sentence.resize(request - 2);
  } else if (finding.next.empty() &&
             finding.level >= FindingLevel::kAttention) {
    finding.next = AdviceOn(finding);
  }
  finding.sentence = AsSentence(finding.sentence);
  if (!finding.next.empty()) finding.next = AsSentence(finding.next);
  return finding;
}

}  // namespace alidade::internal
