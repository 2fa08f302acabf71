#include "src/calibration/plausibility.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/forward_kinematics.h"
#include "src/calibration/input_mistakes.h"
#include "src/calibration/position_fit.h"
#include "src/calibration/position_sample.h"
#include "src/calibration/sigma_estimation.h"
#include "src/calibration/stations.h"
#include "src/common/format.h"
#include "src/common/number_text.h"
#include "src/common/text.h"
#include "src/kernel/partition.h"

namespace alidade::internal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

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

class Diagnosis {
 public:
  /// `inverse`: the same of the inverse poses, where poses were measured.
  Diagnosis(const Arm& arm, const PositionSample& sample,
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
    const double best = BestRelative(*cures);
    if (cure.Relative() > kAlike * best) return;
    cures->insert(cure.Relative() < best ? cures->begin() : cures->end(), cure);
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

// How many rows are lost, and what is known of them here.
struct LostRows {
  std::int64_t count = 0;
  std::string first;       // where it was read
  Eigen::Vector3d point;   // of the first
  std::vector<int> lines;  // of the same file, in ascending order

  // "leave them out by `exclude: [12, 40]` in `data`"
  std::string Cure() const {
    constexpr std::size_t kMostNamed = 12;
    std::string text = "leave the rows out";
    if (lines.empty()) return text;
    std::vector<std::string> numbers;
    for (const int line : lines) {
      if (numbers.size() == kMostNamed) break;
      numbers.push_back(std::to_string(line));
    }
    if (lines.size() > kMostNamed) numbers.emplace_back("...");
    return text + " by `exclude: [" + Join(numbers, ", ") + "]` in `data`";
  }
};

// Those of which is_lost().
template <typename IsLost>
LostRows FindLost(const Dataset& data, Communicator* communicator,
                  const IsLost& is_lost) {
  LostRows lost;
  for (const ObservationBlock& block : data.blocks) {
    if (!HoldsPosition(block.kind)) continue;
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      const auto sigmas = block.sigmas.col(i).head<3>();
      if (!sigmas.allFinite() || !is_lost(block.measured.col(i).head<3>())) {
        continue;
      }
      if (++lost.count == 1) {
        lost.first = SourceOf(data, block.pose(i));
        lost.point = block.measured.col(i).head<3>();
      }
      if (data.files.size() == 1 && !data.sources.empty()) {
        lost.lines.push_back(data.sources[block.pose(i)].line);
      }
    }
  }
  std::sort(lost.lines.begin(), lost.lines.end());
  lost.count = SumOverRanks(communicator, data, lost.count);
  return lost;
}

bool IsOneNumber(const Eigen::Vector3d& point) {
  return point[0] == point[1] && point[1] == point[2];
}

Eigen::Vector3d MedianPoint(const PositionSample& sample) {
  Eigen::Vector3d median;
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::VectorXd values = sample.points.row(axis);
    double* const middle = values.data() + values.size() / 2;
    std::nth_element(values.data(), middle, values.data() + values.size());
    median[axis] = *middle;
  }
  return median;
}

// A few positions that no arm of this size can reach from the others.
std::optional<Finding> DiagnoseFar(const Arm& arm, const Dataset& data,
                                   const PositionSample& sample,
                                   Communicator* communicator) {
  constexpr double kFar = 8.0;       // of the reach
  constexpr double kFarOfOne = 2.5;  // where x, y and z are one number
  constexpr double kFewPart = 0.2;   // of the positions
  Arm at_origin = arm;
  at_origin.instrument_from_base.setIdentity();
  const double far = kFar * Reach(at_origin);
  const Eigen::Vector3d median = MedianPoint(sample);
  double nearest = std::numeric_limits<double>::infinity();
  const LostRows lost =
      FindLost(data, communicator, [&](const Eigen::Vector3d& point) {
        const double distance = (point - median).norm();
        const double limit =
            (IsOneNumber(point) && !point.isZero(0.0) ? kFarOfOne / kFar
                                                      : 1.0) *
            far;
        if (distance <= limit) return false;
        nearest = std::min(nearest, limit);
        return true;
      });
  if (lost.count == 0 ||
      static_cast<double>(lost.count) >
          kFewPart * static_cast<double>(data.global_poses())) {
    return std::nullopt;
  }
  return Finding{
      "plausibility.far_positions", static_cast<double>(lost.count), 0.0,
      (lost.first.empty() ? "" : lost.first + ": ") +
          Count(lost.count, "position") + (lost.count == 1 ? " is" : " are") +
          " more than " +
          FormatLength(std::isfinite(nearest) ? nearest : far, 2) +
          " from the others, which no arm of this size reaches: "
          "instruments write such numbers when they have lost the target. "
          "State the number that stands for that (`missing: [-9999]` in "
          "`data`), or " +
          lost.Cure(),
      FindingLevel::kFailed};
}

// Positions that stay where they are while the joints move.
std::optional<Finding> DiagnoseStill(const Arm& arm,
                                     const PositionSample& sample) {
  // Of what the nominal arm moves its target: m that were read as mm are 1e-3.
  constexpr double kStill = 2e-4;
  const double measured = ExtentOf(sample.points);
  const double expected = ExtentOf(TargetPositions(arm, sample.joint_values));
  if (measured >= kStill * expected) return std::nullopt;
  return Finding{"plausibility.still_positions", measured, kStill * expected,
                 "the measured positions lie within " +
                     FormatLength(measured, 2) +
                     " where these joint values move the target by " +
                     FormatLength(expected, 2) +
                     ": the instrument had stopped, or one row was copied. "
                     "Look at the position columns",
                 FindingLevel::kFailed};
}

