#include <string_view>
#include <utility>

#include "src/report/report.h"

namespace alidade::internal {

ReportFile::ReportFile(std::string file_name, std::string text)
    : ReportFile(std::move(file_name), WholeText(std::move(text))) {}

ReportFile::ReportFile(std::string file_name, TextSource source)
    : name(std::move(file_name)), content(std::move(source)) {}

std::string ReportFile::Text() const {
  std::string text;
  content([&text](std::string_view piece) { text += piece; });
  return text;
}

}  // namespace alidade::internal
