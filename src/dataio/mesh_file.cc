#include "src/dataio/mesh_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "alidade/error.h"
#include "src/common/characters.h"
#include "src/common/files.h"
#include "src/common/numbers.h"

namespace alidade::internal {
namespace {

using Eigen::Vector3d;

constexpr std::uintmax_t kMostBytes = 64'000'000;
constexpr std::size_t kHeaderBytes = 84;
constexpr std::size_t kTriangleBytes = 50;
// Of the smallest sensible arm to the largest, in any unit.
constexpr double kLargest = 1e9;

[[noreturn]] void Fail(const std::string& path, const std::string& message) {
  throw InputError({path, 0, 0, ""}, message);
}

bool IsUsable(const Vector3d& point) {
  return point.allFinite() && point.cwiseAbs().maxCoeff() < kLargest;
}

// Collects triangles whose corners are usable.
class MeshBuilder {
 public:
  int AddVertex(const Vector3d& vertex) {
    vertices_.push_back(vertex);
    return static_cast<int>(vertices_.size()) - 1;
  }
  int num_vertices() const { return static_cast<int>(vertices_.size()); }

  void AddTriangle(const std::array<int, 3>& corners) {
    if (std::all_of(corners.begin(), corners.end(), [this](int corner) {
          return IsUsable(vertices_[static_cast<std::size_t>(corner)]);
        })) {
      triangles_.push_back(corners);
    }
  }

  TriangleMesh Finish(const std::string& path) const {
    if (triangles_.empty()) Fail(path, "has no triangle");
    TriangleMesh mesh;
    mesh.vertices.resize(3, static_cast<Eigen::Index>(vertices_.size()));
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
      mesh.vertices.col(static_cast<Eigen::Index>(i)) = vertices_[i];
    }
    mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles_.size()));
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      mesh.triangles.col(static_cast<Eigen::Index>(i)) =
          Eigen::Map<const Eigen::Vector3i>(triangles_[i].data());
    }
    return mesh;
  }

 private:
  std::vector<Vector3d> vertices_;
  std::vector<std::array<int, 3>> triangles_;
};

// STL is little-endian, and so is what this program runs on.
template <typename Number>
Number At(const std::string& bytes, std::size_t place) {
  Number number;
  std::memcpy(&number, bytes.data() + place, sizeof number);
  return number;
}

TriangleMesh ReadBinaryStl(const std::string& path, const std::string& bytes) {
  const std::size_t count = At<std::uint32_t>(bytes, kHeaderBytes - 4);
  if (count > (bytes.size() - kHeaderBytes) / kTriangleBytes) {
    Fail(path,
         "is cut short: states " + std::to_string(count) +
             " triangles and has room for " +
             std::to_string((bytes.size() - kHeaderBytes) / kTriangleBytes));
  }
  MeshBuilder mesh;
  for (std::size_t i = 0; i < count; ++i) {
    // Behind the normal.
    const std::size_t start = kHeaderBytes + i * kTriangleBytes + 12;
    std::array<int, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      Vector3d vertex;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        vertex[static_cast<Eigen::Index>(axis)] =
            static_cast<double>(At<float>(bytes, start + 4 * (3 * k + axis)));
      }
      corners[k] = mesh.AddVertex(vertex);
    }
    mesh.AddTriangle(corners);
  }
  return mesh.Finish(path);
}

// Words one after the other, whatever space is between them.
class WordReader {
 public:
  explicit WordReader(std::string_view text) : text_(text) {}

  std::optional<std::string_view> Next() {
    while (at_ < text_.size() && IsSpace(text_[at_])) ++at_;
    if (at_ == text_.size()) return std::nullopt;
    const std::size_t begin = at_;
    while (at_ < text_.size() && !IsSpace(text_[at_])) ++at_;
    return text_.substr(begin, at_ - begin);
  }

