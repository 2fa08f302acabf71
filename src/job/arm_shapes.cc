#include "src/job/arm_shapes.h"

#include <algorithm>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/error.h"
#include "alidade/units.h"
#include "src/common/files.h"
#include "src/common/text.h"
#include "src/dataio/mesh_file.h"
#include "src/dataio/urdf_file.h"
#include "src/dataio/urdf_shapes.h"
#include "src/serialization/config_file.h"

namespace alidade::internal {
namespace {

namespace fs = std::filesystem;

constexpr int kMostTriangles = 3000;
constexpr std::size_t kMostNotes = 3;
constexpr std::uintmax_t kMostBytes = 100'000'000;

struct UrdfSource {
  std::string file;
  std::string base_link;
  std::string tip_link;
};

bool IsAsItWas(const InputFile& input) {
  std::error_code error;
  return fs::is_regular_file(input.path, error) && !error &&
         Sha256OfFile(input.path) == input.sha256;
}

// Of an arm file that is described by one.
std::optional<UrdfSource> UrdfOf(const std::string& path) {
  const std::string ending = fs::path(path).extension().string();
  if (ending != ".yaml" && ending != ".yml") return std::nullopt;
  try {
    const YamlValue root = ReadConfigFile(path, FileFormat::kArm);
    const std::optional<YamlValue> urdf = root.Find("urdf");
    if (!urdf) return std::nullopt;
    const YamlMap map = urdf->Map({"file", "base_link", "tip_link"});
    return UrdfSource{ResolvePath(path, map.Required("file").Text()),
                      map.Required("base_link").Text(),
                      map.Required("tip_link").Text()};
  } catch (const InputError&) {
    return std::nullopt;  // a file of another kind
  }
}

// Where a mesh is: packages are folders beside the URDF or above it, as far as
// the folder that holds several packages. What a name leads to elsewhere, by
// itself or by "..", is not looked at: a page is sent to others, and a URDF
// that came from others must not choose what is in it.
std::optional<std::string> FindMesh(const std::string& urdf,
                                    const std::string& name) {
  constexpr int kMostFolders = 4;
  std::string rest = name;
  for (const char* scheme : {"package://", "model://", "file://"}) {
    const std::string prefix = scheme;
    if (rest.compare(0, prefix.size(), prefix) == 0) {
      rest = rest.substr(prefix.size());
    }
  }
  const fs::path whole = fs::path(rest).lexically_normal();
  if (whole.is_absolute()) return std::nullopt;
  const fs::path inside =
      whole.lexically_relative(whole.empty() ? "" : *whole.begin());
  std::error_code error;
  fs::path folder = fs::canonical(urdf, error).parent_path();
  if (error) return std::nullopt;
  fs::path top = folder;
  for (int i = 1; i < kMostFolders; ++i) top = top.parent_path();
  for (int i = 0; i < kMostFolders; ++i, folder = folder.parent_path()) {
    for (const fs::path& each : {folder / whole, folder / inside}) {
      const fs::path file = fs::canonical(each, error);
      if (error || !fs::is_regular_file(file, error)) continue;
      if (*file.lexically_relative(top).begin() != "..") return file.string();
    }
    if (!folder.has_relative_path()) break;
  }
  return std::nullopt;
}

class ShapeReader {
 public:
  ShapeReader(UrdfSource source, const Arm& arm)
      : source_(std::move(source)), arm_(arm) {}

  ArmShapes Read() {
    const std::vector<UrdfLinkShape> links =
        LoadUrdfShapes(source_.file, source_.base_link, source_.tip_link);
    const Arm nominal =
        LoadUrdfArm(source_.file, source_.base_link, source_.tip_link);
    if (links.empty() || nominal.num_joints() != arm_.num_joints()) return {};
    frames_ = LinkFrames(nominal, Eigen::VectorXd::Zero(arm_.num_joints()));
    most_ = kMostTriangles / static_cast<int>(links.size());
    for (const UrdfLinkShape& link : links) AddLink(link);
    Note();
    return std::move(shapes_);
  }

 private:
  // As it looks, or else as collisions are checked with.
  void AddLink(const UrdfLinkShape& link) {
    std::string reason = "no mesh";
    for (const auto* meshes : {&link.visual, &link.collision}) {
      if (meshes->empty()) continue;
      std::vector<LinkShape> read;
      try {
        for (const UrdfMesh& mesh : *meshes) {
          read.push_back(ReadMesh(mesh, link.num_joints,
                                  most_ / static_cast<int>(meshes->size())));
        }
      } catch (const InputError& error) {
        reason = error.message();
        continue;
      }
      for (LinkShape& shape : read) shapes_.links.push_back(std::move(shape));
      return;
    }
    missing_.push_back(link.link + " (" + reason + ")");
  }

  LinkShape ReadMesh(const UrdfMesh& mesh, int frame, int most) {
    const std::optional<std::string> path = FindMesh(source_.file, mesh.file);
    if (!path) throw InputError({}, mesh.file + " is not there");
    std::error_code error;
    bytes_ += fs::file_size(*path, error);
    if (error) throw InputError({}, mesh.file + ": " + error.message());
    if (bytes_ > kMostBytes) {
      throw InputError({}, "all meshes together are larger than 100 MB");
    }
    const TriangleMesh small = SimplifyMesh(LoadMesh(*path), std::max(most, 1));
    const auto place = static_cast<std::size_t>(frame);
    const Eigen::Affine3d frame_from_mesh =
        frames_[place].inverse() * mesh.base_from_mesh;
    LinkShape shape = {frame,
                       (frame_from_mesh * small.vertices).eval() / kMillimetre,
                       small.triangles};
    if (!shape.vertices.allFinite()) {
      throw InputError({}, mesh.file + " has numbers that are too large");
    }
    return shape;
  }

  void Note() {
    if (missing_.empty()) return;
    const std::size_t more =
        missing_.size() - std::min(missing_.size(), kMostNotes);
    missing_.resize(missing_.size() - more);
    shapes_.note = "Links without a shape: " + Join(missing_, "; ") +
                   (more > 0 ? " and " + std::to_string(more) + " more" : "") +
                   ".";
  }

  const UrdfSource source_;
  const Arm& arm_;
  std::vector<Eigen::Isometry3d> frames_;
  int most_ = 0;
  std::uintmax_t bytes_ = 0;
  std::vector<std::string> missing_;
  ArmShapes shapes_;
};

}  // namespace

ArmShapes ShapesOf(const std::vector<InputFile>& inputs, const Arm& arm) {
  try {
    for (const InputFile& input : inputs) {
      if (!IsAsItWas(input)) continue;
      const std::optional<UrdfSource> source = UrdfOf(input.path);
      if (!source) continue;
      const bool is_known = std::any_of(
          inputs.begin(), inputs.end(), [&](const InputFile& other) {
            std::error_code error;
            return fs::equivalent(other.path, source->file, error) && !error &&
                   IsAsItWas(other);
          });
      if (is_known) return ShapeReader(*source, arm).Read();
    }
  } catch (const std::exception& error) {
    ArmShapes none;
    none.note =
        std::string("The arm's shape cannot be shown: ") + error.what() + ".";
    return none;
  }
  return {};
}

}  // namespace alidade::internal
