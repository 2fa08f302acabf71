#ifndef ALIDADE_SRC_SERIALIZATION_SIMULATION_FILE_H_
#define ALIDADE_SRC_SERIALIZATION_SIMULATION_FILE_H_

#include <string>

#include "alidade/units.h"
#include "src/serialization/config_file.h"
#include "src/serialization/yaml_reader.h"
#include "src/simulation/simulation.h"

namespace alidade::internal {

/// Reads what a simulation file and a job's `simulate` have in common: how the
/// real arm differs, poses, noise, seed. `map` may hold other keys too.
/// @pre config->arm is the nominal arm. @throws InputError.
void ReadSimulationSection(const YamlMap& map, const Units& units,
                           NamedFiles* files, SimulationConfig* config);

/// A job's `simulate`, of the job's arm. @throws InputError.
SimulationConfig ReadSimulatedData(const YamlValue& value, const Arm& arm,
                                   const Units& units, NamedFiles* files);

/// Reads a simulation and every file it names.
/// @throws InputError with file, line, column and key.
SimulationConfig LoadSimulation(const std::string& path);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_SIMULATION_FILE_H_
