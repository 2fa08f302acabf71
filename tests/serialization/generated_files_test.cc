// What is generated from the descriptions of fields: the tables of
// docs/files.md and schemas/*.json. scripts/generate_docs writes them.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "src/common/files.h"
#include "tests/serialization/described_formats.h"
#include "tests/support/io_test_util.h"

namespace alidade::internal {
namespace {

// Compares a file with what it should be, or writes it.
void ExpectGenerated(const std::string& name, const std::string& text) {
  const std::string path = SourcePath(name);
  if (std::getenv("ALIDADE_GENERATE") != nullptr) {
    std::filesystem::create_directories(
        std::filesystem::path(path).parent_path());
    std::ofstream(path, std::ios::binary) << text;
    return;
  }
  EXPECT_TRUE(std::filesystem::exists(path) && ReadFile(path) == text)
      << name << " is not what the descriptions of fields say: run "
      << "scripts/generate_docs";
}

// "without a, b" as a list.
std::vector<std::string> ParseNames(std::string text) {
  std::replace(text.begin(), text.end(), ',', ' ');
  std::istringstream words(text);
  std::vector<std::string> names;
  for (std::string word; words >> word;) names.push_back(word);
  return names;
}

// A table stands between "<!-- fields: PATH [without SECTION, ...] -->" and
// "<!-- end -->".
TEST(GeneratedFilesTest, TablesOfFilesMd) {
  std::istringstream old(ReadFile(SourcePath("docs/files.md")));
  const std::string mark = "<!-- fields: ";
  std::string text;
  int num_tables = 0;
  for (std::string line; std::getline(old, line);) {
    text += line + "\n";
    if (line.rfind(mark, 0) != 0) continue;
    std::string what = line.substr(mark.size());
    what.resize(what.find(" -->"));
    std::vector<std::string> names = ParseNames(what);
    const std::string path = names.front();
    names.erase(names.begin());
    text += "| key | unit | default | meaning |\n|---|---|---|---|\n" +
            testing::FormatRows(FieldsAt(path), names);
    ++num_tables;
    while (std::getline(old, line) && line != "<!-- end -->") {
    }
    text += "<!-- end -->\n";
  }
  EXPECT_GE(num_tables, 8);
  ExpectGenerated("docs/files.md", text);
}

TEST(GeneratedFilesTest, Schemas) {
  for (const DescribedFormat& format : DescribeFormats()) {
    ExpectGenerated("schemas/" + format.name + ".json",
                    testing::FormatSchema(format));
  }
}

// A reader of the table learns each word.
void ExpectWordsInText(const std::vector<FieldRecord>& fields) {
  for (const FieldRecord& field : fields) {
    for (const std::string& word : field.words) {
      EXPECT_NE(field.text.find("`" + word + "`"), std::string::npos)
          << field.key.name << ": " << word;
    }
    EXPECT_FALSE(field.text.empty()) << field.key.name;
    ExpectWordsInText(field.fields);
  }
}

TEST(GeneratedFilesTest, TextsNameEveryWord) {
  for (const DescribedFormat& format : DescribeFormats()) {
    ExpectWordsInText(format.fields);
  }
}

}  // namespace
}  // namespace alidade::internal
