#include <algorithm>
#include <filesystem>
#include <iostream>
#include <sstream>
#include <utility>

#include "alidade/arm_file.h"
#include "alidade/error.h"
#include "src/cli/command.h"
#include "src/cli/targets.h"
#include "src/common/files.h"
#include "src/common/names.h"
#include "src/dataio/csv_columns.h"
#include "src/dataio/row_condition.h"
#include "src/job/import_data.h"
#include "src/job/result_directory.h"
#include "src/report/table.h"
#include "src/serialization/robot_files.h"

namespace alidade::internal {
namespace {

namespace fs = std::filesystem;

// "mm,deg", in any order; one of both may be left out.
void ReadUnits(const std::string& text, ImportRequest* request) {
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string name = text.substr(begin, end - begin);
    const Unit* const unit = FindHeaderUnit(name);
    if (unit == nullptr) {
      throw InputError({}, "import: --units=" + text + ": \"" + name +
                               "\" is no unit of lengths or angles, expected "
                               "--units=mm,deg for instance");
    }
    (unit->dimension == Dimension::kLength ? request->length_unit
                                           : request->angle_unit) = unit;
    begin = end + 1;
  }
}

// "130-,12,status = lost": as a job's `exclude`, with commas between.
void ReadExclusions(const std::string& text, ImportRequest* request) {
  std::istringstream entries(text);
  for (std::string entry; std::getline(entries, entry, ',');) {
    if (const auto lines = ParseLines(entry)) {
      request->excluded_lines.push_back(*lines);
    } else if (auto condition = ParseRowCondition(entry)) {
      request->exclude.push_back(*std::move(condition));
    } else {
      throw InputError({}, "import: --exclude=" + text + ": " + Quote(entry) +
                               " is neither lines of the file (12, 40-45, "
                               "130-) nor a condition ('status = lost')");
    }
  }
}

void Show(const ImportedData& imported) {
  Table table({">column", "header", "read as", "unit", ">first row"});
  int number = 0;
  for (const ImportedData::Column& column : imported.columns) {
    table.AddRow({CountCell(++number), column.name,
                  column.use.empty() ? "(passed over)" : column.use,
                  column.unit, column.first});
  }
  std::cout << table.ToText();
  for (const std::string& note : imported.notes) {
    std::cout << "- " << note << "\n";
  }
}

// As a job in the directory names it: arms that come with the program are found
// by their names wherever job and program go.
std::string ArmIn(const fs::path& directory, const std::string& path) {
  std::string name = RobotNameOf(path);
  if (!name.empty()) return name;
  return fs::proximate(fs::absolute(path), fs::absolute(directory)).string();
}

}  // namespace

ExitStatus RunImport(const CommandLine& line) {
  const std::string& file = line.files.front();
  if (line.arm.empty()) {
    throw InputError(
        {},
        "import: --arm=ARM.yaml is missing: how many joints there are, and "
        "which slide, is the arm's; 'alidade import --help' says more");
  }
  std::vector<std::string> inputs = {file, line.arm};
  const Arm arm = LoadArm(line.arm, &inputs);
  ImportRequest request{file, arm};
  request.rotation = RotationFlag(line);
  ReadUnits(line.units, &request);
  ReadExclusions(line.exclude, &request);
  const fs::path directory = OutputDirectory(line);
  const std::string data = (directory / "data.csv").string();
  const std::string job = (directory / "job.yaml").string();
  for (const std::string& output : {data, job}) CheckOutputFile(output, inputs);
  const ImportedData imported = ImportData(request);
  std::cout << file << ", read for " << arm.name << "\n";
  Show(imported);
  const Dataset& poses = imported.loaded.data;
  MakeDirectories(directory.string());
  WriteFileAtomically(
      data, DataText(imported, arm,
                     "imported from " + fs::path(file).filename().string()));
  WriteFileAtomically(
      job, JobText(fs::path(file).stem().string(), ArmIn(directory, line.arm),
                   "data.csv", poses.num_poses()));
  std::cout << poses.num_poses() << " poses\n";
  PrintResults({data, job});
  std::cout << "\nNext: alidade calibrate " << job << " --report\n";
  return kExitDone;
}

}  // namespace alidade::internal
