#include "src/identifiability/elimination.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <utility>

namespace alidade::internal {
namespace {

// Every exchange multiplies the volume of the basis, so that there are few;
// this is far beyond what any arm needs.
constexpr int kMostExchanges = 1000;

Eigen::MatrixXd Select(const Eigen::MatrixXd& factor,
                       const std::vector<int>& columns) {
  Eigen::MatrixXd selected(factor.rows(),
                           static_cast<Eigen::Index>(columns.size()));
  Eigen::Index to = 0;
  for (const int column : columns) selected.col(to++) = factor.col(column);
  return selected;
}

struct Choice {
  std::vector<int> kept;
  std::vector<int> dependent;
  std::vector<int> zero;
};

Choice ChooseInOrder(const Eigen::MatrixXd& factor, double tolerance) {
  Choice choice;
  const double zero = tolerance * factor.colwise().norm().maxCoeff();
  Eigen::MatrixXd basis(factor.rows(), 0);
  for (Eigen::Index c = 0; c < factor.cols(); ++c) {
    const Eigen::VectorXd column = factor.col(c);
    Eigen::VectorXd rest = column;
    // Twice is enough: one pass of Gram-Schmidt leaves rounding of the kept
    // columns after (Kahan; Parlett 1980, "The symmetric eigenvalue problem").
    for (int pass = 0; pass < 2; ++pass) {
      rest -= basis * (basis.transpose() * rest).eval();
    }
    const auto index = static_cast<int>(c);
    if (column.norm() <= zero) {
      choice.zero.push_back(index);
    } else if (rest.norm() <= tolerance * column.norm()) {
      choice.dependent.push_back(index);
    } else {
      choice.kept.push_back(index);
      basis.conservativeResize(Eigen::NoChange, basis.cols() + 1);
      basis.rightCols<1>() = rest.normalized();
    }
  }
  return choice;
}

// The coefficients of a basis' dependent columns, kept x dependent, while
// columns of both change places.
class Exchange {
 public:
  Exchange(const Eigen::MatrixXd& factor, int num_protected, Choice* choice)
      : factor_(factor), num_protected_(num_protected), choice_(*choice) {
    SetCoefficients();
  }

  const Eigen::MatrixXd& coefficients() const { return coefficients_; }

  void Run() {
    bool has_exchanged = false;
    for (int exchange = 0; exchange < kMostExchanges; ++exchange) {
      Eigen::MatrixXd sizes = coefficients_.cwiseAbs();
      for (Eigen::Index i = 0; i < sizes.rows(); ++i) {
        if (IsProtected(i)) sizes.row(i).setZero();
      }
      Eigen::Index out = 0;
      Eigen::Index in = 0;
      if (!(sizes.maxCoeff(&out, &in) > kLargestCoefficient)) break;
      Swap(out, in);
      has_exchanged = true;
    }
    if (!has_exchanged) return SetLeadingCoefficients();
    while (ReturnToOrder()) {
    }
    std::sort(choice_.kept.begin(), choice_.kept.end());
    std::sort(choice_.dependent.begin(), choice_.dependent.end());
    SetCoefficients();
  }

 private:
  void SetCoefficients() {
    coefficients_ = Select(factor_, choice_.kept)
                        .colPivHouseholderQr()
                        .solve(Select(factor_, choice_.dependent));
  }

  // In the order given, a column depends on those before it alone.
  void SetLeadingCoefficients() {
    coefficients_.setZero();
    for (Eigen::Index d = 0; d < coefficients_.cols(); ++d) {
      const int column = choice_.dependent[d];
      const auto before =
          std::lower_bound(choice_.kept.begin(), choice_.kept.end(), column) -
          choice_.kept.begin();
      if (before == 0) continue;
      const std::vector<int> leading(choice_.kept.begin(),
                                     choice_.kept.begin() + before);
      const Eigen::VectorXd right = factor_.col(column);
      const Eigen::VectorXd found =
          Select(factor_, leading).colPivHouseholderQr().solve(right);
      coefficients_.col(d).head(before) = found;
    }
  }

  bool IsProtected(Eigen::Index kept) const {
    return choice_.kept[kept] < num_protected_;
  }

  // One step of Gauss and Jordan.
  void Swap(Eigen::Index out, Eigen::Index in) {
    Eigen::MatrixXd& x = coefficients_;
    const double pivot = x(out, in);
    const Eigen::VectorXd column = x.col(in);
    const Eigen::RowVectorXd row = x.row(out) / pivot;
    x.noalias() -= column * row;
    x.row(out) = row;
    x.col(in) = -column / pivot;
    x(out, in) = 1.0 / pivot;
    std::swap(choice_.kept[out], choice_.dependent[in]);
  }

  // A column for one after it, where no coefficient becomes large by that.
  bool ReturnToOrder() {
    for (Eigen::Index in = 0; in < coefficients_.cols(); ++in) {
      for (Eigen::Index out = 0; out < coefficients_.rows(); ++out) {
        const bool is_behind = choice_.kept[out] > choice_.dependent[in];
        const double size = std::abs(coefficients_(out, in));
        if (!is_behind || IsProtected(out) ||
            size < 1.0 / kLargestCoefficient) {
          continue;
        }
        Swap(out, in);
        if (coefficients_.cwiseAbs().maxCoeff() <= kLargestCoefficient) {
          return true;
        }
        Swap(out, in);
      }
    }
    return false;
  }

  const Eigen::MatrixXd& factor_;
  const int num_protected_;
  Choice& choice_;
  Eigen::MatrixXd coefficients_;
};

}  // namespace

Elimination Eliminate(const Eigen::MatrixXd& factor, double tolerance,
                      int num_protected) {
  if (factor.cols() == 0) return {};
  Choice choice = ChooseInOrder(factor, tolerance);
  Elimination elimination;
  elimination.tolerance = tolerance;
  const auto num_kept = static_cast<Eigen::Index>(choice.kept.size());
  for (const int index : choice.zero) {
    elimination.dependent.push_back(
        {index, Eigen::VectorXd::Zero(num_kept), true});
  }
  if (!choice.dependent.empty()) {
    Exchange exchange(factor, num_protected, &choice);
    exchange.Run();
    Eigen::Index column = 0;
    for (const int index : choice.dependent) {
      elimination.dependent.push_back(
          {index, exchange.coefficients().col(column++), false});
    }
  }
  std::sort(elimination.dependent.begin(), elimination.dependent.end(),
            [](const DependentColumn& a, const DependentColumn& b) {
              return a.index < b.index;
            });
  elimination.kept = std::move(choice.kept);
  return elimination;
}

}  // namespace alidade::internal
