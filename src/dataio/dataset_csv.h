#ifndef ALIDADE_SRC_DATAIO_DATASET_CSV_H_
#define ALIDADE_SRC_DATAIO_DATASET_CSV_H_

#include <string>
#include <vector>

#include "alidade/arm.h"
#include "alidade/dataset.h"
#include "alidade/references.h"
#include "src/common/mapped_file.h"
#include "src/common/text_pieces.h"
#include "src/dataio/data_format.h"
#include "src/dataio/read_options.h"

namespace alidade::internal {

/// Reads measurements of any kind (docs/files.md, "Data set"). Points and
/// planes are looked up by their names in `references`; those that are not
/// there are appended as unknown.
/// @pre the mapping's lists are empty or as long as they should be.
///
/// Files whose names end in ".npy" are NumPy arrays, all others CSV. Large
/// files of positions or poses are mapped into memory and read by
/// `num_threads`; the result does not depend on it.
/// @throws InputError with file, line (of a NumPy array, row) and column name.
LoadedData LoadData(const std::string& path, const Arm& arm,
                    const DataFormat& format, References* references,
                    int num_threads = 1);

/// LoadData with all its options. @throws InputError.
LoadedData LoadDataWith(const DataFile& file, References* references,
                        const ReadOptions& options);
/// The same of a file that is open.
LoadedData ReadData(MappedFile content, const DataFile& file,
                    References* references, const ReadOptions& options);

/// Reads only the joint columns; others are allowed and ignored.
Eigen::MatrixXd LoadJointValues(const std::string& path, const Arm& arm);

/// Writes a data set of positions or poses as text that LoadDataset reads back:
/// joint values in deg and mm with `joint_decimals` decimals, or with
/// kFewestDigits so that they read back to the same bits (a column of angles
/// that no number of degrees reads back to is in rad); positions in mm
/// with the fewest digits that read back to the same bits; orientations as
/// rotation vectors in deg that read back to rounding; sigmas likewise when
/// `with_sigmas` (not the correlations of whiteners, and not kUnstatedSigma).
/// What was not measured is an empty cell. Rows are in the order of poses. Each
/// of `comments` is a line after "# " on top.
/// @pre blocks are of kPosition and kPose.
void WriteDatasetText(const Dataset& dataset, const Arm& arm,
                      int joint_decimals, bool with_sigmas,
                      const std::vector<std::string>& comments,
                      const TextSink& sink);
/// The same as one string.
std::string FormatDataset(const Dataset& dataset, const Arm& arm,
                          int joint_decimals, bool with_sigmas,
                          const std::vector<std::string>& comments);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_DATASET_CSV_H_
