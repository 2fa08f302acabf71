#ifndef ALIDADE_SRC_DATAIO_URDF_SHAPES_H_
#define ALIDADE_SRC_DATAIO_URDF_SHAPES_H_

#include <Eigen/Geometry>
#include <string>
#include <vector>

namespace alidade::internal {

/// A mesh that a URDF file names for a link.
struct UrdfMesh {
  std::string file;  ///< as written: "package://robot/meshes/base.stl"
  /// From the mesh's own lengths and frame, all joints at zero (m).
  Eigen::Affine3d base_from_mesh = Eigen::Affine3d::Identity();
};

/// What a link looks like.
struct UrdfLinkShape {
  std::string link;
  int num_joints = 0;  ///< that move, between the base and it
  std::vector<UrdfMesh> visual;
  std::vector<UrdfMesh> collision;  ///< simpler ones, for want of others
};

/// The links of a chain that have meshes, from the base to the tip. Links that
/// hang beside the chain are left out. Origins and scales that are no numbers
/// count as none. @throws InputError as LoadUrdfChain.
std::vector<UrdfLinkShape> LoadUrdfShapes(const std::string& path,
                                          const std::string& base_link,
                                          const std::string& tip_link);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_URDF_SHAPES_H_
