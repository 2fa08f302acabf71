#ifndef ALIDADE_SRC_DATAIO_ROBOT_PROGRAM_H_
#define ALIDADE_SRC_DATAIO_ROBOT_PROGRAM_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "alidade/arm.h"

namespace alidade::internal {

enum class ProgramLanguage { kUrScript, kKrl, kRapid, kFanuc };

/// A number in a program's text: where it stands, and what it says as written.
struct NumberSpan {
  std::size_t begin = 0;
  std::size_t end = 0;
  int decimals = 0;
  double value = 0.0;

  /// The value where it is a whole number that an int can hold.
  std::optional<int> Whole() const;
};

/// A position that a program states in numbers.
struct ProgramTarget {
  bool is_joints = false;
  int line = 0;
  std::string name;  ///< of the variable; may be empty
  /// Lines that move to it, ascending, until its variable is given another
  /// position; its own where there are none. The order of a program's motions.
  std::vector<int> uses;
  /// Joint values, or x, y, z and the orientation as the language writes it.
  std::vector<NumberSpan> numbers;
  /// Names among RobotProgram::frames; empty: the arm's own tool, its base.
  std::string tool;
  std::string frame;
  /// What the program says of the posture: T of KRL, cf1, cf4, cf6 of RAPID,
  /// all whole numbers.
  std::vector<NumberSpan> posture;
  std::optional<int> branch;  ///< cfx of RAPID
};

/// What is not corrected: no motion at all, one relative to a position that is
/// corrected, or one to a place that is not stated in numbers.
enum class Uncorrected { kNoMotion, kRelativeMotion, kMotion };

struct ProgramNote {
  int line = 0;
  std::string text;
  Uncorrected kind = Uncorrected::kNoMotion;
};

/// A DEF, PROC or def: its lines, its own name and what people call it.
struct ProgramRoutine {
  std::string name;
  std::string title;  ///< "DEF weld"
  int first_line = 0;
  int last_line = 0;
};

/// A position that a tool or base holds for which another routine sets.
struct BorrowedFrame {
  std::string kind;  ///< "tool", "base"
  int line = 0;      ///< of the motion
  int set_line = 0;
};

/// One file of a program: where its text begins, and in which line.
struct ProgramFile {
  std::string path;
  std::size_t begin = 0;
  int first_line = 1;
};

/// A program's positions. Its text is not changed but where these stand. Lines
/// are those of the text: LineName is what people call them.
struct RobotProgram {
  ProgramLanguage language = ProgramLanguage::kUrScript;
  std::string path;  ///< of the file that moves
  std::string text;  ///< of all files, a line feed between them
  std::vector<ProgramFile> files;
  std::vector<ProgramTarget> targets;  ///< in the order of the text
  std::map<std::string, Eigen::Isometry3d> frames;
  /// Lines of positions before which the program sets no "tool" or no "base",
  /// nor does the table of frames name one so: taken as the arm's own.
  std::map<std::string, std::vector<int>> unstated;
  /// Lines of positions whose tool or base neither the program nor the table of
  /// frames states: these are not among the targets.
  std::map<std::string, std::vector<int>> missing;
  /// Lines that move along a straight line or an arc.
  std::set<int> straight;
  std::vector<ProgramRoutine> routines;  ///< by their first lines
  /// Lines before which the text is not in the order of the motions: a routine
  /// that moves begins, ends or is called there. Ascending.
  std::vector<ProgramNote> breaks;
  std::vector<BorrowedFrame> borrowed;  ///< the first of each routine
  std::vector<ProgramNote> left;        ///< computed at run time: not touched
  std::vector<ProgramNote> refused;  ///< not understood: nothing may be written
};

/// Whether a character may stand in a name of one of the languages.
bool IsWordCharacter(char c);

/// By the ending of a file's name: .script, .urscript; .src, .dat, .sub; .mod,
/// .modx, .prg, .sys; .ls. Nothing for others.
std::optional<ProgramLanguage> ProgramLanguageOf(const std::string& path);

/// The file of declarations (.dat) that belongs to a file of KRL motions (.src)
/// and lies beside it; empty where there is none. @throws InputError where what
/// has that name is no file.
std::string DeclarationsBeside(const std::string& path);

/// What people call a line: "line 12" or, of a file that is not the program's
/// path, "seam.dat line 4"; and its file and number there.
std::string LineName(const RobotProgram& program, int line);
std::pair<std::string, int> PlaceOf(const RobotProgram& program, int line);

/// The innermost routine that a line is in; null of none.
const ProgramRoutine* RoutineAt(const RobotProgram& program, int line);

/// Reads a program for an arm of so many joints, KRL motions (.src) together
/// with the declarations beside them. `frames`: tools and bases
/// that it refers to and does not state, "tool 1", "base 2" (KRL, Fanuc) or by
/// their names (RAPID); "tool" (URScript, KRL) and "base" (KRL): what holds
/// where it sets none. @throws InputError where the file cannot be read.
RobotProgram ReadProgram(
    const std::string& path, int num_joints,
    const std::map<std::string, Eigen::Isometry3d>& frames);
/// The same of a file's text; `declarations`: the path and the text of the file
/// that is read before it.
RobotProgram ParseProgram(
    const std::string& text, const std::string& path, int num_joints,
    const std::map<std::string, Eigen::Isometry3d>& frames,
    const std::optional<std::pair<std::string, std::string>>& declarations =
        std::nullopt);

/// The pose that a target states, in its frame. @pre it is not of joints.
Eigen::Isometry3d PoseOf(ProgramLanguage language, const ProgramTarget& target);

/// The joint values that it states (rad, m). @pre it is of joints.
Eigen::VectorXd MotorsOf(ProgramLanguage language, const ProgramTarget& target,
                         const Arm& arm);

/// The numbers that state a pose or joint values, as written, near those of
/// `target`.
std::vector<double> NumbersOfPose(ProgramLanguage language,
                                  const ProgramTarget& target,
                                  const Eigen::Isometry3d& pose);
std::vector<double> NumbersOfMotors(ProgramLanguage language, const Arm& arm,
                                    const Eigen::VectorXd& motors);

/// Bounds of the motors' values (n x 2, rad) that the target's posture allows;
/// infinite where it says nothing.
Eigen::MatrixXd PostureBounds(ProgramLanguage language,
                              const ProgramTarget& target, int num_joints);

/// The same statement of other joint values: one integer for each span.
std::vector<int> PostureOf(ProgramLanguage language,
                           const ProgramTarget& target,
                           const Eigen::VectorXd& motors);

/// The integers of a target's posture as they are written.
std::vector<int> StatedPosture(const ProgramTarget& target);

/// What the posture of a target says, with integers for its spans as PostureOf
/// gives them: "T 10", "[0,-1,0]", and in words.
std::string PostureText(ProgramLanguage language,
                        const std::vector<int>& posture);
std::string PostureMeaning(ProgramLanguage language,
                           const std::vector<int>& posture, int num_joints);

/// What replaces the numbers of one target.
struct ProgramValues {
  std::vector<double> numbers;
  std::vector<int> posture;
};

/// The text of each file with the numbers of all targets replaced, in their
/// decimals or, if these are fewer, in those that a controller shows. Every
/// other byte stays; a number that stood right after a word ("X-5") is parted
/// from it by a space.
std::vector<std::string> RewriteProgram(
    const RobotProgram& program, const std::vector<ProgramValues>& values);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_ROBOT_PROGRAM_H_
