#ifndef ALIDADE_SRC_SERIALIZATION_VALIDATION_SECTION_H_
#define ALIDADE_SRC_SERIALIZATION_VALIDATION_SECTION_H_

#include <optional>
#include <string>
#include <vector>

#include "src/calibration/calibration_options_fields.h"
#include "src/serialization/data_section.h"
#include "src/serialization/job_config.h"

namespace alidade::internal {

/// @throws InputError where the map says several or none.
void CheckOneWay(const YamlMap& map);

/// The section `validation`: one of several ways to come by poses that the fit
/// does not use.
struct StatedValidation {
  std::optional<YamlValue> data, set, file;
  HoldOutOptions holdout;
  FoldsOptions folds;
  /// The station of the data to fit whose base is the arm's.
  std::string first_station;
};

template <typename Visitor>
void VisitValidation(Visitor& v, StatedValidation* stated) {
  v.Field(Key("data").Schema(kDataSchema), stated->data,
          "other data, named as in `data`. Points and planes that these alone "
          "name are found from them, the calibrated arm held, which is said");
  VisitFields(v, stated->holdout);
  VisitFields(v, stated->folds);
  v.Field(Key("seed"), stated->holdout.seed,
          "of the configurations that `fraction` or `folds` draw");
  v.Field(Key("set").Schema(kTextsSchema), stated->set,
          "list of texts: poses are held out whose cell in the column `set` is "
          "one of them");
  v.Field(Key("file").Schema(R"({"type": ["string", "integer"]})"),
          stated->file,
          "the poses of one of the files of `data` are held out: its path, its "
          "name without folders, or its place in that list, from 1");
  v.Check(CheckOneWay);
}

/// Reads other data, or takes poses out of the job's; `sets` are those of its
/// poses (LoadedData). @throws InputError.
void TakeValidation(const YamlMap& map, const StatedValidation& stated,
                    const MeasurementSigmas& sigmas,
                    const std::vector<std::string>& sets, JobContext* context,
                    JobConfig* job);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_VALIDATION_SECTION_H_