// Of "file:line"; 0 of nothing.
int LineOf(const std::string& where) {
  return where.empty() ? 0 : std::stoi(where.substr(where.rfind(':') + 1));
}

// Where the second station begins, if this rank knows it.
void AddStations(const Dataset& data, InputDiagnosis* diagnosis) {
  const Eigen::Index number = diagnosis->first_of_second_station;
  std::string where = PlaceOfPosition(data, number);
  const int line = LineOf(where);
  const int before = number > 0 ? LineOf(PlaceOfPosition(data, number - 1)) : 0;
  if (where.empty()) where = "position " + std::to_string(number + 1);
  diagnosis->finding->sentence +=
      " (from about " + where +
      " on): the instrument was moved, or set up anew. Say which lines of the "
      "file belong to which place, and each has a base of its own: " +
      (line > 1 ? "`stations: {first: 1-" + std::to_string(line - 1) +
                      ", second: " + std::to_string(line) + "-}` in `data`"
                : std::string("`stations` in `data`, or a column of them"));
  if (before > 0 && before + 1 < line) {
    diagnosis->finding->sentence +=
        ". Rows between lines " + std::to_string(before) + " and " +
        std::to_string(line) +
        " are held out or left out, and may be of either";
  }
}

}  // namespace

InputDiagnosis DiagnoseInput(const Arm& arm, const Dataset& data,
                             const CandidateGroups& candidates,
                             Communicator* communicator,
                             const Dataset* held_out) {
  std::optional<PositionSample> sample = SamplePositions(data, communicator);
  if (!sample) return {};
  if (auto far = DiagnoseFar(arm, data, *sample, communicator)) {
    return {std::move(far), true};
  }
  if (auto still = DiagnoseStill(arm, *sample)) return {std::move(still), true};
  const std::optional<PositionSample> inverse =
      data.Has(MeasurementKind::kPose)
          ? SamplePositions(WithInversePoses(data), communicator)
          : std::nullopt;
  const std::optional<Dataset> rows =
      held_out != nullptr ? PositionsInRowOrder(data, *held_out) : std::nullopt;
  if (rows) {
    auto in_order = SamplePositions(*rows, SingleProcess());
    if (in_order) sample = std::move(in_order);
  }
  InputDiagnosis diagnosis = Diagnosis(arm, *sample, inverse, candidates,
                                       MedianLengthSigma(data, communicator))
                                 .Run();
  if (diagnosis.first_of_second_station > 0) {
    AddStations(rows ? *rows : data, &diagnosis);
  }
  return diagnosis;
}

std::optional<Finding> DiagnoseLost(const Dataset& data,
                                    Communicator* communicator) {
  const LostRows lost = FindLost(data, communicator, IsOneNumber);
  if (lost.count == 0) return std::nullopt;
  const bool is_one = lost.count == 1;
  const bool is_zero = lost.point.isZero(0.0);
  const std::string missing =
      is_zero ? ""
              : ", state what stands for that (`missing: [" +
                    ShortestNumber(NumberOrNan(
                        FormatSignificant(lost.point[0] / kMillimetre, 6))) +
                    "]` in `data`)";
  return Finding{
      is_zero ? "plausibility.zero_positions" : "plausibility.one_number",
      static_cast<double>(lost.count), 0.0,
      (lost.first.empty() ? "" : lost.first + ": ") +
          std::to_string(lost.count) +
          (is_zero ? (is_one ? " position is exactly 0, 0, 0"
                             : " positions are exactly 0, 0, 0")
                   : (is_one ? " position has" : " positions have") +
                         std::string(" the same number in x, y and z (") +
                         FormatLength(lost.point[0], 6) + ")") +
          ", which instruments write when they have lost the target: empty "
          "these cells" +
          missing + " or " + lost.Cure(),
      FindingLevel::kAttention};
}

std::optional<Finding> DiagnoseStale(const MeasurementModel& model,
                                     const Eigen::VectorXd& values,
                                     const Dataset& data) {
  constexpr double kMoved = 10.0;  // standard deviations
  if (data.partition) return std::nullopt;
  LostRows stale;
  for (const ObservationBlock& block : data.blocks) {
    if (!HoldsPosition(block.kind)) continue;
    for (Eigen::Index i = 1; i < block.size(); ++i) {
      if (block.measured.col(i) != block.measured.col(i - 1)) continue;
      const double sigma = block.sigmas.col(i).head<3>().maxCoeff();
      if (!std::isfinite(sigma) || block.target(i) != block.target(i - 1)) {
        continue;
      }
      Eigen::MatrixXd joints(data.num_joints(), 2);
      joints << data.joint_values.col(block.pose(i - 1)),
          data.joint_values.col(block.pose(i));
      const Eigen::Matrix3Xd points =
          model.Predict(values, joints, block.target(i));
      if ((points.col(1) - points.col(0)).norm() <= kMoved * sigma) continue;
      if (++stale.count == 1) stale.first = SourceOf(data, block.pose(i));
      if (data.files.size() == 1 && !data.sources.empty()) {
        stale.lines.push_back(data.sources[block.pose(i)].line);
      }
    }
  }
  if (stale.count == 0) return std::nullopt;
  return Finding{
      "plausibility.stale_readings", static_cast<double>(stale.count), 0.0,
      (stale.first.empty() ? "" : stale.first + ": ") +
          Count(stale.count, "measurement") +
          (stale.count == 1 ? " is" : " are") +
          " exactly the one before, although the arm had moved in between: the "
          "instrument had not measured anew. " +
          AsSentence(stale.Cure()),
      FindingLevel::kAttention};
}

}  // namespace alidade::internal
