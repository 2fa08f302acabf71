#include "src/fleet/job_computer.h"

#include <algorithm>
#include <exception>
#include <memory>
#include <new>

#include "alidade/error.h"
#include "alidade/version.h"
#include "src/common/files.h"
#include "src/common/format.h"
#include "src/job/result_directory.h"

namespace alidade::internal {
namespace {

// What job files say of the job is in its fingerprint; what they say of others,
// and comments, do not matter.
std::vector<InputFile> WithoutJobFiles(std::vector<InputFile> inputs,
                                       const JobMatrix& matrix) {
  const std::vector<std::string>& files = matrix.files();
  const auto is_job_file = [&files](const InputFile& input) {
    return std::find(files.begin(), files.end(), input.path) != files.end();
  };
  inputs.erase(std::remove_if(inputs.begin(), inputs.end(), is_job_file),
               inputs.end());
  return inputs;
}

BatchStatus StatusOf(CalibrationStatus status) {
  if (status == CalibrationStatus::kDone) return BatchStatus::kDone;
  return status == CalibrationStatus::kMissedLimits ? BatchStatus::kMissedLimits
                                                    : BatchStatus::kFailed;
}

void Describe(const CalibrationResult& result, BatchEntry* entry) {
  entry->status = StatusOf(result.status);
  entry->message = result.message;
  entry->title = result.title;
  entry->arm = result.arm_name;
  entry->data = result.train.name;
  const KeptErrors train = result.train.Judged();
  entry->train_before = train.before;
  entry->train_after = train.after;
  if (result.validation) {
    const KeptErrors validation = result.validation->Judged();
    entry->validation_before = validation.before;
    entry->validation_after = validation.after;
  }
  entry->num_free = result.identifiability.num_free;
  if (!result.runs.empty()) {
    const SolverSummary& summary = result.runs.front().summary;
    entry->solver_status = ToString(summary.status);
    if (!summary.iterations.empty()) {
      entry->iterations = summary.iterations.back().iteration;
    }
  }
  if (result.estimated_sigma > 0.0) entry->sigma = result.estimated_sigma;
  entry->reduced_chi_square = result.reduced_chi_square;
  entry->num_outliers = static_cast<std::int64_t>(result.outliers.size());
  entry->warnings = result.warnings;
}

bool HasResult(const BatchEntry& entry) {
  return entry.status == BatchStatus::kDone ||
         entry.status == BatchStatus::kMissedLimits;
}

}  // namespace

std::string FingerprintOf(const BatchPlan& plan, const PlannedJob& job,
                          const BatchOptions& options) {
  std::string fingerprint = plan.matrices[job.matrix].FingerprintOf(job.number);
  if (options.outputs) {
    fingerprint += std::string("+") + WordOf(*options.outputs);
  }
  return fingerprint;
}

BatchEntry EntryOf(const PlannedJob& job) {
  BatchEntry entry;
  entry.name = job.name;
  entry.job_file = job.file;
  return entry;
}

void WorkTimes::Add(const WorkTimes& more) {
  reading += more.reading;
  calibrating += more.calibrating;
  writing += more.writing;
}

std::string WorkTimes::Format() const {
  const auto seconds = [](std::int64_t nanoseconds) {
    return FormatSignificant(1e-9 * static_cast<double>(nanoseconds), 3) + " s";
  };
  return "reading " + seconds(reading) + ", calibrating " +
         seconds(calibrating) + ", writing " + seconds(writing);
}

JobComputer::JobComputer(const BatchPlan& plan, const BatchOptions& options,
                         int threads_each, WorkTimes* times)
    : plan_(plan),
      options_(options),
      times_(*times),
      threads_each_(threads_each),
      places_(plan, options.directory) {}

Computed JobComputer::Compute(const PlannedJob& job) const {
  Computed computed;
  BatchRecord& record = computed.record;
  record.entry = EntryOf(job);
  record.version = Version();
  try {
    if (job.matrix < 0) {
      record.entry.status = BatchStatus::kBadInput;
      record.entry.message = job.error;
    } else {
      Run(job, &computed);
    }
  } catch (const OutputConflict&) {
    throw;
  } catch (const InputError& error) {
    record.entry.status = BatchStatus::kBadInput;
    record.entry.message = error.what();
  } catch (const std::bad_alloc&) {
    record.entry.status = BatchStatus::kFailed;
    record.entry.message = "out of memory";
  } catch (const std::exception& error) {
    record.entry.status = BatchStatus::kFailed;
    record.entry.message = std::string("internal error: ") + error.what();
  }
  if (!HasResult(record.entry)) {
    computed.files.clear();
    computed.result.reset();
    computed.item.reset();
  }
  return computed;
}

JobConfig JobComputer::Read(const PlannedJob& job, BatchRecord* record) const {
  const ScopedTimer timer(&times_.reading);
  record->fingerprint = FingerprintOf(plan_, job, options_);
  JobConfig config = plan_.matrices[job.matrix].Load(job.number, threads_each_);
  for (const std::string& input : config.input_files) places_.Refuse(input);
  if (options_.outputs) config.outputs = *options_.outputs;
  return config;
}

CalibrationResult JobComputer::Calibrate(const JobConfig& config,
                                         const PlannedJob& job) const {
  const ScopedTimer timer(&times_.calibrating);
  return RunJob(config, "alidade batch " + job.file, &cache_);
}

void JobComputer::Run(const PlannedJob& job, Computed* computed) const {
  BatchRecord& record = computed->record;
  const JobConfig config = Read(job, &record);
  computed->result =
      std::make_unique<const CalibrationResult>(Calibrate(config, job));
  const CalibrationResult& result = *computed->result;
  const ScopedTimer timer(&times_.writing);
  record.inputs = WithoutJobFiles(result.inputs, plan_.matrices[job.matrix]);
  Describe(result, &record.entry);
  if (!HasResult(record.entry)) return;
  computed->files = RenderResult(result, config.outputs);
  record.entry.directory = job.name;
  computed->item = MakeComparisonItem(job.name, result, "");
  for (const ReportFile& file : computed->files) {
    if (file.name == "result.json") record.result_sha256 = Sha256(file.Text());
  }
}

}  // namespace alidade::internal
