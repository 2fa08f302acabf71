#ifndef ALIDADE_DATASET_FILE_H_
#define ALIDADE_DATASET_FILE_H_

#include <string>

#include "alidade/arm.h"
#include "alidade/dataset.h"

namespace alidade {

/// Reads a data set of positions, orientations (quaternions or rotation
/// vectors) and differences from a file in Alidade's own format, CSV or, where
/// the name ends in ".npy", a NumPy array (docs/files.md, "Data set").
/// `default_sigma` (m) is that of lengths without one. Large files are read by
/// `num_threads`; the result does not depend on it.
/// @throws InputError with file, line (of an array, row) and column; also where
/// the file needs a job to be understood (columns, references).
Dataset LoadDataset(const std::string& path, const Arm& arm,
                    double default_sigma, int num_threads = 1);

}  // namespace alidade

#endif  // ALIDADE_DATASET_FILE_H_
