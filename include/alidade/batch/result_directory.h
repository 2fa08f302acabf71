#ifndef ALIDADE_BATCH_RESULT_DIRECTORY_H_
#define ALIDADE_BATCH_RESULT_DIRECTORY_H_

#include <string>
#include <vector>

#include "alidade/batch/job.h"
#include "alidade/report/report.h"

namespace alidade {

/// The files of a result directory (docs/files.md): arm.yaml, result.json,
/// report.txt, the CSV files and the figures. Tables with a row for each
/// observation are made of `outcome` when they are written: ReportFile.
/// @pre a usable solution.
std::vector<ReportFile> RenderResult(const JobOutcome& outcome);
std::vector<ReportFile> RenderResult(const JobOutcome&& outcome) = delete;

/// What a job asks for by its `outputs`: the above, or arm.yaml and result.json
/// alone. @pre a usable solution.
std::vector<ReportFile> RenderResult(const JobOutcome& outcome,
                                     JobOutputs outputs);
std::vector<ReportFile> RenderResult(const JobOutcome&& outcome,
                                     JobOutputs outputs) = delete;

/// Writes them into `directory`, which is created, each to a temporary name
/// that is renamed. The last of them (result.json) is taken away first and
/// written last, so that a directory which has it is complete. Files that an
/// earlier call has written there and this one does not are removed, and so is
/// an earlier report.html: no two results are ever mixed. (Their names are kept
/// in `.alidade-files`; files of others stay.) Returns the paths.
/// @throws InputError.
std::vector<std::string> WriteResultDirectory(
    const std::string& directory, const std::vector<ReportFile>& files);

}  // namespace alidade

#endif  // ALIDADE_BATCH_RESULT_DIRECTORY_H_
