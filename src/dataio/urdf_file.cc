#include "src/dataio/urdf_file.h"

#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string_view>

#include "alidade/error.h"
#include "src/common/files.h"
#include "src/common/names.h"
#include "src/common/numbers.h"
#include "src/common/text.h"
#include "src/model/motors.h"

namespace alidade::internal {
namespace {

using tinyxml2::XMLElement;

class UrdfReader {
 public:
  explicit UrdfReader(const std::string& path)
      : UrdfReader(ReadFile(path), path) {}
  UrdfReader(const std::string& text, const std::string& path) : path_(path) {
    if (document_.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
      throw InputError({path_, document_.ErrorLineNum(), 0, ""},
                       "not well-formed XML, expected a URDF file");
    }
    robot_ = document_.FirstChildElement("robot");
    if (robot_ == nullptr) Fail(nullptr, "no <robot>, expected a URDF file");
    RefuseXacro();
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

  // Of the joints that move: the motor that each goes by, and how.
  struct Coupling {
    std::string motor;
    double multiplier = 1.0;
    double offset = 0.0;
  };
  std::vector<Coupling> Couplings(const std::string& base,
                                  const std::string& tip) const {
    std::vector<Coupling> couplings;
    for (const XMLElement* joint : Joints(base, tip)) {
      if (Attribute(joint, "type") == "fixed") continue;
      couplings.push_back(CouplingOf(*joint));
    }
    return couplings;
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

  // Elements, not words in comments, texts and names of spaces.
  static const XMLElement* FindXacro(const XMLElement& element) {
    for (auto* child = element.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      if (std::string_view(child->Name()).substr(0, 6) == "xacro:") {
        return child;
      }
      const XMLElement* const inside = FindXacro(*child);
      if (inside != nullptr) return inside;
    }
    return nullptr;
  }

  void RefuseXacro() const {
    const XMLElement* const macro = FindXacro(*robot_);
    if (macro == nullptr) return;
    const bool is_macro_alone =
        robot_->FirstChildElement("link") == nullptr &&
        std::string_view(macro->Name()) == "xacro:macro";
    Fail(macro, is_macro_alone
                    ? "holds only a xacro macro, which another file calls: "
                      "expand that one, xacro ROBOT.xacro > ROBOT.urdf"
                    : "has xacro macros, expand it first: xacro FILE > "
                      "FILE.urdf");
  }

  // What is not read would be missed without a word.
  void RefuseOthers(const XMLElement& joint, const char* child,
                    std::initializer_list<std::string_view> known) const {
    const XMLElement* const element = joint.FirstChildElement(child);
    if (element == nullptr) return;
    std::vector<std::string> names;
    for (const std::string_view name : known) names.emplace_back(name);
    for (auto* attribute = element->FirstAttribute(); attribute != nullptr;
         attribute = attribute->Next()) {
      if (std::find(names.begin(), names.end(), attribute->Name()) !=
          names.end()) {
        continue;
      }
      Fail(element, std::string("<") + child + "> of joint " +
                        Quote(Attribute(&joint, "name")) + ": " +
                        UnknownName("attribute", attribute->Name(), names));
    }
  }

  double Number(const XMLElement& at, const std::string& text) const {
    const char* const spaces = " \t\r\n";
    const std::size_t begin =
        std::min(text.find_first_not_of(spaces), text.size());
    std::string_view word(text);
    word = word.substr(begin, text.find_last_not_of(spaces) + 1 - begin);
    if (word.substr(0, 1) == "+") word.remove_prefix(1);
    const auto number = ParseNumber(word);
    if (number) return *number;
    const bool is_expression = text.find("${") != std::string::npos;
    Fail(&at, "expected a finite number, found " + Quote(text) +
                  (is_expression ? ", an expression of xacro: expand the file "
                                   "first, xacro FILE > FILE.urdf"
                                 : ""));
  }

  double NumberOr(const XMLElement& at, const char* name, double value) const {
    const std::string text = Attribute(&at, name);
    return text.empty() ? value : Number(at, text);
  }

  Coupling CouplingOf(const XMLElement& joint) const {
    Coupling coupling{Attribute(&joint, "name")};
    const XMLElement* at = &joint;
    std::vector<const XMLElement*> passed;
    while (const XMLElement* mimic = at->FirstChildElement("mimic")) {
      passed.push_back(at);
      const double multiplier = NumberOr(*mimic, "multiplier", 1.0);
      coupling.offset += coupling.multiplier * NumberOr(*mimic, "offset", 0.0);
      coupling.multiplier *= multiplier;
      coupling.motor = Attribute(mimic, "joint");
      at = FindJoint(coupling.motor);
      const bool loops =
          std::find(passed.begin(), passed.end(), at) != passed.end();
      if (at == nullptr || loops) {
        Fail(mimic, "joint " + Quote(Attribute(&joint, "name")) + " mimics " +
                        Quote(coupling.motor) +
                        (loops ? ", which mimics it" : ", which is not there"));
      }
    }
    return coupling;
  }

  const XMLElement* FindJoint(const std::string& name) const {
    for (auto* joint = robot_->FirstChildElement("joint"); joint != nullptr;
         joint = joint->NextSiblingElement("joint")) {
      if (Attribute(joint, "name") == name) return joint;
    }
    return nullptr;
  }

  Eigen::Vector3d ReadVector(const XMLElement& joint, const char* child,
                             const char* name,
                             const Eigen::Vector3d& value) const {
    const std::string text = Attribute(joint.FirstChildElement(child), name);
    if (text.empty()) return value;
    const std::vector<double> numbers = Numbers(joint, text);
    if (numbers.size() != 3) {
      Fail(&joint, "expected 3 numbers, found " + Quote(text));
    }
    return {numbers[0], numbers[1], numbers[2]};
  }

  Eigen::Matrix3d ReadRotation(const XMLElement& joint) const {
    const XMLElement* const origin = joint.FirstChildElement("origin");
    const std::string text = Attribute(origin, "quat_xyzw");
    if (text.empty()) {
      const Eigen::Vector3d rpy =
          ReadVector(joint, "origin", "rpy", Eigen::Vector3d::Zero());
      return (Eigen::AngleAxisd(rpy.z(), Eigen::Vector3d::UnitZ()) *
              Eigen::AngleAxisd(rpy.y(), Eigen::Vector3d::UnitY()) *
              Eigen::AngleAxisd(rpy.x(), Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
    }
    if (!Attribute(origin, "rpy").empty()) {
      Fail(origin, "found \"rpy\" beside \"quat_xyzw\", expected one of both");
    }
    constexpr double kNorm = 1e-3;  // of 1
    const std::vector<double> numbers = Numbers(*origin, text);
    if (numbers.size() == 4) {
      const Eigen::Quaterniond rotation(numbers[3], numbers[0], numbers[1],
                                        numbers[2]);
      if (std::abs(rotation.norm() - 1.0) <= kNorm) {
        return rotation.normalized().toRotationMatrix();
      }
    }
    Fail(origin, "expected a unit quaternion x, y, z, w, found " + Quote(text));
  }

  std::vector<double> Numbers(const XMLElement& at,
                              const std::string& text) const {
    std::vector<double> numbers;
    std::size_t end = 0;
    const char* const spaces = " \t\r\n";
    for (std::size_t begin = text.find_first_not_of(spaces);
         begin != std::string::npos;
         begin = text.find_first_not_of(spaces, end)) {
      end = std::min(text.find_first_of(spaces, begin), text.size());
      numbers.push_back(Number(at, text.substr(begin, end - begin)));
    }
    return numbers;
  }

  ChainJoint ReadJoint(const XMLElement& joint) const {
    const std::string type = Attribute(&joint, "type");
    const std::string name = "joint " + Quote(Attribute(&joint, "name"));
    ChainJoint read;
    const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
    RefuseOthers(joint, "origin", {"xyz", "rpy", "quat_xyzw"});
    RefuseOthers(joint, "axis", {"xyz"});
    RefuseOthers(joint, "mimic", {"joint", "multiplier", "offset"});
    read.parent_from_joint.translation() =
        ReadVector(joint, "origin", "xyz", zero);
    read.parent_from_joint.linear() = ReadRotation(joint);
    read.type = ChainJoint::Type::kFixed;
    if (type == "fixed") return read;
    if (type != "revolute" && type != "continuous" && type != "prismatic") {
      Fail(&joint, name + " is of type " + Quote(type) +
                       ", expected revolute, continuous, prismatic or fixed");
    }
    read.type = type == "prismatic" ? ChainJoint::Type::kPrismatic
                                    : ChainJoint::Type::kRevolute;
    read.axis = ReadVector(joint, "axis", "xyz", Eigen::Vector3d::UnitX());
    // Far from overflow and underflow.
    if (read.axis.cwiseAbs().maxCoeff() > 0.0) read.axis.stableNormalize();
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

// The map stays empty where no joint mimics another.
void SetMotors(const std::vector<UrdfReader::Coupling>& couplings,
               const std::vector<std::string>& motors, Arm* arm) {
  const auto n = static_cast<Eigen::Index>(couplings.size());
  const auto m = static_cast<Eigen::Index>(motors.size());
  Eigen::MatrixXd map = Eigen::MatrixXd::Zero(n, m);
  Eigen::VectorXd offsets = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto motor =
        std::find(motors.begin(), motors.end(), couplings[i].motor);
    map(i, motor - motors.begin()) = couplings[i].multiplier;
    offsets[i] = couplings[i].offset;
  }
  if (!map.isIdentity(0.0)) arm->joints_from_motors = map;
  if (!offsets.isZero(0.0)) arm->motor_offsets = offsets;
}

}  // namespace

std::vector<ChainJoint> LoadUrdfChain(const std::string& path,
                                      const std::string& base_link,
                                      const std::string& tip_link) {
  return UrdfReader(path).Chain(base_link, tip_link);
}

Arm LoadUrdfArm(const std::string& path, const std::string& base_link,
                const std::string& tip_link) {
  return ParseUrdfArm(ReadFile(path), path, base_link, tip_link);
}

Arm ParseUrdfArm(const std::string& text, const std::string& path,
                 const std::string& base_link, const std::string& tip_link) {
  const UrdfReader reader(text, path);
  Arm arm = ArmFromChain(reader.Chain(base_link, tip_link));
  if (arm.num_joints() > kMostJoints) {
    throw InputError({path, 0, 0, ""},
                     std::to_string(arm.num_joints()) +
                         " joints move between the links, expected at most " +
                         std::to_string(kMostJoints));
  }
  const std::vector<UrdfReader::Coupling> couplings =
      reader.Couplings(base_link, tip_link);
  std::vector<std::string> motors;
  for (const UrdfReader::Coupling& coupling : couplings) {
    if (std::find(motors.begin(), motors.end(), coupling.motor) ==
        motors.end()) {
      motors.push_back(coupling.motor);
    }
  }
  SetMotors(couplings, motors, &arm);
  return arm;
}

std::vector<std::string> LoadUrdfJointNames(const std::string& path,
                                            const std::string& base_link,
                                            const std::string& tip_link) {
  return UrdfReader(path).Names(base_link, tip_link);
}

}  // namespace alidade::internal
