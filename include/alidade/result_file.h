#ifndef ALIDADE_RESULT_FILE_H_
#define ALIDADE_RESULT_FILE_H_

#include <string>
#include <vector>

#include "alidade/calibration_result.h"
#include "alidade/identifiability.h"
#include "alidade/job.h"
#include "alidade/monte_carlo.h"
#include "alidade/plan.h"

namespace alidade {

/// Reads a result directory, or its result.json: all of the latter, and what
/// tables beside it hold (docs/files.md). Those state lengths in mm and angles
/// in deg, so that residuals are those of the result to rounding, and
/// orientations' residuals angles alone, about x.
/// @throws InputError with file and key.
CalibrationResult LoadResult(const std::string& path);

/// result.json of a result, in SI with the digits that read back to the same
/// bits; what has a number for each pose or observation is not in it.
std::string FormatResult(const CalibrationResult& result);
/// Reads that back. @throws InputError.
CalibrationResult ParseResult(const std::string& text);

/// report.txt and report.html: the latter is one file that loads nothing.
std::string ReportText(const CalibrationResult& result);
std::string ReportPage(const CalibrationResult& result);

/// What an identifiability analysis found (docs/identifiability.md), all but
/// its decisions, and what the program prints of it.
std::string FormatResult(const IdentifiabilityResult& result);
std::string ReportText(const IdentifiabilityResult& result);

/// plan.json of a plan, and what the program prints of it.
std::string FormatResult(const PlanResult& result);
std::string ReportText(const PlanResult& result);
/// The files of a plan's directory (docs/planning.md), figures among them.
std::vector<NamedFile> FilesOf(const PlanResult& result);

/// What the program prints of simulated calibrations, and their files.
std::string ReportText(const MonteCarloResult& result);
std::vector<NamedFile> FilesOf(const MonteCarloResult& result);

/// Writes such files into a directory, which is created; those of an earlier
/// run there are replaced. Returns the paths. @throws InputError.
std::vector<std::string> SaveFiles(const std::vector<NamedFile>& files,
                                   const std::string& directory);

}  // namespace alidade

#endif  // ALIDADE_RESULT_FILE_H_
