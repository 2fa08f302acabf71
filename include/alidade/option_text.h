#ifndef ALIDADE_OPTION_TEXT_H_
#define ALIDADE_OPTION_TEXT_H_

#include <string>
#include <vector>

#include "alidade/arm.h"
#include "alidade/calibration_options.h"
#include "alidade/dataset.h"
#include "alidade/monte_carlo.h"
#include "alidade/plan.h"
#include "alidade/references.h"

namespace alidade {

/// Options as text, for those who have them as keys and values and not as a
/// file: other languages, servers, notebooks. A text is YAML, of which JSON is
/// a part:
///
///   units: {length: m, angle: rad}
///   options:
///     identifiability: {parameters: [joints, base, tool]}
///     robust: {loss: huber}
///
/// Keys, ranges and messages are those of job and plan files (docs/files.md);
/// OptionsOf* list them. What is left out leaves the options alone.
///
/// All functions throw InputError whose key is the option's, "options." before
/// it, and that has line and column of the text.

/// One option, or a section of some.
struct OptionDescription {
  std::string name;
  std::string text;  ///< what it means, in Markdown
  /// "number", "integer", "boolean", "text", "word", "section", "items" (a list
  /// of maps) or "value" (anything else: the text says what).
  std::string type;
  std::string default_value;  ///< for people; empty where there is none
  std::string range;          ///< "above 0", "from 0 to 12"; may be empty
  std::string unit;           ///< "length", "angle", others in words, or empty
  bool is_required = false;
  std::vector<std::string> words;         ///< that a "word" is one of
  std::vector<OptionDescription> fields;  ///< of a "section", of "items"
};

/// Those of a calibration: `estimate_sigma`, `solver`, `robust`,
/// `compare_with`, `identifiability`, `errors`, `bounds`, `validation`,
/// `acceptance`, `uncertainty`.
std::vector<OptionDescription> OptionsOfCalibration();
void ReadOptions(const std::string& text, const Arm& arm,
                 const References& references, CalibrationOptions* options);

/// Those of simulated calibrations.
std::vector<OptionDescription> OptionsOfMonteCarlo();
void ReadOptions(const std::string& text, MonteCarloOptions* options);

/// Those of a plan, but for arm and earlier measurements. `identifiability` and
/// `errors` are options of the calibration to come.
std::vector<OptionDescription> OptionsOfPlan();
void ReadOptions(const std::string& text, const Arm& arm,
                 const References& references, PlanOptions* options,
                 CalibrationOptions* calibration);

/// Measurements as a job's `data` names them.
struct LoadedMeasurements {
  Dataset data;
  References references;           ///< stated ones, then those that files name
  std::vector<CovariateUse> uses;  ///< of the data's covariates
  std::vector<std::string> sets;   ///< of each pose, where a column says it
  /// Where files name stations, the one whose base is the arm's.
  std::string first_station;
  std::vector<RejectedRow> rejected;
  /// Not all sigmas are a first guess of `measurement: {sigma: estimate}`.
  bool are_sigmas_stated = true;
};

/// What a map of `data` may say of a file.
std::vector<OptionDescription> OptionsOfData();
/// Reads files by a text of `units`, `measurement`, `references` (which may be
/// left out) and `data`, as in a job. Paths are relative to the current
/// directory.
LoadedMeasurements LoadMeasurements(const std::string& text, const Arm& arm,
                                    int num_threads = 1);

}  // namespace alidade

#endif  // ALIDADE_OPTION_TEXT_H_
