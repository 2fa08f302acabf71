#include <filesystem>
#include <iostream>

#include "alidade/error.h"
#include "src/cli/command.h"
#include "src/common/files.h"
#include "src/common/names.h"
#include "src/job/arm_verification.h"
#include "src/report/arm_check_report.h"

namespace alidade::internal {
namespace {

namespace fs = std::filesystem;

constexpr int kFewestPlanned = 3;
constexpr int kMostPlanned = 50;

VerificationOptions OptionsOf(const CommandLine& line) {
  VerificationOptions options;
  options.corrected = line.corrected;
  options.num_threads = line.threads;
  options.refit_base = line.refit == "base" || line.refit == "base,tool";
  options.refit_tool = line.refit == "tool" || line.refit == "base,tool";
  if (!line.refit.empty() && !options.refit_base && !options.refit_tool) {
    throw InputError({},
                     "--refit: " + UnknownName("frame", line.refit,
                                               {"base", "tool", "base,tool"}));
  }
  return options;
}

// results/my_arm_check.csv of results/my_arm, unless --out says otherwise.
std::string PosesFile(const CommandLine& line) {
  if (!line.out.empty()) return line.out;
  fs::path result = line.files[0];
  if (result.filename().empty()) result = result.parent_path();
  return "results/" + result.stem().string() + "_check.csv";
}

// Their columns are not read here.
void RefuseCovariates(const Arm& arm) {
  for (const CovariateEffect& effect : arm.errors.covariates) {
    if (effect.is_zero()) continue;
    throw InputError({}, "--check: the arm has an effect of `" + effect.name +
                             "`, which a check does not take into account; "
                             "`alidade validate RESULT JOB.yaml` does");
  }
}

// The two ways to go on, with their commands.
std::string NextSteps(const CommandLine& line, const std::string& out) {
  const std::string& result = line.files[0];
  const std::string nominal =
      line.nominal.empty() ? "" : " --nominal=" + line.nominal;
  const fs::path file = fs::path(out).filename();
  const std::string to_drive = "results/corrected/" + file.string();
  return "Next\n"
         "  the arm alone: drive to the joint values of " +
         out +
         ", fill in what is measured there, then\n"
         "    alidade validate --check " +
         result + " " + out + nominal +
         "\n"
         "  with the correction: make the joint values to drive to,\n"
         "    alidade correct " +
         result + " " + out + nominal + " --out=" + to_drive +
         "\n"
         "  drive to its corrected_q1_deg ..., fill what is measured into " +
         out +
         ", whose joint values stay, then\n"
         "    alidade validate --check --corrected " +
         result + " " + out + nominal + "\n" +
         "  The poses lie within what the calibration has measured: a program "
         "that goes elsewhere is not checked by them.\n";
}

}  // namespace

ExitStatus RunCheckPlan(const CommandLine& line) {
  const std::string out = PosesFile(line);
  if (fs::exists(out)) {
    throw InputError({out, 0, 0, ""},
                     "is there already, and measurements may stand in it; "
                     "expected another --out=FILE");
  }
  if (line.poses < kFewestPlanned || line.poses > kMostPlanned) {
    throw InputError({}, "--poses=" + std::to_string(line.poses) +
                             ", must be between " +
                             std::to_string(kFewestPlanned) + " and " +
                             std::to_string(kMostPlanned));
  }
  const ArmSource source = LoadArmSource(line.files[0], line.nominal);
  RefuseCovariates(source.real);
  const VerificationPlan plan = PlanVerification(
      source, line.poses, line.seed.value_or(kDefaultSeed), OptionsOf(line));
  const fs::path folder = fs::path(out).parent_path();
  if (!folder.empty()) MakeDirectories(folder.string());
  WriteFileAtomically(out, plan.text);
  std::cout << FormatCheckPlan(source.real, plan.planned, plan.by_number);
  PrintResults({out});
  std::cout << "\n" << NextSteps(line, out);
  return kExitDone;
}

ExitStatus RunArmCheck(const CommandLine& line) {
  if (line.files.size() != 2) {
    throw InputError({}, "validate --check: expected RESULT DATA.csv");
  }
  const ArmSource source = LoadArmSource(line.files[0], line.nominal);
  RefuseCovariates(source.real);
  const ArmCheckResult check =
      VerifyArm(source, line.files[1], OptionsOf(line));
  std::cout << FormatArmCheck(source.real, check);
  return check.passes ? kExitDone : kExitMissedLimits;
}

}  // namespace alidade::internal
