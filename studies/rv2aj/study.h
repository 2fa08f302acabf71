#ifndef ALIDADE_STUDIES_RV2AJ_STUDY_H_
#define ALIDADE_STUDIES_RV2AJ_STUDY_H_

#include <string>
#include <vector>

#include "alidade/accuracy.h"
#include "alidade/job.h"
#include "alidade/units.h"

namespace alidade::rv2aj {

/// One line of "published against obtained".
struct StudyRow {
  std::string key;  ///< as the job names the quantity
  std::string quantity;
  std::string published;
  std::string obtained;
};

/// One parameter of the study's tables, as deviations from nominal.
struct StudyParameter {
  std::string name;
  Dimension dimension = Dimension::kLength;
  bool identified = false;
  double nominal = 0.0;
  double assumed = 0.0;    ///< deviation of the assumed real arm
  double published = 0.0;  ///< as the study's table prints it
  double obtained = 0.0;   ///< ours, at full precision
};

/// A free parameter takes up part of a fixed one that is not at its
/// nominal value: to first order at the identified geometry,
/// change of `taken_up_by` = coefficient * deviation of `fixed`.
struct Absorption {
  std::string fixed;
  Dimension fixed_dimension = Dimension::kLength;
  double fixed_deviation = 0.0;
  std::string taken_up_by;
  Dimension dimension = Dimension::kLength;  ///< of `taken_up_by`
  double coefficient = 0.0;
  double amount = 0.0;
};

/// The published study beside our results.
struct StudyResult {
  std::string source;
  std::vector<StudyRow> rows;
  std::vector<StudyParameter> parameters;
  std::vector<Absorption> absorptions;
  /// Digits of the study's printed table (of rad and of mm).
  int angle_decimals = 0;
  int length_decimals = 0;
  /// Over the validation poses: the identified values, the same rounded as the
  /// study prints them, and with three more decimals of the lengths.
  Accuracy full_precision;
  Accuracy as_printed;
  Accuracy three_more_decimals;
  /// The baseline's fixed number of iterations against the published time.
  int timed_iterations = 0;
  double timed_s = 0.0;
  double published_s = 0.0;
};

/// Sets the job's result beside what the job's `published` says: repeats the
/// study's fixed number of iterations of its own algorithm (median time of
/// three), evaluates the identified values rounded as its table prints them,
/// and finds which free parameters took up the fixed ones. @pre the result
/// is usable; the job has `published`, `validation` and `truth`; the data are
/// one position per pose, all of the same sigma.
StudyResult CompareWithStudy(const Job& job, const CalibrationResult& result);

}  // namespace alidade::rv2aj

#endif  // ALIDADE_STUDIES_RV2AJ_STUDY_H_
