#include "alidade/team.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "alidade/error.h"

namespace alidade::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(TeamTest, GathersByRankWhateverTheSizes) {
  RunAsTeam(4, [](Team* team) {
    const std::string mine(static_cast<std::size_t>(team->rank()),
                           static_cast<char>('a' + team->rank()));
    EXPECT_THAT(team->Gather(mine), ElementsAre("", "b", "cc", "ddd"));
    const std::vector<std::string> at_first = team->GatherToFirst(mine);
    if (team->is_first()) {
      EXPECT_THAT(at_first, ElementsAre("", "b", "cc", "ddd"));
    } else {
      EXPECT_THAT(at_first, IsEmpty());
    }
  });
}

TEST(TeamTest, WhatTheFirstSaysCounts) {
  RunAsTeam(3, [](Team* team) {
    EXPECT_EQ(team->Broadcast(team->is_first() ? "yes" : "never mind"), "yes");
    EXPECT_EQ(team->OfFirst(10.0 + team->rank()), 10.0);
    EXPECT_EQ(team->Sum(team->rank() + 1), 6);
  });
}

TEST(TeamTest, OneMemberIsATeamToo) {
  RunAsTeam(1, [](Team* team) {
    EXPECT_THAT(team->Gather("alone"), ElementsAre("alone"));
    EXPECT_EQ(team->Broadcast("x"), "x");
  });
}

// What each member is thrown, as RunTogether gives it to them.
std::vector<std::string> ErrorsOf(int size,
                                  const std::function<void(Team*)>& work) {
  std::vector<std::string> errors(static_cast<std::size_t>(size), "none");
  try {
    RunAsTeam(size, [&](Team* team) {
      try {
        team->RunTogether([&] { work(team); });
      } catch (const std::exception& error) {
        errors[team->rank()] = error.what();
        throw;
      }
    });
  } catch (const std::exception& error) {
    // The outermost one, of member 0.
    EXPECT_EQ(error.what(), errors[0]);
  }
  return errors;
}

InputError Wrong(int rank) {
  SourceLocation location;
  location.file = "shard" + std::to_string(rank) + ".csv";
  location.line = 7;
  location.column = 2;
  location.key = "x_mm";
  return InputError(location, "is no number");
}

TEST(TeamTest, EverybodyGetsTheErrorOfTheLowestRankThatFailed) {
  const std::string expected = "shard1.csv:7:2: x_mm: is no number";
  EXPECT_THAT(ErrorsOf(4,
                       [](Team* team) {
                         if (team->rank() % 2 == 1) throw Wrong(team->rank());
                         team->Gather("all are well");
                         ADD_FAILURE() << "nobody comes here";
                       }),
              ElementsAre(expected, expected, expected, expected));
}

TEST(TeamTest, AFailureBehindTheLastCallIsNoticedToo) {
  const std::string expected = "shard2.csv:7:2: x_mm: is no number";
  EXPECT_THAT(ErrorsOf(3,
                       [](Team* team) {
                         team->Gather("all are well");
                         if (team->rank() == 2) throw Wrong(2);
                       }),
              ElementsAre(expected, expected, expected));
}

TEST(TeamTest, ErrorsKeepTheirTypes) {
  std::atomic<int> count{0};
  const auto throw_on_last = [](Team* team, const auto& error) {
    if (team->rank() == 1) throw error;
    team->Sum(1);
  };
  RunAsTeam(2, [&](Team* team) {
    const auto run = [&](const auto& error) {
      team->RunTogether([&] { throw_on_last(team, error); });
    };
    EXPECT_THROW(run(std::bad_alloc()), std::bad_alloc);
    EXPECT_THROW(run(std::logic_error("a bug")), std::runtime_error);
    try {
      run(Wrong(1));
    } catch (const InputError& error) {
      EXPECT_EQ(error.location().line, 7);
      EXPECT_EQ(error.message(), "is no number");
      ++count;
    }
    // A team that has failed may be used again.
    EXPECT_EQ(team->Sum(1), 2);
  });
  EXPECT_EQ(count, 2);
}

TEST(TeamTest, OneErrorOfAllIsThatOfTheFirst) {
  const std::string expected = "shard0.csv:7:2: x_mm: is no number";
  EXPECT_THAT(ErrorsOf(2, [](Team* team) { throw Wrong(team->rank()); }),
              ElementsAre(expected, expected));
}

TEST(TeamTest, MessagesOfOneMemberComeInTheirOrder) {
  RunAsTeam(3, [](Team* team) {
    if (!team->is_first()) {
      for (const char* text : {"a", "", "ccc"}) team->Send(0, text);
      return;
    }
    std::vector<std::string> from_all(3);
    for (int count = 0; count < 6;) {
      const std::optional<Team::Message> message = team->Receive();
      if (!message) continue;
      ++count;
      from_all[message->from] += message->bytes + ";";
    }
    EXPECT_THAT(from_all, ElementsAre("", "a;;ccc;", "a;;ccc;"));
    EXPECT_FALSE(team->Receive());
  });
}

TEST(TeamTest, MessagesDoNotMeetCollectiveCalls) {
  RunAsTeam(2, [](Team* team) {
    const int other = 1 - team->rank();
    team->Send(other, "before " + std::to_string(team->rank()));
    EXPECT_EQ(team->Sum(1), 2);
    const std::optional<Team::Message> message = team->Receive();
    ASSERT_TRUE(message);
    EXPECT_EQ(message->from, other);
    EXPECT_EQ(message->bytes, "before " + std::to_string(other));
  });
}

}  // namespace
}  // namespace alidade::internal
