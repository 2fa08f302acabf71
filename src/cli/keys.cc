#include <algorithm>
#include <iostream>
#include <regex>
#include <string>

#include "src/cli/command.h"
#include "src/common/text.h"
#include "src/serialization/described_formats.h"

namespace alidade::internal {
namespace {

constexpr int kWidth = 80;
constexpr int kIndent = 6;

// "docs/batch.md" of "[batch.md](batch.md)".
std::string WithoutMarks(std::string text) {
  static const std::regex kLink(R"(\[[^\]]*\]\(([^)]*)\))");
  text = std::regex_replace(text, kLink, "docs/$1");
  text.erase(std::remove(text.begin(), text.end(), '`'), text.end());
  return text;
}

// The key with its unit and default, and what it means below.
void Print(const FieldRow& row) {
  std::string head = "  " + row.path;
  const std::string sides =
      row.unit.empty() || row.default_value.empty() ? "" : ", ";
  const std::string about = WithoutMarks(row.unit + sides + row.default_value);
  if (!about.empty()) head += "  (" + about + ")";
  std::cout << head << "\n";
  for (const std::string& line :
       WrapText(WithoutMarks(row.text), kWidth - kIndent)) {
    std::cout << std::string(kIndent, ' ') << line << "\n";
  }
}

void PrintNames(const std::vector<DescribedFormat>& formats) {
  for (const DescribedFormat& format : formats) {
    std::string sections;
    for (const FieldRecord& field : format.fields) {
      if (field.fields.empty()) continue;
      sections += (sections.empty() ? "" : ", ") + std::string(field.key.name);
    }
    std::cout << "  " << format.name;
    if (!sections.empty()) {
      std::cout << std::string(12 - format.name.size(), ' ') << "sections "
                << sections;
    }
    std::cout << "\n";
  }
}

}  // namespace

ExitStatus RunKeys(const CommandLine& line) {
  if (line.files.empty()) {
    std::cout << "Formats\n";
    PrintNames(DescribeFormats());
    std::cout << "Parts of them\n";
    PrintNames(DescribeParts());
    return kExitDone;
  }
  for (const FieldRow& row : FieldRows(FieldsAt(line.files.front()))) {
    Print(row);
  }
  return kExitDone;
}

}  // namespace alidade::internal
