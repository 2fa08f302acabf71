#include "src/calibration/mistake_search.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/forward_kinematics.h"
#include "src/calibration/input_mistakes.h"
#include "src/calibration/position_fit.h"
#include "src/calibration/stations.h"
#include "src/common/constants.h"
#include "src/common/format.h"
#include "src/common/text.h"

namespace alidade::internal {
namespace {

// At the nominal geometry, of the reach.
constexpr double kTolerated = 0.02;
// A residual of a larger part of how far the positions lie apart explains
// nothing: an arm that hardly moves fits to any small cloud.
constexpr double kExplains = 0.2;
// After a calibration, of the reach and of how far the positions lie apart, at
// positions that it has not seen.
constexpr double kSolvedTolerated = 1e-3;
constexpr double kSolvedExplains = 0.02;
constexpr double kClearlyBetter = 4.0;
// Cures whose errors are closer than this explain the data alike.
constexpr double kAlike = 2.0;
// Cures that are looked at more closely, and of these those that are solved.
constexpr std::size_t kMostFitted = 60;
constexpr std::size_t kMostSolved = 8;

// A cure and the error that it leaves. Cures compare by the part of how far the
// positions then lie apart: a smaller unit makes every error smaller.
struct Cure {
  const InputMistake* mistake = nullptr;
  PositionSample mended;
  double misfit = kInfinity;

  double Relative() const { return misfit / ExtentOf(mended.points); }
};

void KeepBest(std::size_t count, std::vector<Cure>* cures) {
  std::stable_sort(
      cures->begin(), cures->end(),
      [](const Cure& a, const Cure& b) { return a.Relative() < b.Relative(); });
  if (cures->size() > count) cures->resize(count);
}

// Poses that state the instrument in the tool's frame.
InputMistake InverseMistake() {
  return {InputMistake::Kind::kRow,
          "the poses are inverse, as a camera on the tool measures them: "
          "invert each (position and orientation), so that it states the "
          "target in the frame of the instrument",
          {}};
}

class MistakeSearch {
 public:
  MistakeSearch(const Arm& arm, const PositionSample& sample,
                const std::optional<PositionSample>& inverse,
                const CandidateGroups& candidates, double sigma)
      : arm_(arm), sample_(sample), inverse_(inverse), candidates_(candidates) {
    constexpr double kNoise = 4.0;       // sigmas
    constexpr double kMostNoise = 2e-3;  // of the reach
    Arm at_origin = arm;
    at_origin.instrument_from_base.setIdentity();
    reach_ = Reach(at_origin);
    noise_ = std::min(kNoise * sigma, kMostNoise * reach_);
  }

  InputDiagnosis Run() {
    const double tolerated = Tolerated(sample_, kTolerated, kExplains);
    if (MisfitAsStated(arm_, sample_) <= tolerated) return {};
    const double misfit = Misfit(arm_, sample_);
    if (!(misfit > tolerated) || !std::isfinite(misfit)) return {};
    solved_ = SolvedMisfit(arm_, sample_);
    if (IsExplained(sample_, solved_)) return {};
    Finding finding{"plausibility.position_misfit", misfit, tolerated, "",
                    FindingLevel::kAttention};
    finding.sentence =
        "the measured positions do not fit this arm wherever its base and "
        "tool are: half of them are more than " +
        FormatLength(misfit, 3) + " off";
    const std::vector<InputMistake> singles = SingleMistakes(arm_);
    std::vector<Cure> cures = FindCures(singles);
    const InputMistake inverse = InverseMistake();
    AddInverse(inverse, &cures);
    if (cures.empty()) {
      if (const auto stations = TwoStations()) {
        finding.sentence +=
            ". They fit in two parts, each with a base of its "
            "own";
        return {finding, true, stations->first_of_second};
      }
    }
    // Two that explain it as well are as possible: a joint that counts the
    // other way may be two others that do.
    std::vector<std::string> found;
    for (const Cure& cure : cures) found.push_back(cure.mistake->text);
    const std::vector<InputMistake> doubles = DoubleMistakes(arm_, found);
    const double best = BestRelative(cures);
    for (Cure& cure : FindCures(doubles)) {
      if (cure.Relative() <= kAlike * best) cures.push_back(std::move(cure));
    }
    // A zero that is degrees off, which the calibration itself will find.
    if (cures.empty() &&
        IsExplained(sample_, SolvedMisfit(arm_, sample_, true))) {
      return {};
    }
    const bool is_whole = KeepWhole(&cures);
    finding.sentence += Describe(cures);
    if (!is_whole) {
      finding.sentence +=
          ". But this is not all: base and tool would have to be elsewhere "
          "than stated. Identify them too, or look for a further mistake that "
          "they would take up";
    }
    return {finding, !cures.empty()};
  }

 private:
  // Noise is no mistake, however little the positions lie apart.
  double Tolerated(const PositionSample& sample, double of_reach,
                   double of_extent) const {
    return std::max(noise_, std::min(of_reach * reach_,
                                     of_extent * ExtentOf(sample.points)));
  }

