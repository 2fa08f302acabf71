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
#include "src/job/import_files.h"
#include "src/job/join_tables.h"
#include "src/job/result_directory.h"
#include "src/report/table.h"
#include "src/serialization/robot_files.h"

namespace alidade::internal {
namespace {

namespace fs = std::filesystem;

// "mm,deg", in any order; one of both may be left out, and a second unit of
// angles is that of orientations.
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
    const bool is_length = unit->dimension == Dimension::kLength;
    const bool is_second = !is_length && request->angle_unit != nullptr;
    const Unit*& member = is_length   ? request->length_unit
                          : is_second ? request->rotation_unit
                                      : request->angle_unit;
    if (member != nullptr) {
      throw InputError({}, "import: --units=" + text +
                               ": a unit too many of its kind, expected one "
                               "of lengths, one of joints and one of "
                               "orientations: mm,rad,deg");
    }
    member = unit;
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
  for (const ImportedColumn& column : imported.columns) {
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

// A job that is there may have been edited: it is kept, under another name.
// Empty: there was none, or it says the same.
std::string KeepEarlierJob(const std::string& job, const std::string& text) {
  if (!fs::exists(job) || ReadFile(job) == text) return "";
  std::string kept = job + ".old";
  for (int number = 2; fs::exists(kept); ++number) {
    if (ReadFile(kept) == ReadFile(job)) return kept;
    kept = job + ".old" + std::to_string(number);
  }
  fs::rename(job, kept);
  return kept;
}

// The two files as one, which is kept for people to look at.
std::string Joined(const CommandLine& line, const fs::path& directory) {
  const std::string& first = line.files[0];
  const std::string& second = line.files[1];
  if (line.match.empty()) {
    throw InputError(
        {},
        "import: two files, expected one, or --match=COLUMN: the column "
        "that names the points, by which rows of " +
            first + " and " + second + " are put together");
  }
  std::string path = (directory / "joined.csv").string();
  CheckOutputFile(path, {first, second});
  const JoinedTables joined = JoinTables(first, second, line.match);
  MakeDirectories(directory.string());
  WriteFileAtomically(path, joined.text);
  std::cout << path << "\n";
  for (const std::string& note : joined.notes)
    std::cout << "- " << note << "\n";
  return path;
}

}  // namespace

ExitStatus RunImport(const CommandLine& line) {
  if (!line.match.empty() && line.files.size() == 1) {
    throw InputError({}, "import: --match=" + line.match +
                             " puts two files together, and one is named");
  }
  if (line.arm.empty()) {
    throw InputError(
        {},
        "import: --arm=ARM.yaml is missing: how many joints there are, and "
        "which slide, is the arm's; 'alidade import --help' says more");
  }
  std::vector<std::string> inputs = line.files;
  inputs.push_back(line.arm);
  const Arm arm = LoadArm(line.arm, &inputs);
  const fs::path directory = OutputDirectory(line);
  const bool are_two = line.files.size() > 1;
  const std::string file =
      are_two ? Joined(line, directory) : line.files.front();
  ImportRequest request{file, arm};
  request.rotation = RotationFlag(line);
  ReadUnits(line.units, &request);
  ReadExclusions(line.exclude, &request);
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
  const std::string text =
      JobText(fs::path(line.files.front()).stem().string(),
              ArmIn(directory, line.arm), "data.csv", poses.num_poses());
  const std::string kept = KeepEarlierJob(job, text);
  WriteFileAtomically(job, text);
  std::cout << poses.num_poses() << " poses\n";
  if (!kept.empty()) {
    std::cout << "- " << job << " was there and said something else: it is "
              << "kept as " << kept << "\n";
  }
  std::vector<std::string> written = {data, job};
  if (are_two) written.insert(written.begin(), file);
  PrintResults(written);
  std::cout << "\nNext: alidade calibrate " << job
            << " --report --out=" << (directory / "result").string() << "\n";
  return kExitDone;
}

}  // namespace alidade::internal
