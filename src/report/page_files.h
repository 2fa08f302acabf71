#ifndef ALIDADE_SRC_REPORT_PAGE_FILES_H_
#define ALIDADE_SRC_REPORT_PAGE_FILES_H_

#include <string>

namespace alidade::internal {

// The sources of the page, src/report/page, made into C++ by its embed.cmake.
std::string PageTemplate();
std::string PageStyle();
/// Of figures, in pages and files alike.
std::string FigureStyle();
std::string PageScript();

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_PAGE_FILES_H_
