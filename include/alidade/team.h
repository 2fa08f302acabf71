#ifndef ALIDADE_TEAM_H_
#define ALIDADE_TEAM_H_

#include <cstdint>
#include <exception>
#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "alidade/bytes.h"

namespace alidade {

/// Members that work on one job together, each with a share of its data:
/// processes under mpirun, or threads in a test. Members are numbered from 0,
/// and all of them run the same code.
///
/// Calls that are *collective* are made by every member, in the same order;
/// each waits for what it needs of the others. A member whose work throws does
/// not come to the next of them. So that nobody waits for ever, work of a team
/// is done within RunTogether, which then takes part in its place: on every
/// other member that call throws the same error.
///
/// Messages go from one member to another and are not collective: for work that
/// members do each at a pace of its own, between two collective calls. Whoever
/// sends must know that the other one comes to receive.
///
/// Not to be used by several threads of a member at once.
class Team {
 public:
  struct Message {
    int from = 0;
    std::string bytes;
  };

  virtual ~Team() = default;
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  int rank() const { return rank_; }
  int size() const { return size_; }
  bool is_first() const { return rank_ == 0; }

  /// Collective: the bytes of every member by rank, on every member.
  std::vector<std::string> Gather(std::string mine);
  /// Collective: the same on member 0 alone; nothing on all others.
  std::vector<std::string> GatherToFirst(std::string mine);
  /// Collective: what member 0 calls it with, on every member.
  std::string Broadcast(const std::string& of_first);

  /// Collective: the sum of all members' numbers, on every member.
  std::int64_t Sum(std::int64_t mine);
  /// Collective: the value of member 0, on every member.
  template <typename T>
  T OfFirst(const T& mine) {
    static_assert(std::is_trivially_copyable_v<T>);
    ByteWriter writer;
    writer.Put(mine);
    return ByteReader(Broadcast(writer.Take())).Get<T>();
  }

  /// Not collective: sends to member `to`, another one. Returns once the
  /// message is on its way; what arrives here meanwhile is kept for Receive.
  void Send(int to, const std::string& bytes);
  /// Not collective, does not wait: a message that has arrived, those of one
  /// member in the order that they were sent; nothing where there is none.
  std::optional<Message> Receive();

  /// Collective: work() on every member. Where it throws on some members, the
  /// error of the lowest of their ranks is thrown on all: InputError with its
  /// location, std::bad_alloc, or std::runtime_error for all else.
  void RunTogether(const std::function<void()>& work);

 protected:
  Team(int rank, int size) : rank_(rank), size_(size) {}

  // What a transport does; all are collective and ask for no agreement.
  /// The number of every member by rank.
  virtual std::vector<std::int64_t> Exchange(std::int64_t mine) = 0;
  /// All bytes by rank on member 0, nothing elsewhere. Sizes are known.
  virtual std::vector<std::string> Collect(
      std::string mine, const std::vector<std::int64_t>& sizes) = 0;
  /// The bytes of member `from` on every member. Their size is known: `bytes`
  /// has it.
  virtual void Spread(int from, std::string* bytes) = 0;
  virtual void Transmit(int to, const std::string& bytes) = 0;
  virtual std::optional<Message> Fetch() = 0;
  /// Ends all members at once: no agreement is possible any more.
  [[noreturn]] virtual void Abandon(const std::string& why) = 0;

 private:
  // Between Agree and the end of a transport others count on this member: what
  // is thrown there (no memory for a message) ends all of them.
  template <typename Work>
  auto InTransit(const Work& work);
  // The sizes of what members have to say, once it is clear that none has
  // failed.
  std::vector<std::int64_t> Agree(std::int64_t mine);
  [[noreturn]] void ThrowTogether(const std::vector<std::int64_t>& sizes,
                                  const std::string& error);
  [[noreturn]] void Fail(const std::string& error);

  const int rank_;
  const int size_;
  bool has_failed_ = false;
};

/// An error as bytes, for another member to throw: InputError with its
/// location, std::bad_alloc, or std::runtime_error for all else.
std::string DescribeError(const std::exception& error);
[[noreturn]] void ThrowDescribed(const std::string& description);

/// A team of `size` threads of this process: calls work(member) in each of
/// them, within RunTogether. Returns when all are done. @throws what
/// RunTogether does. For tests, and for trying out what a cluster would do.
void RunAsTeam(int size, const std::function<void(Team*)>& work);

}  // namespace alidade

#endif  // ALIDADE_TEAM_H_
