#ifndef ALIDADE_SRC_DATAIO_NUMBER_EVIDENCE_H_
#define ALIDADE_SRC_DATAIO_NUMBER_EVIDENCE_H_

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "src/dataio/csv_dialect.h"

namespace alidade::internal {

/// What the cells of a table say of how its numbers are written.
class NumberEvidence {
 public:
  void Add(std::string_view cell, std::size_t column, int line);
  /// All cells of the rows of a text, after so many lines.
  void AddRows(std::string_view rows, int lines_before,
               const StatedDialect& stated, const CsvDialect& dialect);

  /// Whether some number had another mark than one point.
  bool HasOtherMarks() const {
    return decimals_.count(',') > 0 || ambiguous_.count(',') > 0 ||
           !thousands_.empty();
  }

  /// The marks that are certain or stated, set in `dialect`. @throws
  /// InputError where two readings are possible.
  void Decide(const std::string& path, const StatedDialect& stated,
              CsvDialect* dialect) const;

 private:
  struct Example {
    std::string cell;
    int line = 0;
  };
  using Examples = std::map<char, Example>;  // by mark

  void Count(std::string_view cell);
  static void Keep(char mark, std::string_view cell, int line, Examples* kept);
  char DecimalMark(const std::string& path, const StatedDialect& stated) const;
  char AmbiguousAlone(const std::string& path) const;
  [[noreturn]] void FailAmbiguous(const std::string& path,
                                  const Example& example) const;

  Examples decimals_;
  Examples thousands_;
  Examples ambiguous_;
  std::vector<bool> has_integers_;  // by column
  std::vector<bool> has_ambiguous_;
  bool is_counter_ = true;  // what integers the first column has
  std::optional<int> last_;
  bool has_long_groups_ = false;  // two or three digits before such a mark
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_NUMBER_EVIDENCE_H_
