#include "src/report/page.h"

#include "src/common/text.h"
#include "src/report/markup.h"
#include "src/report/page_files.h"

namespace alidade::internal {
namespace {

// What a level looks like, and its sign.
std::pair<const char*, const char*> LookOf(FindingLevel level) {
  switch (level) {
    case FindingLevel::kPassed:
      return {"good", "✓\u00a0"};
    case FindingLevel::kNote:
      return {"plain", "·\u00a0"};
    case FindingLevel::kAttention:
      return {"warn", "!\u00a0"};
    case FindingLevel::kFailed:
      return {"bad", "✗\u00a0"};
  }
  return {"plain", ""};
}

// No '<' in JSON that could end the element.
std::string DataElement(const PageData& data) {
  std::string json;
  for (const char c : data.json) {
    if (c == '<') {
      json += "\\u003c";
    } else {
      json += c;
    }
  }
  return Element("script", {{"type", "application/json"}, {"id", data.id}},
                 json) +
         "\n";
}

}  // namespace

std::string HtmlParagraph(const std::string& text, const std::string& look) {
  return text.empty() ? ""
                      : Element("p", {{"class", look}}, Sentences(text)) + "\n";
}

std::string HtmlNote(const std::string& text) {
  return HtmlParagraph(text, "note");
}

std::string HtmlList(const std::vector<std::string>& items,
                     const std::string& id, const std::string& look) {
  if (items.empty()) return "";
  std::string list;
  for (const std::string& item : items) list += Element("li", {}, item) + "\n";
  return Element("ul", {{"id", id}, {"class", look}}, list);
}

std::string HtmlFold(const std::string& summary, const std::string& html,
                     bool is_printed) {
  if (html.empty()) return "";
  return Element("details", {{"class", is_printed ? "printed" : "unprinted"}},
                 Element("summary", {}, Words(summary)) + html) +
         "\n";
}

std::string HtmlBadge(FindingLevel level, const std::string& text) {
  const auto [look, sign] = LookOf(level);
  return Element(
      "span", {{"class", std::string("badge ") + look}},
      Element("span", {{"aria-hidden", "true"}}, sign) + EscapeXml(text));
}

std::string HtmlVerdict(FindingLevel level, const std::string& title,
                        const std::string& sentence) {
  return Element("p", {{"class", "decision"}}, HtmlBadge(level, title)) +
         Element("h2", {{"class", "verdict"}}, Sentences(sentence)) + "\n";
}

std::string HtmlFigure(const std::string& id, const Figure& figure,
                       const std::string& note) {
  std::string caption = AsSentence(figure.subtitle);
  if (!note.empty()) {
    caption += (caption.empty() ? "" : " ") + AsSentence(note);
  }
  return Element("figure", {{"id", id}},
                 Element("div", {{"class", "table-head"}},
                         Element("h3", {}, Words(figure.title))) +
                     Element("div", {{"class", "drawing"}},
                             figure.render(FigureMedium::kPage)) +
                     (caption.empty()
                          ? ""
                          : Element("figcaption", {}, Words(caption)))) +
         "\n";
}

std::string HtmlFact(const std::string& title, const std::string& value,
                     const std::string& remark) {
  return Element("div", {},
                 Element("div", {{"class", "small"}}, Words(title)) +
                     Element("div", {{"class", "big"}}, Words(value)) +
                     Element("div", {{"class", "small"}}, Words(remark)));
}

std::string HtmlPair(const std::vector<std::string>& parts) {
  std::string pair;
  for (const std::string& part : parts) {
    if (!part.empty()) pair += Element("div", {}, part);
  }
  return pair.empty() ? "" : Element("div", {{"class", "pair"}}, pair) + "\n";
}

std::string HtmlChoices(const std::string& id, const std::string& label,
                        const std::vector<PageChoice>& choices,
                        std::size_t first) {
  if (choices.empty()) return "";
  std::string html = Element("span", {{"class", "small"}}, Words(label));
  for (std::size_t i = 0; i < choices.size(); ++i) {
    const std::string button = id + "-" + std::to_string(i + 1);
    html += Element("div", {{"class", "choice"}},
                    "<input type=\"radio\" name=\"" + id + "\" id=\"" + button +
                        "\"" + (i == first ? " checked>" : ">") +
                        Element("label", {{"for", button}},
                                Words(choices[i].label)) +
                        Element("div", {}, choices[i].html)) +
            "\n";
  }
  return Element("div",
                 {{"class", "choices"},
                  {"id", id},
                  {"role", "group"},
                  {"aria-label", label}},
                 html);
}

std::string HtmlSection(const PageSection& section) {
  if (section.html.empty()) return "";
  const std::string title = section.id + "-title";
  return Element("section", {{"id", section.id}, {"aria-labelledby", title}},
                 Element("h2", {{"id", title}}, Words(section.title)) + "\n" +
                     section.html) +
         "\n";
}

std::string HtmlContents(const std::vector<PageSection>& sections) {
  std::vector<std::string> links;
  for (const PageSection& section : sections) {
    if (section.html.empty()) continue;
    links.push_back(
        Element("a", {{"href", "#" + section.id}}, Words(section.title)));
  }
  return Element("nav", {{"aria-label", "Contents"}}, HtmlList(links, ""));
}

std::string HtmlFooter(const std::string& version) {
  return Element(
      "footer", {},
      EscapeXml(
          "Alidade " + version +
          ". Lengths in mm, angles in degrees where nothing else is said. An "
          "error is the distance between where the arm believes its target to "
          "be and where it was measured."));
}

std::string FillPage(const std::string& title, const std::string& content,
                     const std::vector<PageData>& data) {
  std::string scripts;
  for (const PageData& each : data) scripts += DataElement(each);
  const std::vector<std::pair<std::string, std::string>> parts = {
      {"{{title}}", EscapeXml(title)},
      {"{{page_style}}", PageStyle()},
      {"{{figure_style}}", FigureStyle()},
      {"{{content}}", content},
      {"{{data}}", scripts},
      {"{{script}}", PageScript()}};
  // In the order of the template, each mark once, so that a mark inside of a
  // part stays what it is.
  const std::string source = PageTemplate();
  std::string page;
  std::size_t from = 0;
  for (const auto& [mark, part] : parts) {
    const std::size_t at = source.find(mark, from);
    page += source.substr(from, at - from) + part;
    from = at + mark.size();
  }
  return page + source.substr(from);
}

std::string CompletePage(const std::string& title, std::string content,
                         const std::vector<PageSection>& sections,
                         const std::string& version,
                         const std::string& arm_json, const std::string& json) {
  constexpr std::size_t kLargestJson = 500'000;
  for (const PageSection& section : sections) content += HtmlSection(section);
  content += HtmlFooter(version);
  std::vector<PageData> data;
  if (!arm_json.empty()) data.push_back({"arm-data", arm_json});
  if (json.size() <= kLargestJson) data.push_back({"alidade-data", json});
  return FillPage(title + " – Alidade", content, data);
}

}  // namespace alidade::internal
