#include "src/job/import_data.h"

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "alidade/error.h"
#include "src/calibration/position_fit.h"
#include "src/calibration/position_sample.h"
#include "src/common/format.h"
#include "src/common/names.h"
#include "src/common/number_text.h"
#include "src/dataio/column_roles.h"
#include "src/dataio/csv_columns.h"
#include "src/dataio/csv_lines.h"
#include "src/dataio/dataset_columns.h"
#include "src/dataio/dataset_csv.h"
#include "src/dataio/dataset_npy.h"
#include "src/job/import_text.h"
#include "src/job/lost_targets.h"
#include "src/job/orientation_misfit.h"
#include "src/job/rotation_search.h"
#include "src/job/unused_columns.h"
#include "src/model/motors.h"

namespace alidade::internal {
namespace {

// Angles of an orientation beyond it are in degrees: a little more than 2 pi.
constexpr double kTurn = 6.4;

std::vector<std::string> Numbers(const std::vector<int>& columns) {
  std::vector<std::string> numbers;
  for (const int column : columns) numbers.push_back(std::to_string(column));
  return numbers;
}

const StatedDialect& DialectOf(const ImportRequest& request) {
  if (IsNpy(request.path)) {
    throw InputError({request.path, 0, 0, ""},
                     "an array states its columns: jobs read it as it is");
  }
  return request.dialect;
}

std::vector<std::string> TargetNames(const Arm& arm) {
  std::vector<std::string> names;
  for (const Target& target : arm.targets) names.push_back(target.name);
  return names;
}

class Importer {
 public:
  explicit Importer(const ImportRequest& request)
      : request_(request),
        text_(request.path, DialectOf(request), request.exclude),
        names_(text_.names()) {
    format_.dialect = request.dialect;
    format_.exclude = request.exclude;
  }

  ImportedData Import() {
    DescribeText();
    text_.RefuseShortRows();
    roles_ = FindColumnRoles(request_.path, names_, NumMotors(request_.arm),
                             TargetNames(request_.arm));
    text_.RefuseEmptyAtEnd(roles_.joints);
    NoteEmptyAtEnd();
    SetFormat();
    FindUnits();
    const ColumnMapping& columns = format_.columns;
    // First: what was written in place of angles says nothing of their unit.
    LeaveOutLost(LoadWith(columns.length_unit, columns.angle_unit).data,
                 ArmReach(request_.arm));
    FindRotationUnit();
    LoadedData loaded = Load(format_);
    Describe(loaded);
    DescribeOwn();
    NoteRotation(loaded.data);
    NoteUnused();
    FindPlaces(loaded.data);
    result_.num_rows =
        static_cast<int>(loaded.data.num_poses() +
                         static_cast<Eigen::Index>(loaded.rejected.size())) +
        num_lost_;
    result_.loaded = std::move(loaded);
    return std::move(result_);
  }

 private:
  void NoteEmptyAtEnd() {
    const std::vector<int> lines = text_.EmptyAtEnd(Positions());
    if (lines.size() < 2) return;
    result_.notes.push_back(
        "the last rows have no positions (lines " + LinesText(lines) +
        "): if columns have slipped, pasted a few rows higher than the "
        "others, all rows are wrong");
  }

  void NoteUnused() {
    LineRanges excluded = format_.dialect.excluded_lines;
    // A job leaves rows out, no single positions.
    for (const auto& [line, target] : lost_positions_) excluded.Add(line, line);
    for (const std::string& note :
         NotesOnUnused(result_.columns, {request_, roles_, text_, excluded})) {
      result_.notes.push_back(note);
    }
  }

  void DescribeText() {
    result_.notes = text_.Notes();
    for (const std::string& name : names_) {
      result_.columns.push_back({name, "", "", ""});
    }
    bool is_first = true;
    text_.VisitRows([&](const ImportText::Cells& cells, int /*line*/) {
      if (!std::exchange(is_first, false)) return;
      for (std::size_t i = 0; i < std::min(names_.size(), cells.size()); ++i) {
        result_.columns[i].first = TextOf(cells[i]);
      }
    });
  }

  void FindPlaces(const Dataset& data) {
    std::map<int, std::string> labels;
    if (result_.columns.front().use.empty()) {
      const std::string name = names_[0] == "1" ? "" : names_[0] + " ";
      text_.VisitRows([&](const ImportText::Cells& cells, int line) {
        labels[line] = WithoutMarks(name + TextOf(cells[0]));
      });
    }
    for (std::size_t i = 0; i < data.sources.size(); ++i) {
      const int line = data.sources[i].line;
      const std::string place = "line " + std::to_string(line);
      const auto label = labels.find(line);
      result_.places.push_back(
          label == labels.end() ? place : label->second + " (" + place + ")");
    }
  }

