#include "src/fleet/batch_csv.h"

#include <cmath>

#include "alidade/units.h"
#include "src/common/text.h"

namespace alidade::internal {
namespace {

std::string NumberCell(double value) {
  return std::isfinite(value) ? ShortestNumber(value) : "";
}

std::string AccuracyCells(const Accuracy& before, const Accuracy& after) {
  if (after.n == 0) return ",,,,";
  std::string cells;
  for (const double value : {before.rms, after.rms, before.max, after.max}) {
    cells += "," + NumberCell(value / kMillimetre);
  }
  return cells;
}

}  // namespace

const char* ToString(BatchStatus status) {
  switch (status) {
    case BatchStatus::kNotRun:
      return "not run";
    case BatchStatus::kDone:
      return "done";
    case BatchStatus::kMissedLimits:
      return "missed limits";
    case BatchStatus::kBadInput:
      return "bad input";
    case BatchStatus::kFailed:
      return "failed";
  }
  return "";
}

std::string FormatBatchCsv(const BatchSummary& summary) {
  std::string text =
      "name,job,arm,data,status,message,"
      "train_rms_before_mm,train_rms_after_mm,train_max_before_mm,"
      "train_max_after_mm,validation_rms_before_mm,validation_rms_after_mm,"
      "validation_max_before_mm,validation_max_after_mm,"
      "free,iterations,sigma_mm,reduced_chi_square,outliers,warnings,"
      "directory\n";
  for (const BatchEntry& entry : summary.entries) {
    text += entry.name + "," + TextCell(entry.job_file) + "," +
            TextCell(entry.arm) + "," + TextCell(entry.data) + "," +
            ToString(entry.status) + "," + TextCell(entry.message) +
            AccuracyCells(entry.train_before, entry.train_after) +
            AccuracyCells(entry.validation_before, entry.validation_after);
    if (entry.train_after.n > 0) {
      text += "," + std::to_string(entry.num_free) + "," +
              std::to_string(entry.iterations) + "," +
              NumberCell(entry.sigma / kMillimetre) + "," +
              NumberCell(entry.reduced_chi_square) + "," +
              std::to_string(entry.num_outliers) + "," +
              std::to_string(entry.warnings.size());
    } else {
      text += ",,,,,,";
    }
    text += "," + entry.directory + "\n";
  }
  return text;
}

}  // namespace alidade::internal
