#ifndef ALIDADE_SRC_SERIALIZATION_DATA_SECTION_H_
#define ALIDADE_SRC_SERIALIZATION_DATA_SECTION_H_

#include <string>

#include "src/dataio/dataset_csv.h"
#include "src/serialization/field_records.h"
#include "src/serialization/job_config.h"

namespace alidade::internal {

inline constexpr char kDataSchema[] = R"({"$ref": "#/$defs/data"})";
inline constexpr char kSigmaSchema[] =
    R"({"anyOf": [{"type": "number", "exclusiveMinimum": 0}, {"const": "estimate"}]})";

/// A first guess of a sigma that is to be estimated: what an arm's calibration
/// commonly leaves (m). Only the ratio to the priors hangs on it, until the
/// estimate replaces it.
inline constexpr double kFirstSigma = 1e-4;

/// What `measurement` says of data that state no sigmas of their own.
struct MeasurementSigmas {
  double length = 0.0;                    ///< (m)
  double rotation = 0.0;                  ///< (rad); 0 = from that of lengths
  std::optional<double> instrument = {};  ///< of lengths that are estimated
};

/// The section `measurement` of a job.
template <typename Visitor>
void VisitMeasurement(Visitor& v, MeasurementSigmas* sigmas, bool* estimates) {
  const Key sigma = LengthKey("sigma").Above(0).Required();
  v.Custom(sigma.Schema(kSigmaSchema),
           "standard deviation of each measured length, where a data set "
           "states none; or `estimate`: from the residuals of the fit "
           "(\"Estimated sigmas\", below)",
           [&](const YamlValue& value, const Units& units) {
             *estimates = value.Text() == "estimate";
             sigmas->length =
                 *estimates ? kFirstSigma : ReadNumber(value, sigma, units);
           });
  v.Field(
      AngleKey("sigma_rotation").Above(0).Default("sigma / 0.2 m, in rad"),
      sigmas->rotation,
      "likewise of measured orientations, about each axis of the instrument");
  v.Field(LengthKey("instrument").Above(0), sigmas->instrument,
          "with `estimate`: the instrument's own standard deviation of a "
          "length, where a data set states none. What the residuals have "
          "beyond it the model lacks");
  v.Check([sigmas, estimates](const YamlMap& map) {
    if (!sigmas->instrument) return;
    if (!*estimates) {
      map.Required("instrument").Fail("needs `sigma: estimate`");
    }
    sigmas->length = *sigmas->instrument;
  });
}

/// What a map of `data` may hold.
std::vector<FieldRecord> DataFields();

/// Whether sigmas that are estimated are more than a first guess: in the job or
/// in a file somebody says what the instrument has.
bool AreStated(const MeasurementSigmas& sigmas, const Dataset& data);

/// Reads data for the job's arm: a path, a map of a file and what it does not
/// say itself, or a list of both, merged. The job's references grow by what the
/// files name, its list of rejected rows by theirs. `first_station`: the one
/// whose base is the arm's; found where it is empty. @throws InputError.
LoadedData ReadData(const YamlValue& value, const MeasurementSigmas& sigmas,
                    std::string* first_station, JobContext* context,
                    JobConfig* job);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_DATA_SECTION_H_
