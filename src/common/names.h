#ifndef ALIDADE_SRC_COMMON_NAMES_H_
#define ALIDADE_SRC_COMMON_NAMES_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace alidade::internal {

/// `text` in double quotes for a message: shortened to 40 characters, control
/// characters shown as '?', so that what() stays one readable line.
std::string Quote(std::string_view text);

/// `text` with control characters replaced by spaces: what stands after a
/// comment sign stays one line.
std::string OneLine(std::string text);

/// "a, b, c"; beyond sixteen names the rest is a count.
std::string JoinNames(const std::vector<std::string>& names);

/// The candidate with the smallest edit distance to `name`, upper and lower
/// case alike, or nothing where none is near enough to be a misspelling.
std::optional<std::string> NearestName(
    std::string_view name, const std::vector<std::string>& candidates);

/// `unknown key "lenght", did you mean "length"? Expected one of ...`, where
/// `what` is "key", "unit" ... Of "xyz", "intrinsic_xyz" is meant.
std::string UnknownName(std::string_view what, std::string_view name,
                        const std::vector<std::string>& candidates);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMMON_NAMES_H_
