#include <algorithm>
#include <iostream>
#include <optional>

#include "alidade/error.h"
#include "alidade/units.h"
#include "src/cli/command.h"
#include "src/cli/targets.h"
#include "src/common/format.h"
#include "src/common/names.h"
#include "src/common/text.h"
#include "src/job/arm_export.h"
#include "src/job/arm_source.h"
#include "src/job/calibrated_arm.h"
#include "src/job/frame_table.h"

namespace alidade::internal {
namespace {

void RequireOneOf(const char* flag, const std::string& value,
                  const std::vector<std::string>& choices) {
  if (std::find(choices.begin(), choices.end(), value) != choices.end()) return;
  if (value.empty()) {
    throw InputError({}, std::string("export: --") + flag +
                             "=FORMAT is missing, expected one of " +
                             JoinNames(choices));
  }
  throw InputError({}, std::string("--") + flag + ": " +
                           UnknownName("format", value, choices));
}

std::string Statement(const ArmExport& exported) {
  std::string text;
  for (const std::string& sentence : exported.lost) {
    text += Paragraph(sentence);
  }
  const auto mm = [](double length) {
    return FormatSignificant(length / kMillimetre, 3);
  };
  return text +
         Paragraph("Over the workspace it differs from the calibrated arm by " +
                   mm(exported.cost.mean) + " mm in the mean, " +
                   mm(exported.cost.p95) + " mm in 95 %, " +
                   mm(exported.cost.max) + " mm at most.");
}

// The flange in the last joint's frame: the target of the arm that --nominal
// names, or of the one that the result was calibrated from, where that is
// turned alone, as the arms of `alidade robots` have it. The last joint's frame
// elsewhere: a target that is moved is a guess of the tool.
Eigen::Isometry3d FlangeOf(const CommandLine& line) {
  const std::string& path = line.files[0];
  if (!line.nominal.empty()) {
    return LoadArmOrResult(line.nominal).last_from_target();
  }
  if (!IsResult(path)) return Eigen::Isometry3d::Identity();
  const Arm nominal = LoadArmSource(path, "").nominal;
  Eigen::Isometry3d flange = nominal.last_from_target();
  if (nominal.num_targets() == 1 && flange.translation().isZero(0.0)) {
    return flange;
  }
  std::cerr << "note: tools are in the frame of the last joint, as the nominal "
               "arm's tool may be a guess: where the flange is turned or moved "
               "from it, name an arm whose tool is the flange by --nominal\n";
  return Eigen::Isometry3d::Identity();
}

ExitStatus ExportFrames(const CommandLine& line) {
  const std::string& path = line.files[0];
  PoseFormat format;
  if (const auto rotation = RotationFlag(line)) {
    format.form = OrientationForm::kAngles;
    format.rotation = *rotation;
  }
  std::optional<CalibratedArm> calibrated;
  if (IsResult(path)) calibrated = LoadCalibratedArm(path);
  const Arm arm = calibrated ? calibrated->arm : LoadArmOrResult(path);
  WriteTable(
      line,
      FormatFrames(arm, FlangeOf(line),
                   calibrated ? &calibrated->covariance : nullptr, format),
      {path});
  return kExitDone;
}

}  // namespace

ExitStatus RunExport(const CommandLine& line) {
  RequireOneOf("as", line.as,
               {"dh", "mdh", "offsets", "ur", "urdf", "json", "frames"});
  if (line.as == "frames") return ExportFrames(line);
  const std::string table = line.table.empty() ? "csv" : line.table;
  RequireOneOf("table", table, {"csv", "yaml", "latex"});
  const std::string& path = line.files[0];
  // An arm file alone is its own nominal arm.
  const bool is_alone = !IsResult(path) && line.nominal.empty();
  const ArmSource source = LoadArmSource(path, is_alone ? path : line.nominal);
  const ArmExport exported = ExportArm({line.as, table, source.nominal_path},
                                       source.nominal, source.real);
  WriteTable(line, exported.text, source.inputs);
  // Beside the text itself, where that is on standard output.
  (line.out.empty() ? std::cerr : std::cout) << Statement(exported);
  return kExitDone;
}

}  // namespace alidade::internal
