#ifndef ALIDADE_IO_RESULT_JSON_H_
#define ALIDADE_IO_RESULT_JSON_H_

#include <string>

#include "alidade/results/job_result.h"

namespace alidade {

/// A result for machines (docs/files.md, "result.json"): SI units, stable keys,
/// every number with the digits that read back to the same bits, NaN and
/// infinities as null.
std::string FormatResultJson(const JobResult& result);

/// Reads result.json back as far as `show` needs it: all but the per-pose
/// arrays, which live in residuals.csv. @throws InputError.
JobResult LoadResultJson(const std::string& path);

}  // namespace alidade

#endif  // ALIDADE_IO_RESULT_JSON_H_
