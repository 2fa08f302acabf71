#include "src/error_terms/term_columns.h"

#include <glog/logging.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "src/common/number_text.h"

namespace alidade::internal {
namespace {

constexpr double kComplianceUnit = 1e-4;  // rad / (N m)

// Knots beyond the measured values, in lengths: where the prior's correlation
// with what was measured is 0.05.
constexpr double kFadingLengths = 2.75;

// A fifth of a length or less, of few poses, which see no more, three fifths;
// on a grid that all finer ones refine.
double SpacingFor(double length, Eigen::Index num_poses) {
  constexpr double kFinest = 0.02;
  constexpr Eigen::Index kFew = 700;
  const double part = num_poses < kFew ? 0.601 : 0.201;
  double spacing = kFinest;
  for (const double coarser : {0.06, 0.24}) {
    if (coarser <= part * length) spacing = coarser;
  }
  return spacing;
}

TermGroup GroupOf(const CovariateUse& use) {
  if (use.is_station) return TermGroup::kStation;
  return use.is_approach ? TermGroup::kBacklash : TermGroup::kCovariate;
}

bool CoversTurn(const Joint& joint, double lowest, double highest) {
  return joint.type == JointType::kRevolute && highest - lowest > 2.0 * M_PI;
}

// Of functions modulo a turn: about as far apart as `spacing`, on a grid that
// all finer ones of SpacingFor refine, about the middle of the joint's values.
FunctionKnots OneTurn(int joint, double spacing, double middle) {
  constexpr int kCoarsest = 27;
  constexpr double kTurn = 2.0 * M_PI;
  FunctionKnots knots;
  knots.joint = joint;
  knots.is_periodic = true;
  knots.count = std::max(3, static_cast<int>(std::lround(6.48 / spacing)));
  knots.spacing = kTurn / knots.count;
  const double grid = kTurn / kCoarsest;
  knots.first = grid * std::floor((middle - 0.5 * kTurn) / grid);
  return knots;
}

// Matern's covariance of smoothness 3/2 (Rasmussen and Williams 2006, "Gaussian
// processes for machine learning", 4.17).
// Matern's covariance along the circle's chords is one along its arcs, too.
double Correlation(const FunctionKnots& knots, double distance, double length) {
  if (knots.is_periodic) distance = 2.0 * std::sin(0.5 * distance);
  const double u = std::sqrt(3.0) * std::abs(distance) / length;
  return (1.0 + u) * std::exp(-u);
}

bool SameTerm(const DenseTerm& a, const DenseTerm& b) {
  return a.group == b.group && a.joint == b.joint && a.axis == b.axis &&
         a.regressor == b.regressor && a.cycles == b.cycles &&
         a.other == b.other;
}

Harmonic* HarmonicOf(double cycles, JointErrors* joint) {
  for (Harmonic& harmonic : joint->harmonics) {
    if (harmonic.cycles == cycles) return &harmonic;
  }
  joint->harmonics.push_back({cycles, 0.0, 0.0});
  return &joint->harmonics.back();
}

// Where terms hold the coefficient of a dense one; the place is made.
double* PlaceOf(const DenseTerm& term, ErrorTerms* terms) {
  if (term.regressor == DenseTerm::Regressor::kCovariate) {
    const auto n = static_cast<int>(terms->joints.size());
    CovariateEffect& effect = terms->covariates[term.other];
    if (term.joint >= n) {
      auto& moved = term.joint < n + 2 ? effect.base : effect.target;
      return &moved[3 * ((term.joint - n) % 2) + term.axis];
    }
    if (effect.joints.size() == 0) effect.joints.setZero(n);
    return &effect.joints[term.joint];
  }
  JointErrors& joint = terms->joints[term.joint];
  switch (term.regressor) {
    case DenseTerm::Regressor::kMoment:
      return &joint.compliance[term.axis];
    case DenseTerm::Regressor::kCosine:
      return &HarmonicOf(term.cycles, &joint)->cosine;
    case DenseTerm::Regressor::kSine:
      return &HarmonicOf(term.cycles, &joint)->sine;
    case DenseTerm::Regressor::kJointValue:
      return &terms->coupling(term.joint, term.other);
    case DenseTerm::Regressor::kMomentSign:
      return &joint.backlash;
    case DenseTerm::Regressor::kCovariate:
      break;
  }
  return nullptr;
}

// Of moves and turns of base and targets, in their order.
std::string MotionName(int motion, int axis) {
  return std::string(motion < 2 ? "" : "tool_") + (motion % 2 == 0 ? "" : "r") +
         "xyz"[axis];
}

ErrorTerms Prepared(const ErrorTerms& like, int num_joints, bool has_coupling) {
  ErrorTerms terms = like;
  terms.joints.assign(num_joints, JointErrors());
  terms.coupling.resize(0, 0);
  for (CovariateEffect& effect : terms.covariates) {
    effect.base.setZero();
    effect.joints.resize(0);
    effect.target.setZero();
  }
  if (has_coupling) terms.coupling.setZero(num_joints, num_joints);
  return terms;
}

}  // namespace

const char* NameOf(TermGroup group) {
  switch (group) {
    case TermGroup::kOwnAxis:
      return "compliance about the joint's axis";
    case TermGroup::kOtherAxes:
      return "compliance about the other axes";
    case TermGroup::kFunction:
      return "joint functions";
    case TermGroup::kHarmonic:
      return "harmonics";
    case TermGroup::kCoupling:
      return "scale and coupling";
    case TermGroup::kBacklash:
      return "backlash";
    case TermGroup::kCovariate:
      return "covariates";
    case TermGroup::kStation:
      return "stations";
  }
  return "";
}

CovariateUse UseOf(const std::string& name,
                   const std::vector<CovariateUse>& uses) {
  for (const CovariateUse& use : uses) {
    if (use.name == name) return use;
  }
  return {name};
}

double VarianceBesideKnots(const FunctionKnots& knots, double length,
                           double joint_value) {
  const auto [below, above, share] = knots.PlaceOf(joint_value);
  // Knots beyond the last ones have no part.
  const double a = below >= 0 ? 1.0 - share : 0.0;
  const double b = above >= 0 ? share : 0.0;
  const auto at = [&](double part) {
    return Correlation(knots, part * knots.spacing, length);
  };
  const double variance =
      1.0 + a * a + b * b +
      2.0 * (a * b * at(1.0) - a * at(share) - b * at(1.0 - share));
  return std::max(0.0, variance);
}

std::string NameOf(const DenseTerm& term, int num_joints) {
  constexpr double kShown = 1e4;  // of cycles, four decimals
  const std::string joint = std::to_string(term.joint + 1);
  const std::string cycles =
      ShortestNumber(std::round(kShown * term.cycles) / kShown);
  switch (term.regressor) {
    case DenseTerm::Regressor::kMoment:
      return "k" + joint + "_" + "xyz"[term.axis];
    case DenseTerm::Regressor::kCosine:
      return "h" + joint + "_c" + cycles;
    case DenseTerm::Regressor::kSine:
      return "h" + joint + "_s" + cycles;
    case DenseTerm::Regressor::kJointValue:
      return "g" + joint +
             (term.other == term.joint ? ""
                                       : "_" + std::to_string(term.other + 1));
    case DenseTerm::Regressor::kMomentSign:
      return "b" + joint;
    case DenseTerm::Regressor::kCovariate:
      return "c" + std::to_string(term.other + 1) + "_" +
             (term.joint >= num_joints
                  ? MotionName(term.joint - num_joints, term.axis)
                  : (term.group == TermGroup::kBacklash ? "b" : "") + joint);
  }
  return "";
}

TermColumns::TermColumns(const Arm& arm, const TermSet& set,
                         const Eigen::MatrixXd& joint_values,
                         const Eigen::VectorXd& covariate_deviations)
    : function_length_(set.function_length) {
  if (set.elasticity) AddElasticity(arm);
  AddShifts(arm, set);
  AddCovariates(arm, set, covariate_deviations);
  if (set.function_length > 0.0) AddFunctions(arm, set, joint_values);
}

void TermColumns::AddElasticity(const Arm& arm) {
  for (const TermGroup group : {TermGroup::kOwnAxis, TermGroup::kOtherAxes}) {
    for (int j = 0; j < arm.num_joints(); ++j) {
      const bool is_own = group == TermGroup::kOwnAxis;
      if (is_own && arm.joints[j].type == JointType::kPrismatic) continue;
      for (int axis = is_own ? 2 : 0; axis < (is_own ? 3 : 2); ++axis) {
        dense_.push_back({group, j, axis, DenseTerm::Regressor::kMoment, 0.0, 0,
                          kComplianceUnit});
      }
    }
  }
}

void TermColumns::AddShifts(const Arm& arm, const TermSet& set) {
  const auto add = [&](TermGroup group, int j, DenseTerm::Regressor regressor,
                       double cycles, int other) {
    dense_.push_back({group, j, 2, regressor, cycles, other, kTermUnit});
  };
  for (int j = 0; j < arm.num_joints(); ++j) {
    if (arm.joints[j].type == JointType::kPrismatic) continue;
    for (const double cycles : set.cycles) {
      add(TermGroup::kHarmonic, j, DenseTerm::Regressor::kCosine, cycles, 0);
      add(TermGroup::kHarmonic, j, DenseTerm::Regressor::kSine, cycles, 0);
    }
    if (set.backlash) {
      add(TermGroup::kBacklash, j, DenseTerm::Regressor::kMomentSign, 0.0, 0);
    }
  }
  for (const auto& [joint, cycles] : set.joint_cycles) {
    add(TermGroup::kHarmonic, joint, DenseTerm::Regressor::kCosine, cycles, 0);
    add(TermGroup::kHarmonic, joint, DenseTerm::Regressor::kSine, cycles, 0);
  }
  for (int j = 0; j < arm.num_joints() && set.scale; ++j) {
    add(TermGroup::kCoupling, j, DenseTerm::Regressor::kJointValue, 0.0, j);
  }
  for (const auto& [joint, other] : set.coupling) {
    add(TermGroup::kCoupling, joint, DenseTerm::Regressor::kJointValue, 0.0,
        other);
  }
}

void TermColumns::AddCovariates(const Arm& arm, const TermSet& set,
                                const Eigen::VectorXd& deviations) {
  const int n = arm.num_joints();
  for (int k = 0; k < static_cast<int>(arm.errors.covariates.size()); ++k) {
    const CovariateUse use = UseOf(arm.errors.covariates[k].name, set.uses);
    if (use.is_payload || !(set.covariates || use.is_station)) continue;
    const TermGroup group = GroupOf(use);
    const auto add = [&](int joint, int axis) {
      dense_.push_back(
          {group, joint, axis, DenseTerm::Regressor::kCovariate, 0.0, k,
           group == TermGroup::kCovariate ? kTermUnit / deviations[k]
                                          : kTermUnit});
    };
    for (int motion = 0; motion < 4; ++motion) {
      if (!(motion < 2 ? use.moves_base : use.moves_target)) continue;
      for (int axis = 0; axis < 3; ++axis) add(n + motion, axis);
    }
    for (const int joint : use.joints) add(joint, 2);
  }
}

void TermColumns::AddFunctions(const Arm& arm, const TermSet& set,
                               const Eigen::MatrixXd& joint_values) {
  constexpr double kMoved = 1e-3;  // rad, m
  // Of joints that turned so far that their functions had more, none is
  // estimated.
  constexpr double kMostKnots = 2000.0;
  const bool fades = !(set.knot_spacing > 0.0);
  const double spacing = fades
                             ? SpacingFor(function_length_, joint_values.cols())
                             : set.knot_spacing;
  int offset = 0;
  for (int j = 0; j < arm.num_joints(); ++j) {
    const double lowest = joint_values.row(j).minCoeff();
    const double highest = joint_values.row(j).maxCoeff();
    if (highest - lowest < kMoved) continue;
    FunctionKnots knots;
    knots.joint = j;
    if (set.modulo_turn && CoversTurn(arm.joints[j], lowest, highest)) {
      knots = OneTurn(j, spacing, 0.5 * (lowest + highest));
    } else {
      knots.spacing = spacing;
      const double beyond = fades ? kFadingLengths * function_length_ : 0.0;
      const double first = std::floor((lowest - beyond) / knots.spacing);
      const double last = std::ceil((highest + beyond) / knots.spacing);
      if (!(last - first < kMostKnots)) continue;
      knots.first = first * knots.spacing;
      knots.count = static_cast<int>(last - first) + 1;
    }
    knots.offset = offset;
    offset += knots.count;
    functions_.push_back(knots);
  }
}

TermColumns TermColumns::Union(const std::vector<TermColumns>& others) {
  TermColumns all;
  for (const TermColumns& other : others) {
    for (const DenseTerm& term : other.dense_) {
      const bool is_there = std::any_of(
          all.dense_.begin(), all.dense_.end(),
          [&](const DenseTerm& one) { return SameTerm(one, term); });
      if (!is_there) all.dense_.push_back(term);
    }
    for (const FunctionKnots& knots : other.functions_) {
      const auto found = std::find_if(
          all.functions_.begin(), all.functions_.end(),
          [&](const FunctionKnots& one) { return one.joint == knots.joint; });
      if (found == all.functions_.end()) {
        all.functions_.push_back(knots);
        continue;
      }
      CHECK_EQ(found->is_periodic, knots.is_periodic);
      if (knots.is_periodic) {
        if (knots.count > found->count) *found = knots;
        continue;
      }
      const double last =
          std::max(found->first + found->spacing * (found->count - 1),
                   knots.first + knots.spacing * (knots.count - 1));
      found->first = std::min(found->first, knots.first);
      found->spacing = std::min(found->spacing, knots.spacing);
      found->count = static_cast<int>(
                         std::lround((last - found->first) / found->spacing)) +
                     1;
    }
  }
  int offset = 0;
  for (FunctionKnots& knots : all.functions_) {
    knots.offset = offset;
    offset += knots.count;
  }
  return all;
}

bool TermColumns::has_periodic() const {
  return std::any_of(functions_.begin(), functions_.end(),
                     [](const auto& knots) { return knots.is_periodic; });
}

int TermColumns::num_groups() const {
  std::array<bool, kNumTermGroups> has = {};
  for (const DenseTerm& term : dense_) has[static_cast<int>(term.group)] = true;
  has[static_cast<int>(TermGroup::kFunction)] = !functions_.empty();
  return static_cast<int>(std::count(has.begin(), has.end(), true));
}

int TermColumns::num_knots() const {
  return functions_.empty()
             ? 0
             : functions_.back().offset + functions_.back().count;
}

Eigen::MatrixXd TermColumns::Precision(const FunctionKnots& knots) const {
  constexpr double kRounding = 1e-9;
  Eigen::MatrixXd covariance(knots.count, knots.count);
  for (int a = 0; a < knots.count; ++a) {
    for (int b = 0; b < knots.count; ++b) {
      covariance(a, b) =
          Correlation(knots, knots.spacing * (a - b), function_length_);
    }
    covariance(a, a) += kRounding;
  }
  return covariance.llt().solve(
      Eigen::MatrixXd::Identity(knots.count, knots.count));
}

double TermColumns::Regressor(const DenseTerm& term, const PoseNumbers& pose) {
  const auto value = [&] { return pose.joint_values[term.joint]; };
  switch (term.regressor) {
    case DenseTerm::Regressor::kMoment:
      return pose.moments[3 * term.joint + term.axis];
    case DenseTerm::Regressor::kCosine:
      return std::cos(term.cycles * value());
    case DenseTerm::Regressor::kSine:
      return std::sin(term.cycles * value());
    case DenseTerm::Regressor::kJointValue:
      return pose.joint_values[term.other];
    case DenseTerm::Regressor::kMomentSign:
      return SmoothSign(pose.moments[3 * term.joint + 2]);
    case DenseTerm::Regressor::kCovariate:
      return pose.covariates[term.other];
  }
  return 0.0;
}

ErrorTerms TermColumns::TermsOf(const Eigen::VectorXd& coefficients,
                                const ErrorTerms& like, int num_joints) const {
  const bool has_coupling = std::any_of(
      dense_.begin(), dense_.end(),
      [](const DenseTerm& term) { return term.group == TermGroup::kCoupling; });
  ErrorTerms terms = Prepared(like, num_joints, has_coupling);
  for (int k = 0; k < num_dense(); ++k) {
    *PlaceOf(dense_[k], &terms) = dense_[k].unit * coefficients[k];
  }
  for (const FunctionKnots& knots : functions_) {
    JointFunction& function = terms.joints[knots.joint].function;
    function.first = knots.first;
    function.spacing = knots.spacing;
    function.is_periodic = knots.is_periodic;
    function.values = kTermUnit * coefficients.segment(
                                      num_dense() + knots.offset, knots.count);
  }
  return terms;
}

Eigen::VectorXd TermColumns::CoefficientsOf(const ErrorTerms& terms) const {
  Eigen::VectorXd coefficients = Eigen::VectorXd::Zero(size());
  if (terms.empty()) return coefficients;
  ErrorTerms places = terms;
  if (places.coupling.size() == 0) {
    const auto n = static_cast<Eigen::Index>(terms.joints.size());
    places.coupling.setZero(n, n);
  }
  for (int k = 0; k < num_dense(); ++k) {
    coefficients[k] = *PlaceOf(dense_[k], &places) / dense_[k].unit;
  }
  for (const FunctionKnots& knots : functions_) {
    const JointFunction& function = terms.joints[knots.joint].function;
    for (int k = 0; k < knots.count; ++k) {
      coefficients[num_dense() + knots.offset + k] =
          function.At(knots.first + k * knots.spacing) / kTermUnit;
    }
  }
  return coefficients;
}

Eigen::SparseMatrix<double> TermColumns::From(const TermColumns& other) const {
  std::vector<Eigen::Triplet<double>> entries;
  for (int k = 0; k < other.num_dense(); ++k) {
    for (int mine = 0; mine < num_dense(); ++mine) {
      if (SameTerm(dense_[mine], other.dense_[k])) {
        entries.emplace_back(mine, k, 1.0);
      }
    }
  }
  for (const FunctionKnots& theirs : other.functions_) {
    for (const FunctionKnots& mine : functions_) {
      if (mine.joint != theirs.joint) continue;
      for (int k = 0; k < mine.count; ++k) {
        const double place =
            (mine.first + k * mine.spacing - theirs.first) / theirs.spacing;
        const double below = std::floor(place + 1e-9);
        for (const double knot : {below, below + 1.0}) {
          const double share = 1.0 - std::abs(place - knot);
          int number = static_cast<int>(knot);
          if (theirs.is_periodic) {
            number = (number + theirs.count) % theirs.count;
          }
          if (number < 0 || number >= theirs.count || share <= 0.0) continue;
          entries.emplace_back(num_dense() + mine.offset + k,
                               other.num_dense() + theirs.offset + number,
                               share);
        }
      }
    }
  }
  Eigen::SparseMatrix<double> from(size(), other.size());
  from.setFromTriplets(entries.begin(), entries.end());
  return from;
}

}  // namespace alidade::internal