  // What needs no quotes in a CSV, nor is looked at as a mark of numbers.
  static std::string WithoutMarks(std::string text) {
    const auto is_mark = [](char c) {
      return c == ',' || c == '"' || c == '\'';
    };
    std::replace_if(text.begin(), text.end(), is_mark, ' ');
    return OneLine(text);
  }

  void SetFormat() {
    format_.sigma = kUnstatedSigma;
    format_.ignore_others = true;
    format_.poses_only = true;
    format_.logs_findings = false;
    ColumnMapping& columns = format_.columns;
    columns.joints = Numbers(roles_.joints);
    columns.position = Numbers(roles_.position);
    for (const auto& [name, position] : roles_.targets) {
      columns.targets.emplace_back(name, Numbers(position));
    }
    format_.rotation = request_.rotation;
    const bool has_angles = !roles_.angles.empty() && request_.rotation;
    if (!roles_.quaternion.empty()) {
      columns.orientation = Numbers(roles_.quaternion);
    } else if (!roles_.matrix.empty()) {
      columns.orientation = Numbers(roles_.matrix);
    } else if (has_angles) {
      columns.orientation = Numbers(roles_.angles);
    } else {
      format_.ignore_rotation = true;
    }
    const Arm& arm = request_.arm;
    if (arm.num_targets() > 1 && roles_.targets.empty() &&
        std::find(names_.begin(), names_.end(), "target") == names_.end()) {
      throw InputError({request_.path, 0, 0, "target"},
                       "arm " + Quote(arm.name) + " has the targets " +
                           JoinNames(TargetNames(arm)) +
                           ", expected a column target that names one of "
                           "them, or columns of each (" +
                           arm.targets[0].name + " X, " + arm.targets[0].name +
                           " Y ...)");
    }
  }

  bool NeedsUnit(const std::vector<int>& columns) const {
    return std::any_of(columns.begin(), columns.end(), [&](int column) {
      return !StatesUnit(names_[static_cast<std::size_t>(column) - 1]);
    });
  }

  LoadedData Load(const DataFormat& format) const {
    References references;
    LoadedData loaded =
        LoadData(request_.path, request_.arm, format, &references);
    DropPositions(lost_positions_, &loaded.data);
    return loaded;
  }

  // Those that a table may have without saying so.
  std::vector<const Unit*> Candidates(
      const std::vector<int>& columns, const Unit* stated,
      const std::vector<const char*>& names) const {
    if (stated != nullptr) return {stated};
    if (!NeedsUnit(columns)) return {nullptr};
    std::vector<const Unit*> units;
    for (const char* name : names) units.push_back(FindHeaderUnit(name));
    return units;
  }

  // The columns of all positions.
  std::vector<int> Positions() const {
    std::vector<int> columns = roles_.position;
    for (const auto& [name, position] : roles_.targets) {
      columns.insert(columns.end(), position.begin(), position.end());
    }
    return columns;
  }

  // By the fit of the positions to the nominal arm with any base and tool.
  void FindUnits() {
    const std::vector<const Unit*> lengths =
        Candidates(Positions(), request_.length_unit, {"mm", "m", "in"});
    const std::vector<const Unit*> angles =
        Candidates(roles_.joints, request_.angle_unit, {"deg", "rad"});
    if (lengths.size() * angles.size() > 1) {
      // In no unit yet, the reach is about what positions are apart.
      const Dataset data = LoadWith(lengths[0], angles[0]).data;
      LeaveOutLost(data, 2.0 * TypicalDistance(data));
    }
    std::vector<std::pair<double, std::pair<const Unit*, const Unit*>>> fits;
    for (const Unit* length : lengths) {
      for (const Unit* angle : angles) {
        const bool is_only = lengths.size() * angles.size() == 1;
        fits.emplace_back(is_only ? 0.0 : MisfitWith(length, angle),
                          std::pair{length, angle});
      }
    }
    std::sort(fits.begin(), fits.end(),
              [](const auto& a, const auto& b) { return a.first < b.first; });
    constexpr double kFits = 0.02;  // of the reach, as plausibility.h has it
    constexpr double kClear = 5.0;
    const bool is_certain =
        fits.size() == 1 || (fits[0].first < kFits * ArmReach(request_.arm) &&
                             fits[1].first > kClear * fits[0].first);
    if (!is_certain) FailUnits();
    std::tie(format_.columns.length_unit, format_.columns.angle_unit) =
        fits[0].second;
    if (fits.size() > 1) {
      result_.notes.push_back(
          "units that names do not state are those under which the positions "
          "fit the arm, to " +
          FormatSignificant(fits[0].first * 1e3, 2) + " mm");
    }
  }

