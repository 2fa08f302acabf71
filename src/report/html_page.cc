#include "src/report/html_page.h"

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

#include "src/report/svg_writer.h"

namespace alidade::internal {
namespace {

// Line by line, since EscapeXml makes a space of a line's end.
std::string EscapeLines(const std::string& text) {
  std::string escaped;
  std::size_t from = 0;
  while (from < text.size()) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    escaped +=
        EscapeXml(std::string_view(text).substr(from, end - from)) + "\n";
    from = end + 1;
  }
  return escaped;
}

}  // namespace

std::string FillPage(const std::string& title, const std::string& data,
                     const std::string& text, const std::string& sections) {
  const std::vector<std::pair<std::string, std::string>> parts = {
      {"{{title}}", EscapeXml(title)},
      {"{{style}}", PageStyle()},
      {"{{sections}}", sections},
      {"{{text}}", EscapeLines(text)},
      {"{{data}}", data},
      {"{{script}}", PageScript()}};
  // In the order of the template, each mark once, so that a mark inside of a
  // part stays what it is.
  const std::string source = PageTemplate();
  std::string page;
  std::size_t from = 0;
  for (const auto& [mark, content] : parts) {
    const std::size_t at = source.find(mark, from);
    page += source.substr(from, at - from) + content;
    from = at + mark.size();
  }
  return page + source.substr(from);
}

}  // namespace alidade::internal
