#include "src/report/error_term_tables.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "src/common/constants.h"
#include "src/common/format.h"
#include "src/common/number_text.h"
#include "src/common/text.h"

namespace alidade::internal {
namespace {

const JointErrors* ErrorsOf(const Arm& arm, int j) {
  return arm.errors.joints.empty() ? nullptr : &arm.errors.joints[j];
}

const ErrorTermEstimate* FindTerm(const std::vector<ErrorTermEstimate>& terms,
                                  const std::string& name) {
  const auto found = std::find_if(
      terms.begin(), terms.end(),
      [&](const ErrorTermEstimate& one) { return one.name == name; });
  return found == terms.end() ? nullptr : &*found;
}

// "0.045 ± 0.012", both to the second digit of the standard deviation; sorted
// by the value.
TableCell WithStd(double value, double std) {
  if (!(std > 0.0)) return NumberCell(value, 3);
  const int exponent = static_cast<int>(std::floor(std::log10(std)));
  const int decimals = std::max(0, 1 - exponent);
  return {FixedNumber(value, decimals) + " ± " + FixedNumber(std, decimals),
          value};
}

double StdOf(const std::vector<ErrorTermEstimate>& terms,
             const std::string& name) {
  const ErrorTermEstimate* const term = FindTerm(terms, name);
  return term == nullptr ? 0.0 : term->std;
}

// What a function is within some joint values.
struct FunctionSize {
  double rms = 0.0;
  double largest = 0.0;
  double std = 0.0;  // rms; 0 where not known
};

FunctionSize SizeOf(const JointFunction& function, int joint,
                    const std::vector<MeasuredRange>& measured) {
  FunctionSize size;
  double count = 0.0;
  for (Eigen::Index k = 0; k < function.values.size(); ++k) {
    const double at =
        function.first + function.spacing * static_cast<double>(k);
    if (!IsMeasured(measured, joint, at)) continue;
    count += 1.0;
    const double value = function.values[k];
    size.rms += value * value;
    size.largest = std::max(size.largest, std::abs(value));
    if (function.deviations.size() == 0) continue;
    size.std += function.deviations[k] * function.deviations[k];
  }
  if (count == 0.0) return {};
  return {std::sqrt(size.rms / count), size.largest,
          std::sqrt(size.std / count)};
}

// mm of a prismatic joint.
const char* SmallUnit(Dimension dimension) {
  return dimension == Dimension::kLength ? "mm" : "mrad";
}

TableCell LengthCell(double metres) {
  return metres > 0.0 ? QuantityCell(metres, Dimension::kLength, 3)
                      : TableCell("-");
}

TableCell PriorCell(double value) {
  return value > 0.0 ? NumberCell(value / kMilli, 2) : TableCell("-");
}

const Accuracy& ShownAccuracy(const CalibrationResult& result,
                              const ErrorRung& rung) {
  return result.validation ? rung.validation : rung.train;
}

// What is delivered, as a rung.
ErrorRung DeliveredRung(const ErrorTermsResult& errors,
                        const CalibrationResult& result) {
  ErrorRung rung;
  rung.name = "delivered";
  rung.num_terms = static_cast<int>(errors.terms.size());
  for (const JointErrors& joint : result.arm.errors.joints) {
    rung.num_terms += static_cast<int>(joint.function.values.size());
  }
  rung.region_error = errors.region_error;
  rung.random_error = errors.random_error;
  rung.train = result.train.after;
  if (result.validation) {
    rung.validation = result.validation->after;
    rung.validation_rotation = result.validation->rotation_after;
  }
  return rung;
}

}  // namespace

double JointErrorAt(const JointErrors& joint, double joint_value) {
  double error = joint.function.empty() ? 0.0 : joint.function.At(joint_value);
  for (const Harmonic& harmonic : joint.harmonics) {
    error += harmonic.cosine * std::cos(harmonic.cycles * joint_value) +
             harmonic.sine * std::sin(harmonic.cycles * joint_value);
  }
  return error;
}

bool IsMeasured(const std::vector<MeasuredRange>& measured, int joint,
                double joint_value) {
  return measured.empty() || std::any_of(measured.begin(), measured.end(),
                                         [&](const MeasuredRange& range) {
                                           return range.joint == joint &&
                                                  joint_value >= range.lower &&
                                                  joint_value <= range.upper;
                                         });
}

Table ComplianceTable(const Arm& arm,
                      const std::vector<ErrorTermEstimate>& terms) {
  Table table(
      "compliances", "Compliances [mrad/(N m)]",
      {">joint", ">k_x|about x of the joint's frame",
       ">k_y|about y of the joint's frame", ">k_z|about the joint's own axis"});
  for (int j = 0; j < arm.num_joints(); ++j) {
    const JointErrors* const errors = ErrorsOf(arm, j);
    if (errors == nullptr || errors->compliance.isZero(0.0)) continue;
    std::vector<TableCell> row = {CountCell(j + 1)};
    for (int axis = 0; axis < 3; ++axis) {
      const std::string name = "k" + std::to_string(j + 1) + "_" + "xyz"[axis];
      row.push_back(WithStd(errors->compliance[axis] / kMilli,
                            StdOf(terms, name) / kMilli));
    }
    table.AddRow(std::move(row));
  }
  return table;
}

Table FunctionTable(const Arm& arm,
                    const std::vector<MeasuredRange>& measured) {
  Table table("joint-functions",
              measured.empty() ? "Error functions of the joints"
                               : "Error functions where joints were measured",
              {"joint", ">from", ">to", "of", ">knots",
               ">rms|root mean square of the function", ">largest",
               ">std|root mean square of its standard deviation", "unit"});
  for (int j = 0; j < arm.num_joints(); ++j) {
    const JointErrors* const errors = ErrorsOf(arm, j);
    if (errors == nullptr || errors->function.empty()) continue;
    const JointFunction& function = errors->function;
    const Dimension dimension = arm.joints[j].dimension();
    double from = function.first;
    double to = function.last();
    if (!measured.empty()) {
      from = to;
      to = function.first;
      for (const MeasuredRange& range : measured) {
        if (range.joint != j + 1) continue;
        from = std::min(from, range.lower);
        to = std::max(to, range.upper);
      }
    }
    const FunctionSize size = SizeOf(function, j + 1, measured);
    table.AddRow(
        {CountCell(j + 1), QuantityCell(from, dimension, 4),
         QuantityCell(to, dimension, 4), UnitForPeople(dimension),
         CountCell(function.values.size()), NumberCell(size.rms / kMilli, 3),
         NumberCell(size.largest / kMilli, 3),
         size.std > 0.0 ? NumberCell(size.std / kMilli, 2) : TableCell("-"),
         SmallUnit(dimension)});
  }
  return table;
}

Table OtherTermTable(const Arm& arm,
                     const std::vector<ErrorTermEstimate>& terms) {
  Table table("other-terms", "Harmonics, backlash, scale and coupling",
              {"term", "~of", ">value", "unit"});
  const auto add = [&](const std::string& name, const std::string& what,
                       double value, const std::string& unit) {
    table.AddRow({name, what,
                  WithStd(value / kMilli, StdOf(terms, name) / kMilli), unit});
  };
  for (int j = 0; j < arm.num_joints(); ++j) {
    const std::string number = std::to_string(j + 1);
    const std::string joint = " of joint " + number;
    const JointErrors* const errors = ErrorsOf(arm, j);
    if (errors != nullptr) {
      for (const Harmonic& harmonic : errors->harmonics) {
        const std::string cycles = FormatSignificant(harmonic.cycles, 4);
        const std::string turn = " of " + cycles + " per turn" + joint;
        const std::string name =
            ShortestNumber(std::round(1e4 * harmonic.cycles) / 1e4);
        add("h" + number + "_c" + name, "cosine" + turn, harmonic.cosine,
            "mrad");
        add("h" + number + "_s" + name, "sine" + turn, harmonic.sine, "mrad");
      }
      if (errors->backlash != 0.0) {
        add("b" + number, "half of the backlash" + joint, errors->backlash,
            "mrad");
      }
    }
    if (arm.errors.coupling.size() == 0) continue;
    for (int other = 0; other < arm.num_joints(); ++other) {
      const double value = arm.errors.coupling(j, other);
      if (value == 0.0) continue;
      const bool is_scale = other == j;
      const std::string to = SmallUnit(arm.joints[j].dimension());
      const bool of_length =
          arm.joints[other].dimension() == Dimension::kLength;
      add("g" + number + (is_scale ? "" : "_" + std::to_string(other + 1)),
          is_scale ? "scale error" + joint
                   : "joint " + number + " moves with joint " +
                         std::to_string(other + 1),
          value, to + (of_length ? "/m" : "/rad"));
    }
  }
  return table;
}

std::string FormatArmErrors(const Arm& arm) {
  std::string text;
  const auto add = [&text](const std::string& title, const Table& table) {
    if (!table.empty()) text += "\n" + Paragraph(title + ":") + table.ToText();
  };
  add("Compliances under gravity [mrad/(N m)]" +
          std::string(arm.errors.links.empty()
                          ? ", for 1 kg at each joint and the stated payload"
                          : ""),
      ComplianceTable(arm, {}));
  add("Error functions of the joints", FunctionTable(arm, {}));
  add("Harmonics, backlash, scale and coupling", OtherTermTable(arm, {}));
  return text;
}

Table RungTable(const ErrorTermsResult& errors,
                const CalibrationResult& result) {
  const std::string poses =
      result.validation ? "validation poses" : "training poses";
  constexpr int kNameWidth = 20;
  Table table(
      "error-rungs",
      "What each set of terms brought, and what it cost; mean, max and change "
      "at " +
          poses,
      {Table::Column("model").Wrapped(kNameWidth),
       ">terms|coefficients besides the geometry",
       (">weight [%]|in what is delivered; -: a model with fewer terms has as "
        "much evidence"),
       Table::PageOnly(">evidence|what it gains in -2 log of the restricted "
                       "likelihood over the geometry alone"),
       (">regions [mm]|mean error at training poses in regions of joint space "
        "that were left out of the fit"),
       ">random [mm]|the same, left out at random", ">mean [mm]|position error",
       ">max [mm]|position error", ">mean [deg]|orientation error",
       Table::PageOnly(
           ">change [%]|of the mean position error, against geometry alone")});
  const double before = ShownAccuracy(result, errors.rungs.front()).mean;
  const auto add = [&](const ErrorRung& rung, const TableCell& weight) {
    const Accuracy& accuracy = ShownAccuracy(result, rung);
    const bool has_rotation = rung.validation_rotation.n > 0;
    table.AddRow(
        {rung.name, CountCell(rung.num_terms), weight,
         rung.evidence != 0.0 ? FixedCell(rung.evidence, 1) : TableCell("-"),
         LengthCell(rung.region_error), LengthCell(rung.random_error),
         QuantityCell(accuracy.mean, Dimension::kLength, 3),
         QuantityCell(accuracy.max, Dimension::kLength, 3),
         has_rotation
             ? QuantityCell(rung.validation_rotation.mean, Dimension::kAngle, 3)
             : TableCell("-"),
         FixedCell(100.0 * (accuracy.mean / before - 1.0), 0)});
  };
  for (const ErrorRung& rung : errors.rungs) {
    add(rung,
        rung.is_weighed ? FixedCell(100.0 * rung.weight, 1) : TableCell("-"));
  }
  add(DeliveredRung(errors, result), "");
  return table;
}

Table PriorTable(const ErrorTermsResult& errors) {
  Table table(
      "error-priors",
      "Prior standard deviations, found from the training poses",
      {"model", ">k_z [mrad/(N m)]|compliance about the joint's own axis",
       ">k_x, k_y [mrad/(N m)]|about the other two",
       ">functions [mrad]|of a joint function's values"});
  for (const ErrorRung& rung : errors.rungs) {
    if (rung.num_terms == 0) continue;
    table.AddRow({rung.name, PriorCell(rung.compliance_std),
                  PriorCell(rung.other_compliance_std),
                  PriorCell(rung.function_std)});
  }
  return table;
}

Table EffectTable(const ErrorTermsResult& errors) {
  std::vector<std::string> kinds;
  std::set<int> joints;
  for (const ErrorTermEffect& effect : errors.effects) {
    joints.insert(effect.joint);
    if (effect.term != "all" &&
        std::find(kinds.begin(), kinds.end(), effect.term) == kinds.end()) {
      kinds.push_back(effect.term);
    }
  }
  kinds.emplace_back("all");
  std::vector<Table::Column> columns = {"joint"};
  for (const std::string& kind : kinds) {
    columns.emplace_back(">" + kind + " [mm]");
  }
  columns.emplace_back(">largest [mm]|of all terms of the joint");
  Table table("error-effects",
              "How far the terms move the target (root mean square)",
              std::move(columns));
  const auto add = [&](int joint) {
    std::vector<TableCell> row = {joint == 0 ? TableCell("together")
                                             : CountCell(joint)};
    double largest = 0.0;
    for (const std::string& kind : kinds) {
      const auto found =
          std::find_if(errors.effects.begin(), errors.effects.end(),
                       [&](const ErrorTermEffect& effect) {
                         return effect.joint == joint && effect.term == kind;
                       });
      const bool is_there = found != errors.effects.end();
      row.push_back(is_there ? LengthCell(found->rms) : TableCell("-"));
      if (is_there && kind == "all") largest = found->max;
    }
    row.push_back(LengthCell(largest));
    table.AddRow(std::move(row));
  };
  for (const int joint : joints) {
    if (joint > 0) add(joint);
  }
  if (joints.count(0) > 0) add(0);
  return table;
}

std::string DescribeErrorTerms(const CalibrationResult& result) {
  const ErrorTermsResult& errors = *result.error_terms;
  std::string text = AsSentence(errors.sentence);
  if (!(errors.share > 0.0) || errors.rungs.empty()) return text;
  const ErrorRung delivered = DeliveredRung(errors, result);
  const ErrorRung& geometry = errors.rungs.front();
  text += " What is delivered has " +
          Count(delivered.num_terms, "coefficient") +
          " besides the geometry, held by priors: together with the geometry "
          "they fit as freely as " +
          FormatSignificant(errors.effective_terms, 3) +
          " parameters without priors would.";
  const auto compare = [](double before, double after) {
    return FormatLength(before, 3) + " with geometry alone and " +
           FormatLength(after, 3) + " with the terms";
  };
  text += " The mean error at " +
          std::string(result.validation ? "validation" : "training") +
          " poses is " +
          compare(ShownAccuracy(result, geometry).mean,
                  ShownAccuracy(result, delivered).mean);
  if (errors.region_error > 0.0) {
    text +=
        "; in regions of joint space held out of a fit to the other "
        "training poses it is " +
        compare(geometry.region_error, errors.region_error);
  }
  text += ".";
  if (errors.share < 0.995 && errors.region_error > 0.0) {
    text +=
        " Of the step from geometry alone to the weighted mean of all sets "
        "of terms " +
        FixedNumber(100.0 * errors.share, 0) +
        " % is taken: so much the evidence allows.";
  }
  return text;
}

std::string ErrorTermsSection(const CalibrationResult& result) {
  if (!result.error_terms) return "";
  const ErrorTermsResult& errors = *result.error_terms;
  std::string text = Paragraph(DescribeErrorTerms(result));
  const auto add = [&text](const std::string& title, const Table& table) {
    if (!table.empty()) text += "\n" + Paragraph(title) + table.ToText();
  };
  if (!errors.rungs.empty()) {
    add("What each set of terms brought, and what it cost. \"regions\" and "
        "\"random\": mean error at training poses that were left out of the "
        "fit; then errors at " +
            std::string(result.validation ? "validation" : "training") +
            " poses:",
        RungTable(errors, result));
    add("Prior standard deviations, found from the training poses:",
        PriorTable(errors));
  }
  if (!(errors.share > 0.0) && errors.terms.empty()) return text;
  add("Compliances with their standard deviations [mrad/(N m)]:",
      ComplianceTable(result.arm, errors.terms));
  add("Error functions where joints were measured:",
      FunctionTable(result.arm, errors.measured));
  add("Harmonics, backlash, scale and coupling:",
      OtherTermTable(result.arm, errors.terms));
  add("How far the terms move the target over the joint limits (root mean "
      "square):",
      EffectTable(errors));
  return text;
}

}  // namespace alidade::internal