  LoadedData LoadWith(const Unit* length, const Unit* angle) const {
    DataFormat format = format_;
    format.ignore_rotation = true;
    format.columns.orientation.clear();
    format.columns.length_unit = length;
    format.columns.angle_unit = angle;
    return Load(format);
  }

  double MisfitWith(const Unit* length, const Unit* angle) const {
    const LoadedData loaded = LoadWith(length, angle);
    const std::optional<PositionSample> sample =
        SamplePositions(loaded.data, SingleProcess());
    return sample ? Misfit(request_.arm, *sample)
                  : std::numeric_limits<double>::infinity();
  }

  [[noreturn]] void FailUnits() const {
    throw InputError(
        {request_.path, 0, 0, ""},
        "the names of columns state no units, and under none, or several, of "
        "mm, m, inches, degrees and radians do the positions fit the arm: "
        "expected --units=mm,deg, or another arm; or joint values and "
        "positions are not of the same poses, as where columns have slipped "
        "by some rows");
  }

  const Unit* StatedRotationUnit() const {
    return request_.rotation_unit != nullptr ? request_.rotation_unit
                                             : request_.angle_unit;
  }

  // Of three angles, whose unit may be another than that of the joints.
  void FindRotationUnit() {
    ColumnMapping& columns = format_.columns;
    if (columns.orientation.size() != 3 || !NeedsUnit(roles_.angles)) return;
    columns.rotation_unit = StatedRotationUnit();
    if (columns.rotation_unit != nullptr) return;
    const double largest = text_.LargestOf(roles_.angles, format_.dialect);
    if (largest > kTurn) {
      columns.rotation_unit = FindHeaderUnit("deg");
      result_.notes.push_back(
          "angles of the orientation are in degrees: the largest is " +
          FormatSignificant(largest, 3));
      return;
    }
    const std::optional<double> degrees = RotationMisfitWith("deg");
    const std::optional<double> radians = RotationMisfitWith("rad");
    constexpr double kClear = 3.0;
    if (degrees && radians) {
      const bool are_degrees = *degrees < *radians;
      const auto [best, other] = std::minmax(*degrees, *radians);
      if (best < kOrientationFits && other > kClear * best) {
        columns.rotation_unit = FindHeaderUnit(are_degrees ? "deg" : "rad");
        result_.notes.push_back(
            std::string("angles of the orientation are in ") +
            (are_degrees ? "degrees" : "radians") +
            ": so they fit the arm, to " +
            FormatSignificant(best / kDegree, 2) + " deg");
        return;
      }
    }
    const std::string& name =
        names_[static_cast<std::size_t>(roles_.angles.front()) - 1];
    throw InputError({request_.path, 0, 0, name},
                     "the unit of the orientation's angles is not stated, and "
                     "the arm does not show it: expected --units=mm,rad,deg "
                     "(of lengths, joints and orientation), or units in the "
                     "headers (" +
                         name + "_deg); or another --rotation");
  }

  // What the arm says of the convention of three angles.
  void NoteRotation(const Dataset& data) {
    if (roles_.angles.empty()) return;
    constexpr Eigen::Index kMostPoses = 5000;  // that are read 25 times
    const std::optional<FittingRotation> found =
        data.num_poses() > kMostPoses ? std::nullopt : SearchRotation();
    std::string note =
        "three angles state an orientation in many ways: they are passed over, "
        "--rotation=CONVENTION reads them";
    if (format_.columns.orientation.size() == 3) {
      const std::optional<double> misfit =
          OrientationMisfit(request_.arm, data);
      constexpr double kClear = 3.0;
      const bool fits = misfit && *misfit < kOrientationFits &&
                        !(found && *misfit > kClear * found->misfit);
      if (!misfit || fits) return;
      note = "under this --rotation orientations are " +
             FormatSignificant(*misfit / kDegree, 2) +
             " deg off those of the arm";
    }
    if (found) {
      note += "; they fit the arm as " + found->names + ", to " +
              FormatSignificant(found->misfit / kDegree, 2) + " deg";
    }
    result_.notes.push_back(note);
  }

