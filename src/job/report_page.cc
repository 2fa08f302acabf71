#include "src/job/report_page.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "alidade/arm_file.h"
#include "alidade/units.h"
#include "src/common/files.h"
#include "src/model/chain_axes.h"
#include "src/report/result_table.h"
#include "src/serialization/result_json.h"

namespace alidade::internal {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostPictures = 60;
constexpr std::size_t kMostRowsLookedAt = 4000;

// Base, corner and axis of every joint, last frame, target; points that
// coincide once.
Eigen::Matrix3Xd Corners(const Arm& arm, const Eigen::VectorXd& joint_values) {
  constexpr double kSamePlace = 1e-6;  // m
  ChainAxes axes;
  ComputeChainAxes(arm, joint_values.data(), &axes);
  const Eigen::Index joints = arm.num_joints();
  Eigen::Matrix3Xd points(3, 2 * joints + 2);
  for (int j = 0; j < arm.num_joints(); ++j) {
    points.col(2 * j) = axes.origin_before.col(j);
    points.col(2 * j + 1) = axes.origin_on_axis.col(j);
  }
  points.col(points.cols() - 2) = axes.instrument_from_last.translation();
  points.col(points.cols() - 1) = axes.instrument_from_target.translation();
  Eigen::Index kept = 1;
  for (Eigen::Index i = 1; i < points.cols(); ++i) {
    if ((points.col(i) - points.col(kept - 1)).norm() < kSamePlace) continue;
    points.col(kept++) = points.col(i);
  }
  return points.leftCols(kept);
}

// The columns of the joint values and their units; empty where the table has
// not those of this arm.
std::vector<std::pair<int, double>> JointColumns(const Arm& arm,
                                                 const ResultTable& table) {
  std::vector<std::pair<int, double>> columns;
  for (int j = 0; j < arm.num_joints(); ++j) {
    const bool turns = arm.joints[j].type == JointType::kRevolute;
    const int column =
        table.Column("q" + std::to_string(j + 1) + (turns ? "_deg" : "_mm"));
    if (column < 0) return {};
    columns.emplace_back(column, turns ? kDegree : kMillimetre);
  }
  return columns;
}

// One row of the table for each pose, some of them where there are many.
std::vector<std::size_t> RowsOfPoses(const ResultTable& table, int column) {
  std::set<double> seen;
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    const double pose = table.Number(row, column);
    if (std::isfinite(pose) && seen.insert(pose).second) rows.push_back(row);
  }
  const std::size_t every = (rows.size() + kMostPictures - 1) / kMostPictures;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < rows.size(); i += every) kept.push_back(rows[i]);
  return kept;
}

TextSource SourceOf(const std::vector<ReportFile>& files,
                    const std::string& name) {
  for (const ReportFile& file : files) {
    if (file.name == name) return file.content;
  }
  return {};
}

std::string ContentOf(const std::vector<ReportFile>& files,
                      const std::string& name) {
  for (const ReportFile& file : files) {
    if (file.name == name) return file.Text();
  }
  return "";
}

std::string ReadIfThere(const fs::path& path) {
  return fs::exists(path) ? ReadFile(path.string()) : "";
}

TextSource SourceIfThere(const fs::path& path) {
  if (!fs::exists(path)) return {};
  return [name = path.string()](const TextSink& sink) {
    ReadInPieces(name, sink);
  };
}

std::string JsonPath(const std::string& path) {
  return fs::is_directory(path) ? (fs::path(path) / "result.json").string()
                                : path;
}

fs::path DirectoryOf(const std::string& path) {
  return fs::absolute(fs::path(JsonPath(path)))
      .lexically_normal()
      .parent_path();
}

// The directory of a result by its path alone: "a", "a/" and "a/result.json"
// name the same.
fs::path NamedDirectory(const std::string& path) {
  const fs::path whole = fs::absolute(path).lexically_normal();
  const bool is_inside = whole.extension() == ".json" || !whole.has_filename();
  return is_inside ? whole.parent_path() : whole;
}

}  // namespace

