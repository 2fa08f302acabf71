#ifndef ALIDADE_SRC_COMMON_TEXT_PIECES_H_
#define ALIDADE_SRC_COMMON_TEXT_PIECES_H_

#include <functional>
#include <string>
#include <string_view>
#include <utility>

namespace alidade::internal {

/// A text that may be too long for the memory is handed on in pieces: who has
/// it calls a sink with one piece after the other, each valid during the call.

/// Takes the next piece of a text. Throws where it can take no more, and who
/// calls it lets that through.
using TextSink = std::function<void(std::string_view piece)>;

/// Gives a whole text to a sink, the same at every call.
using TextSource = std::function<void(const TextSink& sink)>;

/// A text that is there, as one piece.
inline TextSource WholeText(std::string text) {
  return [text = std::move(text)](const TextSink& sink) { sink(text); };
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMMON_TEXT_PIECES_H_
