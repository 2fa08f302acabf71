#ifndef ALIDADE_SRC_FLEET_STAGING_AREA_H_
#define ALIDADE_SRC_FLEET_STAGING_AREA_H_

#include <atomic>
#include <string>
#include <vector>

#include "src/calibration/batch_summary.h"
#include "src/report/report.h"

namespace alidade::internal {

/// Where the results of a batch are written before they come to their names:
/// DIR/.batch/staged-MARK-N. Safe to use from several threads.
class StagingArea {
 public:
  /// `mark`: distinguished by it are processes that write to one directory,
  /// those of an earlier batch included, which may still be ending on another
  /// machine. The process that holds the directory needs none.
  StagingArea(const std::string& directory, const std::string& mark);

  const std::string& path() const { return path_; }
  /// Removes all that is there, whoever wrote it.
  void Clear() const;
  /// A name that was not given before.
  std::string NewName();
  /// Writes files to a new staged directory and syncs them; returns its path,
  /// and in `written` what they are and how long. @throws InputError.
  std::string Stage(const std::vector<ReportFile>& files,
                    std::vector<ResultFile>* written);

 private:
  const std::string path_;
  const std::string mark_;
  std::atomic<int> next_{0};
};

/// Takes down a directory or file that nobody reads.
void RemoveStaged(const std::string& path);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_FLEET_STAGING_AREA_H_
