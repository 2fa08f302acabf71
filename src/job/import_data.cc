#include "src/job/import_data.h"

#include <algorithm>
#include <cmath>
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
#include "src/common/text.h"
#include "src/dataio/column_roles.h"
#include "src/dataio/csv_columns.h"
#include "src/dataio/csv_layout.h"
#include "src/dataio/csv_lines.h"
#include "src/dataio/dataset_csv.h"
#include "src/dataio/dataset_npy.h"
#include "src/dataio/text_encoding.h"
#include "src/model/motors.h"

namespace alidade::internal {
namespace {

constexpr Eigen::Index kPosesToHoldOut = 20;

std::vector<std::string> Numbers(const std::vector<int>& columns) {
  std::vector<std::string> numbers;
  for (const int column : columns) numbers.push_back(std::to_string(column));
  return numbers;
}

class Importer {
 public:
  explicit Importer(const ImportRequest& request) : request_(request) {
    if (IsNpy(request.path)) {
      throw InputError({request.path, 0, 0, ""},
                       "an array states its columns: jobs read it as it is");
    }
  }

  ImportedData Import() {
    ReadLayout();
    roles_ = FindColumnRoles(request_.path, names_, NumMotors(request_.arm));
    SetFormat();
    FindUnits();
    LoadedData loaded = Load(format_);
    if (LeaveOutLost(loaded.data, ArmReach(request_.arm))) {
      loaded = Load(format_);
    }
    Describe(loaded);
    NoteUnused();
    FindPlaces(loaded.data);
    result_.loaded = std::move(loaded);
    return std::move(result_);
  }

 private:
  // Columns that are passed over and look as if they said something of use.
  void NoteUnused() {
    const auto is_unused = [&](const std::string& name) {
      return std::any_of(result_.columns.begin(), result_.columns.end(),
                         [&](const ImportedData::Column& column) {
                           return column.use.empty() && column.name == name;
                         });
    };
    for (const ImportedData::Column& column : result_.columns) {
      const std::string& name = column.name;
      if (!column.use.empty() ||
          (name != "station" && name != "Station" && name != "STATION")) {
        continue;
      }
      result_.notes.emplace_back(
          "where the instrument stood is passed over: in the job, `data: "
          "{file: data.csv, stations: {NAME: FIRST-LAST, ...}}` gives each "
          "place a base of its own, by lines of that file");
    }
    if (is_unused("A") && is_unused("B") && is_unused("C")) {
      result_.notes.emplace_back(
          "A, B and C are passed over: where they are KUKA's angles, rename "
          "them rz, ry and rx, and state --rotation=intrinsic_zyx");
    }
  }

  void ReadLayout() {
    const TextFile text = OpenText(MappedFile(request_.path));
    const std::string_view all = text.file.text().substr(text.begin);
    format_.dialect.excluded_lines = request_.excluded_lines;
    format_.exclude = request_.exclude;
    const CsvLayout layout = FindCsvLayout(request_.path, all, format_.dialect);
    names_ = layout.names;
    separator_ = layout.dialect.separator;
    if (names_.empty()) {
      throw InputError({request_.path, 0, 0, ""}, "holds no table");
    }
    if (!text.encoding.empty()) {
      result_.notes.push_back("the text is " + text.encoding);
    }
    result_.notes.insert(result_.notes.end(), layout.notes.begin(),
                         layout.notes.end());
    std::string_view rest = all.substr(layout.rows);
    std::vector<std::string_view> cells;
    while (!rest.empty() && cells.empty()) {
      const std::string_view line = TakeLine(&rest);
      if (IsPassedOver(line, layout.dialect.separator)) continue;
      SplitCells(line, layout.dialect.separator, &cells);
    }
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const std::string first = i < cells.size() ? TextOf(cells[i]) : "";
      result_.columns.push_back({names_[i], "", "", first});
    }
  }

