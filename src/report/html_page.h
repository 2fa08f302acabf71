#ifndef ALIDADE_SRC_REPORT_HTML_PAGE_H_
#define ALIDADE_SRC_REPORT_HTML_PAGE_H_

#include <string>

namespace alidade::internal {

// The sources of the page, src/report/page, made into C++ by its embed.cmake.
std::string PageTemplate();
std::string PageStyle();
std::string PageScript();

/// The page: `data` is JSON without a '<', which the script draws everything
/// from; `text` is for readers without scripts; `sections` are <section>
/// elements, which the script puts before its own.
std::string FillPage(const std::string& title, const std::string& data,
                     const std::string& text, const std::string& sections = "");

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_HTML_PAGE_H_
