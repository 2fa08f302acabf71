#ifndef ALIDADE_SRC_DATAIO_MESH_FILE_H_
#define ALIDADE_SRC_DATAIO_MESH_FILE_H_

#include <Eigen/Core>
#include <string>

namespace alidade::internal {

/// A surface of triangles: columns are vertices, and three of their numbers.
struct TriangleMesh {
  Eigen::Matrix3Xd vertices;
  Eigen::Matrix3Xi triangles;
};

/// Reads an STL file (binary or text) or an OBJ file of at most 64 MB, whose
/// ending says which it is; lengths as written. Triangles with a corner that
/// is no finite number are left out. @throws InputError where it is none of
/// these, is cut short or has no triangle.
TriangleMesh LoadMesh(const std::string& path);
/// The same of a file's content.
TriangleMesh ParseMesh(const std::string& content, const std::string& path);

/// The mesh with at most so many triangles: vertices within cells of a grid
/// become one (Rossignac and Borrel 1993), and what is left of triangles that
/// way. @pre most > 0.
TriangleMesh SimplifyMesh(const TriangleMesh& mesh, int most);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_MESH_FILE_H_