  void FindPlaces(const Dataset& data) {
    const TextFile text = OpenText(MappedFile(request_.path));
    std::string_view rest = text.file.text().substr(text.begin);
    const bool has_label = result_.columns.front().use.empty();
    const std::string name = names_[0] == "1" ? "" : names_[0] + " ";
    int number = 0;
    std::vector<std::string_view> cells;
    for (std::size_t i = 0; i < data.sources.size(); ++i) {
      std::string_view line;
      for (; number < data.sources[i].line; ++number) line = TakeLine(&rest);
      std::string place = "line " + std::to_string(number);
      if (has_label && SplitCells(line, separator_, &cells) == nullptr) {
        place = WithoutMarks(name + TextOf(cells[0])) + " (" + place + ")";
      }
      result_.places.push_back(place);
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
    format_.logs_findings = false;
    ColumnMapping& columns = format_.columns;
    columns.joints = Numbers(roles_.joints);
    columns.position = Numbers(roles_.position);
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
    if (!roles_.angles.empty() && !has_angles) {
      result_.notes.emplace_back(
          "three angles state an orientation in many ways: they are passed "
          "over, --rotation=CONVENTION reads them");
    }
    const Arm& arm = request_.arm;
    if (arm.num_targets() > 1 &&
        std::find(names_.begin(), names_.end(), "target") == names_.end()) {
      throw InputError({request_.path, 0, 0, "target"},
                       "arm " + Quote(arm.name) +
                           " has several targets, expected a column target "
                           "that names one of them");
    }
  }

  bool NeedsUnit(const std::vector<int>& columns) const {
    return std::any_of(columns.begin(), columns.end(), [&](int column) {
      return !StatesUnit(names_[static_cast<std::size_t>(column) - 1]);
    });
  }

  LoadedData Load(const DataFormat& format) const {
    References references;
    return LoadData(request_.path, request_.arm, format, &references);
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

  // By the fit of the positions to the nominal arm with any base and tool.
  void FindUnits() {
    const std::vector<const Unit*> lengths =
        Candidates(roles_.position, request_.length_unit, {"mm", "m", "in"});
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
        "expected --units=mm,deg, or another arm");
  }

  // Whether there were any.
  bool LeaveOutLost(const Dataset& data, double reach) {
    constexpr double kFar = 20.0;  // reaches
    const double far = kFar * reach;
    const Eigen::Vector3d middle = MedianOf(data);
    const std::set<double> sentinels = SentinelsOf(data, middle, reach);
    std::vector<int> lines;
    std::set<std::string> written;
    ForEachPosition(data, [&](const Eigen::Vector3d& point, int line) {
      const bool is_one = point[0] == point[1] && point[1] == point[2];
      const auto sentinel =
          std::find_if(point.begin(), point.end(),
                       [&](double x) { return sentinels.count(x) > 0; });
      if (!is_one && sentinel == point.end() && (point - middle).norm() < far) {
        return;
      }
      lines.push_back(line);
      if (is_one || sentinel != point.end()) {
        written.insert(
            ShortestNumber(InMillimetres(is_one ? point[0] : *sentinel)) +
            " mm");
      }
    });
    // Most of them are not lost: something else is wrong.
    if (2 * lines.size() > data.sources.size()) return false;
    std::sort(lines.begin(), lines.end());
    std::vector<std::string> names;
    for (const int line : lines) {
      format_.dialect.excluded_lines.emplace_back(line, line);
      names.push_back(std::to_string(line));
    }
    if (!names.empty()) {
      result_.notes.push_back(
          "the target was lost (" +
          (written.empty() ? "out of reach"
                           : JoinNames({written.begin(), written.end()}) +
                                 " in place of a position, or out of reach") +
          ") and the row is left out: line " + JoinNames(names));
    }
    return !names.empty();
  }

  template <typename Use>
  static void ForEachPosition(const Dataset& data, const Use& use) {
    for (const ObservationBlock& block : data.blocks) {
      if (!HoldsPosition(block.kind)) continue;
      for (Eigen::Index i = 0; i < block.size(); ++i) {
        use(Eigen::Vector3d(block.measured.map().col(i).head<3>()),
            data.sources[block.pose(i)].line);
      }
    }
  }

  // Coordinates that stand for none: out of reach, and there again and again
  // or of nines alone.
  static std::set<double> SentinelsOf(const Dataset& data,
                                      const Eigen::Vector3d& middle,
                                      double reach) {
    constexpr double kOutOfReach = 2.5;  // reaches
    constexpr int kOften = 3;
    const double limit = kOutOfReach * reach;
    std::map<double, int> counts;
    ForEachPosition(data, [&](const Eigen::Vector3d& point, int /*line*/) {
      for (int axis = 0; axis < 3; ++axis) {
        if (std::abs(point[axis] - middle[axis]) > limit) {
          ++counts[point[axis]];
        }
      }
    });
    std::set<double> sentinels;
    for (const auto& [value, count] : counts) {
      if (count >= kOften || IsOfNines(value)) sentinels.insert(value);
    }
    return sentinels;
  }

  // As it may have been written: to nine digits.
  static double InMillimetres(double metres) {
    constexpr int kDigits = 9;
    return NumberOrNan(FormatSignificant(metres / kMillimetre, kDigits));
  }

  // 999, -9999.9, in mm or m.
  static bool IsOfNines(double metres) {
    std::string digits = ShortestNumber(std::abs(InMillimetres(metres)));
    digits.erase(std::remove(digits.begin(), digits.end(), '.'), digits.end());
    digits.erase(digits.find_last_not_of('0') + 1);
    return digits.size() > 2 &&
           digits.find_first_not_of('9') == std::string::npos;
  }

  // The median distance of positions from their middle.
  static double TypicalDistance(const Dataset& data) {
    const Eigen::Vector3d middle = MedianOf(data);
    std::vector<double> distances;
    ForEachPosition(data, [&](const Eigen::Vector3d& point, int /*line*/) {
      distances.push_back((point - middle).norm());
    });
    if (distances.empty()) return 0.0;
    const auto half =
        distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), half, distances.end());
    return *half;
  }

