#ifndef ALIDADE_SRC_CALIBRATION_BATCH_SUMMARY_FIELDS_H_
#define ALIDADE_SRC_CALIBRATION_BATCH_SUMMARY_FIELDS_H_

#include "src/calibration/batch_summary.h"
#include "src/calibration/calibration_result_fields.h"
#include "src/common/fields.h"

namespace alidade::internal {

template <>
inline constexpr std::array kWords<BatchStatus> = {
    std::pair{BatchStatus::kNotRun, "not_run"},
    std::pair{BatchStatus::kDone, "done"},
    std::pair{BatchStatus::kMissedLimits, "missed_limits"},
    std::pair{BatchStatus::kBadInput, "bad_input"},
    std::pair{BatchStatus::kFailed, "failed"},
};

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, BatchEntry>& entry) {
  v.Field("name", entry.name);
  v.Field("job", entry.job_file);
  v.Field("status", entry.status);
  v.Field("message", entry.message);
  v.Field("directory", entry.directory);
  v.Field("title", entry.title);
  v.Field("arm", entry.arm);
  v.Field("data", entry.data);
  v.NullableGroup("train", entry.train_after.n > 0, [&](auto& train) {
    train.Field("before", entry.train_before);
    train.Field("after", entry.train_after);
  });
  v.NullableGroup("validation", entry.validation_after.n > 0,
                  [&](auto& validation) {
                    validation.Field("before", entry.validation_before);
                    validation.Field("after", entry.validation_after);
                  });
  v.Field("num_free", entry.num_free);
  v.Field("iterations", entry.iterations);
  v.Field("solver_status", entry.solver_status);
  v.Field("sigma", entry.sigma);
  v.Field("reduced_chi_square", entry.reduced_chi_square);
  v.Field("num_outliers", entry.num_outliers);
  v.Field("warnings", entry.warnings);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, BatchSummary>& summary) {
  v.Field("version", summary.version);
  v.Group("counts", [&](auto& counts) {
    for (const auto& [status, word] : kWords<BatchStatus>) {
      counts.Computed(word, summary.Count(status));
    }
  });
  v.Later("comparison", summary.comparison);
  v.Field("jobs", summary.entries);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, ResultFile>& file) {
  v.Field("name", file.name);
  v.Field("bytes", file.bytes);
}

template <typename Visitor>
void VisitFields(Visitor& v, Subject<Visitor, BatchRecord>& record) {
  v.Field("version", record.version);
  v.Field("fingerprint", record.fingerprint);
  v.Field("inputs", record.inputs);
  v.Field("result_sha256", record.result_sha256);
  v.Field("files", record.files);
  v.Field("entry", record.entry);
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_BATCH_SUMMARY_FIELDS_H_
