#include <algorithm>
#include <filesystem>
#include <iostream>
#include <sstream>
#include <utility>

#include "alidade/arm_file.h"
#include "alidade/error.h"
#include "src/cli/command.h"
#include "src/cli/shell_word.h"
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

// The file whose lines are named, "points.txt" of "points.txt:32"; null: none.
TableToJoin* TableOf(const std::string& name,
                     std::vector<TableToJoin>* tables) {
  for (TableToJoin& table : *tables) {
    if (table.path == name) return &table;
  }
  for (TableToJoin& table : *tables) {
    if (fs::path(table.path).filename() == name) return &table;
  }
  return nullptr;
}

[[noreturn]] void FailExclusion(const std::string& text,
                                const std::string& entry,
                                const std::vector<TableToJoin>& tables) {
  const std::string begin =
      "import: --exclude=" + text + ": " + Quote(entry) + " ";
  if (tables.size() > 1 && ParseLines(entry)) {
    throw InputError({}, begin +
                             "are lines of one of two files, expected which: "
                             "--exclude=" +
                             fs::path(tables[1].path).filename().string() +
                             ":" + entry);
  }
  throw InputError({}, begin +
                           "is neither lines of the file (12, 40-45, 130-; of "
                           "two files points.txt:12) nor a condition ('status "
                           "= lost')");
}

// "130-,12,status = lost": as a job's `exclude`, with commas between. Lines of
// two files stand behind their names.
void ReadExclusions(const std::string& text, std::vector<TableToJoin>* tables) {
  std::istringstream entries(text);
  for (std::string entry; std::getline(entries, entry, ',');) {
    const std::size_t colon = entry.rfind(':');
    TableToJoin* const table = colon == std::string::npos
                                   ? nullptr
                                   : TableOf(entry.substr(0, colon), tables);
    const auto lines = table == nullptr ? ParseLines(entry)
                                        : ParseLines(entry.substr(colon + 1));
    const auto condition = ParseRowCondition(entry);
    if (lines && (table != nullptr || tables->size() == 1)) {
      (table == nullptr ? tables->front() : *table).excluded_lines.Add(*lines);
    } else if (condition && !lines) {
      for (TableToJoin& each : *tables) each.exclude.push_back(*condition);
    } else {
      FailExclusion(text, entry, *tables);
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

// Where a file goes that may have been edited, before `text` takes its place.
// Empty: there is none, or it says the same.
std::string PlaceToKeep(const std::string& path, const std::string& text) {
  if (!fs::is_regular_file(path)) return "";
  const std::string earlier = ReadFile(path);
  if (earlier == text) return "";
  std::string kept = path + ".old";
  for (int number = 2; fs::exists(fs::symlink_status(kept)); ++number) {
    if (fs::is_regular_file(kept) && ReadFile(kept) == earlier) break;
    kept = path + ".old" + std::to_string(number);
  }
  return kept;
}

void WriteAndKeep(const std::string& path, const std::string& text,
                  const std::string& kept) {
  if (!kept.empty()) fs::rename(path, kept);
  WriteFileAtomically(path, text);
  if (kept.empty()) return;
  std::cout << "- " << path << " was there and said something else: it is "
            << "kept as " << kept << "\n";
}

// The two files as one. It is written before all else is certain: messages and
// people's eyes need its lines.
JoinedTables Join(const CommandLine& line, const std::string& path,
                  const std::vector<TableToJoin>& tables) {
  CheckOutputFile(path, line.files);
  JoinedTables joined = JoinTables(tables[0], tables[1], line.match);
  MakeDirectories(fs::path(path).parent_path().string());
  WriteAndKeep(path, joined.text, PlaceToKeep(path, joined.text));
  std::cout << path << "\n";
  for (const std::string& note : joined.notes) {
    std::cout << "- " << note << "\n";
  }
  return joined;
}

// Alidade's own form, and nothing is to be found.
StatedDialect JoinedDialect() {
  StatedDialect dialect;
  dialect.separator = ',';
  dialect.decimal = '.';
  dialect.thousands = '\0';
  dialect.header = 1;
  return dialect;
}

void CheckFiles(const CommandLine& line) {
  const bool are_two = line.files.size() > 1;
  if (!line.match.empty() && !are_two) {
    throw InputError({}, "import: --match=" + line.match +
                             " puts two files together, and one is named");
  }
  if (line.match.empty() && are_two) {
    throw InputError(
        {},
        "import: two files, expected one, or --match=COLUMN: the column "
        "that names the points, by which rows of " +
            line.files[0] + " and " + line.files[1] + " are put together");
  }
  if (line.arm.empty()) {
    throw InputError(
        {},
        "import: --arm=ARM.yaml is missing: how many joints there are, and "
        "which slide, is the arm's; 'alidade import --help' says more");
  }
}

}  // namespace

ExitStatus RunImport(const CommandLine& line) {
  CheckFiles(line);
  std::vector<std::string> inputs = line.files;
  inputs.push_back(line.arm);
  const Arm arm = LoadArm(line.arm, &inputs);
  const fs::path directory = OutputDirectory(line);
  const std::string data = (directory / "data.csv").string();
  const std::string job = (directory / "job.yaml").string();
  for (const std::string& output : {data, job}) CheckOutputFile(output, inputs);
  const bool are_two = line.files.size() > 1;
  const std::string file =
      are_two ? (directory / "joined.csv").string() : line.files.front();
  ImportRequest request{file, arm};
  request.directory = directory.string();
  request.rotation = RotationFlag(line);
  request.rotation_name = line.rotation;
  ReadUnits(line.units, &request);
  std::vector<TableToJoin> tables;
  for (const std::string& path : line.files) tables.push_back({path});
  ReadExclusions(line.exclude, &tables);
  int num_joined = 0;
  if (are_two) {
    num_joined = Join(line, file, tables).num_rows;
    request.dialect = JoinedDialect();
  } else {
    request.dialect.excluded_lines = tables.front().excluded_lines;
    request.exclude = tables.front().exclude;
  }
  const ImportedData imported = ImportData(request);
  if (are_two && imported.num_rows != num_joined) {
    throw InputError({file, 0, 0, ""},
                     std::to_string(num_joined) + " rows were joined and " +
                         std::to_string(imported.num_rows) +
                         " are read or said to be left out: expected cells "
                         "that do not look as the marks of comments");
  }
  std::cout << file << ", read for " << arm.name << "\n";
  Show(imported);
  const Dataset& poses = imported.loaded.data;
  const std::string rows = DataText(
      imported, arm, "imported from " + fs::path(file).filename().string());
  const std::string text =
      JobText(fs::path(line.files.front()).stem().string(),
              ArmIn(directory, line.arm), "data.csv", poses.num_poses());
  const std::string kept = PlaceToKeep(job, text);
  MakeDirectories(directory.string());
  WriteFileAtomically(data, rows);
  std::cout << poses.num_poses() << " poses\n";
  WriteAndKeep(job, text, kept);
  std::vector<std::string> written = {data, job};
  if (are_two) written.insert(written.begin(), file);
  PrintResults(written);
  std::cout << "\nNext: alidade calibrate " << ShellWord(job)
            << " --report --out=" << ShellWord((directory / "result").string())
            << "\n";
  return kExitDone;
}

}  // namespace alidade::internal