  // NaN where there is none.
  double NextNumber() {
    const std::optional<std::string_view> word = Next();
    return word ? ParseNumber(*word).value_or(
                      std::numeric_limits<double>::quiet_NaN())
                : std::numeric_limits<double>::quiet_NaN();
  }

  Vector3d NextPoint() {
    const double x = NextNumber();
    const double y = NextNumber();
    return {x, y, NextNumber()};
  }

 private:
  static bool IsSpace(char c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

TriangleMesh ReadTextStl(const std::string& path, const std::string& text) {
  MeshBuilder mesh;
  WordReader words(text);
  std::vector<int> corners;
  while (const std::optional<std::string_view> word = words.Next()) {
    if (*word == "facet") corners.clear();
    if (*word != "vertex") continue;
    corners.push_back(mesh.AddVertex(words.NextPoint()));
    if (corners.size() == 3) {
      mesh.AddTriangle({corners[0], corners[1], corners[2]});
    }
  }
  return mesh.Finish(path);
}

TriangleMesh ReadStl(const std::string& path, const std::string& bytes) {
  const bool has_header = bytes.size() >= kHeaderBytes;
  const bool is_exact =
      has_header && (bytes.size() - kHeaderBytes) ==
                        kTriangleBytes * std::size_t{At<std::uint32_t>(
                                             bytes, kHeaderBytes - 4)};
  // Headers of binary files begin with "solid" too.
  const bool is_text = bytes.compare(0, 5, "solid") == 0 && !is_exact;
  if (is_text) return ReadTextStl(path, bytes);
  if (!has_header) Fail(path, "is cut short, expected an STL file");
  return ReadBinaryStl(path, bytes);
}

// The vertex of "7/2/5", "7" or "-1"; none where it is not there.
std::optional<int> CornerOf(std::string_view word, int num_vertices) {
  const auto number = ParseWhole<int>(word.substr(0, word.find('/')));
  if (!number) return std::nullopt;
  const std::int64_t place = *number > 0 ? std::int64_t{*number} - 1
                                         : std::int64_t{num_vertices} + *number;
  if (*number == 0 || place < 0 || place >= num_vertices) return std::nullopt;
  return static_cast<int>(place);
}

TriangleMesh ReadObj(const std::string& path, const std::string& text) {
  MeshBuilder mesh;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    WordReader words(std::string_view(text).substr(begin, end - begin));
    begin = end + 1;
    const std::optional<std::string_view> kind = words.Next();
    if (kind == "v") mesh.AddVertex(words.NextPoint());
    if (kind != "f") continue;
    // A polygon as triangles about its first corner.
    std::vector<int> corners;
    while (const std::optional<std::string_view> word = words.Next()) {
      const std::optional<int> corner = CornerOf(*word, mesh.num_vertices());
      if (!corner) {
        Fail(path, "has a face with a corner \"" + std::string(*word) +
                       "\" that is not there");
      }
      corners.push_back(*corner);
    }
    for (std::size_t k = 2; k < corners.size(); ++k) {
      mesh.AddTriangle({corners[0], corners[k - 1], corners[k]});
    }
  }
  return mesh.Finish(path);
}

std::string EndingOf(const std::string& path) {
  return LowerCase(std::filesystem::path(path).extension().string());
}

// Three whole numbers below 2^21 as one.
std::uint64_t Packed(const std::array<std::uint64_t, 3>& numbers) {
  return numbers[0] << 42U | numbers[1] << 21U | numbers[2];
}

// Vertices of a cell of the grid become their mean. @pre at most 2^21 cells or
// vertices.
TriangleMesh Clustered(const TriangleMesh& mesh, const Vector3d& lower,
                       double cell) {
  std::unordered_map<std::uint64_t, int> cells;
  std::vector<Vector3d> sums;
  std::vector<int> counts;
  std::vector<int> cluster_of(static_cast<std::size_t>(mesh.vertices.cols()),
                              -1);
  const auto cluster = [&](int vertex) {
    int& found = cluster_of[static_cast<std::size_t>(vertex)];
    if (found >= 0) return found;
    const Vector3d point = mesh.vertices.col(vertex);
    std::array<std::uint64_t, 3> key{};
    for (int axis = 0; axis < 3; ++axis) {
      key[static_cast<std::size_t>(axis)] = static_cast<std::uint64_t>(
          std::max(0.0, (point[axis] - lower[axis]) / cell));
    }
    const auto [place, is_new] =
        cells.emplace(Packed(key), static_cast<int>(sums.size()));
    if (is_new) {
      sums.emplace_back(Vector3d::Zero());
      counts.push_back(0);
    }
    found = place->second;
    sums[static_cast<std::size_t>(found)] += point;
    ++counts[static_cast<std::size_t>(found)];
    return found;
  };
  // The same three corners once, whichever comes first.
  std::unordered_set<std::uint64_t> seen;
  std::vector<Eigen::Vector3i> kept;
  for (Eigen::Index i = 0; i < mesh.triangles.cols(); ++i) {
    Eigen::Vector3i corners;
    for (int k = 0; k < 3; ++k) corners[k] = cluster(mesh.triangles(k, i));
    std::array<std::uint64_t, 3> key{};
    std::copy(corners.begin(), corners.end(), key.begin());
    std::sort(key.begin(), key.end());
    if (key[0] == key[1] || key[1] == key[2]) continue;
    if (seen.insert(Packed(key)).second) kept.push_back(corners);
  }
  TriangleMesh small;
  small.vertices.resize(3, static_cast<Eigen::Index>(sums.size()));
  for (std::size_t i = 0; i < sums.size(); ++i) {
    small.vertices.col(static_cast<Eigen::Index>(i)) = sums[i] / counts[i];
  }
  small.triangles.resize(3, static_cast<Eigen::Index>(kept.size()));
  for (std::size_t i = 0; i < kept.size(); ++i) {
    small.triangles.col(static_cast<Eigen::Index>(i)) = kept[i];
  }
  return small;
}

}  // namespace

