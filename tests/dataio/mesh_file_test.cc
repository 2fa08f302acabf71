#include "src/dataio/mesh_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "alidade/error.h"
#include "alidade/units.h"
#include "tests/support/io_test_util.h"

namespace alidade::internal {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;
using ::testing::Property;
using ::testing::Throws;

// A box from 0 to (1, 2, 3): its corners, and their numbers for 12 triangles
// that face outwards.
constexpr int kBox[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6},
                             {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7},
                             {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};

Vector3d BoxCorner(int i) {
  return {i % 2 * 1.0, i / 2 % 2 * 2.0, i / 4 * 3.0};
}

void Append(const void* bytes, std::size_t count, std::string* text) {
  text->append(static_cast<const char*>(bytes), count);
}

std::string BinaryStl(const std::vector<Vector3d>& corners,
                      const std::string& header = "made up") {
  std::string text = header;
  text.resize(80, ' ');
  const auto count = static_cast<std::uint32_t>(corners.size() / 3);
  Append(&count, 4, &text);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (i % 3 == 0) text.append(12, '\0');
    for (const double value : corners[i]) {
      const auto number = static_cast<float>(value);
      Append(&number, 4, &text);
    }
    if (i % 3 == 2) text.append(2, '\0');
  }
  return text;
}

std::vector<Vector3d> BoxTriangles() {
  std::vector<Vector3d> corners;
  for (const auto& triangle : kBox) {
    for (const int corner : triangle) corners.push_back(BoxCorner(corner));
  }
  return corners;
}

// By the divergence theorem; right only where every triangle is there and
// faces outwards.
double Volume(const TriangleMesh& mesh) {
  double volume = 0.0;
  for (Eigen::Index i = 0; i < mesh.triangles.cols(); ++i) {
    const Vector3d a = mesh.vertices.col(mesh.triangles(0, i));
    const Vector3d b = mesh.vertices.col(mesh.triangles(1, i));
    const Vector3d c = mesh.vertices.col(mesh.triangles(2, i));
    volume += a.dot(b.cross(c)) / 6.0;
  }
  return volume;
}

class MeshFileTest : public ::testing::Test {
 protected:
  TriangleMesh Load(const std::string& name, const std::string& content) {
    return LoadMesh(directory_.Write(name, content));
  }

  void ExpectRefused(const std::string& name, const std::string& content,
                     const std::string& message) {
    EXPECT_THAT(
        [&] { Load(name, content); },
        Throws<InputError>(Property(&InputError::what, HasSubstr(message))));
  }

  TestDirectory directory_;
};

TEST_F(MeshFileTest, FormatsHoldTheSameBox) {
  std::string text = "solid box\n";
  std::string obj = "# a box\n";
  for (int i = 0; i < 8; ++i) {
    const Vector3d corner = BoxCorner(i);
    obj += "v " + std::to_string(corner.x()) + " " +
           std::to_string(corner.y()) + " " + std::to_string(corner.z()) + "\n";
  }
  for (const auto& triangle : kBox) {
    text += "facet normal 0 0 0\n outer loop\n";
    obj += "f";
    for (const int corner : triangle) {
      const Vector3d at = BoxCorner(corner);
      text += "  vertex " + std::to_string(at.x()) + " " +
              std::to_string(at.y()) + " " + std::to_string(at.z()) + "\n";
      obj += " " + std::to_string(corner + 1) + "/1/1";
    }
    text += " endloop\nendfacet\n";
    obj += "\n";
  }
  for (const auto& [name, content] :
       {std::pair<std::string, std::string>{"binary.stl",
                                            BinaryStl(BoxTriangles())},
        {"solid.STL", BinaryStl(BoxTriangles(), "solid by a careless program")},
        {"text.stl", text + "endsolid\n"},
        {"box.obj", obj}}) {
    const TriangleMesh mesh = Load(name, content);
    EXPECT_EQ(mesh.triangles.cols(), 12) << name;
    EXPECT_NEAR(Volume(mesh), 6.0, 1e-12) << name;
  }
  // Quadrangles, and corners counted from the end.
  const TriangleMesh quad =
      Load("quad.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf -4 -3 -2 -1\n");
  EXPECT_EQ(quad.triangles.cols(), 2);
}

TEST_F(MeshFileTest, HostileFilesAreRefused) {
  std::string binary = BinaryStl(BoxTriangles());
  const std::uint32_t many = 0xFFFFFFFF;
  std::memcpy(&binary[80], &many, 4);
  ExpectRefused("many.stl", binary, "is cut short");
  ExpectRefused("short.stl", "\x01\x02", "is cut short");
  ExpectRefused("empty.stl", "", "is cut short");
  ExpectRefused("none.stl", BinaryStl({}), "has no triangle");
  ExpectRefused("words.stl", "solid vertex vertex vertex 1", "has no triangle");
  ExpectRefused("far.obj", "v 0 0 0\nf 1 2 3\n", "corner \"2\"");
  ExpectRefused("zero.obj", "v 0 0 0\nf 0 1 1\n", "corner \"0\"");
  ExpectRefused("deep.obj", "v 0 0 0\nf -9223372036854775808 1 1\n",
                "that is not there");
  ExpectRefused("page.dae", "<COLLADA/>", "expected an STL or OBJ file");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ExpectRefused("nan.stl",
                BinaryStl({{nan, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1e30, 0.0}}),
                "has no triangle");
  EXPECT_THROW(LoadMesh(directory_.Path("missing.stl")), InputError);
}

TEST_F(MeshFileTest, SimplifiedMeshesStayNearTheirSurface) {
  // A sphere of radius 1.
  std::vector<Vector3d> corners;
  constexpr int kParts = 60;
  const auto at = [](int i, int k) {
    const double height = kPi * i / kParts;
    const double angle = 2.0 * kPi * k / kParts;
    return Vector3d(std::sin(height) * std::cos(angle),
                    std::sin(height) * std::sin(angle), std::cos(height));
  };
  for (int i = 0; i < kParts; ++i) {
    for (int k = 0; k < kParts; ++k) {
      for (const auto& [a, b] :
           {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}}) {
        corners.push_back(at(i + a, k + b));
      }
    }
  }
  const TriangleMesh sphere = Load("sphere.stl", BinaryStl(corners));
  for (const int most : {1000, 200, 20, 1}) {
    const TriangleMesh small = SimplifyMesh(sphere, most);
    EXPECT_LE(small.triangles.cols(), most);
    EXPECT_GE(small.triangles.cols(), 1);
    EXPECT_LT(small.vertices.cols(), sphere.vertices.cols());
    if (most < 200) continue;
    EXPECT_GT(small.triangles.cols(), most / 4);
    // Cells of a fifth of the diameter at most, so that their means are no
    // farther within than that.
    for (Eigen::Index i = 0; i < small.vertices.cols(); ++i) {
      const double radius = small.vertices.col(i).norm();
      EXPECT_LE(radius, 1.0 + 1e-6);
      EXPECT_GE(radius, 0.6);
    }
    EXPECT_NEAR(Volume(small) / (4.0 / 3.0 * kPi), 1.0,
                most > 500 ? 0.1 : 0.25);
  }
}

}  // namespace
}  // namespace alidade::internal
