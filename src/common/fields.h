#ifndef ALIDADE_SRC_COMMON_FIELDS_H_
#define ALIDADE_SRC_COMMON_FIELDS_H_

#include <array>
#include <cstddef>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "alidade/units.h"

namespace alidade::internal {

/// One description of each field. A struct that stands in files has, in a
/// header `NAME_fields.h` of its own module, one function that names its
/// fields in the order in which people look for them:
///
///   template <typename Visitor>
///   void VisitFields(Visitor& v, Subject<Visitor, StageResult>& stage) {
///     v.Field("name", stage.name);
///     v.Optional("validation", stage.validation);
///   }
///
/// Who writes, reads or documents the struct is a visitor and calls it; so
/// modules know nothing of file formats, and no key is written twice. Visitors
/// of results have these functions:
///
///   Field(key, member)      always there. A third argument is the number that
///                           `null` means, NaN where there is none
///   Optional(key, member)   there where the member has something to say
///   Later(key, member)      always written; files of earlier versions lack it
///   Computed(key, value)    follows from other fields: written, never read
///   Group(key, visit)       an object of its own; visit(v) has its fields.
///                           LaterGroup and NullableGroup(key, is_there, visit)
///                           likewise
///   Pairs(key, member, first, second)    a list of objects of two keys
///   Has(key, is_there)      whether the key is there: when writing, is_there

/// A struct as a visitor sees it: to be changed only where it reads.
template <typename Visitor, typename Struct>
using Subject = std::conditional_t<Visitor::kReads, Struct, const Struct>;

/// The words of an enum in files: pairs of value and word. They stay as they
/// are once published, whatever the words for people become. Each enum
/// specialises it beside its struct.
template <typename Enum>
inline constexpr std::nullptr_t kWords = nullptr;

template <>
inline constexpr std::array kWords<Dimension> = {
    std::pair{Dimension::kLength, "m"},
    std::pair{Dimension::kAngle, "rad"},
};

/// All of them, in the order of the table.
template <typename Enum>
std::vector<std::string> WordsOf() {
  std::vector<std::string> words;
  for (const auto& [value, word] : kWords<Enum>) words.emplace_back(word);
  return words;
}

/// The value of a word. @pre the table of the enum has it.
template <typename Enum>
Enum ValueOf(const std::string& wanted) {
  for (const auto& [value, word] : kWords<Enum>) {
    if (wanted == word) return value;
  }
  return {};
}

/// The word of a value. @pre the table of the enum has it.
template <typename Enum>
const char* WordOf(Enum wanted) {
  for (const auto& [value, word] : kWords<Enum>) {
    if (value == wanted) return word;
  }
  return "";
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMMON_FIELDS_H_
