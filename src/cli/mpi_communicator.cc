// All that the project has to do with MPI; tests/fences looks after it.
#include "alidade/error.h"
#include "src/cli/launch.h"

#ifdef ALIDADE_WITH_MPI

#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <mpi.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <iostream>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace alidade::internal {
namespace {

// MPI counts in int: longer messages go in pieces.
constexpr std::size_t kMostBytes = std::size_t{1} << 30;

constexpr int kPieceTag = 0;
constexpr int kMessageTag = 1;

// Calls send(first byte, count) for pieces of `bytes`.
template <typename Transfer>
void InPieces(std::string* bytes, const Transfer& transfer) {
  for (std::size_t first = 0; first < bytes->size(); first += kMostBytes) {
    const std::size_t count = std::min(kMostBytes, bytes->size() - first);
    transfer(bytes->data() + first, static_cast<int>(count));
  }
}

// MPI's own error handler ends all processes, so that no call returns an error.
class MpiCommunicator : public Communicator {
 public:
  MpiCommunicator(int rank, int size) : Communicator(rank, size) {}
  ~MpiCommunicator() override { MPI_Finalize(); }

 private:
  std::vector<std::int64_t> Exchange(std::int64_t mine) override {
    std::vector<std::int64_t> all(size());
    MPI_Allgather(&mine, 1, MPI_INT64_T, all.data(), 1, MPI_INT64_T,
                  MPI_COMM_WORLD);
    return all;
  }

  std::vector<std::string> Collect(
      std::string mine, const std::vector<std::int64_t>& sizes) override {
    std::vector<std::string> all;
    if (!is_root()) {
      InPieces(&mine, [](char* data, int count) {
        MPI_Send(data, count, MPI_BYTE, 0, kPieceTag, MPI_COMM_WORLD);
      });
      return all;
    }
    all.resize(size());
    all[0] = std::move(mine);
    for (int from = 1; from < size(); ++from) {
      all[from].resize(static_cast<std::size_t>(sizes[from]));
      InPieces(&all[from], [from](char* data, int count) {
        MPI_Recv(data, count, MPI_BYTE, from, kPieceTag, MPI_COMM_WORLD,
                 MPI_STATUS_IGNORE);
      });
    }
    return all;
  }

  void Spread(int from, std::string* bytes) override {
    InPieces(bytes, [from](char* data, int count) {
      MPI_Bcast(data, count, MPI_BYTE, from, MPI_COMM_WORLD);
    });
  }

  // Ranks that send to each other at once must not wait for each other: what
  // arrives is taken in until the own message is gone.
  void Transmit(int to, const std::string& bytes) override {
    if (bytes.size() > kMostBytes) Abandon("a message is longer than 1 GiB");
    MPI_Request request = MPI_REQUEST_NULL;
    MPI_Isend(bytes.data(), static_cast<int>(bytes.size()), MPI_BYTE, to,
              kMessageTag, MPI_COMM_WORLD, &request);
    for (int is_gone = 0; is_gone == 0;) {
      MPI_Request_get_status(request, &is_gone, MPI_STATUS_IGNORE);
      if (std::optional<Message> message = TakeIn()) {
        arrived_.push_back(*std::move(message));
      }
    }
    MPI_Wait(&request, MPI_STATUS_IGNORE);
  }

  std::optional<Message> Fetch() override {
    if (arrived_.empty()) return TakeIn();
    Message message = std::move(arrived_.front());
    arrived_.pop_front();
    return message;
  }

  static std::optional<Message> TakeIn() {
    int is_there = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, kMessageTag, MPI_COMM_WORLD, &is_there, &status);
    if (is_there == 0) return std::nullopt;
    int count = 0;
    MPI_Get_count(&status, MPI_BYTE, &count);
    Message message;
    message.from = status.MPI_SOURCE;
    message.bytes.resize(static_cast<std::size_t>(count));
    MPI_Recv(message.bytes.data(), count, MPI_BYTE, message.from, kMessageTag,
             MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    return message;
  }

  [[noreturn]] void Abandon(const std::string& why) override {
    std::cerr << "alidade: " << why << std::endl;
    MPI_Abort(MPI_COMM_WORLD, 3);
    std::abort();
  }

  std::deque<Message> arrived_;
};

}  // namespace

std::unique_ptr<Communicator> JoinProcesses(const Launch& launch) {
  int provided = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
  int rank = 0;
  int size = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  if (rank != launch.rank || size != launch.size) {
    // Each would take itself for the only one, and all would write the same
    // files.
    MPI_Finalize();
    throw InputError(
        {}, "the launcher started process " + std::to_string(launch.rank) +
                " of " + std::to_string(launch.size) + ", MPI says it is " +
                std::to_string(rank) + " of " + std::to_string(size) +
                ": start it by the mpirun of the Open MPI that it was built "
                "with");
  }
  return std::make_unique<MpiCommunicator>(rank, size);
}

}  // namespace alidade::internal

#else  // ALIDADE_WITH_MPI

namespace alidade::internal {

std::unique_ptr<Communicator> JoinProcesses(const Launch& launch) {
  throw InputError(
      {}, std::to_string(launch.size) +
              " processes were started together, but this program was built "
              "without MPI: run it without mpirun, or install Open MPI "
              "(scripts/setup mpi) and build it again");
}

}  // namespace alidade::internal

#endif  // ALIDADE_WITH_MPI
