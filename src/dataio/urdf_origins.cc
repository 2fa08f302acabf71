#include "src/dataio/urdf_origins.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <string_view>
#include <vector>

#include "alidade/error.h"
#include "src/common/files.h"
#include "src/common/names.h"
#include "src/common/number_text.h"
#include "src/compensation/geometry_fit.h"
#include "src/dataio/rotation_convention.h"
#include "src/dataio/urdf_file.h"

namespace alidade::internal {
namespace {

using Eigen::Isometry3d;

const RotationConvention kRollPitchYaw = {false, false, {0, 1, 2}};

std::string ThreeNumbers(const Eigen::Vector3d& numbers) {
  std::string text;
  for (const double number : numbers) {
    text += (text.empty() ? "" : " ") + ShortestNumber(number);
  }
  return text;
}

// Changes attributes of a document's text and leaves all else as it is.
class UrdfEditor {
 public:
  UrdfEditor(std::string path, std::string text)
      : path_(std::move(path)), text_(std::move(text)) {}

  void SetOrigin(const std::string& joint, const Isometry3d& origin) {
    const std::string xyz = ThreeNumbers(origin.translation());
    const std::string rpy = ThreeNumbers(
        NumbersOf(kRollPitchYaw, origin.linear(), Eigen::Vector3d::Zero()));
    Mask();
    const std::size_t begin = FindJoint(joint);
    const std::size_t end = masked_.find("</joint", begin);
    const std::size_t tag = FindTag("origin", begin, end);
    if (tag == std::string::npos) {
      const std::size_t close = CloseOf(begin) + 1;
      text_.insert(close, "<origin xyz=\"" + xyz + "\" rpy=\"" + rpy + "\"/>");
      return;
    }
    SetAttribute(tag, "rpy", rpy);
    Mask();
    SetAttribute(tag, "xyz", xyz);
  }

  const std::string& text() const { return text_; }

 private:
  // Comments and CDATA are no tags.
  void Mask() {
    masked_ = text_;
    for (const auto& [open, close] :
         {std::pair<const char*, const char*>{"<!--", "-->"},
          {"<![CDATA[", "]]>"}}) {
      for (std::size_t at = 0;
           (at = masked_.find(open, at)) != std::string::npos;) {
        const std::size_t end =
            std::min(masked_.find(close, at), masked_.size());
        std::fill(masked_.begin() + static_cast<std::ptrdiff_t>(at),
                  masked_.begin() + static_cast<std::ptrdiff_t>(end), ' ');
      }
    }
  }

  // The '>' that ends the tag, outside quotes.
  std::size_t CloseOf(std::size_t tag) const {
    char quote = '\0';
    for (std::size_t at = tag; at < masked_.size(); ++at) {
      const char c = masked_[at];
      if (quote != '\0') {
        if (c == quote) quote = '\0';
      } else if (c == '"' || c == '\'') {
        quote = c;
      } else if (c == '>') {
        return at;
      }
    }
    return masked_.size();
  }

  std::size_t FindTag(const std::string& name, std::size_t from,
                      std::size_t to) const {
    const std::string open = "<" + name;
    for (std::size_t at = from;
         (at = masked_.find(open, at)) < std::min(to, masked_.size()); ++at) {
      const char next = masked_[at + open.size()];
      if (std::isspace(static_cast<unsigned char>(next)) != 0 || next == '/' ||
          next == '>') {
        return at;
      }
    }
    return std::string::npos;
  }

  // Begin and size of an attribute's value; npos without.
  std::pair<std::size_t, std::size_t> FindAttribute(
      std::size_t tag, const std::string& name) const {
    const std::size_t close = CloseOf(tag);
    for (std::size_t at = tag; (at = masked_.find(name, at)) < close; ++at) {
      std::size_t equals = at + name.size();
      const auto skip = [&](std::size_t* place) {
        while (std::isspace(static_cast<unsigned char>(masked_[*place])) != 0) {
          ++*place;
        }
      };
      skip(&equals);
      const char before = masked_[at - 1];
      if (masked_[equals] != '=' ||
          std::isspace(static_cast<unsigned char>(before)) == 0) {
        continue;
      }
      std::size_t quote = equals + 1;
      skip(&quote);
      const std::size_t end = masked_.find(masked_[quote], quote + 1);
      return {quote + 1, end - quote - 1};
    }
    return {std::string::npos, 0};
  }

  // <joint> that has a parent: <transmission> and <gazebo> have others of the
  // same name.
  std::size_t FindJoint(const std::string& name) const {
    for (std::size_t at = 0;
         (at = FindTag("joint", at, masked_.size())) != std::string::npos;
         ++at) {
      const auto [begin, size] = FindAttribute(at, "name");
      if (begin == std::string::npos || text_.substr(begin, size) != name) {
        continue;
      }
      const std::size_t end = masked_.find("</joint", at);
      if (FindTag("parent", at, end) != std::string::npos) return at;
    }
    throw InputError({path_, 0, 0, ""},
                     "no <joint> " + Quote(name) + " in the file's text");
  }

  void SetAttribute(std::size_t tag, const std::string& name,
                    const std::string& value) {
    const auto [begin, size] = FindAttribute(tag, name);
    if (begin != std::string::npos) {
      text_.replace(begin, size, value);
      return;
    }
    const std::string_view open = "<origin";
    text_.insert(tag + open.size(), " " + name + "=\"" + value + "\"");
  }

  const std::string path_;
  std::string text_;
  std::string masked_;
};

// Frames of an arm's joints at joint values of zero, in the instrument's.
std::vector<Isometry3d> FramesAtZero(const Arm& arm) {
  std::vector<Isometry3d> frames = JointOrigins(arm);
  for (std::size_t j = 1; j < frames.size(); ++j) {
    frames[j] = frames[j - 1] * frames[j];
  }
  return frames;
}

}  // namespace

std::string RewriteUrdf(const UrdfChain& chain, const Arm& nominal,
                        const Arm& real) {
  const auto joints =
      LoadUrdfChain(chain.path, chain.base_link, chain.tip_link);
  const auto names =
      LoadUrdfJointNames(chain.path, chain.base_link, chain.tip_link);
  const std::vector<Isometry3d> nominal_frames = FramesAtZero(nominal);
  const std::vector<Isometry3d> real_frames = FramesAtZero(real);
  UrdfEditor editor(chain.path, ReadFile(chain.path));
  // The link behind each joint, as the file has it and as it is to be.
  Isometry3d link = Isometry3d::Identity();
  Isometry3d new_link = Isometry3d::Identity();
  std::size_t number = 0;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    link = link * joints[i].parent_from_joint;
    if (joints[i].type == ChainJoint::Type::kFixed) {
      new_link = new_link * joints[i].parent_from_joint;
      continue;
    }
    if (number >= nominal_frames.size()) break;
    // What the link is on its joint's axis, it stays.
    const Isometry3d link_from_frame = link.inverse() * nominal_frames[number];
    const Isometry3d wanted = real_frames[number] * link_from_frame.inverse();
    editor.SetOrigin(names[i], new_link.inverse() * wanted);
    new_link = wanted;
    ++number;
  }
  if (number != nominal_frames.size()) {
    throw InputError({chain.path, 0, 0, ""},
                     "has other joints between the links than the arm");
  }
  return editor.text();
}

}  // namespace alidade::internal
