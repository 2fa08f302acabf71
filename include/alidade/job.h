#ifndef ALIDADE_JOB_H_
#define ALIDADE_JOB_H_

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "alidade/arm.h"
#include "alidade/calibration_options.h"
#include "alidade/calibration_result.h"

namespace alidade {

/// A calibration as a job file states it (docs/files.md), its files loaded and
/// checked against each other.
struct Job {
  std::string path;
  std::string title;
  Arm arm;
  CalibrationData data;
  CalibrationOptions options;
  /// Rows of the data's files that hold no measurement.
  std::vector<RejectedRow> rejected;
  /// What a publication says of the same calibration.
  std::optional<PublishedStudy> published;
  /// Every file that was read, the job file first.
  std::vector<std::string> input_files;
};

/// Reads a job and every file that it names. The number of threads, which is
/// the job's as well, makes no difference to what is read. @throws InputError
/// with file, line, column and key.
Job LoadJob(const std::string& path, int num_threads = 1);

/// Calibrates as the job says, and notes where the result comes from: title,
/// `command`, the hashes of the files, published values. Writes nothing.
/// @throws InputError as Calibrate, and where a file cannot be read again.
CalibrationResult RunJob(Job job, const std::string& command = "");

/// A text file of a result directory.
struct NamedFile {
  std::string name;
  std::string content;
};

/// A table of a report's section.
struct ReportTable {
  std::string id;       ///< of its element in report.html
  std::string caption;  ///< may be empty
  /// Those of numbers, which stand to the right, begin with '>', those of
  /// sentences with '~'. What report.html says of a column follows after a
  /// bar: ">d [mm]|of a joint".
  std::vector<std::string> titles;
  std::vector<std::vector<std::string>> rows;
  /// Characters that report.txt wraps the cells of a column to, 0 = it does
  /// not; empty: none are.
  std::vector<int> widths;
};

/// A figure of a report's section; report.html alone shows it.
struct ReportFigure {
  std::string id;  ///< of its element
  std::string title;
  std::string svg;   ///< an <svg> element, which becomes a part of the page
  std::string note;  ///< sentences that stand below it
};

/// A section of the report besides those that every result has.
struct ReportSection {
  std::string id;  ///< of its element, which nothing else has
  std::string title;
  /// Paragraphs, tables and figures, in their order.
  std::vector<std::variant<std::string, ReportTable, ReportFigure>> content;
};

/// A section without its title as report.txt has it, for a terminal.
std::string FormatSection(const ReportSection& section);

/// What Save writes besides what every result has.
struct SaveOptions {
  /// Before the last section of report.txt, and first in report.html.
  std::vector<ReportSection> sections;
  std::vector<NamedFile> files;
  bool report_page = false;  ///< also report.html
};

/// Writes a result directory (docs/files.md): arm.yaml, which is loadable
/// wherever an arm is, result.json, report.txt, tables and figures. It is
/// created; files of an earlier result there are replaced, others stay. Returns
/// the paths. @pre the result is usable. @throws InputError where the directory
/// cannot be written, or a file that is not Alidade's is in the way.
std::vector<std::string> Save(const CalibrationResult& result,
                              const std::string& directory,
                              const SaveOptions& options = {});

/// The figures of a result for a section, in the style of report.html. Their
/// ids are "error_before", "error_after", "convergence", and, with validation
/// poses, "validation_before" and "validation_after"; Save writes them as files
/// of these names.
std::vector<ReportFigure> Figures(const CalibrationResult& result);

/// Errors before and after, at training and validation poses, as a table for a
/// terminal.
std::string AccuracyTable(const CalibrationResult& result);

}  // namespace alidade

#endif  // ALIDADE_JOB_H_
