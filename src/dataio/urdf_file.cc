#include "src/dataio/urdf_file.h"

#include <tinyxml2.h>

#include <algorithm>

#include "alidade/error.h"
#include "src/common/files.h"
#include "src/common/names.h"
#include "src/common/numbers.h"
#include "src/common/text.h"

namespace alidade::internal {
namespace {

using tinyxml2::XMLElement;

class UrdfReader {
 public:
  explicit UrdfReader(const std::string& path) : path_(path) {
    const std::string text = ReadFile(path);
    if (document_.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
      throw InputError({path_, document_.ErrorLineNum(), 0, ""},
                       "not well-formed XML, expected a URDF file");
    }
    robot_ = document_.FirstChildElement("robot");
    if (robot_ == nullptr) Fail(nullptr, "no <robot>, expected a URDF file");
    if (text.find("<xacro:") != std::string::npos) {
      Fail(robot_, "has xacro macros, expand it first: xacro FILE > FILE.urdf");
    }
  }

  std::vector<ChainJoint> Chain(const std::string& base,
                                const std::string& tip) const {
    std::vector<ChainJoint> chain;
    bool moves = false;
    for (const XMLElement* joint : Joints(base, tip)) {
      chain.push_back(ReadJoint(*joint));
      moves = moves || chain.back().type != ChainJoint::Type::kFixed;
    }
    if (!moves) Fail(robot_, "no joint between the links moves");
    return chain;
  }

  std::vector<std::string> Names(const std::string& base,
                                 const std::string& tip) const {
    std::vector<std::string> names;
    for (const XMLElement* joint : Joints(base, tip)) {
      names.push_back(Attribute(joint, "name"));
    }
    return names;
  }

 private:
  // From the base to the tip.
  std::vector<const XMLElement*> Joints(const std::string& base,
                                        const std::string& tip) const {
    CheckLink(base);
    CheckLink(tip);
    std::vector<const XMLElement*> passed;
    for (std::string link = tip; link != base;) {
      const XMLElement* joint = JointAbove(link);
      const bool loops =
          std::find(passed.begin(), passed.end(), joint) != passed.end();
      if (joint == nullptr || loops) {
        Fail(robot_, "no chain from link " + Quote(base) + " to link " +
                         Quote(tip) + ", expected the tip to hang on the base");
      }
      passed.push_back(joint);
      link = Attribute(joint->FirstChildElement("parent"), "link");
    }
    std::reverse(passed.begin(), passed.end());
    return passed;
  }

  [[noreturn]] void Fail(const XMLElement* at,
                         const std::string& message) const {
    throw InputError({path_, at == nullptr ? 0 : at->GetLineNum(), 0, ""},
                     message);
  }

  static std::string Attribute(const XMLElement* element, const char* name) {
    const char* text = element == nullptr ? nullptr : element->Attribute(name);
    return text == nullptr ? "" : text;
  }

  void CheckLink(const std::string& name) const {
    std::vector<std::string> names;
    for (auto* link = robot_->FirstChildElement("link"); link != nullptr;
         link = link->NextSiblingElement("link")) {
      names.push_back(Attribute(link, "name"));
    }
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      Fail(robot_, UnknownName("link", name, names));
    }
  }

  const XMLElement* JointAbove(const std::string& link) const {
    for (auto* joint = robot_->FirstChildElement("joint"); joint != nullptr;
         joint = joint->NextSiblingElement("joint")) {
      if (Attribute(joint->FirstChildElement("child"), "link") == link) {
        return joint;
      }
    }
    return nullptr;
  }

  double Number(const XMLElement& at, const std::string& text) const {
    const auto number = ParseNumber(text);
    if (!number) Fail(&at, "expected a finite number, found " + Quote(text));
    return *number;
  }

  Eigen::Vector3d ReadVector(const XMLElement& joint, const char* child,
                             const char* name, Eigen::Vector3d value) const {
    const std::string text = Attribute(joint.FirstChildElement(child), name);
    if (text.empty()) return value;
    std::size_t end = 0;
    int count = 0;
    const char* const spaces = " \t\r\n";
    for (std::size_t at = text.find_first_not_of(spaces);
         at != std::string::npos; at = text.find_first_not_of(spaces, end)) {
      end = std::min(text.find_first_of(spaces, at), text.size());
      if (count < 3) value[count] = Number(joint, text.substr(at, end - at));
      ++count;
    }
    if (count != 3) Fail(&joint, "expected 3 numbers, found " + Quote(text));
    return value;
  }

  ChainJoint ReadJoint(const XMLElement& joint) const {
    const std::string type = Attribute(&joint, "type");
    const std::string name = "joint " + Quote(Attribute(&joint, "name"));
    ChainJoint read;
    const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
    const Eigen::Vector3d rpy = ReadVector(joint, "origin", "rpy", zero);
    read.parent_from_joint.translation() =
        ReadVector(joint, "origin", "xyz", zero);
    read.parent_from_joint.linear() =
        (Eigen::AngleAxisd(rpy.z(), Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(rpy.y(), Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(rpy.x(), Eigen::Vector3d::UnitX()))
            .toRotationMatrix();
    read.type = ChainJoint::Type::kFixed;
    if (type == "fixed") return read;
    if (type != "revolute" && type != "continuous" && type != "prismatic") {
      Fail(&joint, name + " is of type " + Quote(type) +
                       ", expected revolute, continuous, prismatic or fixed");
    }
    if (joint.FirstChildElement("mimic") != nullptr) {
      Fail(&joint, name + " mimics another, expected independent joints");
    }
    read.type = type == "prismatic" ? ChainJoint::Type::kPrismatic
                                    : ChainJoint::Type::kRevolute;
    read.axis = ReadVector(joint, "axis", "xyz", Eigen::Vector3d::UnitX());
    if (!(read.axis.norm() > 0.0)) Fail(&joint, name + " has a zero axis");
    const XMLElement* limit = joint.FirstChildElement("limit");
    if (type == "continuous" || limit == nullptr) return read;
    read.lower = read.upper = 0.0;  // URDF's defaults
    const std::string lower = Attribute(limit, "lower");
    const std::string upper = Attribute(limit, "upper");
    if (!lower.empty()) read.lower = Number(*limit, lower);
    if (!upper.empty()) read.upper = Number(*limit, upper);
    CheckLimits(read, *limit, name);
    return read;
  }

  void CheckLimits(const ChainJoint& joint, const XMLElement& limit,
                   const std::string& name) const {
    if (joint.lower <= joint.upper) return;
    Fail(&limit, name + " has the lower limit " + ShortestNumber(joint.lower) +
                     " above the upper one " + ShortestNumber(joint.upper) +
                     ", expected lower <= upper");
  }

  std::string path_;
  tinyxml2::XMLDocument document_;
  const XMLElement* robot_ = nullptr;
};

}  // namespace

std::vector<ChainJoint> LoadUrdfChain(const std::string& path,
                                      const std::string& base_link,
                                      const std::string& tip_link) {
  return UrdfReader(path).Chain(base_link, tip_link);
}

std::vector<std::string> LoadUrdfJointNames(const std::string& path,
                                            const std::string& base_link,
                                            const std::string& tip_link) {
  return UrdfReader(path).Names(base_link, tip_link);
}

}  // namespace alidade::internal
