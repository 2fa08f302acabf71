#include "src/dataio/npy_header.h"

#include <glog/logging.h>

#include <algorithm>
#include <optional>

#include "alidade/error.h"
#include "src/common/names.h"

namespace alidade::internal {
namespace {

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr std::size_t kAlignment = 64;
constexpr char kType[] = "<f8";
constexpr char kHowToSave[] =
    "expected one dimension and named fields: np.save(\"data.npy\", "
    "np.rec.fromarrays(a.T, names=\"q1_rad,q2_rad,x_m,y_m,z_m\")), or a CSV "
    "and `alidade convert`";

// Python's literals, as far as such headers have them.
class LiteralReader {
 public:
  LiteralReader(const std::string& path, std::string_view text)
      : path_(path), rest_(text) {}

  bool Accept(char wanted) {
    SkipSpaces();
    if (rest_.empty() || rest_.front() != wanted) return false;
    rest_.remove_prefix(1);
    return true;
  }

  void Expect(char wanted) {
    if (!Accept(wanted)) FailHere(std::string("'") + wanted + "'");
  }

  bool IsString() {
    SkipSpaces();
    return !rest_.empty() && (rest_.front() == '\'' || rest_.front() == '"');
  }

  std::string String() {
    if (!IsString()) FailHere("a text in quotes");
    const std::size_t end = rest_.find(rest_.front(), 1);
    const std::string_view text =
        rest_.substr(1, std::min(end, rest_.size()) - 1);
    if (end == std::string_view::npos ||
        text.find('\\') != std::string_view::npos) {
      FailHere("a text in quotes, without backslashes");
    }
    rest_.remove_prefix(end + 1);
    return std::string(text);
  }

  bool Boolean() {
    SkipSpaces();
    for (const bool value : {false, true}) {
      const std::string_view word = value ? "True" : "False";
      if (rest_.substr(0, word.size()) != word) continue;
      rest_.remove_prefix(word.size());
      return value;
    }
    FailHere("True or False");
  }

  std::int64_t Integer() {
    SkipSpaces();
    constexpr std::size_t kMaxDigits = 18;
    const std::size_t digits =
        std::min(rest_.find_first_not_of("0123456789"), rest_.size());
    if (digits == 0 || digits > kMaxDigits) FailHere("a number of rows");
    std::int64_t value = 0;
    for (const char c : rest_.substr(0, digits)) value = value * 10 + (c - '0');
    rest_.remove_prefix(digits);
    if (!rest_.empty() && rest_.front() == 'L') rest_.remove_prefix(1);
    return value;
  }

  void ExpectEnd() {
    SkipSpaces();
    if (!rest_.empty()) FailHere("its end");
  }

  [[noreturn]] void Fail(const std::string& message,
                         const std::string& field = "") const {
    throw InputError({path_, 0, 0, field}, message);
  }

  [[noreturn]] void FailHere(const std::string& expected) const {
    Fail("the header of the NumPy array is damaged, expected " + expected +
         " before " + Quote(rest_));
  }

 private:
  void SkipSpaces() {
    rest_.remove_prefix(
        std::min(rest_.find_first_not_of(" \t\r\n"), rest_.size()));
  }

