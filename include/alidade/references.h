#ifndef ALIDADE_REFERENCES_H_
#define ALIDADE_REFERENCES_H_

#include <Eigen/Core>
#include <string>
#include <vector>

namespace alidade {

/// A point that targets are measured against, in the instrument's frame: the
/// anchor of a ball bar or a draw wire, the centre of a socket.
struct ReferencePoint {
  std::string name;                                    ///< as data sets call it
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< (m) or a guess
  bool is_known = false;  ///< false: identified with the arm
};

/// A plane that targets touch: n . p = offset in the instrument's frame.
struct ReferencePlane {
  std::string name;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< norm 1
  double offset = 0.0;                                ///< (m)
  bool is_known = false;
};

/// All that a job's data sets are measured against. The order is that of the
/// parameters point1, point2 ... and plane1 ... of a layout.
struct References {
  std::vector<ReferencePoint> points;
  std::vector<ReferencePlane> planes;

  int num_points() const { return static_cast<int>(points.size()); }
  int num_planes() const { return static_cast<int>(planes.size()); }
  /// Index of the name, or -1.
  int FindPoint(const std::string& name) const;
  int FindPlane(const std::string& name) const;
};

/// Two unit vectors that make a right-handed frame with the unit vector
/// `normal`: the directions that a plane's parameters u and v tilt it in,
///
///   n = (n0 + u t1 + v t2) / sqrt(1 + u^2 + v^2).
///
/// They depend on `normal` alone. Duff et al. 2017, "Building an orthonormal
/// basis, revisited".
void TangentBasis(const Eigen::Vector3d& normal, Eigen::Vector3d* t1,
                  Eigen::Vector3d* t2);

}  // namespace alidade

#endif  // ALIDADE_REFERENCES_H_
