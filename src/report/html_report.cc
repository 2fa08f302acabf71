#include "src/report/html_report.h"

#include <string>

#include "alidade/units.h"
#include "src/report/html_json.h"
#include "src/report/html_page.h"
#include "src/report/result_table.h"

namespace alidade::internal {
namespace {

constexpr std::size_t kMostRows = 4000;
// Beyond this a result.json carries seven digits: those of a page are read by
// people, and its directory has all.
constexpr std::size_t kLargeResult = 500'000;
constexpr int kDigitsOfLarge = 7;
// A tenth of a micrometre: of a picture.
constexpr int kPictureDigits = 6;

template <typename Column>
std::string JsonList(const Column& values, double unit, int digits) {
  std::string json = "[";
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    json += (i > 0 ? "," : "") + JsonNumber(values[i] / unit, digits);
  }
  return json + "]";
}

std::string PictureJson(const ArmPicture& picture) {
  std::string json = "{\"instrument_from_base\":[";
  for (int row = 0; row < 3; ++row) {
    Eigen::Vector4d values = picture.instrument_from_base.row(row);
    values[3] /= kMillimetre;
    json += (row > 0 ? "," : "") + JsonList(values, 1.0, 12);
  }
  json += "],\"poses\":[";
  for (std::size_t i = 0; i < picture.poses.size(); ++i) {
    json += (i > 0 ? "," : "") + std::to_string(picture.poses[i]);
  }
  json += "],\"lines\":[";
  for (std::size_t i = 0; i < picture.lines.size(); ++i) {
    json += i > 0 ? ",[" : "[";
    for (Eigen::Index k = 0; k < picture.lines[i].cols(); ++k) {
      json += (k > 0 ? "," : "") +
              JsonList(picture.lines[i].col(k), kMillimetre, kPictureDigits);
    }
    json += "]";
  }
  return json + "]}";
}

void AppendTable(const std::string& name, const TextSource& csv,
                 std::string* json) {
  if (!csv) return;
  if (json->back() != '{') *json += ",";
  *json += JsonText(name) + ":" + TableJson(ReadResultTable(csv, kMostRows));
}

}  // namespace

std::string RenderResultPage(const ReportSource& source) {
  std::string tables = "{";
  AppendTable("residuals", source.residuals_csv, &tables);
  AppendTable("heldout", source.heldout_csv, &tables);
  AppendTable("predicted_map", source.predicted_map_csv, &tables);
  AppendTable("influence", source.influence_csv, &tables);
  tables += "}";
  const int digits =
      source.result_json.size() > kLargeResult ? kDigitsOfLarge : 0;
  std::string data =
      "{\"format\":\"alidade-page-1\",\"page\":\"result\",\"results\":[{"
      "\"label\":" +
      JsonText(source.label) +
      ",\"result\":" + CompactJson(source.result_json, digits) +
      ",\"tables\":" + tables;
  if (source.picture) data += ",\"picture\":" + PictureJson(*source.picture);
  return FillPage(source.title, data + "}]}", source.report_text,
                  source.sections);
}

}  // namespace alidade::internal
