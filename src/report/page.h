#ifndef ALIDADE_SRC_REPORT_PAGE_H_
#define ALIDADE_SRC_REPORT_PAGE_H_

#include <string>
#include <vector>

#include "alidade/calibration_result.h"
#include "src/report/svg_chart.h"

namespace alidade::internal {

/// HTML pages that people look at (docs/report.md). A page is one file: style,
/// script and data are inside, nothing is loaded from anywhere. It is complete
/// without its script, which sorts and copies tables, shows tips, saves figures
/// and turns the view of the arm.

/// A part of a page under a heading of its own. `html` is markup.
struct PageSection {
  std::string id;
  std::string title;
  std::string html;
};

/// JSON that the page's script reads.
struct PageData {
  std::string id;
  std::string json;
};

/// One of several things of which a page shows one at a time.
struct PageChoice {
  std::string label;
  std::string html;
};

// Parts of a page. Texts are sentences, which are escaped and typeset; nothing
// comes of an empty one.
std::string HtmlParagraph(const std::string& text,
                          const std::string& look = "");
std::string HtmlNote(const std::string& text);
/// `items` are markup.
std::string HtmlList(const std::vector<std::string>& items,
                     const std::string& id, const std::string& look = "");
/// Folded away until somebody opens it; on paper it is open where `is_printed`.
/// Nothing where `html` is empty. `summary` is a text, `html` is markup.
std::string HtmlFold(const std::string& summary, const std::string& html,
                     bool is_printed = true);
/// A mark that is recognised by its sign and its words, never by colour alone.
std::string HtmlBadge(FindingLevel level, const std::string& text);
/// The verdict's badge and sentence, the heading of what follows.
std::string HtmlVerdict(FindingLevel level, const std::string& title,
                        const std::string& sentence);
/// A figure with its title above and its subtitle and `note` below.
std::string HtmlFigure(const std::string& id, const Figure& figure,
                       const std::string& note = "");
/// Side by side where there is room; empty parts are left out.
/// A number of the first screen: what it is, itself, and a remark.
std::string HtmlFact(const std::string& title, const std::string& value,
                     const std::string& remark);
std::string HtmlPair(const std::vector<std::string>& parts);
/// A row of buttons, one for each choice, which need no script.
std::string HtmlChoices(const std::string& id, const std::string& label,
                        const std::vector<PageChoice>& choices,
                        std::size_t first = 0);
/// With its heading; nothing where it has no content.
std::string HtmlSection(const PageSection& section);
/// A list of links to sections.
std::string HtmlContents(const std::vector<PageSection>& sections);
std::string HtmlFooter(const std::string& version);

/// The whole page. `content` is markup.
std::string FillPage(const std::string& title, const std::string& content,
                     const std::vector<PageData>& data);

/// The page of one thing: `content`, which begins it, its sections, and the
/// data that scripts draw the arm from (`arm_json`, may be empty) and that the
/// page saves (`json`, left out where it is longer than 500 kB).
std::string CompletePage(const std::string& title, std::string content,
                         const std::vector<PageSection>& sections,
                         const std::string& version,
                         const std::string& arm_json, const std::string& json);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_PAGE_H_