  std::optional<FittingRotation> SearchRotation() const {
    DataFormat format = format_;
    format.ignore_rotation = false;
    format.columns.orientation = Numbers(roles_.angles);
    const Unit*& unit = format.columns.rotation_unit;
    if (unit == nullptr) unit = StatedRotationUnit();
    if (unit == nullptr) {
      unit = FindHeaderUnit(
          text_.LargestOf(roles_.angles, format_.dialect) > kTurn ? "deg"
                                                                  : "rad");
    }
    try {
      return FindFittingRotation(request_.arm,
                                 [&](const RotationConvention& rotation) {
                                   format.rotation = rotation;
                                   return Load(format).data;
                                 });
    } catch (const InputError&) {
      return std::nullopt;  // they may be no angles at all
    }
  }

  std::optional<double> RotationMisfitWith(const char* unit) const {
    DataFormat format = format_;
    format.columns.rotation_unit = FindHeaderUnit(unit);
    return OrientationMisfit(request_.arm, Load(format).data);
  }

  void LeaveOutLost(const Dataset& data, double reach) {
    const LostTargets lost = FindLostTargets(data, reach);
    for (const int line : lost.lines) {
      format_.dialect.excluded_lines.Add(line, line);
    }
    num_lost_ += static_cast<int>(lost.lines.size());
    lost_positions_.insert(lost.positions.begin(), lost.positions.end());
    std::vector<std::string>& notes = result_.notes;
    for (const std::string& note : lost.Describe(request_.arm)) {
      if (std::find(notes.begin(), notes.end(), note) == notes.end()) {
        notes.push_back(note);
      }
    }
  }

  void SetUse(const std::vector<int>& columns,
              const std::vector<std::string>& uses, const Unit* unit) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      ImportedColumn& column =
          result_.columns[static_cast<std::size_t>(columns[i]) - 1];
      column.use = uses.empty() ? "joint " + std::to_string(i + 1) : uses[i];
      if (StatesUnit(column.name)) {
        const std::size_t begin = WithoutUnit(column.name).size();
        column.unit = UnitNameOf(column.name.substr(begin));
      } else if (unit != nullptr) {
        column.unit = unit->name;
      }
    }
  }

  static std::string UnitNameOf(std::string text) {
    text.erase(0, text.find_first_not_of(" _/"));
    const Unit* const unit = FindHeaderUnit(text);
    return unit == nullptr ? "" : unit->name;
  }

  // By Alidade's own names columns are read beside those that were found.
  void DescribeOwn() {
    const std::vector<ColumnSpec> specs =
        MakeDatasetColumns(request_.arm, format_).specs;
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (!result_.columns[i].use.empty()) continue;
      const int number = static_cast<int>(i) + 1;
      for (const ColumnSpec& spec : specs) {
        if (spec.is_ignored || !spec.mapped.empty()) continue;
        if (!IsNamed(spec, names_[i], number)) continue;
        const bool is_length_or_angle =
            spec.type != ColumnType::kPlain && spec.type != ColumnType::kText;
        const Unit* const unit =
            is_length_or_angle ? UnitOf(spec, names_[i]) : nullptr;
        if (is_length_or_angle && unit == nullptr) continue;
        SetUse({number}, {spec.base}, unit);
      }
    }
  }

  void Describe(const LoadedData& loaded) {
    const ColumnMapping& units = format_.columns;
    SetUse(roles_.joints, {}, units.angle_unit);
    SetUse(roles_.position, {"x", "y", "z"}, units.length_unit);
    for (const auto& [name, position] : roles_.targets) {
      SetUse(position, {name + " x", name + " y", name + " z"},
             units.length_unit);
    }
    SetUse(roles_.matrix,
           {"r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33"},
           nullptr);
    SetUse(roles_.quaternion, {"qw", "qx", "qy", "qz"}, nullptr);
    if (request_.rotation) {
      SetUse(roles_.angles, {"rx", "ry", "rz"}, units.rotation_unit);
    }
    std::vector<std::string> lines;
    for (const RejectedRow& row : loaded.rejected) {
      lines.push_back(std::to_string(row.line));
    }
    if (!lines.empty()) {
      result_.notes.push_back("nothing was measured in line " +
                              JoinNames(lines));
    }
  }

  const ImportRequest& request_;
  const ImportText text_;
  const std::vector<std::string>& names_;
  ColumnRoles roles_;
  DataFormat format_;
  int num_lost_ = 0;                              // rows
  std::set<std::pair<int, int>> lost_positions_;  // of other rows
  ImportedData result_;
};

}  // namespace

ImportedData ImportData(const ImportRequest& request) {
  return Importer(request).Import();
}

}  // namespace alidade::internal
