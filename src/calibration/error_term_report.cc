#include "src/calibration/error_term_report.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "src/common/constants.h"
#include "src/kernel/holdout.h"
#include "src/kernel/measurement_model.h"
#include "src/model/joint_draw.h"

namespace alidade::internal {
namespace {

constexpr Eigen::Index kMostPoses = 500;

std::string UnitOf(const DenseTerm& term, const Arm& arm) {
  if (term.regressor == DenseTerm::Regressor::kMoment) return "rad/(N m)";
  if (term.regressor == DenseTerm::Regressor::kCovariate) {
    const bool moves =
        term.joint == arm.num_joints() || term.joint == arm.num_joints() + 2 ||
        (term.joint < arm.num_joints() &&
         arm.joints[term.joint].dimension() == Dimension::kLength);
    return moves ? "m" : "rad";
  }
  if (term.regressor != DenseTerm::Regressor::kJointValue) return "rad";
  const bool is_length =
      arm.joints[term.joint].dimension() == Dimension::kLength;
  const bool of_length =
      arm.joints[term.other].dimension() == Dimension::kLength;
  if (is_length == of_length) return "1";
  return is_length ? "m/rad" : "rad/m";
}

/// The kinds of error terms that a joint may have.
struct TermKind {
  const char* name;
  bool (*is_there)(const ErrorTerms& errors, int joint);
  void (*remove)(ErrorTerms* errors, int joint);
};

bool HasJoints(const ErrorTerms& errors) { return !errors.joints.empty(); }

constexpr TermKind kKinds[] = {
    {"elasticity",
     [](const ErrorTerms& errors, int j) {
       return HasJoints(errors) && !errors.joints[j].compliance.isZero(0.0);
     },
     [](ErrorTerms* errors, int j) { errors->joints[j].compliance.setZero(); }},
    {"function",
     [](const ErrorTerms& errors, int j) {
       return HasJoints(errors) && !errors.joints[j].function.empty();
     },
     [](ErrorTerms* errors, int j) { errors->joints[j].function = {}; }},
    {"harmonics",
     [](const ErrorTerms& errors, int j) {
       return HasJoints(errors) && !errors.joints[j].harmonics.empty();
     },
     [](ErrorTerms* errors, int j) { errors->joints[j].harmonics.clear(); }},
    {"scale and coupling",
     [](const ErrorTerms& errors, int j) {
       return errors.coupling.size() > 0 && !errors.coupling.row(j).isZero(0.0);
     },
     [](ErrorTerms* errors, int j) { errors->coupling.row(j).setZero(); }},
    {"backlash",
     [](const ErrorTerms& errors, int j) {
       return HasJoints(errors) && errors.joints[j].backlash != 0.0;
     },
     [](ErrorTerms* errors, int j) { errors->joints[j].backlash = 0.0; }},
};

// Residuals along each joint, and how sharply a pose determines them.
struct Projection {
  Eigen::MatrixXd shifts;      // n x poses (rad, m)
  Eigen::MatrixXd deviations;  // the same for residuals of one sigma
};

Projection Project(const TermRows& rows) {
  const Eigen::Index n = rows.num_joints();
  const Eigen::Index poses = rows.joint_values.cols();
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(n, poses);
  Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(n, poses);
  for (const TermRows::Observation& one : rows.observations) {
    if (one.pose < 0 || one.num_measured == 0) continue;
    const auto turns = rows.turns.middleRows(one.first_row, one.height);
    const auto residual = rows.residuals.segment(one.first_row, one.height);
    for (Eigen::Index j = 0; j < n; ++j) {
      const auto turn = turns.col(3 * j + 2);
      products(j, one.pose) -= turn.dot(residual);
      squares(j, one.pose) += turn.squaredNorm();
    }
  }
  return {kTermUnit * products.cwiseQuotient(squares),
          kTermUnit * squares.cwiseSqrt().cwiseInverse()};
}

// Poses at which a joint moves what is measured three times less than usual, or
// a hundred times less than another joint does, say nothing of it.
void LeaveOutInsensitive(const Eigen::MatrixXd& deviations,
                         JointResiduals* residuals) {
  constexpr double kTolerated = 3.0;
  constexpr double kBesideOthers = 100.0;
  const Eigen::RowVectorXd best = deviations.colwise().minCoeff();
  for (Eigen::Index j = 0; j < deviations.rows(); ++j) {
    std::vector<double> sorted(deviations.cols());
    Eigen::Map<Eigen::RowVectorXd>(sorted.data(), deviations.cols()) =
        deviations.row(j);
    const auto middle =
        sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    for (Eigen::Index k = 0; k < deviations.cols(); ++k) {
      if (deviations(j, k) <=
          std::min(kTolerated * *middle, kBesideOthers * best[k])) {
        continue;
      }
      residuals->geometry(j, k) = kNan;
      residuals->remaining(j, k) = kNan;
    }
  }
}

}  // namespace

void DescribeErrorTerms(const CalibrationSolution& rigid,
                        const CalibrationSolution& fit,
                        CalibrationResult* result) {
  constexpr int kDrawn = 1000;
  ErrorTermsResult& errors = *result->error_terms;
  const Arm& arm = result->arm;
  errors.terms = ListErrorTerms(*fit.terms, arm);
  errors.effects =
      MeasureEffects(arm, DrawJointValues(arm, kDrawn, result->seed),
                     fit.model().num_threads());
  errors.measured =
      MeasuredRanges(arm, fit.task.data.training.joint_values.map());
  errors.residuals = ProjectResiduals(rigid, fit);
}

std::vector<ErrorTermEstimate> ListErrorTerms(const TermCovariance& covariance,
                                              const Arm& arm) {
  const TermColumns& columns = covariance.columns;
  const Eigen::VectorXd coefficients = columns.CoefficientsOf(arm.errors);
  const auto p = static_cast<Eigen::Index>(covariance.geometry.size());
  std::vector<ErrorTermEstimate> terms;
  for (int k = 0; k < columns.num_dense(); ++k) {
    const DenseTerm& term = columns.dense()[k];
    terms.push_back(
        {NameOf(term, arm.num_joints()), term.unit * coefficients[k],
         term.unit * covariance.root.row(p + k).norm(), UnitOf(term, arm)});
  }
  return terms;
}

std::vector<ErrorTermEffect> MeasureEffects(const Arm& arm,
                                            const Eigen::MatrixXd& joint_values,
                                            int num_threads) {
  const auto positions = [&](const Arm& one) {
    const MeasurementModel model(one, num_threads);
    return model.Predict(model.NominalValues(), joint_values);
  };
  const Eigen::Matrix3Xd with_all = positions(arm);
  std::vector<ErrorTermEffect> effects;
  const auto add = [&](int joint, const char* term, const ErrorTerms& errors) {
    Arm without = arm;
    without.errors = errors;
    const Accuracy moved = SummarizeErrors(
        (positions(without) - with_all).colwise().norm().transpose());
    effects.push_back({joint, term, moved.rms, moved.max});
  };
  add(0, "all", ErrorTerms());
  for (int j = 0; j < arm.num_joints(); ++j) {
    ErrorTerms none = arm.errors;
    bool is_any = false;
    for (const TermKind& kind : kKinds) {
      if (!kind.is_there(arm.errors, j)) continue;
      is_any = true;
      ErrorTerms errors = arm.errors;
      kind.remove(&errors, j);
      kind.remove(&none, j);
      add(j + 1, kind.name, errors);
    }
    if (is_any) add(j + 1, "all", none);
  }
  return effects;
}

std::vector<MeasuredRange> MeasuredRanges(const Arm& arm,
                                          const Eigen::MatrixXd& joint_values) {
  constexpr double kPart = 0.05;
  std::vector<MeasuredRange> ranges;
  if (joint_values.cols() == 0) return ranges;
  std::vector<double> sorted(joint_values.cols());
  for (int j = 0; j < arm.num_joints(); ++j) {
    Eigen::Map<Eigen::RowVectorXd>(sorted.data(), joint_values.cols()) =
        joint_values.row(j);
    std::sort(sorted.begin(), sorted.end());
    const double smallest =
        arm.joints[j].dimension() == Dimension::kAngle ? 0.1 : 0.02;
    const double gap =
        std::max(smallest, kPart * (sorted.back() - sorted.front()));
    ranges.push_back({j + 1, sorted.front(), sorted.front()});
    for (const double value : sorted) {
      if (value - ranges.back().upper > gap) {
        ranges.push_back({j + 1, value, value});
      }
      ranges.back().upper = value;
    }
  }
  return ranges;
}

JointResiduals ProjectResiduals(const CalibrationSolution& rigid,
                                const CalibrationSolution& fit) {
  const Dataset& all = fit.task.data.training;
  JointResiduals residuals;
  if (all.Has(MeasurementKind::kDifference) || all.num_poses() == 0) {
    return residuals;
  }
  const Eigen::Index step = (all.num_poses() + kMostPoses - 1) / kMostPoses;
  std::vector<Eigen::Index> poses;
  for (Eigen::Index k = 0; k < all.num_poses(); k += step) {
    poses.push_back(k);
    residuals.poses.push_back(static_cast<int>(k));
  }
  const Dataset data = SelectPoses(all, poses);
  const TermRows rows = MakeTermRows(fit.model(), fit.values, data, {});
  Projection remaining = Project(rows);
  residuals.joint_values = rows.joint_values;
  residuals.geometry =
      Project(MakeTermRows(rigid.model(), rigid.values, data, {})).shifts;
  residuals.remaining = std::move(remaining.shifts);
  LeaveOutInsensitive(remaining.deviations, &residuals);
  return residuals;
}

}  // namespace alidade::internal