  bool IsExplained(const PositionSample& sample, double solved) const {
    return solved <= Tolerated(sample, kSolvedTolerated, kSolvedExplains);
  }

  // Those that explain the data after a calibration, the best and what is as
  // good. Cheap looks choose which are worth an expensive one.
  std::vector<Cure> FindCures(const std::vector<InputMistake>& mistakes) const {
    std::vector<Cure> cures;
    for (const InputMistake& mistake : mistakes) {
      PositionSample mended = sample_;
      mistake.mend(&mended);
      const double misfit = MisfitAsStated(arm_, mended);
      cures.push_back({&mistake, std::move(mended), misfit});
    }
    KeepBest(kMostFitted, &cures);
    for (Cure& cure : cures) cure.misfit = Misfit(arm_, cure.mended);
    KeepBest(kMostSolved, &cures);
    for (Cure& cure : cures) cure.misfit = SolvedMisfit(arm_, cure.mended);
    KeepBest(kMostSolved, &cures);
    const double best = cures.front().Relative();
    std::vector<Cure> explaining;
    for (Cure& cure : cures) {
      if (IsCure(cure) && cure.Relative() <= kAlike * best) {
        explaining.push_back(std::move(cure));
      }
    }
    // Which of several that explain it alike is the best, rounding decides.
    std::sort(explaining.begin(), explaining.end(),
              [](const Cure& a, const Cure& b) {
                return std::less<>()(a.mistake, b.mistake);
              });
    return explaining;
  }

  // Infinite where there is none.
  static double BestRelative(const std::vector<Cure>& cures) {
    double best = kInfinity;
    for (const Cure& cure : cures) best = std::min(best, cure.Relative());
    return best;
  }

  bool IsCure(const Cure& cure) const {
    const Cure as_read{nullptr, sample_, solved_};
    return IsExplained(cure.mended, cure.misfit) &&
           kClearlyBetter * cure.Relative() < as_read.Relative();
  }

  void AddInverse(const InputMistake& mistake, std::vector<Cure>* cures) const {
    if (!inverse_) return;
    const Cure cure{&mistake, *inverse_, SolvedMisfit(arm_, *inverse_)};
    if (!IsCure(cure)) return;
    if (cure.Relative() <= kAlike * BestRelative(*cures)) {
      cures->push_back(cure);
    }
  }

  // Each part has to fit alone, with the nominal arm and after a calibration.
  std::optional<StationChange> TwoStations() const {
    const auto change = FindStationChange(arm_, sample_);
    if (!change) return std::nullopt;
    for (const PositionSample& part :
         {TakePart(sample_, 0, change->column),
          TakePart(sample_, change->column, sample_.size())}) {
      if (!(Misfit(arm_, part) <= Tolerated(part, kTolerated, kExplains)) ||
          !IsExplained(part, SolvedMisfit(arm_, part))) {
        return std::nullopt;
      }
    }
    return change;
  }

  // Cures that are whole with what is known of base and tool; all of them, and
  // false, where none is.
  bool KeepWhole(std::vector<Cure>* cures) const {
    if ((candidates_.base && candidates_.tool) || cures->empty()) return true;
    std::vector<Cure> whole;
    for (const Cure& cure : *cures) {
      const double misfit = SolvedMisfit(arm_, cure.mended, false, candidates_);
      if (IsExplained(cure.mended, misfit)) whole.push_back(cure);
    }
    if (whole.empty()) return false;
    *cures = std::move(whole);
    return true;
  }

  static std::string Describe(const std::vector<Cure>& cures) {
    if (cures.empty()) {
      return ". No single mistake of units, columns or signs explains it, nor "
             "two together: check whether the arm file describes the arm that "
             "was measured";
    }
    double misfit = kInfinity;
    for (const Cure& cure : cures) misfit = std::min(misfit, cure.misfit);
    const std::string error = FormatLength(misfit, 2);
    const std::string how =
        " (calibrated with two thirds of them, the others "
        "are " +
        error + " off)";
    if (cures.size() == 1) {
      return ". They fit" + how + " if " + cures.front().mistake->text;
    }
    constexpr std::size_t kMostNamed = 4;
    std::vector<std::string> texts;
    for (const Cure& cure : cures) {
      if (texts.size() == kMostNamed) {
        texts.emplace_back("others");
        break;
      }
      texts.push_back(cure.mistake->text);
    }
    return ". Several mistakes explain it alike" + how +
           ", since base and tool can imitate one by another; look which is "
           "there: " +
           Join(texts, "; or ");
  }

  const Arm& arm_;
  const PositionSample& sample_;
  const std::optional<PositionSample>& inverse_;
  const CandidateGroups& candidates_;
  double reach_ = 0.0;
  double noise_ = 0.0;         // residuals (m) that sigma explains
  double solved_ = kInfinity;  // as read
};

}  // namespace

InputDiagnosis FindMistakes(const Arm& arm, const PositionSample& sample,
                            const std::optional<PositionSample>& inverse,
                            const CandidateGroups& candidates, double sigma) {
  return MistakeSearch(arm, sample, inverse, candidates, sigma).Run();
}

}  // namespace alidade::internal
