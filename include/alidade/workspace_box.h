#ifndef ALIDADE_WORKSPACE_BOX_H_
#define ALIDADE_WORKSPACE_BOX_H_

#include <Eigen/Core>
#include <algorithm>
#include <vector>

namespace alidade {

/// Where the target may be: a box in the base frame (m), limits included.
struct WorkspaceBox {
  Eigen::Vector3d lower = Eigen::Vector3d::Zero();
  Eigen::Vector3d upper = Eigen::Vector3d::Zero();
};

/// Whether a point of the base frame is in one of the boxes; anywhere where
/// there are none.
inline bool IsInside(const std::vector<WorkspaceBox>& boxes,
                     const Eigen::Vector3d& point) {
  return boxes.empty() ||
         std::any_of(boxes.begin(), boxes.end(), [&](const WorkspaceBox& box) {
           return (point.array() >= box.lower.array()).all() &&
                  (point.array() <= box.upper.array()).all();
         });
}

}  // namespace alidade

#endif  // ALIDADE_WORKSPACE_BOX_H_