  const std::string& path_;
  std::string_view rest_;
};

// What stands in the header, before anything is asked of it.
struct Description {
  std::optional<std::string> type;  // of an array without fields
  std::vector<std::string> names;
  bool is_fortran = false;
  std::vector<std::int64_t> shape;
};

std::string ShapeText(const std::vector<std::int64_t>& shape) {
  if (shape.size() == 1) return "(" + std::to_string(shape[0]) + ",)";
  std::string text;
  for (const std::int64_t size : shape) {
    text += (text.empty() ? "" : ", ") + std::to_string(size);
  }
  return "(" + text + ")";
}

// The header that is made of the names must split into them again.
bool IsColumnName(std::string_view name) {
  if (name.empty() || name.front() == ' ' || name.back() == ' ') return false;
  return std::all_of(name.begin(), name.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte >= 0x20 && byte != 0x7f && c != ',' && c != '"' && c != '#';
  });
}

void CheckType(const std::string& type, const std::string& field,
               const LiteralReader& literal) {
  if (type == kType) return;
  if (type == ">f8") {
    literal.Fail(
        "numbers are big endian ('>f8'), expected '<f8': "
        "a.astype(a.dtype.newbyteorder(\"<\"))",
        field);
  }
  literal.Fail("numbers are " + Quote(type) +
                   ", expected '<f8': a.astype([(name, \"<f8\") for name in "
                   "a.dtype.names])",
               field);
}

std::string ReadField(LiteralReader* literal) {
  literal->Expect('(');
  if (!literal->IsString()) {
    literal->Fail("a field has a title, expected a name alone");
  }
  std::string name = literal->String();
  literal->Expect(',');
  if (!literal->IsString()) {
    literal->Fail("holds fields of its own, expected one number ('<f8')", name);
  }
  CheckType(literal->String(), name, *literal);
  if (!literal->Accept(',')) {
    literal->Expect(')');
  } else if (!literal->Accept(')')) {
    literal->Fail("holds an array, expected one number ('<f8')", name);
  }
  if (!IsColumnName(name)) {
    literal->Fail("field " + Quote(name) +
                  ", expected the name of a column, such as \"q1_rad\"");
  }
  return name;
}

void ReadFields(LiteralReader* literal, Description* description) {
  if (literal->IsString()) {
    description->type = literal->String();
    return;
  }
  literal->Expect('[');
  while (!literal->Accept(']')) {
    description->names.push_back(ReadField(literal));
    if (literal->Accept(',')) continue;
    literal->Expect(']');
    return;
  }
}

std::vector<std::int64_t> ReadShape(LiteralReader* literal) {
  std::vector<std::int64_t> shape;
  literal->Expect('(');
  while (!literal->Accept(')')) {
    shape.push_back(literal->Integer());
    if (literal->Accept(',')) continue;
    literal->Expect(')');
    break;
  }
  return shape;
}

Description ReadDescription(LiteralReader* literal) {
  Description description;
  std::vector<std::string> keys;
  literal->Expect('{');
  while (!literal->Accept('}')) {
    keys.push_back(literal->String());
    literal->Expect(':');
    if (keys.back() == "descr") {
      ReadFields(literal, &description);
    } else if (keys.back() == "fortran_order") {
      description.is_fortran = literal->Boolean();
    } else if (keys.back() == "shape") {
      description.shape = ReadShape(literal);
    } else {
      literal->FailHere("descr, fortran_order and shape alone");
    }
    if (literal->Accept(',')) continue;
    literal->Expect('}');
    break;
  }
  literal->ExpectEnd();
  std::sort(keys.begin(), keys.end());
  if (keys != std::vector<std::string>{"descr", "fortran_order", "shape"}) {
    literal->FailHere("descr, fortran_order and shape, each once,");
  }
  return description;
}

void CheckDescription(const Description& description,
                      const LiteralReader& literal) {
  const std::string shape = ShapeText(description.shape);
  if (description.type) {
    literal.Fail("an array of " + Quote(*description.type) +
                 " without names of columns, of shape " + shape + ", " +
                 kHowToSave);
  }
  if (description.is_fortran) {
    literal.Fail(
        "an array in Fortran's order, expected C's: "
        "np.save(\"data.npy\", np.ascontiguousarray(a))");
  }
  if (description.names.empty()) {
    literal.Fail(std::string("an array without any field, ") + kHowToSave);
  }
  if (description.shape.size() != 1) {
    literal.Fail("an array of shape " + shape +
                 ", expected one dimension, (rows,): "
                 "np.save(\"data.npy\", a.ravel())");
  }
}

void CheckSize(const NpyHeader& header, std::size_t file_bytes,
               const LiteralReader& literal) {
  const std::size_t bytes = file_bytes - header.data_offset;
  const auto rows = static_cast<std::size_t>(header.num_rows);
  const std::size_t found = bytes / header.record_bytes();
  const std::string stated = "the header states " + std::to_string(rows) +
                             " rows of " +
                             std::to_string(header.record_bytes()) + " bytes, ";
  if (found < rows) {
    literal.Fail("the file is cut off: " + stated + "expected as many, found " +
                 std::to_string(found));
  }
  if (found > rows || bytes % header.record_bytes() != 0) {
    literal.Fail(stated + "expected no more, found " + std::to_string(bytes) +
                 " bytes: save one array to a file");
  }
}

std::size_t LittleEndian(std::string_view bytes) {
  std::size_t value = 0;
  for (std::size_t i = bytes.size(); i > 0; --i) {
    value = value << 8 | static_cast<unsigned char>(bytes[i - 1]);
  }
  return value;
}

// The text between the fixed bytes and the records.
std::string_view HeaderText(std::string_view bytes,
                            const LiteralReader& literal,
                            std::size_t* data_offset) {
  if (bytes.substr(0, kMagic.size()) != kMagic) {
    literal.Fail(
        "not a NumPy array, expected a file that np.save or `alidade convert` "
        "wrote");
  }
  const std::size_t major = LittleEndian(bytes.substr(kMagic.size(), 1));
  const std::size_t begin = kMagic.size() + 2;
  const std::size_t length_bytes = major == 1 ? 2 : 4;
  if (bytes.size() < begin + length_bytes) {
    literal.Fail("the file is cut off in its header, expected all of it");
  }
  if (major < 1 || major > 3) {
    literal.Fail("NumPy's format " + std::to_string(major) +
                 ", expected 1.0, 2.0 or 3.0");
  }
  const std::size_t size = LittleEndian(bytes.substr(begin, length_bytes));
  *data_offset = begin + length_bytes + size;
  if (bytes.size() < *data_offset) {
    literal.Fail("the file is cut off in its header, expected all of it");
  }
  return bytes.substr(begin + length_bytes, size);
}

}  // namespace

NpyHeader ReadNpyHeader(const std::string& path, std::string_view bytes) {
  NpyHeader header;
  const std::string_view text =
      HeaderText(bytes, LiteralReader(path, ""), &header.data_offset);
  LiteralReader literal(path, text);
  const Description description = ReadDescription(&literal);
  CheckDescription(description, literal);
  header.names = description.names;
  header.num_rows = description.shape.front();
  CheckSize(header, bytes.size(), literal);
  return header;
}

std::string FormatNpyHeader(const std::vector<std::string>& names,
                            std::int64_t num_rows) {
  std::string text = "{'descr': [";
  for (const std::string& name : names) {
    if (name != names.front()) text += ", ";
    text += "('" + name + "', '" + kType + "')";
  }
  text += "], 'fortran_order': False, 'shape': (" + std::to_string(num_rows) +
          ",), }";
  const std::size_t begin = kMagic.size() + 4;
  while ((begin + text.size() + 1) % kAlignment != 0) text += ' ';
  text += '\n';
  CHECK_LT(text.size(), std::size_t{1} << 16);  // at most 77 short names
  std::string bytes(kMagic);
  bytes += '\x01';
  bytes += '\0';
  bytes += static_cast<char>(text.size() & 0xff);
  bytes += static_cast<char>(text.size() >> 8);
  return bytes + text;
}

}  // namespace alidade::internal
