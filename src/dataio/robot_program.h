#ifndef ALIDADE_SRC_DATAIO_ROBOT_PROGRAM_H_
#define ALIDADE_SRC_DATAIO_ROBOT_PROGRAM_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
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
};

struct ProgramNote {
  int line = 0;
  std::string text;
};

/// A program's positions. Its text is not changed but where these stand.
struct RobotProgram {
  ProgramLanguage language = ProgramLanguage::kUrScript;
  std::string path;
  std::string text;
  std::vector<ProgramTarget> targets;  ///< in the order of the text
  std::map<std::string, Eigen::Isometry3d> frames;
  /// Lines of positions before which the program sets no "tool" or no "base",
  /// nor does the table of frames name one so: taken as the arm's own.
  std::map<std::string, std::vector<int>> unstated;
  std::vector<ProgramNote> left;     ///< computed at run time: not touched
  std::vector<ProgramNote> refused;  ///< not understood: nothing may be written
};

/// Whether a character may stand in a name of one of the languages.
bool IsWordCharacter(char c);

/// By the ending of a file's name: .script, .urscript; .src, .dat, .sub; .mod,
/// .modx, .prg, .sys; .ls. Nothing for others.
std::optional<ProgramLanguage> ProgramLanguageOf(const std::string& path);

/// Reads a program for an arm of so many joints. `frames`: tools and bases
/// that it refers to and does not state, "tool 1", "base 2" (KRL, Fanuc) or by
/// their names (RAPID); "tool" (URScript, KRL) and "base" (KRL): what holds
/// where it sets none. @throws InputError where the file cannot be read.
RobotProgram ReadProgram(
    const std::string& path, int num_joints,
    const std::map<std::string, Eigen::Isometry3d>& frames);
/// The same of a file's text.
RobotProgram ParseProgram(
    const std::string& text, const std::string& path, int num_joints,
    const std::map<std::string, Eigen::Isometry3d>& frames);

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

/// What replaces the numbers of one target.
struct ProgramValues {
  std::vector<double> numbers;
  std::vector<int> posture;
};

/// The text with the numbers of all targets replaced, in their decimals or, if
/// these are fewer, in those that a controller shows. Every other byte stays; a
/// number that stood right after a word ("X-5") is parted from it by a space.
std::string RewriteProgram(const RobotProgram& program,
                           const std::vector<ProgramValues>& values);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_ROBOT_PROGRAM_H_