std::optional<ArmPicture> PictureOf(const Arm& arm,
                                    const TextSource& residuals_csv) {
  if (!residuals_csv) return std::nullopt;
  const ResultTable table = ReadResultTable(residuals_csv, kMostRowsLookedAt);
  const int pose = table.Column("pose");
  const auto joints = JointColumns(arm, table);
  if (pose < 0 || joints.empty()) return std::nullopt;
  ArmPicture picture;
  picture.instrument_from_base = arm.instrument_from_base.matrix().topRows<3>();
  for (const std::size_t row : RowsOfPoses(table, pose)) {
    Eigen::VectorXd values(arm.num_joints());
    for (int j = 0; j < arm.num_joints(); ++j) {
      values[j] = table.Number(row, joints[j].first) * joints[j].second;
    }
    if (!values.allFinite()) continue;
    picture.poses.push_back(static_cast<int>(table.Number(row, pose)));
    picture.lines.push_back(Corners(arm, values));
  }
  if (picture.poses.empty()) return std::nullopt;
  return picture;
}

ReportFile MakeResultPage(const CalibrationResult& result,
                          const std::vector<ReportFile>& files,
                          const std::string& directory,
                          const std::string& sections) {
  ReportSource source;
  source.label = fs::absolute(directory).lexically_normal().filename();
  source.sections = sections;
  source.title = result.title;
  source.result_json = ContentOf(files, "result.json");
  source.report_text = ContentOf(files, "report.txt");
  source.residuals_csv = SourceOf(files, "residuals.csv");
  source.heldout_csv = SourceOf(files, "heldout.csv");
  source.predicted_map_csv = SourceOf(files, "predicted_map.csv");
  source.influence_csv = SourceOf(files, "influence.csv");
  source.picture = PictureOf(result.arm, source.residuals_csv);
  return {"report.html", RenderResultPage(source)};
}

std::string ResultPageOf(const std::string& path) {
  const std::string json = JsonPath(path);
  const fs::path directory = DirectoryOf(path);
  ReportSource source;
  const CalibrationResult result = LoadResultJson(json);
  source.title = result.title;
  source.label = directory.filename().string();
  // Not as it was read: that of an earlier version has no verdict.
  source.result_json = FormatResultJson(result);
  source.report_text = ReadIfThere(directory / "report.txt");
  source.residuals_csv = SourceIfThere(directory / "residuals.csv");
  source.heldout_csv = SourceIfThere(directory / "heldout.csv");
  source.predicted_map_csv = SourceIfThere(directory / "predicted_map.csv");
  source.influence_csv = SourceIfThere(directory / "influence.csv");
  if (fs::exists(directory / "arm.yaml")) {
    source.picture = PictureOf(LoadArm((directory / "arm.yaml").string()),
                               source.residuals_csv);
  }
  return RenderResultPage(source);
}

void AddToComparison(const std::string& path, const std::string& label,
                     const std::string& page_path, ComparisonPage* page) {
  const fs::path report = DirectoryOf(path) / "report.html";
  std::string link;
  if (fs::exists(report)) {
    const fs::path from = fs::absolute(page_path).lexically_normal();
    link = report.lexically_relative(from.parent_path()).generic_string();
  }
  page->Add(label, LoadResultJson(JsonPath(path)), link);
}

std::vector<std::string> ResultLabels(const std::vector<std::string>& paths) {
  std::vector<fs::path> rest;
  std::vector<std::string> labels;
  for (const std::string& path : paths) {
    const fs::path directory = NamedDirectory(path);
    labels.push_back(directory.filename().string());
    rest.push_back(directory.parent_path());
  }
  const auto all_differ = [&labels] {
    return std::set<std::string>(labels.begin(), labels.end()).size() ==
           labels.size();
  };
  // The same directory twice never differs: stop at the root.
  while (!all_differ() &&
         std::any_of(rest.begin(), rest.end(), [](const fs::path& left) {
           return left.has_relative_path();
         })) {
    for (std::size_t i = 0; i < labels.size(); ++i) {
      if (!rest[i].has_relative_path()) continue;
      labels[i] = rest[i].filename().string() + "/" + labels[i];
      rest[i] = rest[i].parent_path();
    }
  }
  return labels;
}

}  // namespace alidade::internal