  static Eigen::Vector3d MedianOf(const Dataset& data) {
    Eigen::Vector3d median = Eigen::Vector3d::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<double> values;
      for (const ObservationBlock& block : data.blocks) {
        if (!HoldsPosition(block.kind)) continue;
        for (Eigen::Index i = 0; i < block.size(); ++i) {
          values.push_back(block.measured(axis, i));
        }
      }
      if (values.empty()) continue;
      const auto middle =
          values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
      std::nth_element(values.begin(), middle, values.end());
      median[axis] = *middle;
    }
    return median;
  }

  void SetUse(const std::vector<int>& columns,
              const std::vector<const char*>& uses, const Unit* unit) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      ImportedData::Column& column =
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

  void Describe(const LoadedData& loaded) {
    const Unit* const length = format_.columns.length_unit;
    const Unit* const angle = format_.columns.angle_unit;
    SetUse(roles_.joints, {}, angle);
    SetUse(roles_.position, {"x", "y", "z"}, length);
    SetUse(roles_.matrix,
           {"r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33"},
           nullptr);
    SetUse(roles_.quaternion, {"qw", "qx", "qy", "qz"}, nullptr);
    if (request_.rotation) {
      SetUse(roles_.angles, {"rx", "ry", "rz"}, angle);
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
  std::vector<std::string> names_;
  char separator_ = ',';
  ColumnRoles roles_;
  DataFormat format_;
  ImportedData result_;
};

// As YAML reads it.
std::string Quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : OneLine(text)) {
    quoted += c == '\'' ? "''" : std::string(1, c);
  }
  return quoted + "'";
}

}  // namespace

ImportedData ImportData(const ImportRequest& request) {
  return Importer(request).Import();
}

std::string DataText(const ImportedData& imported, const Arm& arm,
                     const std::string& title) {
  const std::string plain =
      FormatDataset(imported.loaded.data, arm, kFewestDigits, true, {title});
  std::string text;
  std::size_t pose = 0;
  bool is_header = true;
  std::string_view rest = plain;
  while (!rest.empty()) {
    const std::string_view line = TakeLine(&rest);
    text += line;
    if (line.front() != '#') {
      text +=
          "," + (std::exchange(is_header, false) ? "note"
                                                 : imported.places.at(pose++));
    }
    text += "\n";
  }
  return text;
}

std::string JobText(const std::string& title, const std::string& arm,
                    const std::string& data, Eigen::Index num_poses) {
  std::string text =
      "format: alidade-job-2\n"
      "title: " +
      Quoted(title) +
      "\n"
      "units: {length: mm, angle: deg}\n"
      "arm: " +
      Quoted(arm) +
      "\n"
      "data: " +
      Quoted(data) +
      "\n"
      "# The instrument's standard deviation of a coordinate, or as here: from "
      "the fit.\n"
      "measurement: {sigma: estimate}\n"
      "identifiability: {parameters: [joints, base, tool]}\n";
  if (num_poses >= kPosesToHoldOut) {
    text +=
        "# Held-out poses, which the result is judged by.\n"
        "validation: {fraction: 0.2}\n";
  }
  return text;
}

}  // namespace alidade::internal
