#ifndef ALIDADE_SRC_ERROR_TERMS_TERM_COLUMNS_H_
#define ALIDADE_SRC_ERROR_TERMS_TERM_COLUMNS_H_

#include <Eigen/Core>
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
  std::vector<double> cycles = {};  ///< of harmonics, per turn
  bool scale = false;
  bool backlash = false;
  std::vector<std::pair<int, int>> coupling = {};  ///< joint by joint, from 0

  bool empty() const {
    return !elasticity && function_length == 0.0 && cycles.empty() && !scale &&
           !backlash && coupling.empty();
  }
};

/// Terms of one kind share the standard deviation of their prior.
enum class TermGroup {
  kOwnAxis,    ///< compliance about the joint's own axis
  kOtherAxes,  ///< about x and y
  kFunction,
  kHarmonic,
  kCoupling,  ///< and scale
  kBacklash,
};
constexpr int kNumTermGroups = 6;

/// "compliance about the joint's axis" ...
const char* NameOf(TermGroup group);

/// A term that is a turn of a joint times one number of the pose.
struct DenseTerm {
  enum class Regressor { kMoment, kCosine, kSine, kJointValue, kMomentSign };
  TermGroup group;
  int joint;
  int axis;  ///< of the turn; 2 moves the joint
  Regressor regressor;
  double cycles = 0.0;  ///< of a harmonic
  int other = 0;        ///< joint whose value it goes with
  double unit = 1e-3;   ///< of the coefficient, in SI
};

/// "k2_z", "h2_c1", "b2", "g2", "g2_3" (ErrorTermEstimate).
std::string NameOf(const DenseTerm& term);

/// The knots of one joint's function, among those of all.
struct FunctionKnots {
  int joint = 0;
  double first = 0.0;
  double spacing = 0.0;
  int count = 0;
  int offset = 0;
};

/// The columns of a set of terms: dense ones first, then the knots of functions
/// joint by joint. Coefficients are in DenseTerm::unit, and in kTermUnit at
/// knots.
class TermColumns {
 public:
  /// Knots enclose `joint_values` (n x poses), and what is so near to them that
  /// a function with the prior of that length is not zero yet. A joint that was
  /// not moved has none.
  TermColumns(const Arm& arm, const TermSet& set,
              const Eigen::MatrixXd& joint_values);
  /// Of a set with functions on the knots of all others, the finest of them.
  static TermColumns Union(const std::vector<TermColumns>& others);

  const std::vector<DenseTerm>& dense() const { return dense_; }
  const std::vector<FunctionKnots>& functions() const { return functions_; }
  int num_dense() const { return static_cast<int>(dense_.size()); }
  int num_knots() const;
  int size() const { return num_dense() + num_knots(); }
  double function_length() const { return function_length_; }
  /// The inverse prior covariance of a function at its knots, for a standard
  /// deviation of one unit.
  Eigen::MatrixXd Precision(const FunctionKnots& knots) const;

  /// What the turn of a dense term is multiplied by.
  static double Regressor(const DenseTerm& term, const double* joint_values,
                          const double* moments);

  /// Calls visit(column, turn, size) for every column that is not zero at a
  /// pose: it is `size` times the turn 3 joint + axis, per kTermUnit.
  template <typename Visit>
  void ForEachAt(const double* joint_values, const double* moments,
                 const Visit& visit) const {
    for (int k = 0; k < num_dense(); ++k) {
      const DenseTerm& term = dense_[k];
      visit(k, 3 * term.joint + term.axis,
            term.unit / kTermUnit * Regressor(term, joint_values, moments));
    }
    for (const FunctionKnots& knots : functions_) {
      const double place =
          (joint_values[knots.joint] - knots.first) / knots.spacing;
      const double below = std::floor(place);
      if (below < 0.0 || below + 1.0 >= knots.count) continue;
      const int first = num_dense() + knots.offset + static_cast<int>(below);
      const int turn = 3 * knots.joint + 2;
      visit(first, turn, 1.0 - (place - below));
      visit(first + 1, turn, place - below);
    }
  }

  /// Terms with these coefficients. `like`: what loads and gravity are.
  ErrorTerms TermsOf(const Eigen::VectorXd& coefficients,
                     const ErrorTerms& like, int num_joints) const;
  /// The inverse, for terms that these columns can express.
  Eigen::VectorXd CoefficientsOf(const ErrorTerms& terms) const;
  /// size() x others: coefficients here from those of columns that these can
  /// express.
  Eigen::MatrixXd From(const TermColumns& other) const;

 private:
  TermColumns() = default;

  void AddElasticity(const Arm& arm);
  void AddShifts(const Arm& arm, const TermSet& set);
  void AddFunctions(const Arm& arm, const Eigen::MatrixXd& joint_values);

  std::vector<DenseTerm> dense_;
  std::vector<FunctionKnots> functions_;
  double function_length_ = 0.0;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_ERROR_TERMS_TERM_COLUMNS_H_
