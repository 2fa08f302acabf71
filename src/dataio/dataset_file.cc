#include "alidade/dataset_file.h"

#include <utility>
#include <vector>

#include "alidade/error.h"
#include "src/common/names.h"
#include "src/dataio/dataset_csv.h"

namespace alidade {

using internal::DataFormat;
using internal::JoinNames;
using internal::LoadData;
using internal::LoadedData;

Dataset LoadDataset(const std::string& path, const Arm& arm,
                    double default_sigma, int num_threads) {
  DataFormat format;
  format.sigma = default_sigma;
  References references;
  LoadedData loaded = LoadData(path, arm, format, &references, num_threads);
  std::vector<std::string> names;
  for (const ReferencePoint& point : references.points) {
    names.push_back(point.name);
  }
  for (const ReferencePlane& plane : references.planes) {
    names.push_back(plane.name);
  }
  if (!names.empty()) {
    throw InputError({path, 0, 0, ""},
                     "measured against " + JoinNames(names) +
                         ": expected a job that names this file as its `data`");
  }
  return std::move(loaded.data);
}

}  // namespace alidade
