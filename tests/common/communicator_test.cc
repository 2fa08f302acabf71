#include "alidade/communicator.h"

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

TEST(CommunicatorTest, GathersByRankWhateverTheSizes) {
  RunOnThreads(4, [](Communicator* communicator) {
    const std::string mine(static_cast<std::size_t>(communicator->rank()),
                           static_cast<char>('a' + communicator->rank()));
    EXPECT_THAT(communicator->Gather(mine), ElementsAre("", "b", "cc", "ddd"));
    const std::vector<std::string> at_root = communicator->GatherToRoot(mine);
    if (communicator->is_root()) {
      EXPECT_THAT(at_root, ElementsAre("", "b", "cc", "ddd"));
    } else {
      EXPECT_THAT(at_root, IsEmpty());
    }
  });
}

TEST(CommunicatorTest, WhatTheRootSaysCounts) {
  RunOnThreads(3, [](Communicator* communicator) {
    EXPECT_EQ(
        communicator->Broadcast(communicator->is_root() ? "yes" : "never mind"),
        "yes");
    EXPECT_EQ(communicator->FromRoot(10.0 + communicator->rank()), 10.0);
    EXPECT_EQ(communicator->Sum(communicator->rank() + 1), 6);
  });
}

TEST(CommunicatorTest, CallsOfASingleProcessAreIdentities) {
  Communicator* const alone = SingleProcess();
  EXPECT_TRUE(alone->is_root());
  EXPECT_EQ(alone->size(), 1);
  EXPECT_THAT(alone->Gather("a"), ElementsAre("a"));
  EXPECT_THAT(alone->GatherToRoot("b"), ElementsAre("b"));
  EXPECT_EQ(alone->Broadcast("c"), "c");
  EXPECT_EQ(alone->FromRoot(2.5), 2.5);
  EXPECT_EQ(alone->Sum(-3), -3);
  EXPECT_FALSE(alone->Receive().has_value());
  EXPECT_THROW(alone->RunTogether([] { throw std::out_of_range("far"); }),
               std::out_of_range);
}

TEST(CommunicatorTest, OneRankIsEnough) {
  RunOnThreads(1, [](Communicator* communicator) {
    EXPECT_THAT(communicator->Gather("alone"), ElementsAre("alone"));
    EXPECT_EQ(communicator->Broadcast("x"), "x");
  });
}

// What each rank is thrown, as RunTogether gives it to them.
std::vector<std::string> ErrorsOf(
    int size, const std::function<void(Communicator*)>& work) {
  std::vector<std::string> errors(static_cast<std::size_t>(size), "none");
  try {
    RunOnThreads(size, [&](Communicator* communicator) {
      try {
        communicator->RunTogether([&] { work(communicator); });
      } catch (const std::exception& error) {
        errors[communicator->rank()] = error.what();
        throw;
      }
    });
  } catch (const std::exception& error) {
    // The outermost one, of rank 0.
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

TEST(CommunicatorTest, EverybodyGetsTheErrorOfTheLowestRankThatFailed) {
  const std::string expected = "shard1.csv:7:2: x_mm: is no number";
  EXPECT_THAT(ErrorsOf(4,
                       [](Communicator* communicator) {
                         if (communicator->rank() % 2 == 1)
                           throw Wrong(communicator->rank());
                         communicator->Gather("all are well");
                         ADD_FAILURE() << "nobody comes here";
                       }),
              ElementsAre(expected, expected, expected, expected));
}

TEST(CommunicatorTest, AFailureBehindTheLastCallIsNoticedToo) {
  const std::string expected = "shard2.csv:7:2: x_mm: is no number";
  EXPECT_THAT(ErrorsOf(3,
                       [](Communicator* communicator) {
                         communicator->Gather("all are well");
                         if (communicator->rank() == 2) throw Wrong(2);
                       }),
              ElementsAre(expected, expected, expected));
}

TEST(CommunicatorTest, ErrorsKeepTheirTypes) {
  std::atomic<int> count{0};
  const auto throw_on_last = [](Communicator* communicator, const auto& error) {
    if (communicator->rank() == 1) throw error;
    communicator->Sum(1);
  };
  RunOnThreads(2, [&](Communicator* communicator) {
    const auto run = [&](const auto& error) {
      communicator->RunTogether([&] { throw_on_last(communicator, error); });
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
    // A communicator that has failed may be used again.
    EXPECT_EQ(communicator->Sum(1), 2);
  });
  EXPECT_EQ(count, 2);
}

TEST(CommunicatorTest, OneErrorOfAllIsThatOfTheFirst) {
  const std::string expected = "shard0.csv:7:2: x_mm: is no number";
  EXPECT_THAT(ErrorsOf(2,
                       [](Communicator* communicator) {
                         throw Wrong(communicator->rank());
                       }),
              ElementsAre(expected, expected));
}

TEST(CommunicatorTest, MessagesOfOneMemberComeInTheirOrder) {
  RunOnThreads(3, [](Communicator* communicator) {
    if (!communicator->is_root()) {
      for (const char* text : {"a", "", "ccc"}) communicator->Send(0, text);
      return;
    }
    std::vector<std::string> from_all(3);
    for (int count = 0; count < 6;) {
      const std::optional<Communicator::Message> message =
          communicator->Receive();
      if (!message) continue;
      ++count;
      from_all[message->from] += message->bytes + ";";
    }
    EXPECT_THAT(from_all, ElementsAre("", "a;;ccc;", "a;;ccc;"));
    EXPECT_FALSE(communicator->Receive());
  });
}

TEST(CommunicatorTest, MessagesDoNotMeetCollectiveCalls) {
  RunOnThreads(2, [](Communicator* communicator) {
    const int other = 1 - communicator->rank();
    communicator->Send(other, "before " + std::to_string(communicator->rank()));
    EXPECT_EQ(communicator->Sum(1), 2);
    const std::optional<Communicator::Message> message =
        communicator->Receive();
    ASSERT_TRUE(message);
    EXPECT_EQ(message->from, other);
    EXPECT_EQ(message->bytes, "before " + std::to_string(other));
  });
}

}  // namespace
}  // namespace alidade::internal
