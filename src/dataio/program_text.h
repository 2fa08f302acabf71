#ifndef ALIDADE_SRC_DATAIO_PROGRAM_TEXT_H_
#define ALIDADE_SRC_DATAIO_PROGRAM_TEXT_H_

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "src/dataio/robot_program.h"

namespace alidade::internal {

/// What a search in a text gives where it finds nothing.
inline constexpr std::size_t kNowhere = std::string::npos;

/// The text of a program with comments and the content of strings blanked out,
/// in capital letters, every byte at its place: what a reader looks at.
class ProgramText {
 public:
  /// `comment` begins a comment that ends with the line; `quote` strings.
  ProgramText(const std::string& text, std::string_view comment, char quote,
              bool keep_case = false);

  const std::string& text() const { return masked_; }
  char at(std::size_t place) const {
    return place < masked_.size() ? masked_[place] : '\n';
  }
  std::size_t size() const { return masked_.size(); }

  int LineOf(std::size_t place) const;
  std::size_t LineStart(std::size_t place) const;
  std::size_t LineEnd(std::size_t place) const;

  std::size_t SkipSpaces(std::size_t place) const;
  /// The last place before `place` that is no space or tab, plus one.
  std::size_t SkipSpacesBack(std::size_t place) const;

  /// A number that begins at `place`.
  std::optional<NumberSpan> NumberAt(std::size_t place) const;
  /// `[1, -2.5]` at `place`, and where it ends; nothing where it holds
  /// anything but numbers.
  std::optional<std::vector<NumberSpan>> ListAt(std::size_t place,
                                                std::size_t* end) const;
  /// The identifier that ends before `place`, or begins there.
  std::string WordBefore(std::size_t place) const;
  std::string WordAt(std::size_t place) const;
  /// Where `word` stands as a whole identifier, from `from` on; npos.
  /// @pre it is not empty.
  std::size_t FindWord(const std::string& word, std::size_t from) const;

 private:
  void ListWords();

  std::string masked_;
  std::vector<std::size_t> line_starts_;
  // Where each word stands, ascending: programs are long, and their names many.
  std::unordered_map<std::string, std::vector<std::size_t>> places_;
};

/// Whether a text may be that of a variable: neither nothing nor a number.
bool MayBeName(const std::string& text);
/// And has nothing that is written again: no brackets, numbers or signs.
bool IsName(const std::string& text);

/// Names of the tool and the base that hold where a program sets none.
constexpr char kUnstatedTool[] = "tool";
constexpr char kUnstatedBase[] = "base";

/// What the readers of all languages share: the text, and notes of what is not
/// corrected.
class ProgramReader {
 protected:
  ProgramReader(std::string_view comment, char quote, bool keep_case,
                RobotProgram* program)
      : text_(program->text, comment, quote, keep_case), program_(program) {}

  void Refuse(std::size_t at, const std::string& why) {
    program_->refused.push_back({text_.LineOf(at), why});
  }
  void Leave(std::size_t at, const std::string& why,
             Uncorrected kind = Uncorrected::kNoMotion) {
    program_->left.push_back({text_.LineOf(at), why, kind});
  }

  /// That the motion at `at` goes along a line or an arc.
  void AddStraight(std::size_t at) {
    program_->straight.insert(text_.LineOf(at));
  }
  /// The same of every line that begins with a word of which `is_straight`.
  void ListStraight(const std::function<bool(const std::string&)>& is_straight);

  /// The frame of a position: `name`, or the arm's own where it is
  /// kUnstatedTool or kUnstatedBase and no table of frames has it.
  std::string FrameOrOwn(const std::string& name, std::size_t at);

  /// Targets in the order of the text, with the lines that use them.
  void SortTargets();

  /// Lines behind the target's own and before `end` that name it; its own where
  /// there are none.
  std::vector<int> UsesOf(const ProgramTarget& target, int end) const;

  const ProgramText text_;
  RobotProgram* const program_;
};

// One source each.
void ReadUrScript(int num_joints, RobotProgram* program);
void ReadKrl(int num_joints, RobotProgram* program);
void ReadRapid(int num_joints, RobotProgram* program);
void ReadFanuc(int num_joints, RobotProgram* program);

/// Whether the program knows a frame, or none is asked for; else it is noted
/// among the missing ones, or a refusal where it is set at run time.
bool KnowsFrame(const std::string& name, int line, RobotProgram* program);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_PROGRAM_TEXT_H_
