#ifndef ALIDADE_SRC_COMMON_BYTES_H_
#define ALIDADE_SRC_COMMON_BYTES_H_

#include <Eigen/Core>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace alidade::internal {

/// Values one after the other as bytes, for ByteReader on a machine of the
/// same kind: what ranks (communicator.h) send each other. No format for files.
class ByteWriter {
 public:
  template <typename T>
  void Put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    Append(&value, sizeof(T));
  }
  void PutText(const std::string& text) {
    Put(static_cast<std::int64_t>(text.size()));
    Append(text.data(), text.size());
  }
  template <typename T>
  void PutList(const std::vector<T>& list) {
    static_assert(std::is_trivially_copyable_v<T>);
    Put(static_cast<std::int64_t>(list.size()));
    Append(list.data(), list.size() * sizeof(T));
  }
  void PutTexts(const std::vector<std::string>& texts) {
    Put(static_cast<std::int64_t>(texts.size()));
    for (const std::string& text : texts) PutText(text);
  }
  void PutMatrix(const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
    Put(static_cast<std::int64_t>(matrix.rows()));
    Put(static_cast<std::int64_t>(matrix.cols()));
    for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
      PutArray(matrix.col(column).data(),
               static_cast<std::size_t>(matrix.rows()));
    }
  }

  /// Without their number, which the reader must know.
  void PutArray(const double* numbers, std::size_t count) {
    Append(numbers, count * sizeof(double));
  }

  std::string&& Take() { return std::move(bytes_); }

 private:
  void Append(const void* data, std::size_t size) {
    if (size > 0) bytes_.append(static_cast<const char*>(data), size);
  }

  std::string bytes_;
};

/// Reads what a ByteWriter wrote, in the same order. Holds a reference.
/// @throws std::logic_error after the end: the two sides disagree.
class ByteReader {
 public:
  explicit ByteReader(const std::string& bytes) : bytes_(bytes) {}

  template <typename T>
  T Get() {
    static_assert(std::is_trivially_copyable_v<T>);
    T value;
    Copy(&value, sizeof(T));
    return value;
  }
  std::string GetText() {
    std::string text(static_cast<std::size_t>(Get<std::int64_t>()), '\0');
    Copy(text.data(), text.size());
    return text;
  }
  template <typename T>
  std::vector<T> GetList() {
    std::vector<T> list(static_cast<std::size_t>(Get<std::int64_t>()));
    Copy(list.data(), list.size() * sizeof(T));
    return list;
  }
  std::vector<std::string> GetTexts() {
    std::vector<std::string> texts(
        static_cast<std::size_t>(Get<std::int64_t>()));
    for (std::string& text : texts) text = GetText();
    return texts;
  }
  Eigen::MatrixXd GetMatrix() {
    const auto rows = static_cast<Eigen::Index>(Get<std::int64_t>());
    const auto columns = static_cast<Eigen::Index>(Get<std::int64_t>());
    Eigen::MatrixXd matrix(rows, columns);
    Copy(matrix.data(),
         static_cast<std::size_t>(matrix.size()) * sizeof(double));
    return matrix;
  }
  void GetArray(std::size_t count, double* numbers) {
    Copy(numbers, count * sizeof(double));
  }
  bool is_at_end() const { return next_ == bytes_.size(); }

 private:
  void Copy(void* to, std::size_t size) {
    if (size > bytes_.size() - next_) {
      throw std::logic_error("a message between processes is too short");
    }
    if (size > 0) std::memcpy(to, bytes_.data() + next_, size);
    next_ += size;
  }

  const std::string& bytes_;
  std::size_t next_ = 0;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMMON_BYTES_H_
