#include "alidade/job.h"

#include <utility>
#include <variant>

#include "src/common/text.h"
#include "src/common/text_table.h"
#include "src/job/report_page.h"
#include "src/job/result_directory.h"
#include "src/job/run_job.h"
#include "src/report/report.h"
#include "src/report/svg_writer.h"
#include "src/serialization/job_file.h"

namespace alidade {
namespace {

using internal::EscapeXml;
using internal::TextTable;

bool IsOfNumbers(const std::string& title) { return title[0] == '>'; }

std::string Shown(const std::string& title) {
  return IsOfNumbers(title) ? title.substr(1) : title;
}

std::string TableText(const ReportTable& table) {
  std::vector<TextTable::Column> columns;
  for (const std::string& title : table.titles) {
    columns.push_back({Shown(title), IsOfNumbers(title)
                                         ? TextTable::Align::kRight
                                         : TextTable::Align::kLeft});
  }
  std::vector<int> widths = table.widths;
  widths.resize(columns.size());
  TextTable text(std::move(columns));
  for (const auto& row : table.rows) {
    internal::AddWrappedRow(row, widths, &text);
  }
  return (table.caption.empty() ? "" : table.caption + "\n\n") +
         text.ToString();
}

std::string RowMarkup(const ReportTable& table,
                      const std::vector<std::string>& cells,
                      const std::string& first, const std::string& others) {
  std::string markup = "<tr>";
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const std::string& element = c == 0 ? first : others;
    markup += "<" + element +
              (IsOfNumbers(table.titles[c]) ? " class=\"right\">" : ">") +
              EscapeXml(cells[c]) + "</" + element.substr(0, 2) + ">";
  }
  return markup + "</tr>\n";
}

std::string Markup(const std::string& paragraph) {
  return "<p>" + EscapeXml(paragraph) + "</p>\n";
}

std::string Markup(const ReportTable& table) {
  std::vector<std::string> titles;
  for (const std::string& title : table.titles) titles.push_back(Shown(title));
  const std::string header = "th scope=\"col\"";
  std::string markup =
      "<div class=\"table\"><h3>" + EscapeXml(table.caption) +
      "</h3><div class=\"scroll\" tabindex=\"0\"><table id=\"" +
      EscapeXml(table.id) + "\">\n<thead>" +
      RowMarkup(table, titles, header, header) + "</thead>\n<tbody>\n";
  for (const auto& row : table.rows) {
    markup += RowMarkup(table, row, "th scope=\"row\"", "td");
  }
  return markup + "</tbody></table></div></div>\n";
}

std::string Markup(const ReportFigure& figure) {
  return "<figure class=\"static\" id=\"" + EscapeXml(figure.id) + "\"><h3>" +
         EscapeXml(figure.title) + "</h3>\n" + figure.svg + "<figcaption>" +
         EscapeXml(figure.note) + "</figcaption></figure>\n";
}

std::string SectionMarkup(const ReportSection& section) {
  const std::string id = EscapeXml(section.id);
  std::string markup = "<section id=\"" + id + "\" aria-labelledby=\"" + id +
                       "-title\"><h2 id=\"" + id + "-title\">" +
                       EscapeXml(section.title) + "</h2>\n";
  for (const auto& part : section.content) {
    markup += std::visit([](const auto& any) { return Markup(any); }, part);
  }
  return markup + "</section>\n";
}

}  // namespace

Job LoadJob(const std::string& path, int num_threads) {
  internal::JobConfig config = internal::LoadJob(path, num_threads);
  return {std::move(config.path),      std::move(config.title),
          std::move(config.arm),       std::move(config.data),
          std::move(config.options),   std::move(config.rejected),
          std::move(config.published), std::move(config.input_files)};
}

CalibrationResult RunJob(Job job, const std::string& command) {
  internal::JobConfig config;
  config.arm = std::move(job.arm);
  config.data = std::move(job.data);
  config.options = std::move(job.options);
  config.title = std::move(job.title);
  config.rejected = std::move(job.rejected);
  config.published = std::move(job.published);
  config.input_files = std::move(job.input_files);
  return internal::RunJob(std::move(config), command);
}

std::string FormatSection(const ReportSection& section) {
  std::vector<std::string> blocks;
  for (const auto& part : section.content) {
    if (const auto* text = std::get_if<std::string>(&part)) {
      blocks.push_back(internal::Paragraph(*text));
    } else if (const auto* table = std::get_if<ReportTable>(&part)) {
      blocks.push_back(TableText(*table));
    }
  }
  return internal::Join(blocks, "\n");
}

std::vector<std::string> Save(const CalibrationResult& result,
                              const std::string& directory,
                              const SaveOptions& options) {
  std::string text;
  std::string markup;
  for (const ReportSection& section : options.sections) {
    text += "\n" + internal::Heading(section.title) + FormatSection(section);
    markup += SectionMarkup(section);
  }
  std::vector<internal::ReportFile> files =
      internal::RenderResult(result, text);
  // Before result.json, which comes last.
  const auto add = [&files](internal::ReportFile file) {
    files.insert(files.end() - 1, std::move(file));
  };
  for (const NamedFile& file : options.files) add({file.name, file.content});
  if (options.report_page) {
    add(internal::MakeResultPage(result, files, directory, markup));
  }
  return internal::WriteResultDirectory(directory, files);
}

std::vector<NamedFile> Figures(const CalibrationResult& result) {
  std::vector<NamedFile> figures;
  for (const internal::ReportFile& file : internal::MakeFigures(result)) {
    figures.push_back({file.name, file.Text()});
  }
  return figures;
}

std::string AccuracyTable(const CalibrationResult& result) {
  return internal::FormatAccuracyTable(result);
}

}  // namespace alidade
