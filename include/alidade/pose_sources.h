#ifndef ALIDADE_POSE_SOURCES_H_
#define ALIDADE_POSE_SOURCES_H_

#include <cstddef>
#include <vector>

namespace alidade {

/// Where a pose was read: for messages.
struct PoseSource {
  int file = 0;  ///< index in Dataset::files
  int line = 0;  ///< from 1
};

/// Where each of many poses was read, in the order of poses. Poses of
/// consecutive lines take no memory of their own.
class PoseSources {
 public:
  /// Poses of consecutive lines.
  struct Run {
    std::size_t first_pose = 0;
    PoseSource source = {};  ///< of that pose
  };

  void push_back(const PoseSource& source);
  /// `count` poses, of `first` and the lines behind it.
  void Append(const PoseSource& first, std::size_t count);
  /// All of others, whose files are numbered from `first_file` on here.
  void Append(const PoseSources& others, int first_file);
  /// Adds to every line.
  void MoveLines(int difference);

  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }
  /// O(log runs). @pre pose < size().
  PoseSource operator[](std::size_t pose) const;

  const std::vector<Run>& runs() const { return runs_; }

 private:
  std::vector<Run> runs_;
  std::size_t size_ = 0;
};

}  // namespace alidade

#endif  // ALIDADE_POSE_SOURCES_H_
