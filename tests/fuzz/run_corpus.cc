// Runs one target over files and over seeded mutations of them, without
// libFuzzer. The input of the moment is always in fuzz_TARGET.input, for a look
// at it where the process ends.
//
// Usage: fuzz_corpus TARGET MUTATIONS DICTIONARY DIRECTORY...

#include <glog/logging.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <vector>

#include "src/common/random.h"
#include "tests/fuzz/fuzz_target.h"

namespace alidade::internal::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostBytes = 8192;

std::string ReadWhole(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  Require(file.good(), path.string() + " cannot be read");
  return {std::istreambuf_iterator<char>(file), {}};
}

// Whole, in the order of their names.
std::vector<std::string> InputsBelow(const std::string& directory) {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(directory)) {
    paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  std::vector<std::string> inputs;
  for (const fs::path& path : paths) inputs.push_back(ReadWhole(path));
  return inputs;
}

// What stands in quotes in a dictionary of libFuzzer's.
std::vector<std::string> ReadWords(const std::string& path) {
  static const std::regex kEscape(R"(\\(?:x([0-9a-fA-F]{2})|(["\\])))");
  std::ifstream lines(path);
  std::vector<std::string> words;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t first = line.find('"');
    const std::size_t last = line.rfind('"');
    if (line.empty() || line[0] == '#' || first >= last) continue;
    std::string word;
    std::string rest = line.substr(first + 1, last - first - 1);
    for (std::smatch match; std::regex_search(rest, match, kEscape);) {
      word += match.prefix();
      word += match[1].matched
                  ? static_cast<char>(std::stoi(match[1], nullptr, 16))
                  : *match[2].first;
      rest = match.suffix();
    }
    words.push_back(word + rest);
  }
  return words;
}

class Mutator {
 public:
  Mutator(std::uint64_t seed, std::vector<std::string> words)
      : random_(seed), words_(std::move(words)) {
    if (words_.empty()) words_.emplace_back("0");
  }

  std::string Mutate(std::string input) {
    const std::size_t num_edits = 1 + Below(4);
    for (std::size_t i = 0; i < num_edits; ++i) Edit(&input);
    input.resize(std::min(input.size(), kMostBytes));
    return input;
  }

 private:
  std::size_t Below(std::size_t bound) {
    return static_cast<std::size_t>(random_.Next() % bound);
  }

  void Edit(std::string* input) {
    const std::size_t at = Below(input->size() + 1);
    const std::size_t length = std::min(Below(32) + 1, input->size() - at);
    switch (Below(4)) {
      case 0:
        if (length > 0) (*input)[at] ^= static_cast<char>(1U << Below(8));
        break;
      case 1:
        input->erase(at, length);
        break;
      case 2:
        input->insert(Below(input->size() + 1), input->substr(at, length));
        break;
      default:
        input->insert(at, words_[Below(words_.size())]);
    }
  }

  Random random_;
  std::vector<std::string> words_;
};

void Run(const FuzzTarget& target, const std::string& input) {
  const std::string path = std::string("fuzz_") + target.name + ".input";
  std::ofstream(path, std::ios::binary) << input;
  RunTarget(target, input);
}

int Main(const std::vector<std::string>& arguments) {
  const auto& targets = FuzzTargets();
  const auto target =
      std::find_if(targets.begin(), targets.end(), [&](const FuzzTarget& one) {
        return !arguments.empty() && arguments[0] == one.name;
      });
  if (target == targets.end() || arguments.size() < 4) {
    std::fputs("usage: fuzz_corpus TARGET MUTATIONS DICTIONARY DIRECTORY...\n",
               stderr);
    return 2;
  }
  FLAGS_minloglevel = google::GLOG_FATAL;
  std::vector<std::string> inputs;
  for (auto it = arguments.begin() + 3; it != arguments.end(); ++it) {
    for (std::string& input : InputsBelow(*it)) {
      inputs.push_back(std::move(input));
    }
  }
  Require(!inputs.empty(), "no inputs");
  for (const std::string& input : inputs) Run(*target, input);
  Mutator mutator(1, ReadWords(arguments[2]));
  const int num_mutations = std::stoi(arguments[1]);
  for (int i = 0; i < num_mutations; ++i) {
    Run(*target, mutator.Mutate(inputs[i % inputs.size()]));
  }
  std::printf("%s: %zu files, %d mutations\n", target->name, inputs.size(),
              num_mutations);
  return 0;
}

}  // namespace
}  // namespace alidade::internal::fuzz

int main(int argc, char** argv) {
  return alidade::internal::fuzz::Main({argv + 1, argv + argc});
}
