#ifndef ALIDADE_SRC_REPORT_HTML_REPORT_H_
#define ALIDADE_SRC_REPORT_HTML_REPORT_H_

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "alidade/calibration_result.h"
#include "alidade/comparison.h"
#include "src/common/text_pieces.h"

namespace alidade::internal {

/// HTML pages that people look at (docs/report.md). A page is one file: style,
/// script and data are inside, nothing is loaded from anywhere. The data are
/// JSON in <script id="alidade-data">, from which the script in the page draws
/// tables and figures. No text of a result can become markup: in the data every
/// '<' is escaped, and the script makes text nodes of text only. Only further
/// sections are markup, of the program that makes the page.

/// The arm as a chain of links at some of the poses of `residuals.csv`, in the
/// instrument's frame (m).
struct ArmPicture {
  Eigen::Matrix<double, 3, 4> instrument_from_base;  ///< [R | t]
  std::vector<int> poses;  ///< as that file counts them, from 1
  /// One entry per pose: the corners from the base to the target.
  std::vector<Eigen::Matrix3Xd> lines;
};

/// One result as its directory holds it. Files that are missing are empty (no
/// text, no source); the
/// page then leaves out what they would show.
struct ReportSource {
  std::string label;  ///< what the directory is called
  std::string title;
  std::string result_json;  ///< valid: LoadResultJson read it
  std::string report_text;  ///< for readers without scripts
  TextSource residuals_csv;
  TextSource heldout_csv;
  TextSource predicted_map_csv;
  TextSource influence_csv;
  std::optional<ArmPicture> picture;
  std::string sections;  ///< markup of further <section> elements
};

/// report.html of one result. At most 4000 rows of a table are in it, spread
/// evenly, and the worst; a result.json of more than 500 kB with seven digits.
std::string RenderResultPage(const ReportSource& source);

/// What a comparison page needs of a result.
struct ComparisonItem {
  ComparedResult values;  ///< what is compared
  std::string version;
  std::string data;  ///< what it was measured on
  std::string json;  ///< what the page shows besides
};

/// `link` leads from the page to the result's own; empty = there is none.
ComparisonItem MakeComparisonItem(const std::string& label,
                                  const CalibrationResult& result,
                                  const std::string& link);

/// One page of several results. 1 to 2 kB of page a result; it holds what it
/// needs of each, not the results.
class ComparisonPage {
 public:
  void Add(ComparisonItem item);
  /// As MakeComparisonItem.
  void Add(const std::string& label, const CalibrationResult& result,
           const std::string& link) {
    Add(MakeComparisonItem(label, result, link));
  }
  /// A job that came to no result, and why.
  void AddFailure(const std::string& label, const std::string& message);

  std::size_t num_results() const { return data_.size(); }

  /// Methods where all results are of the same data files and the same arm,
  /// else a fleet, which cannot be distinguished from an arm over time.
  ComparisonKind GuessKind() const;

  /// What the comparison shows, as the page says it.
  std::string Sentence(ComparisonKind kind) const;

  /// The first 2000 results in full, and how many more there are.
  std::string Render(ComparisonKind kind) const;

 private:
  std::vector<ComparedResult> values_;
  std::vector<std::string> results_;
  std::vector<std::string> failures_;
  std::vector<std::string> data_;  ///< what each result was measured on
  std::string version_;
  std::size_t left_out_ = 0;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_HTML_REPORT_H_
