#ifndef ALIDADE_SRC_ERROR_TERMS_TERM_COLUMNS_H_
#define ALIDADE_SRC_ERROR_TERMS_TERM_COLUMNS_H_

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "alidade/arm.h"
#include "alidade/error_terms.h"
#include "src/error_terms/term_rows.h"

namespace alidade::internal {

/// Which error terms are estimated, of all joints.
struct TermSet {
  std::string name;
  bool elasticity = false;       ///< about z, x and y
  double function_length = 0.0;  ///< of joint functions (rad); 0: none
  /// Between knots, which then are where joint values are and nowhere else; 0:
  /// by the length.
  double knot_spacing = 0.0;
  std::vector<double> cycles = {};  ///< of harmonics, per turn
  /// Joint (from 0) and cycles per turn of harmonics of single joints.
  std::vector<std::pair<int, double>> joint_cycles = {};
  bool scale = false;
  bool backlash = false;
  std::vector<std::pair<int, int>> coupling = {};  ///< joint by joint, from 0
  bool covariates = false;  ///< of the arm, as `uses` say
  /// Of those that are not here on the base.
  std::vector<CovariateUse> uses = {};
  /// Functions of revolute joints whose values cover more than a turn are of
  /// the value modulo a turn.
  bool modulo_turn = false;
};

/// The use of a covariate of that name: of `uses`, else that of one on the
/// base.
CovariateUse UseOf(const std::string& name,
                   const std::vector<CovariateUse>& uses);

/// Terms of one kind share the standard deviation of their prior.
enum class TermGroup {
  kOwnAxis,    ///< compliance about the joint's own axis
  kOtherAxes,  ///< about x and y
  kFunction,
  kHarmonic,
  kCoupling,  ///< and scale
  kBacklash,
  kCovariate,
  kStation,
};
constexpr int kNumTermGroups = 8;

/// "compliance about the joint's axis" ...
const char* NameOf(TermGroup group);

/// A term that is a turn of a joint times one number of the pose.
struct DenseTerm {
  enum class Regressor {
    kMoment,
    kCosine,
    kSine,
    kJointValue,
    kMomentSign,
    kCovariate
  };
  TermGroup group;
  /// n: moves of the base, n + 1: its turns; n + 2, n + 3: of the targets.
  int joint;
  int axis;  ///< of the turn; 2 moves the joint
  Regressor regressor;
  double cycles = 0.0;  ///< of a harmonic
  int other = 0;        ///< joint whose value, or covariate, it goes with
  double unit = 1e-3;   ///< of the coefficient, in SI
};

/// "k2_z", "h2_c1", "b2", "g2", "g2_3" (ErrorTermEstimate); of covariate 1
/// "c1_x" and "c1_rx" for the base, "c1_tool_x" for the targets, "c1_2" for a
/// joint, "c1_b2" for its backlash.
std::string NameOf(const DenseTerm& term, int num_joints);

/// The knots of one joint's function, among those of all.
struct FunctionKnots {
  int joint = 0;
  double first = 0.0;
  double spacing = 0.0;
  int count = 0;
  int offset = 0;
  bool is_periodic = false;  ///< as JointFunction has it

  /// The knots on both sides of a joint value, -1 where there is none, and its
  /// share of the way from one to the other.
  struct Place {
    int below = -1;
    int above = -1;
    double share = 0.0;
  };
  Place PlaceOf(double joint_value) const {
    double place = (joint_value - first) / spacing;
    if (is_periodic) {
      place -= count * std::floor(place / count);
      if (!(place < count)) place = 0.0;
    }
    if (!(place > -1.0 && place < count)) return {};
    const double knot = std::floor(place);
    const int below = static_cast<int>(knot);
    const int above = below + 1 < count ? below + 1 : (is_periodic ? 0 : -1);
    return {below, above, place - knot};
  }
};

/// Variance of a function about what its knots make of it, for a prior of unit
/// variance and that length: 0 at knots, 1 far from them.
double VarianceBesideKnots(const FunctionKnots& knots, double length,
                           double joint_value);

/// The columns of a set of terms: dense ones first, then the knots of functions
/// joint by joint. Coefficients are in DenseTerm::unit, and in kTermUnit at
/// knots.
class TermColumns {
 public:
  TermColumns() = default;  ///< none
  /// Knots enclose `joint_values` (n x poses), and what is so near to them that
  /// a function with the prior of that length is not zero yet. A metre of a
  /// prismatic joint counts as a radian. A joint that was not moved, or by
  /// dozens of turns, has none. Effects are per standard deviation of a
  /// covariate.
  TermColumns(const Arm& arm, const TermSet& set,
              const Eigen::MatrixXd& joint_values,
              const Eigen::VectorXd& covariate_deviations);
  /// Of a set with functions on the knots of all others, the finest of them.
  static TermColumns Union(const std::vector<TermColumns>& others);

  const std::vector<DenseTerm>& dense() const { return dense_; }
  const std::vector<FunctionKnots>& functions() const { return functions_; }
  int num_dense() const { return static_cast<int>(dense_.size()); }
  int num_knots() const;
  int size() const { return num_dense() + num_knots(); }
  int num_groups() const;  ///< that have a term
  bool has_periodic() const;
  double function_length() const { return function_length_; }
  /// The inverse prior covariance of a function at its knots, for a standard
  /// deviation of one unit.
  Eigen::MatrixXd Precision(const FunctionKnots& knots) const;

  /// What the turn of a dense term is multiplied by at a pose.
  static double Regressor(const DenseTerm& term, const PoseNumbers& pose);

  /// Calls visit(column, turn, size) for every column that is not zero at a
  /// pose: it is `size` times the turn 3 joint + axis, per kTermUnit.
  template <typename Visit>
  void ForEachAt(const PoseNumbers& pose, const Visit& visit) const {
    for (int k = 0; k < num_dense(); ++k) {
      const DenseTerm& term = dense_[k];
      visit(k, 3 * term.joint + term.axis,
            term.unit / kTermUnit * Regressor(term, pose));
    }
    for (const FunctionKnots& knots : functions_) {
      const auto [below, above, share] =
          knots.PlaceOf(pose.joint_values[knots.joint]);
      const int first = num_dense() + knots.offset;
      const int turn = 3 * knots.joint + 2;
      if (below >= 0) visit(first + below, turn, 1.0 - share);
      if (above >= 0) visit(first + above, turn, share);
    }
  }

  /// Terms with these coefficients. `like`: what loads and gravity are.
  ErrorTerms TermsOf(const Eigen::VectorXd& coefficients,
                     const ErrorTerms& like, int num_joints) const;
  /// The inverse, for terms that these columns can express.
  Eigen::VectorXd CoefficientsOf(const ErrorTerms& terms) const;
  /// size() x others: coefficients here from those of columns that these can
  /// express.
  Eigen::SparseMatrix<double> From(const TermColumns& other) const;

 private:
  void AddElasticity(const Arm& arm);
  void AddShifts(const Arm& arm, const TermSet& set);
  void AddFunctions(const Arm& arm, const TermSet& set,
                    const Eigen::MatrixXd& joint_values);
  void AddCovariates(const Arm& arm, const TermSet& set,
                     const Eigen::VectorXd& deviations);

  std::vector<DenseTerm> dense_;
  std::vector<FunctionKnots> functions_;
  double function_length_ = 0.0;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_ERROR_TERMS_TERM_COLUMNS_H_
