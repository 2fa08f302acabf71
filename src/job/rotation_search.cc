#include "src/job/rotation_search.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "src/job/orientation_misfit.h"

namespace alidade::internal {

std::optional<FittingRotation> FindFittingRotation(
    const Arm& arm,
    const std::function<Dataset(const RotationConvention&)>& load) {
  constexpr double kClear = 3.0;
  constexpr double kSame = 1e-6;
  std::vector<std::pair<double, std::string>> fits;
  for (const std::string& name : RotationConventionNames()) {
    const auto convention = FindRotationConvention(name);
    const std::optional<double> misfit =
        convention ? OrientationMisfit(arm, load(*convention)) : std::nullopt;
    if (misfit) fits.emplace_back(*misfit, name);
  }
  std::stable_sort(fits.begin(), fits.end(), [](const auto& a, const auto& b) {
    return a.first < b.first;
  });
  if (fits.empty() || fits[0].first > kOrientationFits) return std::nullopt;
  FittingRotation best{fits[0].second, fits[0].first};
  std::size_t next = 1;
  for (; next < fits.size(); ++next) {
    if (fits[next].first > best.misfit * (1.0 + kSame) + kSame * kSame) break;
    best.names += " or " + fits[next].second;
  }
  const bool is_clear =
      next == fits.size() || fits[next].first > kClear * best.misfit;
  if (!is_clear || next > 2) return std::nullopt;
  return best;
}

}  // namespace alidade::internal
