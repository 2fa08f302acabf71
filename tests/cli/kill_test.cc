// Runs that are killed while they write, as users and schedulers do.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <set>
#include <sstream>
#include <string>
#include <system_error>
#include <thread>

#include "src/common/files.h"
#include "src/common/random.h"
#include "tests/support/process.h"

namespace alidade::internal::kill_test {
namespace {

namespace fs = std::filesystem;

using testing::TemporaryDirectory;
using testing::WriteWhole;

// The files are those of the list, each with the bytes that it states; else
// what is wrong.
std::string WhatIsMixed(const std::string& directory) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(directory)) {
    names.insert(entry.path().filename().string());
  }
  names.erase(".alidade-files");
  names.erase("notes.txt");
  std::ifstream list(directory + "/.alidade-files");
  for (std::string line; std::getline(list, line);) {
    std::istringstream cells(line);
    std::string name, size, time, hash;
    std::getline(cells, name, '\t') >> size >> time >> hash;
    if (names.erase(name) == 0) return name + " is missing";
    if (Sha256OfFile(directory + "/" + name) != hash) {
      return name + " is of another result";
    }
  }
  return names.empty() ? "" : *names.begin() + " is not listed";
}

class Process {
 public:
  Process(const std::string& job, const std::string& out, int seed)
      : seed_("--seed=" + std::to_string(seed)), out_("--out=" + out) {
    const char* const arguments[] = {ALIDADE_BINARY, "calibrate",   job.c_str(),
                                     out_.c_str(),   seed_.c_str(), nullptr};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    for (const int file : {STDOUT_FILENO, STDERR_FILENO}) {
      posix_spawn_file_actions_addopen(&actions, file, "/dev/null", O_WRONLY,
                                       0);
    }
    EXPECT_EQ(posix_spawn(&process_, ALIDADE_BINARY, &actions, nullptr,
                          const_cast<char**>(arguments), environ),
              0);
    posix_spawn_file_actions_destroy(&actions);
  }
  std::string Name() const { return std::to_string(process_) + "-"; }
  void Kill() { kill(process_, SIGKILL); }
  bool HasEnded() const {
    siginfo_t info = {};
    waitid(P_PID, process_, &info, WEXITED | WNOHANG | WNOWAIT);
    return info.si_pid == process_;
  }
  /// True where it ended by itself.
  bool Wait() {
    int status = 0;
    waitpid(process_, &status, 0);
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
  }

 private:
  const std::string seed_;
  const std::string out_;
  pid_t process_ = 0;
};

// How often; ALIDADE_KILLS says more.
int NumKills(int usual) {
  const char* const wanted = std::getenv("ALIDADE_KILLS");
  return wanted == nullptr ? usual : std::atoi(wanted);
}

// Killed at random moments of the second half of a run, and every other time as
// soon as a file of the new result is seen, or a little later: however long the
// machine takes to get there, some runs are killed while they write.
TEST(KillTest, AResultIsWholeOrOld) {
  const std::string job = ALIDADE_SOURCE_DIR "/configs/jobs/rv2aj_flange.yaml";
  const TemporaryDirectory scratch;
  const std::string out = scratch / "result";
  // What there is of results that are not finished: of all runs, or of one. A
  // folder may be renamed while it is read, which ends the reading.
  const auto num_staged = [&scratch](const std::string& process = "") {
    int count = 0;
    std::error_code error;
    for (fs::recursive_directory_iterator entry(scratch.path(), error), end;
         entry != end; entry.increment(error)) {
      const std::string path = entry->path().string();
      if (path.find("alidade-staged-" + process) != std::string::npos) ++count;
    }
    return count;
  };
  // Until its folder and a file are there, or it has ended.
  const auto await_writing = [&num_staged](const Process& process) {
    while (num_staged(process.Name()) < 2 && !process.HasEnded()) {
      std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
  };
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  Process first(job, out, 1);
  await_writing(first);
  const auto begin_of_writing = Clock::now();
  ASSERT_TRUE(first.Wait());
  const std::chrono::duration<double> whole = Clock::now() - begin;
  const std::chrono::duration<double> writing = Clock::now() - begin_of_writing;
  WriteWhole(out + "/notes.txt", "mine");
  const int num_kills = NumKills(8);
  ASSERT_GT(num_kills, 0);
  int killed = 0;
  int killed_in_writing = 0;
  Random random(7);
  for (int trial = 0; killed < num_kills && trial < 3 * num_kills; ++trial) {
    Process process(job, out, 2 + trial);
    if (trial % 2 == 1) {
      await_writing(process);
      std::this_thread::sleep_for(writing * random.Uniform(0, 1));
    } else {
      std::this_thread::sleep_for(whole * random.Uniform(0.5, 1.05));
    }
    process.Kill();
    const bool has_ended = process.Wait();
    if (!has_ended) ++killed;
    if (!has_ended && num_staged(process.Name()) > 1) ++killed_in_writing;
    EXPECT_EQ(WhatIsMixed(out), "") << trial;
    EXPECT_TRUE(fs::exists(out + "/notes.txt")) << trial;
  }
  RecordProperty("killed_in_writing", killed_in_writing);
  std::cout << killed << " killed, " << killed_in_writing << " while writing\n";
  EXPECT_GE(killed, num_kills / 2);
  EXPECT_GT(killed_in_writing, 0);
  ASSERT_TRUE(Process(job, out, 1).Wait());
  EXPECT_EQ(WhatIsMixed(out), "");
  EXPECT_EQ(num_staged(), 0);
}

}  // namespace
}  // namespace alidade::internal::kill_test
