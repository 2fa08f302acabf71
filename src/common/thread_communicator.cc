#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "alidade/communicator.h"

namespace alidade {
namespace {

// Where the threads meet.
class Meeting {
 public:
  explicit Meeting(int size)
      : numbers_(size),
        blobs_(size),
        failures_(size),
        mail_(size),
        size_(size) {}

  int size() const { return size_; }
  std::vector<std::int64_t>& numbers() { return numbers_; }
  std::vector<std::string>& blobs() { return blobs_; }
  std::vector<std::exception_ptr>& failures() { return failures_; }

  void Post(int to, Communicator::Message message) {
    const std::lock_guard<std::mutex> lock(mutex_);
    mail_[to].push_back(std::move(message));
  }

  std::optional<Communicator::Message> Collect(int by) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (mail_[by].empty()) return std::nullopt;
    Communicator::Message message = std::move(mail_[by].front());
    mail_[by].pop_front();
    return message;
  }

  // Returns once every thread is here.
  void Wait() {
    std::unique_lock<std::mutex> lock(mutex_);
    const std::int64_t mine = round_;
    if (++waiting_ == size_) {
      waiting_ = 0;
      ++round_;
      all_here_.notify_all();
      return;
    }
    all_here_.wait(lock, [&] { return round_ != mine; });
  }

 private:
  std::vector<std::int64_t> numbers_;
  std::vector<std::string> blobs_;
  std::vector<std::exception_ptr> failures_;
  std::vector<std::deque<Communicator::Message>> mail_;
  const int size_;
  std::mutex mutex_;
  std::condition_variable all_here_;
  int waiting_ = 0;
  std::int64_t round_ = 0;
};

class ThreadCommunicator : public Communicator {
 public:
  ThreadCommunicator(int rank, Meeting* meeting)
      : Communicator(rank, meeting->size()), meeting_(meeting) {}

 private:
  std::vector<std::int64_t> Exchange(std::int64_t mine) override {
    meeting_->numbers()[rank()] = mine;
    meeting_->Wait();
    std::vector<std::int64_t> all = meeting_->numbers();
    meeting_->Wait();
    return all;
  }

  std::vector<std::string> Collect(
      std::string mine, const std::vector<std::int64_t>& /*sizes*/) override {
    meeting_->blobs()[rank()] = std::move(mine);
    meeting_->Wait();
    std::vector<std::string> all;
    if (is_root()) all = std::move(meeting_->blobs());
    if (is_root()) meeting_->blobs().assign(size(), "");
    meeting_->Wait();
    return all;
  }

  void Spread(int from, std::string* bytes) override {
    if (rank() == from) meeting_->blobs()[from] = *bytes;
    meeting_->Wait();
    *bytes = meeting_->blobs()[from];
    meeting_->Wait();
  }

  void Transmit(int to, const std::string& bytes) override {
    meeting_->Post(to, {rank(), bytes});
  }

  std::optional<Message> Fetch() override { return meeting_->Collect(rank()); }

  [[noreturn]] void Abandon(const std::string& /*why*/) override {
    std::terminate();
  }

  Meeting* const meeting_;
};

}  // namespace

void RunOnThreads(int size, const std::function<void(Communicator*)>& work) {
  Meeting meeting(size);
  const auto take_part = [&](int rank) {
    ThreadCommunicator communicator(rank, &meeting);
    try {
      communicator.RunTogether([&] { work(&communicator); });
    } catch (...) {
      meeting.failures()[rank] = std::current_exception();
    }
  };
  std::vector<std::thread> threads;
  for (int rank = 1; rank < size; ++rank) threads.emplace_back(take_part, rank);
  take_part(0);
  for (std::thread& thread : threads) thread.join();
  // RunTogether has thrown the same on all of them.
  if (meeting.failures()[0]) std::rethrow_exception(meeting.failures()[0]);
}

}  // namespace alidade
