#ifndef ALIDADE_SRC_SERIALIZATION_PLAN_FILE_H_
#define ALIDADE_SRC_SERIALIZATION_PLAN_FILE_H_

#include <string>
#include <vector>

#include "src/planning/plan_task.h"
#include "src/serialization/field_records.h"
#include "src/serialization/job_config.h"

namespace alidade::internal {

/// A plan file, its files loaded and checked.
struct PlanConfig : PlanTask {
  std::string path;
  std::string title;
  std::vector<std::string> input_files;
};

/// What a plan file may hold.
std::vector<FieldRecord> PlanFields();

/// What a plan says of its design alone, where arm and earlier measurements are
/// there already: all but head, title and sources.
std::vector<FieldRecord> PlanOptionFields();
/// Reads that. @pre plan->job has the arm, the references and what was measured
/// before. @throws InputError.
void ReadPlanOptions(const YamlValue& value, const Units& units,
                     PlanConfig* plan);

/// Reads a plan file and every file it names; paths are relative to it.
/// @throws InputError with file, line, column and key.
PlanConfig LoadPlan(const std::string& path, int num_threads = 1);
/// The same of a plan file's root.
PlanConfig ReadPlan(const YamlValue& root, int num_threads = 1);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_PLAN_FILE_H_
