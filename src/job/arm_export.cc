#include "src/job/arm_export.h"

#include <cmath>

#include "alidade/correction.h"
#include "alidade/error.h"
#include "src/compensation/geometry_fit.h"
#include "src/dataio/joint_tables.h"
#include "src/dataio/urdf_origins.h"
#include "src/serialization/arm_json.h"
#include "src/serialization/config_file.h"
#include "src/serialization/ur_kinematics.h"

namespace alidade::internal {
namespace {

enum Row { kBeta, kAlpha, kD, kTheta, kR };

FreeGeometry AllFree(int num_joints) {
  return FreeGeometry::Constant(5, num_joints, true);
}

bool HasBeta(const Arm& arm) {
  for (const Joint& joint : arm.joints) {
    if (joint.beta != 0.0) return true;
  }
  return false;
}

Arm WithoutBeta(Arm arm) {
  for (Joint& joint : arm.joints) joint.beta = 0.0;
  return arm;
}

// Rot(x, alpha) after Trans(x, a): all that a last standard row has.
bool IsAlongX(const Eigen::Isometry3d& frame) {
  constexpr double kTiny = 1e-12;
  return frame.translation().tail<2>().norm() < kTiny &&
         std::abs(frame.linear()(0, 0) - 1.0) < kTiny;
}

class Exporter {
 public:
  Exporter(const ExportRequest& request, const Arm& nominal, const Arm& real)
      : request_(request), arms_(MakeCorrectionArms(nominal, real)) {}

  ArmExport Run() {
    if (request_.format == "json") {
      result_.text = FormatArmJson(arms_.real);
      return Finish(arms_.real);
    }
    if (!arms_.real.errors.empty()) {
      result_.lost.emplace_back(
          "It has no error terms (elasticity, joint functions, coupling): the "
          "numbers are those that come nearest to the arm with them.");
    }
    const bool is_table = request_.format == "dh" || request_.format == "mdh" ||
                          request_.format == "offsets";
    if (HasMotorMap(arms_.real)) {
      result_.lost.emplace_back(
          "It has no motors: signs, offsets and coupling of the arm file's "
          "`motors` (or `sign`, `offset`) are to be kept beside it.");
    }
    if (is_table) return Table();
    return request_.format == "ur" ? Ur() : Urdf();
  }

 private:
  ArmExport Finish(const Arm& held) {
    result_.cost = DistanceOver(arms_.real, held);
    return std::move(result_);
  }

  // The real arm's geometry, all of it.
  Arm Geometry() const {
    Arm rigid = WithoutErrorTerms(arms_.real);
    if (arms_.real.errors.empty()) return rigid;
    return FitGeometry(arms_.real, rigid, AllFree(rigid.num_joints()));
  }

  ArmExport Table() {
    const int n = arms_.real.num_joints();
    FreeGeometry free = AllFree(n);
    free.row(kBeta).setConstant(false);
    Arm start = WithoutBeta(WithoutErrorTerms(arms_.real));
    const bool is_standard = request_.format == "dh";
    bool fits = arms_.real.errors.empty() && !HasBeta(arms_.real);
    if (is_standard) {
      free(kAlpha, 0) = free(kD, 0) = false;
      const Joint& first = arms_.real.joints[0];
      if (first.alpha != 0.0 || first.d != 0.0) {
        fits = false;
        result_.lost.emplace_back(
            "Its first row begins at the first joint's axis: alpha and d of "
            "joint 1 are left out.");
      }
      start.joints[0].alpha = start.joints[0].d = 0.0;
    }
    if (request_.format == "offsets") return Offsets();
    if (HasBeta(arms_.real)) {
      result_.lost.emplace_back(
          "It has no beta: of parallel axes the tilt about y is left out.");
    }
    const Arm held = fits ? start : FitGeometry(arms_.real, start, free);
    if (is_standard) {
      const Eigen::Isometry3d& tool = arms_.nominal.last_from_target();
      const bool in_row = IsAlongX(tool);
      const double a = in_row ? tool.translation().x() : 0.0;
      const double alpha =
          in_row ? std::atan2(tool.linear()(2, 1), tool.linear()(1, 1)) : 0.0;
      Arm after = held;
      if (in_row) after.last_from_target().setIdentity();
      Write(StandardTable(held, a, alpha), after);
    } else {
      Write(CraigTable(held), held);
    }
    return Finish(held);
  }

  ArmExport Offsets() {
    const int n = arms_.real.num_joints();
    FreeGeometry free = FreeGeometry::Constant(5, n, false);
    for (int j = 0; j < n; ++j) {
      const bool turns = arms_.nominal.joints[j].type == JointType::kRevolute;
      free(turns ? kTheta : kR, j) = true;
    }
    const Arm held =
        FitGeometry(arms_.real, WithoutErrorTerms(arms_.nominal), free);
    result_.lost.emplace_back(
        "It has the zeros of the joints alone, the best that they can do: "
        "lengths and angles of the links stay nominal.");
    Write(OffsetTable(arms_.nominal, held), held);
    return Finish(held);
  }

  void Write(const JointTable& table, const Arm& arm) {
    result_.text = request_.table == "latex"  ? FormatLatex(table)
                   : request_.table == "yaml" ? FormatYaml(table, arm)
                                              : FormatCsv(table);
  }

  ArmExport Ur() {
    const Arm held = Geometry();
    for (const Joint& joint : held.joints) {
      if (joint.type == JointType::kRevolute && held.num_joints() == 6) {
        continue;
      }
      throw InputError({}, "--as=ur: the arm has " +
                               std::to_string(held.num_joints()) +
                               " joints, expected six that turn");
    }
    if (!held.last_from_target().isApprox(Eigen::Isometry3d::Identity(),
                                          1e-12)) {
      result_.lost.emplace_back(
          "It ends at the flange: the arm file's tool is not part of it.");
    }
    result_.text = FormatUrKinematics(JointOrigins(held));
    return Finish(held);
  }

  ArmExport Urdf() {
    const YamlValue root =
        ReadConfigFile(request_.nominal_path, FileFormat::kArm);
    const std::optional<YamlValue> urdf = root.Find("urdf");
    if (!urdf) {
      throw InputError({request_.nominal_path, 0, 0, "urdf"},
                       "the nominal arm is not described by a URDF, expected "
                       "an arm file with `urdf`, by --nominal");
    }
    const YamlMap map = urdf->Map({"file", "base_link", "tip_link"});
    const UrdfChain chain = {
        ResolvePath(request_.nominal_path, map.Required("file").Text()),
        map.Required("base_link").Text(), map.Required("tip_link").Text()};
    const Arm held = Geometry();
    result_.text = RewriteUrdf(chain, arms_.nominal, held);
    return Finish(held);
  }

  const ExportRequest& request_;
  const CorrectionArms arms_;
  ArmExport result_;
};

}  // namespace

ArmExport ExportArm(const ExportRequest& request, const Arm& nominal,
                    const Arm& real) {
  return Exporter(request, nominal, real).Run();
}

}  // namespace alidade::internal
