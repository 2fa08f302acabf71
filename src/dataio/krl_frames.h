#ifndef ALIDADE_SRC_DATAIO_KRL_FRAMES_H_
#define ALIDADE_SRC_DATAIO_KRL_FRAMES_H_

#include <Eigen/Geometry>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "src/dataio/program_routines.h"
#include "src/dataio/program_text.h"

namespace alidade::internal {

/// {NAME value, NAME value, ...} as far as it holds numbers.
struct KrlAggregate {
  std::size_t begin = 0;
  std::map<std::string, NumberSpan> numbers;
  bool only_numbers = true;

  bool HasAll(const std::vector<std::string>& names) const;
  bool HasAny(const std::vector<std::string>& names) const;
  std::vector<NumberSpan> Of(const std::vector<std::string>& names) const;
};

/// The one whose brace stands at `at`.
KrlAggregate ParseKrlAggregate(const ProgramText& text, std::size_t at);

/// X, Y, Z, A, B, C.
std::vector<std::string> KrlPoseNames();

/// Tool and base that hold at a place of the text.
struct KrlFrames {
  std::string tool = kUnstatedTool;
  std::string base = kUnstatedBase;
  bool operator<(const KrlFrames& other) const {
    return std::tie(tool, base) < std::tie(other.tool, other.base);
  }
};

/// "tool 1", "base 2"; empty for number 0, the arm's own.
std::string KrlFrameName(const char* kind, int index);

/// Reads the tools and bases that a KRL program states, TOOL_DATA[1]={...},
/// into its frames, and where it sets which: $TOOL=..., BAS(#TOOL,1). What is
/// set to something else than one of them or to numbers is "?"; frames that are
/// stated twice with other numbers, or changed in parts, are refused.
class KrlFrameReader {
 public:
  KrlFrameReader(const ProgramText& text, RobotProgram* program);

  /// What holds at a place of the text.
  KrlFrames At(std::size_t at) const;
  /// The statements that set a tool or a base.
  std::vector<FrameSetting> settings() const { return settings_; }

 private:
  void Refuse(std::size_t at, const std::string& why);
  std::optional<int> Index(std::size_t at) const;
  void ReadNumberedFrames();
  void StateFrame(const std::string& name, const Eigen::Isometry3d& frame,
                  std::size_t at);
  bool IsAssigned(std::size_t at) const;
  bool EndsLine(std::size_t at) const;
  std::string AssignedFrame(std::size_t at, const std::string& word,
                            const char* kind);
  void ReadFrameChanges();
  void Change(std::size_t at, bool is_tool, const std::string& name);

  const ProgramText& text_;
  RobotProgram* const program_;
  std::map<std::string, Eigen::Isometry3d> stated_frames_;
  std::vector<std::pair<std::size_t, KrlFrames>> changes_;
  std::vector<FrameSetting> settings_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_KRL_FRAMES_H_
