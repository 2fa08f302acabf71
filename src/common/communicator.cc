#include "alidade/communicator.h"

#include <algorithm>
#include <new>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "alidade/error.h"
#include "src/common/bytes.h"

namespace alidade {
namespace {

// In place of a size: this rank has failed, and its error is so long.
std::int64_t AsFailure(std::size_t length) {
  return -1 - static_cast<std::int64_t>(length);
}

enum class ErrorKind { kInput, kMemory, kOther };

}  // namespace

Communicator* SingleProcess() {
  static Communicator process;
  return &process;
}

std::string DescribeError(const std::exception& error) {
  internal::ByteWriter writer;
  if (const auto* input = dynamic_cast<const InputError*>(&error)) {
    writer.Put(ErrorKind::kInput);
    const SourceLocation& location = input->location();
    writer.PutText(location.file);
    writer.Put(location.line);
    writer.Put(location.column);
    writer.PutText(location.key);
    writer.PutText(input->message());
  } else if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) {
    writer.Put(ErrorKind::kMemory);
  } else {
    writer.Put(ErrorKind::kOther);
    writer.PutText(error.what());
  }
  return writer.Take();
}

void ThrowDescribed(const std::string& description) {
  internal::ByteReader reader(description);
  const auto kind = reader.Get<ErrorKind>();
  if (kind == ErrorKind::kMemory) throw std::bad_alloc();
  if (kind == ErrorKind::kOther) throw std::runtime_error(reader.GetText());
  SourceLocation location;
  location.file = reader.GetText();
  location.line = reader.Get<int>();
  location.column = reader.Get<int>();
  location.key = reader.GetText();
  throw InputError(location, reader.GetText());
}

template <typename Work>
auto Communicator::InTransit(const Work& work) {
  decltype(work()) result{};
  try {
    result = work();
  } catch (const std::bad_alloc&) {
    Abandon("out of memory for what another process has sent");
  }
  return result;
}

std::vector<std::int64_t> Communicator::Agree(std::int64_t mine) {
  std::vector<std::int64_t> sizes = Exchange(mine);
  const bool some_failed = std::any_of(
      sizes.begin(), sizes.end(), [](std::int64_t size) { return size < 0; });
  if (some_failed) ThrowTogether(sizes, "");
  return sizes;
}

void Communicator::ThrowTogether(const std::vector<std::int64_t>& sizes,
                                 const std::string& error) {
  has_failed_ = true;
  int lowest = 0;
  while (sizes[lowest] >= 0) ++lowest;
  std::string description = error;
  if (lowest != rank_) {
    description.resize(static_cast<std::size_t>(-1 - sizes[lowest]));
  }
  Spread(lowest, &description);
  ThrowDescribed(description);
}

void Communicator::Fail(const std::string& error) {
  ThrowTogether(Exchange(AsFailure(error.size())), error);
}

std::vector<std::string> Communicator::GatherToRoot(std::string mine) {
  const std::vector<std::int64_t> sizes =
      Agree(static_cast<std::int64_t>(mine.size()));
  return InTransit([&] { return Collect(std::move(mine), sizes); });
}

std::vector<std::string> Communicator::Gather(std::string mine) {
  const std::vector<std::int64_t> sizes =
      Agree(static_cast<std::int64_t>(mine.size()));
  return InTransit([&] {
    std::string all;
    for (const std::string& each : Collect(std::move(mine), sizes)) all += each;
    all.resize(static_cast<std::size_t>(
        std::accumulate(sizes.begin(), sizes.end(), std::int64_t{0})));
    Spread(0, &all);
    std::vector<std::string> parts;
    std::size_t first = 0;
    for (const std::int64_t size : sizes) {
      parts.push_back(all.substr(first, static_cast<std::size_t>(size)));
      first += static_cast<std::size_t>(size);
    }
    return parts;
  });
}

std::string Communicator::Broadcast(const std::string& of_root) {
  const std::vector<std::int64_t> sizes =
      Agree(is_root() ? static_cast<std::int64_t>(of_root.size()) : 0);
  return InTransit([&] {
    std::string bytes = is_root() ? of_root : "";
    bytes.resize(static_cast<std::size_t>(sizes[0]));
    Spread(0, &bytes);
    return bytes;
  });
}

std::int64_t Communicator::Sum(std::int64_t mine) {
  internal::ByteWriter writer;
  writer.Put(mine);
  std::int64_t sum = 0;
  for (const std::string& each : Gather(writer.Take())) {
    sum += internal::ByteReader(each).Get<std::int64_t>();
  }
  return sum;
}

void Communicator::Send(int to, const std::string& bytes) {
  InTransit([&] {
    Transmit(to, bytes);
    return true;
  });
}

std::optional<Communicator::Message> Communicator::Receive() {
  return InTransit([&] { return Fetch(); });
}

void Communicator::RunTogether(const std::function<void()>& work) {
  if (size_ == 1) {
    work();
    return;
  }
  has_failed_ = false;
  std::string error;
  try {
    work();
  } catch (const std::exception& exception) {
    // What all have thrown together needs no more words.
    if (has_failed_) throw;
    error = DescribeError(exception);
  }
  if (!error.empty()) Fail(error);
  Agree(0);
}

}  // namespace alidade