TriangleMesh ParseMesh(const std::string& content, const std::string& path) {
  return EndingOf(path) == ".obj" ? ReadObj(path, content)
                                  : ReadStl(path, content);
}

TriangleMesh LoadMesh(const std::string& path) {
  const std::string ending = EndingOf(path);
  if (ending != ".stl" && ending != ".obj") {
    Fail(path, "expected an STL or OBJ file");
  }
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (!error && size > kMostBytes) Fail(path, "is larger than 64 MB");
  return ParseMesh(ReadFile(path), path);
}

TriangleMesh SimplifyMesh(const TriangleMesh& mesh, int most) {
  Vector3d lower = Vector3d::Constant(std::numeric_limits<double>::infinity());
  Vector3d upper = -lower;
  for (const int vertex : mesh.triangles.reshaped()) {
    lower = lower.cwiseMin(mesh.vertices.col(vertex));
    upper = upper.cwiseMax(mesh.vertices.col(vertex));
  }
  const double size = (upper - lower).maxCoeff();
  constexpr double kSmallest = 1e-9;  // in any unit
  if (!(size > kSmallest)) return {};
  // STL repeats the corners that triangles share.
  constexpr double kParts = 120.0;
  constexpr Eigen::Index kManyTriangles = 100'000;
  const bool is_large = mesh.triangles.cols() > kManyTriangles;
  TriangleMesh small =
      Clustered(mesh, lower, size / (is_large ? kParts : 4.0 * kParts));
  for (double parts = kParts; small.triangles.cols() > most && parts > 1.0;
       parts *= 0.8) {
    TriangleMesh smaller = Clustered(small, lower, size / parts);
    if (smaller.triangles.cols() == 0) break;
    small = std::move(smaller);
  }
  if (small.triangles.cols() > most) {
    small.triangles.conservativeResize(Eigen::NoChange, most);
  }
  return small;
}

}  // namespace alidade::internal
