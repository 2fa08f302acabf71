#ifndef ALIDADE_SRC_SERIALIZATION_SIMULATION_FILE_H_
#define ALIDADE_SRC_SERIALIZATION_SIMULATION_FILE_H_

#include <string>
#include <vector>

#include "src/serialization/config_file.h"
#include "src/serialization/field_records.h"
#include "src/serialization/yaml_reader.h"
#include "src/simulation/simulation.h"

namespace alidade::internal {

/// What a simulation file may hold, and a job's `simulate`.
std::vector<FieldRecord> SimulationFields();
std::vector<FieldRecord> SimulatedDataFields();

/// A job's `simulate`, of the job's arm. @throws InputError.
SimulationConfig ReadSimulatedData(const YamlValue& value, const Arm& arm,
                                   const Units& units, NamedFiles* files);

/// Reads a simulation and every file it names.
/// @throws InputError with file, line, column and key.
SimulationConfig LoadSimulation(const std::string& path);
/// The same of a simulation file's root.
SimulationConfig ReadSimulation(const YamlValue& root);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_SIMULATION_FILE_H_
