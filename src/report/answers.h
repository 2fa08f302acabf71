#ifndef ALIDADE_SRC_REPORT_ANSWERS_H_
#define ALIDADE_SRC_REPORT_ANSWERS_H_

#include <string>
#include <vector>

#include "alidade/calibration_result.h"

namespace alidade::internal {

/// A question of someone who is to use the arm, and sentences that answer it.
struct Answer {
  std::string question;
  std::vector<std::string> sentences;
};

inline constexpr char kHowAccurate[] = "How accurate is it?";

/// What terminal, report.txt and page say first: may the arm be used, how
/// accurate is it, where is it worst, what is to be measured next. Questions
/// that a result has no answer to are left out.
std::vector<Answer> AnswersOf(const CalibrationResult& result);

/// As text: a paragraph each.
std::string FormatAnswers(const CalibrationResult& result);

/// How many measurements were rejected, or stand out, and whether the numbers
/// contain them; empty where there are none.
std::string OutlierNote(const CalibrationResult& result);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_ANSWERS_H_
