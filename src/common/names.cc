#include "src/common/names.h"

#include <algorithm>
#include <numeric>

#include "src/common/characters.h"

namespace alidade::internal {
namespace {

constexpr std::size_t kMaxQuoted = 40;
constexpr std::size_t kMaxListed = 16;

// Levenshtein distance, one row of its table at a time.
std::size_t EditDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const bool same = LowerCase(a[i]) == LowerCase(b[j]);
      const std::size_t replaced = diagonal + (same ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, diagonal + 1, row[j] + 1});
    }
  }
  return row[b.size()];
}

bool AreAlike(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char c, char d) {
    return LowerCase(c) == LowerCase(d);
  });
}

// What may be meant by a name: the nearest, or those of which it is the last
// part, "intrinsic_xyz" and "extrinsic_xyz" of "XYZ"; quoted.
std::string Suggestion(std::string_view name,
                       const std::vector<std::string>& candidates) {
  const std::optional<std::string> nearest = NearestName(name, candidates);
  if (nearest) return "\"" + *nearest + "\"";
  std::string text;
  for (const std::string& candidate : candidates) {
    const std::size_t mark = candidate.find_last_of("_/");
    if (mark == std::string::npos || name.empty() ||
        !AreAlike(std::string_view(candidate).substr(mark + 1), name)) {
      continue;
    }
    text += (text.empty() ? "\"" : " or \"") + candidate + "\"";
  }
  return text;
}

}  // namespace

std::string Quote(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text.substr(0, kMaxQuoted)) {
    quoted += IsControl(c) ? '?' : c;
  }
  if (text.size() > kMaxQuoted) quoted += "...";
  return quoted + "\"";
}

std::string OneLine(std::string text) {
  std::replace_if(text.begin(), text.end(), IsControl, ' ');
  return text;
}

std::string JoinNames(const std::vector<std::string>& names) {
  std::string joined;
  const std::size_t listed = std::min(names.size(), kMaxListed);
  for (std::size_t i = 0; i < listed; ++i) {
    joined += (i == 0 ? "" : ", ") + names[i];
  }
  if (listed < names.size()) {
    joined += " ... (" + std::to_string(names.size()) + " in all)";
  }
  return joined;
}

std::optional<std::string> NearestName(
    std::string_view name, const std::vector<std::string>& candidates) {
  constexpr std::size_t kMaxCompared = 64;
  if (name.size() > kMaxCompared) return std::nullopt;
  std::size_t best = std::max<std::size_t>(2, name.size() / 3) + 1;
  std::optional<std::string> nearest;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = EditDistance(name, candidate);
    if (distance < best && distance < candidate.size()) {
      best = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

std::string UnknownName(std::string_view what, std::string_view name,
                        const std::vector<std::string>& candidates) {
  std::string message = "unknown " + std::string(what) + " " + Quote(name);
  const std::string meant = Suggestion(name, candidates);
  return message +
         (meant.empty() ? ", expected one of "
                        : ", did you mean " + meant + "? Expected one of ") +
         JoinNames(candidates);
}

}  // namespace alidade::internal
