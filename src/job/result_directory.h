#ifndef ALIDADE_SRC_JOB_RESULT_DIRECTORY_H_
#define ALIDADE_SRC_JOB_RESULT_DIRECTORY_H_

#include <string>
#include <vector>

#include "alidade/calibration_result.h"
#include "src/report/report.h"
#include "src/serialization/job_config.h"

namespace alidade::internal {

/// The result.json of a result: itself, or that of its directory.
std::string ResultJsonOf(const std::string& path);

/// The files of a result directory (docs/files.md): arm.yaml (of a rejected
/// result arm.rejected.yaml), result.json,
/// report.txt, the CSV files and the figures. Tables with a row for each
/// observation are made of `result` when they are written: ReportFile.
/// `further`: FormatReport. @pre a solution that may be used or is rejected.
std::vector<ReportFile> RenderResult(const CalibrationResult& result,
                                     const std::string& further = "");
std::vector<ReportFile> RenderResult(const CalibrationResult&& result,
                                     const std::string& further = "") = delete;

/// What a job asks for by its `outputs`: the above, or arm.yaml and result.json
/// alone. @pre a usable solution.
std::vector<ReportFile> RenderResult(const CalibrationResult& result,
                                     JobOutputs outputs);
std::vector<ReportFile> RenderResult(const CalibrationResult&& result,
                                     JobOutputs outputs) = delete;

/// What a command puts into its directory (docs/files.md).
enum class OutputKind {
  kCalibration,
  kComparison,
  kMonteCarlo,
  kPlan,
  kPredictions,  ///< of `validate`
};

/// That a file which a run is to write is none of those that it reads, by
/// whatever name or link. @throws InputError that names it.
void CheckOutputFile(const std::string& path,
                     const std::vector<std::string>& inputs);

/// That a run may write into `directory`, before it begins: what it would
/// replace or remove there is none of the files that it reads (`inputs`), was
/// written by Alidade (`.alidade-files`) and has not been changed since; and
/// that it can be written.
/// @throws InputError that names the file and says what to do.
void CheckResultDirectory(const std::string& directory, OutputKind kind,
                          const std::vector<std::string>& inputs);

/// Writes files into `directory`, which is created: all of them to a new
/// directory beside it, and that then takes its place, so that a run which is
/// killed leaves the old result or the new one (directory_swap.h says where it
/// cannot; the last file, result.json, then says that all is there). Files that
/// an earlier call has written there and this one does not are removed, and so
/// is an earlier report.html: no two results are ever mixed, nor are those of
/// two processes, which wait for each other. Names, sizes and
/// hashes are kept in `.alidade-files`. Files of others stay: where one that
/// this call did not write, or that has been changed since, is in the way,
/// nothing is written. Returns the paths. @throws InputError.
std::vector<std::string> WriteResultDirectory(
    const std::string& directory, const std::vector<ReportFile>& files);

/// Removes what an earlier result has written there, where a run has none to
/// put in its place: nobody takes the old one for the new. @throws InputError.
void RemoveResult(const std::string& directory);

/// That nothing but a page of `report`, unchanged where a result's directory
/// lists it, is at the path of a new one. @throws InputError.
void CheckReportPage(const std::string& path);

/// Notes a page that has been written in the list of its directory: a
/// report.html where there is a list, another one that is listed. @throws
/// InputError.
void NoteReportPage(const std::string& path);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_RESULT_DIRECTORY_H_
