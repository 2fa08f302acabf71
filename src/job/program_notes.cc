#include "src/job/program_notes.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "alidade/error.h"
#include "alidade/units.h"
#include "src/common/format.h"
#include "src/common/number_text.h"
#include "src/common/text.h"

namespace alidade::internal {
namespace {

constexpr std::size_t kMostLines = 12;

std::string UnstatedFrameNote(const RobotProgram& program,
                              const std::string& kind,
                              const std::vector<int>& lines) {
  const auto others = static_cast<std::int64_t>(lines.size()) - 1;
  const bool is_tool = kind == "tool";
  return LineName(program, lines.front()) +
         (others > 0 ? " and " + Count(others, "other position") : "") +
         ": the program sets no " + kind + " before, so " +
         (is_tool ? "the arm file's target" : "the arm's own base") +
         " is taken for it; where another " + kind +
         " is active on the controller, " +
         (is_tool ? "its installation's for one, " : "") +
         "the correction is wrong: set it in the program, or give --frames a "
         "row named " +
         kind;
}

// The columns that a frame has as its maker's pendant shows it.
std::string FrameColumns(ProgramLanguage language) {
  switch (language) {
    case ProgramLanguage::kKrl:
      return "a_deg, b_deg, c_deg (A, B, C as the pendant shows them)";
    case ProgramLanguage::kRapid:
      return "qw, qx, qy, qz (q1 to q4)";
    case ProgramLanguage::kFanuc:
      return "rx_deg, ry_deg, rz_deg (W, P, R), with "
             "--rotation=extrinsic_xyz";
    case ProgramLanguage::kUrScript:
      break;
  }
  return "wx_deg, wy_deg, wz_deg";
}

std::string MissingFrame(const RobotProgram& program, const std::string& name,
                         const std::vector<int>& lines) {
  return name + " is not stated in the program (" + LineList(program, lines) +
         "), expected a row `" + name + "` in the table of --frames";
}

std::vector<std::string> RefusalLines(const RobotProgram& program,
                                      const std::vector<ProgramNote>& notes) {
  std::vector<std::string> lines;
  for (const auto& [name, places] : program.missing) {
    lines.push_back(MissingFrame(program, name, places));
  }
  if (!lines.empty()) {
    lines.push_back("such a table has the columns name, x_mm, y_mm, z_mm, " +
                    FrameColumns(program.language));
  }
  for (std::size_t i = 0; i < std::min(notes.size(), kMostListed); ++i) {
    // "line 4: out of reach", or "line 4, XP1: ..." by its text.
    const bool is_named = notes[i].text.rfind(", ", 0) == 0;
    lines.push_back(LineName(program, notes[i].line) + (is_named ? "" : ": ") +
                    notes[i].text);
  }
  if (notes.size() > kMostListed) {
    lines.push_back("and " + std::to_string(notes.size() - kMostListed) +
                    " more");
  }
  return lines;
}

std::vector<int> LinesOf(const RobotProgram& program, Uncorrected kind) {
  std::vector<int> lines;
  for (const ProgramNote& note : program.left) {
    if (note.kind == kind) lines.push_back(note.line);
  }
  return lines;
}

}  // namespace

std::string JointName(ProgramLanguage language, int j) {
  const char* letter = "q";
  if (language == ProgramLanguage::kKrl) letter = "A";
  if (language == ProgramLanguage::kFanuc) letter = "J";
  return letter + std::to_string(j + 1);
}

std::string JointText(ProgramLanguage language, const Arm& arm,
                      const Eigen::VectorXd& motors) {
  std::string text;
  bool all_turn = true;
  for (int j = 0; j < arm.num_joints(); ++j) {
    const bool turns = arm.joints[j].type == JointType::kRevolute;
    all_turn = all_turn && turns;
    text += (j > 0 ? ", " : "") + JointName(language, j) + " " +
            FixedNumber(motors[j] / (turns ? kDegree : kMillimetre), 1) +
            (turns ? "" : " mm");
  }
  return text + (all_turn ? " deg" : "");
}

std::string LineList(const RobotProgram& program,
                     const std::vector<int>& lines) {
  // Of one file after the other.
  std::vector<std::pair<std::string, std::vector<std::string>>> groups;
  std::size_t count = 0;
  for (const int line : std::set<int>(lines.begin(), lines.end())) {
    const std::string name = LineName(program, line);
    const std::size_t number = name.rfind(' ');
    const std::string before = name.substr(0, number);
    if (++count > kMostLines) continue;
    if (groups.empty() || groups.back().first != before) {
      groups.push_back({before, {}});
    }
    groups.back().second.push_back(name.substr(number + 1));
  }
  const std::string more =
      count > kMostLines ? std::to_string(count - kMostLines) + " more" : "";
  if (!more.empty()) groups.back().second.push_back(more);
  std::string text;
  for (auto& [before, numbers] : groups) {
    const std::string last = numbers.back();
    numbers.pop_back();
    text += (text.empty() ? "" : "; ") + before +
            (numbers.empty() ? " " : "s " + Join(numbers, ", ") + " and ") +
            last;
  }
  return text;
}

std::vector<std::string> FrameAssumptions(const RobotProgram& program,
                                          const Arm& nominal) {
  std::vector<std::string> notes;
  for (const auto& [kind, lines] : program.unstated) {
    notes.push_back(UnstatedFrameNote(program, kind, lines));
  }
  for (const BorrowedFrame& one : program.borrowed) {
    const ProgramRoutine* setter = RoutineAt(program, one.set_line);
    notes.push_back(LineName(program, one.line) + ": " +
                    RoutineAt(program, one.line)->title + " sets no " +
                    one.kind + " before it; taken: that of " +
                    LineName(program, one.set_line) +
                    (setter == nullptr ? "" : ", in " + setter->title) +
                    ", the last above it in the text");
  }
  if (program.language == ProgramLanguage::kUrScript &&
      program.frames.count("base") > 0) {
    notes.emplace_back(
        "poses are in the robot's own base: URScript knows no other, and the "
        "row base of --frames is not used");
  }
  const double away = nominal.last_from_target().translation().norm();
  const bool has_tools =
      std::any_of(program.targets.begin(), program.targets.end(),
                  [](const ProgramTarget& one) { return !one.tool.empty(); });
  if (has_tools && away > 0.0) {
    notes.push_back(
        "the program's tools begin at the arm file's target, " +
        FormatSignificant(away / kMillimetre, 3) +
        " mm from the frame of the last joint: where that is not the flange, "
        "name an arm whose target it is by --nominal");
  }
  return notes;
}

std::vector<std::string> OrderAssumptions(const RobotProgram& program) {
  namespace fs = std::filesystem;
  fs::path path = program.path;
  const std::string ending = path.extension().string();
  if (ending != ".dat" && ending != ".DAT") return {};
  const std::string file = path.filename().string();
  path.replace_extension(ending == ".dat" ? ".src" : ".SRC");
  const std::string source = path.filename().string();
  std::string note =
      file +
      " alone does not say with which tool and in which order its positions "
      "are moved to: the order of its lines is taken; ";
  note +=
      fs::is_regular_file(path)
          ? "name " + source + ", which lies beside it, and both are corrected"
          : "with " + source +
                " beside it, name that, and both are "
                "corrected";
  return {note};
}

std::vector<std::string> FirstOf(std::vector<std::string> lines) {
  if (lines.size() <= kMostListed) return lines;
  const std::size_t more = lines.size() - kMostListed;
  lines.resize(kMostListed);
  lines.push_back("and " + std::to_string(more) + " more");
  return lines;
}

ProgramRefusal MakeRefusal(const RobotProgram& program,
                           const std::vector<ProgramNote>& notes) {
  std::set<int> lines;
  for (const ProgramNote& note : notes) lines.insert(note.line);
  for (const auto& [name, places] : program.missing) {
    lines.insert(places.begin(), places.end());
  }
  const auto [path, line] = PlaceOf(program, *lines.begin());
  const std::string count =
      Count(static_cast<std::int64_t>(lines.size()), "position");
  return {InputError({path, line, 0, ""}, "nothing is written, as " + count +
                                              " cannot be corrected:")
              .what(),
          RefusalLines(program, notes)};
}

std::string UncorrectedMotions(const RobotProgram& program) {
  std::string text;
  const auto lines = LinesOf(program, Uncorrected::kMotion);
  const auto relative = LinesOf(program, Uncorrected::kRelativeMotion);
  if (!lines.empty()) {
    text += Paragraph(
        "NOT corrected: " +
        Count(static_cast<std::int64_t>(lines.size()), "motion") + " (" +
        LineList(program, lines) +
        "), whose positions are not stated in numbers here. The robot goes "
        "there as before: write their poses as literals, or correct the file "
        "that states them (docs/robot.md, \"Positions computed at run "
        "time\").");
  }
  if (!relative.empty()) {
    text += Paragraph(
        Count(static_cast<std::int64_t>(relative.size()), "motion") +
        (relative.size() == 1 ? " goes" : " go") +
        " by an offset from a position (" + LineList(program, relative) +
        ") and " + (relative.size() == 1 ? "has" : "have") +
        " its correction, not one of " +
        (relative.size() == 1 ? "its" : "their") + " own.");
  }
  return text;
}

}  // namespace alidade::internal
