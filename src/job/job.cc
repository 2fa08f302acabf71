#include "alidade/job.h"

#include <utility>
#include <variant>

#include "src/common/numbers.h"
#include "src/common/text.h"
#include "src/job/report_page.h"
#include "src/job/result_directory.h"
#include "src/job/run_job.h"
#include "src/report/figures.h"
#include "src/report/page.h"
#include "src/report/report.h"
#include "src/report/table.h"
#include "src/serialization/job_config.h"

namespace alidade {
namespace {

internal::Table AsTable(const ReportTable& table) {
  std::vector<internal::Table::Column> columns(table.titles.begin(),
                                               table.titles.end());
  for (std::size_t k = 0; k < table.widths.size(); ++k) {
    columns[k].width = table.widths[k];
  }
  internal::Table shown(table.id, table.caption, columns);
  for (const auto& row : table.rows) {
    std::vector<internal::TableCell> cells(row.begin(), row.end());
    for (std::size_t k = 0; k < cells.size(); ++k) {
      // By which a page sorts.
      const auto number = internal::ParseNumber(row[k]);
      if (columns[k].is_number && number) cells[k].value = *number;
    }
    shown.AddRow(std::move(cells));
  }
  return shown;
}

std::string FigureHtml(const ReportFigure& figure) {
  internal::Figure drawn;
  drawn.title = figure.title;
  drawn.subtitle = figure.note;
  drawn.render = [&figure](internal::FigureMedium) { return figure.svg; };
  return internal::HtmlFigure(figure.id, drawn);
}

internal::PageSection AsPageSection(const ReportSection& section) {
  std::string html;
  std::vector<std::string> figures;  // that stand side by side
  for (const auto& part : section.content) {
    if (const auto* figure = std::get_if<ReportFigure>(&part)) {
      figures.push_back(FigureHtml(*figure));
      continue;
    }
    html += internal::HtmlPair(std::exchange(figures, {}));
    const auto* table = std::get_if<ReportTable>(&part);
    html += table == nullptr
                ? internal::HtmlParagraph(std::get<std::string>(part))
                : AsTable(*table).ToHtml();
  }
  html += internal::HtmlPair(figures);
  return {section.id, section.title, html};
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
      blocks.push_back((table->caption.empty() ? "" : table->caption + "\n\n") +
                       AsTable(*table).ToText());
    }
  }
  return internal::Join(blocks, "\n");
}

std::vector<std::string> Save(const CalibrationResult& result,
                              const std::string& directory,
                              const SaveOptions& options) {
  std::string text;
  std::vector<internal::PageSection> sections;
  for (const ReportSection& section : options.sections) {
    text += "\n" + internal::Heading(section.title) + FormatSection(section);
    sections.push_back(AsPageSection(section));
  }
  std::vector<internal::ReportFile> files =
      internal::RenderResult(result, text);
  // Before result.json, which comes last.
  const auto add = [&files](internal::ReportFile file) {
    files.insert(files.end() - 1, std::move(file));
  };
  for (const NamedFile& file : options.files) add({file.name, file.content});
  if (options.report_page) add(internal::MakeResultPage(result, sections));
  return internal::WriteResultDirectory(directory, files);
}

std::vector<ReportFigure> Figures(const CalibrationResult& result) {
  std::vector<ReportFigure> figures;
  for (const auto& [id, figure] : internal::ResultFigures(result)) {
    figures.push_back({id, figure.title,
                       figure.render(internal::FigureMedium::kPage),
                       internal::AsSentence(figure.subtitle)});
  }
  return figures;
}

std::string AccuracyTable(const CalibrationResult& result) {
  return internal::FormatAccuracyTable(result);
}

}  // namespace alidade
