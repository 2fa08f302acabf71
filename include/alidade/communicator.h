#ifndef ALIDADE_COMMUNICATOR_H_
#define ALIDADE_COMMUNICATOR_H_

#include <cstdint>
#include <cstring>
#include <exception>
#include <functional>
#include <new>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace alidade {

/// Ranks that work on one job together, each with a part of its data: this
/// process alone (SingleProcess), processes under mpirun, or threads in a test.
/// Ranks are numbered from 0, the root, and all of them run the same code.
///
/// Calls that are *collective* are made by every rank, in the same order;
/// each waits for what it needs of the others. A rank whose work throws does
/// not come to the next of them. So that nobody waits for ever, collective work
/// is done within RunTogether, which then takes part in its place: on every
/// other rank that call throws the same error.
///
/// Messages go from one rank to another and are not collective: for work that
/// ranks do each at a pace of its own, between two collective calls. Whoever
/// sends must know that the other one comes to receive.
///
/// Not to be used by several threads of a rank at once.
class Communicator {
 public:
  struct Message {
    int from = 0;
    std::string bytes;
  };

  /// One rank alone.
  Communicator() : Communicator(0, 1) {}
  virtual ~Communicator() = default;
  Communicator(const Communicator&) = delete;
  Communicator& operator=(const Communicator&) = delete;

  int rank() const { return rank_; }
  int size() const { return size_; }
  bool is_root() const { return rank_ == 0; }

  /// Collective: the bytes of every rank by rank, on every rank.
  std::vector<std::string> Gather(std::string mine);
  /// Collective: the same on the root alone; nothing on all others.
  std::vector<std::string> GatherToRoot(std::string mine);
  /// Collective: what the root calls it with, on every rank.
  std::string Broadcast(const std::string& of_root);

  /// Collective: the sum of all ranks' numbers, on every rank.
  std::int64_t Sum(std::int64_t mine);
  /// Collective: the value of the root, on every rank.
  template <typename T>
  T FromRoot(const T& mine) {
    static_assert(std::is_trivially_copyable_v<T>);
    std::string bytes(sizeof(T), '\0');
    std::memcpy(bytes.data(), &mine, sizeof(T));
    bytes = Broadcast(bytes);
    T of_root;
    std::memcpy(&of_root, bytes.data(), sizeof(T));
    return of_root;
  }

  /// Not collective: sends to rank `to`, another one. Returns once the
  /// message is on its way; what arrives here meanwhile is kept for Receive.
  void Send(int to, const std::string& bytes);
  /// Not collective, does not wait: a message that has arrived, those of one
  /// rank in the order that they were sent; nothing where there is none.
  std::optional<Message> Receive();

  /// Collective: work() on every rank. Where it throws on some ranks, the
  /// error of the lowest of their ranks is thrown on all: InputError with its
  /// location, std::bad_alloc, or std::runtime_error for all else.
  void RunTogether(const std::function<void()>& work);

 protected:
  Communicator(int rank, int size) : rank_(rank), size_(size) {}

  // What a transport does: by itself that of one rank alone. All are collective
  // and ask for no agreement.
  /// The number of every rank by rank.
  virtual std::vector<std::int64_t> Exchange(std::int64_t mine) {
    return {mine};
  }
  /// All bytes by rank on the root, nothing elsewhere. Sizes are known.
  virtual std::vector<std::string> Collect(
      std::string mine, const std::vector<std::int64_t>& /*sizes*/) {
    return {std::move(mine)};
  }
  /// The bytes of rank `from` on every rank. Their size is known: `bytes`
  /// has it.
  virtual void Spread(int /*from*/, std::string* /*bytes*/) {}
  virtual void Transmit(int /*to*/, const std::string& /*bytes*/) {}
  virtual std::optional<Message> Fetch() { return std::nullopt; }
  /// Ends all ranks at once: no agreement is possible any more.
  [[noreturn]] virtual void Abandon(const std::string& /*why*/) {
    throw std::bad_alloc();
  }

 private:
  // Between Agree and the end of a transport others count on this rank: what
  // is thrown there (no memory for a message) ends all of them.
  template <typename Work>
  auto InTransit(const Work& work);
  // The sizes of what ranks have to say, once it is clear that none has
  // failed.
  std::vector<std::int64_t> Agree(std::int64_t mine);
  [[noreturn]] void ThrowTogether(const std::vector<std::int64_t>& sizes,
                                  const std::string& error);
  [[noreturn]] void Fail(const std::string& error);

  const int rank_;
  const int size_;
  bool has_failed_ = false;
};

/// An error as bytes, for another rank to throw: InputError with its
/// location, std::bad_alloc, or std::runtime_error for all else.
std::string DescribeError(const std::exception& error);
[[noreturn]] void ThrowDescribed(const std::string& description);

/// This process alone: its calls are identities. Any thread may use it.
Communicator* SingleProcess();

/// What work is done by; results do not depend on it.
struct Execution {
  Execution(int threads = 1,  // NOLINT: threads are what most have to say
            Communicator* ranks = SingleProcess())
      : num_threads(threads), communicator(ranks) {}

  int num_threads;             ///< at least 1, of each rank
  Communicator* communicator;  ///< not null
};

/// Ranks that are `size` threads of this process: calls work(communicator) in
/// each of them, within RunTogether. Returns when all are done. @throws what
/// RunTogether does. For tests, and for trying out what a cluster would do.
void RunOnThreads(int size, const std::function<void(Communicator*)>& work);

}  // namespace alidade

#endif  // ALIDADE_COMMUNICATOR_H_
