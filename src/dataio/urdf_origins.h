#ifndef ALIDADE_SRC_DATAIO_URDF_ORIGINS_H_
#define ALIDADE_SRC_DATAIO_URDF_ORIGINS_H_

#include <string>

#include "alidade/arm.h"

namespace alidade::internal {

/// A chain of a URDF file.
struct UrdfChain {
  std::string path;
  std::string base_link;
  std::string tip_link;
};

/// The text of the URDF with the origins of the chain's moving joints changed
/// so that its tip is where `real` has it: `nominal` is the arm that the file
/// describes. Every other byte stays. Links keep their places on their joints'
/// axes, so that meshes and masses go with them; tip and fixed joints keep
/// theirs. All geometry is held; error terms and motors are not.
/// @throws InputError.
std::string RewriteUrdf(const UrdfChain& chain, const Arm& nominal,
                        const Arm& real);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_URDF_ORIGINS_H_
