#ifndef ALIDADE_SRC_KERNEL_KERNEL_H_
#define ALIDADE_SRC_KERNEL_KERNEL_H_

#include <cstddef>

#include "src/kernel/kernel_constants.h"
#include "src/kernel/tiles.h"

// The batched kernel: whitened residuals and Jacobian columns of a tile of
// observations at once, in the widest vector instructions that the machine has
// (chosen at run time). Residuals are those of observation_residual.h,
// derivatives those of chain_axes.h and docs/kernel.md.
namespace alidade::internal::kernel {

/// Doubles of scratch that EvaluateTile needs for an arm of so many joints.
std::size_t ScratchSize(int num_joints);

/// The rows of a tile, whitened by its inverse sigmas: for each column of
/// `columns` and then for the residual, RowsOf(kind) arrays of kTile numbers.
/// `lengths` becomes the squared norm of each observation's error in lengths
/// (m^2), rows that were not measured left out. Padding becomes zero.
///
/// @pre scratch, rows and lengths are aligned to 64 bytes.
void EvaluateTile(const Constants& constants, const Columns& columns,
                  const Tile& tile, double* scratch, double* rows,
                  double* lengths);

/// What the residuals of a tile come to.
struct TileSums {
  double chi_square = 0.0;       ///< sum of squared whitened residuals
  double squared_lengths = 0.0;  ///< sum of `lengths` (m^2)
  double largest_length = 0.0;   ///< the largest of them (m^2)
};

/// `residual`: `height` arrays of kTile numbers. `norms` becomes the squared
/// norm of each observation's residual. All aligned to 64 bytes.
TileSums SumTile(int height, const double* residual, const double* lengths,
                 double* norms);

}  // namespace alidade::internal::kernel

#endif  // ALIDADE_SRC_KERNEL_KERNEL_H_
