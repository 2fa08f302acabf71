#include "alidade/pose_sources.h"

#include <algorithm>

namespace alidade {

void PoseSources::push_back(const PoseSource& source) { Append(source, 1); }

void PoseSources::Append(const PoseSource& first, std::size_t count) {
  if (count == 0) return;
  bool continues = false;
  if (!runs_.empty()) {
    const Run& last = runs_.back();
    const auto next =
        last.source.line + static_cast<int>(size_ - last.first_pose);
    continues = last.source.file == first.file && next == first.line;
  }
  if (!continues) runs_.push_back({size_, first});
  size_ += count;
}

void PoseSources::Append(const PoseSources& others, int first_file) {
  for (std::size_t k = 0; k < others.runs_.size(); ++k) {
    const Run& run = others.runs_[k];
    const std::size_t end = k + 1 < others.runs_.size()
                                ? others.runs_[k + 1].first_pose
                                : others.size_;
    Append({run.source.file + first_file, run.source.line},
           end - run.first_pose);
  }
}

void PoseSources::MoveLines(int difference) {
  for (Run& run : runs_) run.source.line += difference;
}

PoseSource PoseSources::operator[](std::size_t pose) const {
  const auto after = std::upper_bound(
      runs_.begin(), runs_.end(), pose,
      [](std::size_t p, const Run& run) { return p < run.first_pose; });
  const Run& run = *(after - 1);
  return {run.source.file,
          run.source.line + static_cast<int>(pose - run.first_pose)};
}

}  // namespace alidade
