#include "src/job/import_files.h"

#include <string_view>
#include <utility>
#include <vector>

#include "src/common/number_text.h"
#include "src/common/yaml_text.h"
#include "src/dataio/csv_lines.h"
#include "src/dataio/dataset_csv.h"
#include "src/dataio/observation_order.h"

namespace alidade::internal {
namespace {

constexpr Eigen::Index kPosesToHoldOut = 20;

}  // namespace

std::string DataText(const ImportedData& imported, const Arm& arm,
                     const std::string& title) {
  const std::string plain =
      FormatDataset(imported.loaded.data, arm, kFewestDigits, true, {title});
  const std::vector<ObservationRef> rows = InOrderOfPoses(imported.loaded.data);
  std::string text;
  std::size_t row = 0;
  bool is_header = true;
  std::string_view rest = plain;
  while (!rest.empty()) {
    const std::string_view line = TakeLine(&rest);
    text += line;
    if (line.front() != '#') {
      const bool is_row = !std::exchange(is_header, false);
      text += "," + (is_row ? imported.places.at(static_cast<std::size_t>(
                                  rows.at(row++).pose()))
                            : "note");
    }
    text += "\n";
  }
  return text;
}

std::string JobText(const std::string& title, const std::string& arm,
                    const std::string& data, Eigen::Index num_poses) {
  std::string text =
      "format: alidade-job-2\n"
      "title: " +
      QuotedYaml(title) +
      "\n"
      "units: {length: mm, angle: deg}\n"
      "arm: " +
      QuotedYaml(arm) +
      "\n"
      "data: " +
      QuotedYaml(data) +
      "\n"
      "# The instrument's standard deviation of a coordinate, or as here: from "
      "the fit.\n"
      "measurement: {sigma: estimate}\n"
      "identifiability: {parameters: [joints, base, tool]}\n";
  if (num_poses >= kPosesToHoldOut) {
    text +=
        "# Held-out poses, which the result is judged by.\n"
        "validation: {fraction: 0.2}\n";
  }
  return text;
}

}  // namespace alidade::internal
