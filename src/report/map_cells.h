#ifndef ALIDADE_SRC_REPORT_MAP_CELLS_H_
#define ALIDADE_SRC_REPORT_MAP_CELLS_H_

#include <vector>

#include "src/report/svg_writer.h"

namespace alidade::internal {

/// A value at a place of the chart (pixels).
struct MapSample {
  SvgPoint at;
  double value = 0.0;
};

/// Squares to paint, all of one size: `at` is the middle.
struct MapCells {
  std::vector<MapSample> cells;
  double side = 0.0;
};

/// What to paint for samples in `box`. Some hundred samples or more become a
/// raster, row by row, over the area that they cover: a cell has the largest of
/// the values in it, or that of the nearest cell with a sample. Gaps between
/// rows of samples are closed, a few mean spacings wide. Fewer samples stay
/// squares of their own, in their own order.
/// @pre `box` holds every sample; samples is not empty.
MapCells MakeMapCells(const std::vector<MapSample>& samples, const SvgBox& box);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_MAP_CELLS_H_
