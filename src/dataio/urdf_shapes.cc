#include "src/dataio/urdf_shapes.h"

#include <tinyxml2.h>

#include <cstddef>
#include <locale>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "alidade/error.h"
#include "src/common/files.h"
#include "src/dataio/urdf_file.h"

namespace alidade::internal {
namespace {

using tinyxml2::XMLElement;

std::string Attribute(const XMLElement* element, const char* name) {
  const char* text = element == nullptr ? nullptr : element->Attribute(name);
  return text == nullptr ? "" : text;
}

// As many numbers as `otherwise`, which stands where the attribute is missing.
Eigen::VectorXd NumbersOr(const XMLElement* element, const char* name,
                          const Eigen::VectorXd& otherwise) {
  const std::string text = Attribute(element, name);
  if (text.empty()) return otherwise;
  std::istringstream words(text);
  words.imbue(std::locale::classic());
  Eigen::VectorXd read(otherwise.size());
  for (double& each : read) words >> each;
  std::string more;
  if (!words || words >> more || !read.allFinite()) {
    throw InputError({"", element->GetLineNum(), 0, ""},
                     "expected " + std::to_string(otherwise.size()) +
                         " numbers as " + name + ", found \"" + text + "\"");
  }
  return read;
}

Eigen::Affine3d OriginOf(const XMLElement& shape) {
  const XMLElement* const origin = shape.FirstChildElement("origin");
  const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
  const Eigen::Vector3d rpy = NumbersOr(origin, "rpy", zero);
  const Eigen::Vector4d xyzw =
      NumbersOr(origin, "quat_xyzw", Eigen::Vector4d(0.0, 0.0, 0.0, 1.0));
  const Eigen::Vector3d place = NumbersOr(origin, "xyz", zero);
  // One of both is stated.
  return Eigen::Translation3d(place) *
         Eigen::AngleAxisd(rpy.z(), Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(rpy.y(), Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(rpy.x(), Eigen::Vector3d::UnitX()) *
         Eigen::Quaterniond(xyzw).normalized() * Eigen::Affine3d::Identity();
}

std::vector<UrdfMesh> MeshesOf(const XMLElement& link, const char* kind,
                               const Eigen::Isometry3d& base_from_link) {
  std::vector<UrdfMesh> meshes;
  for (auto* shape = link.FirstChildElement(kind); shape != nullptr;
       shape = shape->NextSiblingElement(kind)) {
    const XMLElement* const geometry = shape->FirstChildElement("geometry");
    if (geometry == nullptr) continue;
    const XMLElement* const mesh = geometry->FirstChildElement("mesh");
    const std::string file = Attribute(mesh, "filename");
    if (file.empty()) continue;
    const Eigen::Vector3d scale =
        NumbersOr(mesh, "scale", Eigen::Vector3d::Ones());
    meshes.push_back(
        {file, base_from_link * OriginOf(*shape) * Eigen::Scaling(scale)});
  }
  return meshes;
}

template <typename Matches>
const XMLElement* Find(const XMLElement& robot, const char* kind,
                       const Matches& matches) {
  for (auto* element = robot.FirstChildElement(kind); element != nullptr;
       element = element->NextSiblingElement(kind)) {
    if (matches(*element)) return element;
  }
  return nullptr;
}

}  // namespace

std::vector<UrdfLinkShape> LoadUrdfShapes(const std::string& path,
                                          const std::string& base_link,
                                          const std::string& tip_link) {
  const std::vector<ChainJoint> chain =
      LoadUrdfChain(path, base_link, tip_link);
  const std::vector<std::string> names =
      LoadUrdfJointNames(path, base_link, tip_link);
  const std::string text = ReadFile(path);
  tinyxml2::XMLDocument document;
  document.Parse(text.data(), text.size());
  const XMLElement* const robot = document.FirstChildElement("robot");
  std::vector<UrdfLinkShape> shapes;
  if (robot == nullptr) return shapes;
  Eigen::Isometry3d base_from_link = Eigen::Isometry3d::Identity();
  int num_joints = 0;
  const auto add = [&](const std::string& name) {
    const XMLElement* const link =
        Find(*robot, "link", [&](const XMLElement& element) {
          return Attribute(&element, "name") == name;
        });
    if (link == nullptr) return;
    UrdfLinkShape shape = {name, num_joints,
                           MeshesOf(*link, "visual", base_from_link),
                           MeshesOf(*link, "collision", base_from_link)};
    if (shape.visual.empty() && shape.collision.empty()) return;
    shapes.push_back(std::move(shape));
  };
  add(base_link);
  for (std::size_t k = 0; k < chain.size(); ++k) {
    base_from_link = base_from_link * chain[k].parent_from_joint;
    if (chain[k].type != ChainJoint::Type::kFixed) ++num_joints;
    const XMLElement* const joint =
        Find(*robot, "joint", [&](const XMLElement& element) {
          return Attribute(&element, "name") == names[k];
        });
    if (joint != nullptr) {
      add(Attribute(joint->FirstChildElement("child"), "link"));
    }
  }
  return shapes;
}

}  // namespace alidade::internal
