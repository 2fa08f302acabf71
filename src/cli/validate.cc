#include <iostream>

#include "alidade/base/units.h"
#include "alidade/batch/evaluate.h"
#include "alidade/io/arm_file.h"
#include "alidade/io/dataset_csv.h"
#include "alidade/measurement/measurement_model.h"
#include "alidade/report/format.h"
#include "alidade/report/text_table.h"
#include "command.h"

namespace alidade {
namespace {

constexpr int kRandomPoses = 10000;
constexpr std::uint64_t kDefaultSeed = 1;

// Errors are told in mm; the sigma of a data set plays no part in them.
constexpr double kAnySigma = kMillimetre;

Accuracy ValidateAgainst(const Arm& arm, const std::string& file,
                         const CommandLine& line) {
  if (!IsDataFile(file)) {
    return CompareArms(arm, LoadArm(file), kRandomPoses,
                       line.seed.value_or(kDefaultSeed));
  }
  const MeasurementModel model(arm, line.threads);
  return EvaluateAccuracy(model,
                          LoadDataset(file, arm, kAnySigma, line.threads),
                          model.NominalValues());
}

}  // namespace

ExitStatus RunValidate(const CommandLine& line) {
  const Arm arm = LoadArm(line.files.front());
  using Align = TextTable::Align;
  TextTable table({{"against"},
                   {"poses", Align::kRight},
                   {"mean mm", Align::kRight},
                   {"rms mm", Align::kRight},
                   {"p95 mm", Align::kRight},
                   {"max mm", Align::kRight}});
  for (std::size_t i = 1; i < line.files.size(); ++i) {
    const Accuracy accuracy = ValidateAgainst(arm, line.files[i], line);
    std::vector<std::string> row = {line.files[i], std::to_string(accuracy.n)};
    for (const double value :
         {accuracy.mean, accuracy.rms, accuracy.p95, accuracy.max}) {
      row.push_back(FormatSignificant(value / kMillimetre, 4));
    }
    table.AddRow(row);
  }
  std::cout << "Position error of " << arm.name << "\n" << table.ToString();
  return kExitDone;
}

}  // namespace alidade
