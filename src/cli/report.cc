#include <filesystem>
#include <iostream>

#include "alidade/error.h"
#include "src/cli/command.h"
#include "src/common/files.h"
#include "src/job/report_page.h"
#include "src/job/result_directory.h"

namespace alidade::internal {
namespace {

namespace fs = std::filesystem;

// The page's path: --out names it, or the folder that it is put into.
std::string PagePath(const CommandLine& line) {
  const fs::path out = line.out;
  if (out.extension() == ".html") return line.out;
  const bool compares = line.files.size() > 1;
  // A comparison never takes the place of a result's own page.
  const char* const name = compares ? "comparison.html" : "report.html";
  if (!line.out.empty()) return (out / name).string();
  if (compares) return name;
  const fs::path first = line.files.front();
  return ((fs::is_directory(first) ? first : first.parent_path()) / name)
      .string();
}

ComparisonKind ReadKind(const std::string& word, const ComparisonPage& page) {
  if (word.empty()) return page.GuessKind();
  if (word == "fleet") return ComparisonKind::kFleet;
  if (word == "time") return ComparisonKind::kTime;
  if (word == "methods" || word == "ways") return ComparisonKind::kMethods;
  throw InputError({}, "report: --read-as = \"" + word +
                           "\", expected fleet, time or methods");
}

std::string ComparisonOf(const CommandLine& line, const std::string& path) {
  ComparisonPage page;
  ReadKind(line.read_as,
           page);  // a wrong word is refused before files are read
  const std::vector<std::string> labels = ResultLabels(line.files);
  for (std::size_t i = 0; i < line.files.size(); ++i) {
    AddToComparison(line.files[i], labels[i], path, &page);
  }
  return page.Render(ReadKind(line.read_as, page));
}

}  // namespace

ExitStatus RunReport(const CommandLine& line) {
  const std::string path = PagePath(line);
  CheckOutputFile(path, line.files);
  CheckReportPage(path);
  const std::string page = line.files.size() == 1
                               ? ResultPageOf(line.files.front())
                               : ComparisonOf(line, path);
  const fs::path directory = fs::path(path).parent_path();
  if (!directory.empty()) MakeDirectories(directory.string());
  WriteFileAtomically(path, page);
  NoteReportPage(path);
  std::cout << path << "\n";
  return kExitDone;
}

}  // namespace alidade::internal
