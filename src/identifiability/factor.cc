#include "alidade/identifiability/factor.h"

#include <Eigen/QR>
#include <algorithm>

#include "alidade/base/parallel.h"

namespace alidade {
namespace {

// The poses are cut into so many parts at most, whatever their number: few
// enough for O(columns^2) memory, enough for the threads to share.
constexpr Eigen::Index kParts = 16;

// Rows of one block: it stays in the cache with some tens of columns.
constexpr Eigen::Index kPosesPerBlock = 64;

// Keeps the triangular factor of all rows seen so far.
class FactorBuilder {
 public:
  explicit FactorBuilder(Eigen::Index columns)
      : factor_(Eigen::MatrixXd::Zero(columns, columns)) {}

  void Add(const Eigen::Ref<const Eigen::MatrixXd>& rows) {
    const Eigen::Index p = factor_.cols();
    stacked_.resize(p + rows.rows(), p);
    stacked_.topRows(p) = factor_;
    stacked_.bottomRows(rows.rows()) = rows;
    const Eigen::HouseholderQR<Eigen::Ref<Eigen::MatrixXd>> qr(stacked_);
    factor_ = qr.matrixQR().topRows(p).triangularView<Eigen::Upper>();
  }

  const Eigen::MatrixXd& factor() const { return factor_; }

 private:
  Eigen::MatrixXd factor_;
  Eigen::MatrixXd stacked_;
};

class JacobianRows {
 public:
  JacobianRows(const PositionModel& model, const Eigen::VectorXd& values,
               const PoseSet& poses, const std::vector<int>& columns)
      : jacobian_(model.nominal(), model.layout(), values),
        poses_(poses),
        columns_(columns),
        reach_(Reach(model.nominal())) {}

  void Fill(Eigen::Index begin, Eigen::Index end, Eigen::MatrixXd* rows) {
    const int height = RowsOf(poses_.kind);
    rows->resize((end - begin) * height,
                 static_cast<Eigen::Index>(columns_.size()));
    for (Eigen::Index i = begin; i < end; ++i) {
      auto pose = rows->middleRows((i - begin) * height, height);
      jacobian_.Evaluate(poses_.joint_values.col(i).data(), columns_,
                         poses_.kind, pose);
      if (poses_.sigmas != nullptr) {
        pose.topRows<3>().array().colwise() /= poses_.sigmas->col(i).array();
      } else if (poses_.kind == MeasurementKind::kPose) {
        pose.bottomRows<3>() *= reach_;
      }
    }
  }

 private:
  GeometricJacobian jacobian_;
  const PoseSet& poses_;
  const std::vector<int>& columns_;
  double reach_;
};

}  // namespace

Eigen::MatrixXd JacobianFactor(const PositionModel& model,
                               const Eigen::VectorXd& values,
                               const PoseSet& poses,
                               const std::vector<int>& columns) {
  const auto p = static_cast<Eigen::Index>(columns.size());
  const Eigen::Index count = poses.joint_values.cols();
  const Eigen::Index part_size =
      std::max(kPosesPerBlock, (count + kParts - 1) / kParts);
  const Eigen::Index num_parts = (count + part_size - 1) / part_size;
  std::vector<FactorBuilder> parts(num_parts, FactorBuilder(p));
  const auto work = [&](std::int64_t begin, std::int64_t end) {
    JacobianRows source(model, values, poses, columns);
    Eigen::MatrixXd rows;
    for (Eigen::Index i = begin; i < end; i += kPosesPerBlock) {
      source.Fill(i, std::min<Eigen::Index>(end, i + kPosesPerBlock), &rows);
      parts[begin / part_size].Add(rows);
    }
  };
  ParallelFor(model.num_threads(), count, part_size, work);
  FactorBuilder all(p);
  for (const FactorBuilder& part : parts) all.Add(part.factor());
  return all.factor();
}

double ColumnScale(const PositionModel& model, int column) {
  const bool angle =
      model.layout().parameter(column).dimension == Dimension::kAngle;
  return angle ? Reach(model.nominal()) : 1.0;
}

Eigen::MatrixXd ScaleColumns(const PositionModel& model,
                             const std::vector<int>& columns,
                             Eigen::MatrixXd factor) {
  for (Eigen::Index c = 0; c < factor.cols(); ++c) {
    factor.col(c) /= ColumnScale(model, columns[c]);
  }
  return factor;
}

Eigen::MatrixXd SelectColumns(const Eigen::MatrixXd& matrix,
                              const std::vector<int>& indices) {
  Eigen::MatrixXd selected(matrix.rows(),
                           static_cast<Eigen::Index>(indices.size()));
  for (Eigen::Index c = 0; c < selected.cols(); ++c) {
    selected.col(c) = matrix.col(indices[c]);
  }
  return selected;
}

}  // namespace alidade
