#ifndef ALIDADE_TESTS_CLI_PROGRAM_LANGUAGES_H_
#define ALIDADE_TESTS_CLI_PROGRAM_LANGUAGES_H_

#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <regex>
#include <string>
#include <vector>

#include "alidade/arm.h"
#include "alidade/forward_kinematics.h"
#include "alidade/rotation.h"
#include "alidade/units.h"
#include "src/common/random.h"

// Programs of four languages, written by templates that have what public ones
// have, and a reader of their numbers that knows nothing of the library's.
namespace alidade::internal::testing {

// A position of a program: the joint values that it was made of.
struct Position {
  Eigen::VectorXd joints;
  bool is_joints = false;
  Eigen::Isometry3d pose;  // as written: tool in frame
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d tool = Eigen::Isometry3d::Identity();
};

// Text of a program: pieces that must stay, and a position after each but the
// last.
struct Program {
  std::vector<std::string> pieces = {""};
  std::vector<Position> positions;
};

inline std::string Number(double value, int decimals) {
  std::array<char, 64> text;
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

// The numbers in a piece of text that has nothing else: names of components
// (X, A1, q) and units are letters.
inline std::vector<double> NumbersIn(const std::string& text) {
  static const std::regex kNumber(
      R"((?:^|[^A-Za-z0-9_.])(-?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?))");
  std::vector<double> numbers;
  for (std::sregex_iterator it(text.begin(), text.end(), kNumber), end;
       it != end; ++it) {
    numbers.push_back(std::stod((*it)[1]));
  }
  return numbers;
}

// What one unit of the last digit of each of them is.
inline std::vector<double> LastDigitsIn(const std::string& text) {
  static const std::regex kDecimals(
      R"((?:^|[^A-Za-z0-9_.])-?\d*(?:\.(\d*)|\d))");
  std::vector<double> digits;
  for (std::sregex_iterator it(text.begin(), text.end(), kDecimals), end;
       it != end; ++it) {
    digits.push_back(std::pow(10.0, -static_cast<double>((*it)[1].length())));
  }
  return digits;
}

inline Eigen::Isometry3d Frame(double x, double y, double z, double turn) {
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  frame.translation() = Eigen::Vector3d(x, y, z);
  frame.linear() = Eigen::AngleAxisd(turn, Eigen::Vector3d(0.6, 0.0, 0.8))
                       .toRotationMatrix();
  return frame;
}

inline Eigen::Vector3d RollPitchYaw(const Eigen::Matrix3d& r) {
  return {std::atan2(r(2, 1), r(2, 2)),
          std::atan2(-r(2, 0), std::hypot(r(0, 0), r(1, 0))),
          std::atan2(r(1, 0), r(0, 0))};
}

inline Eigen::Matrix3d FromRollPitchYaw(double roll, double pitch, double yaw) {
  return (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

// One language: how it writes a position and reads one, and programs of it.
struct Language {
  const char* name;
  const char* robot;
  const char* file;
  double length_digit;  // unit of the last digit (m, rad)
  double angle_digit;
  std::function<std::string(const Position&)> write;
  std::function<Eigen::Isometry3d(const std::vector<double>&)> read;
  double angle;  // unit of joint values
  std::function<void(int, Random*, const Arm&, Program*)> make;
};

class ProgramMaker {
 public:
  ProgramMaker(const Language& language, const Arm& arm, Random* random,
               Program* program)
      : language_(language), arm_(arm), random_(random), program_(program) {
    joints_.resize(6);
    for (double& q : joints_) q = random->Uniform(-0.4, 0.4);
    joints_[1] += language.robot == std::string("ur10") ? -1.2 : 0.2;
    joints_[2] += language.robot == std::string("ur10") ? 1.4 : 0.1;
    joints_[4] += 0.9;
  }

  ProgramMaker& Say(const std::string& text) {
    program_->pieces.back() += text;
    return *this;
  }
  ProgramMaker& Pose() { return Add(false); }
  ProgramMaker& Joints() { return Add(true); }
  ProgramMaker& UseTool(const Eigen::Isometry3d& tool) {
    tool_ = tool;
    return *this;
  }
  ProgramMaker& UseFrame(const Eigen::Isometry3d& frame) {
    frame_ = frame;
    return *this;
  }

 private:
  ProgramMaker& Add(bool is_joints) {
    Position position;
    for (double& q : joints_) q += random_->Uniform(-0.08, 0.08);
    position.joints = joints_;
    position.is_joints = is_joints;
    position.tool = tool_;
    position.frame = frame_;
    position.pose = frame_.inverse() * TargetPose(arm_, joints_) * tool_;
    program_->positions.push_back(position);
    program_->pieces.emplace_back();
    return *this;
  }

  const Language& language_;
  const Arm& arm_;
  Random* const random_;
  Program* const program_;
  Eigen::VectorXd joints_;
  Eigen::Isometry3d tool_ = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d frame_ = Eigen::Isometry3d::Identity();
};

inline std::string Joined(const std::vector<std::string>& numbers,
                          const std::string& separator) {
  std::string text;
  for (const std::string& number : numbers) {
    text += (text.empty() ? "" : separator) + number;
  }
  return text;
}

inline const Language& UrScript() {
  static const auto* const language = [] {
    auto* l = new Language{"URScript", "ur10", "part.script", 1e-6, 1e-6,
                           {},         {},     1.0,           {}};
    l->write = [](const Position& p) {
      std::vector<std::string> numbers;
      if (p.is_joints) {
        for (const double q : p.joints) numbers.push_back(Number(q, 8));
      } else {
        for (const double x : p.pose.translation()) {
          numbers.push_back(Number(x, 9));
        }
        const Eigen::Matrix3d rotation = p.pose.linear();
        const Eigen::Vector3d w = VectorFromRotation(rotation);
        for (const double x : w) numbers.push_back(Number(x, 9));
      }
      return Joined(numbers, ", ");
    };
    l->read = [](const std::vector<double>& n) {
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      pose.translation() = Eigen::Vector3d(n[0], n[1], n[2]);
      const Eigen::Vector3d w(n[3], n[4], n[5]);
      pose.linear() =
          Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix();
      return pose;
    };
    l->make = [l](int i, Random* random, const Arm& arm, Program* program) {
      ProgramMaker m(*l, arm, random, program);
      const std::string end = i % 4 == 3 ? "\r\n" : "\n";
      m.Say("def part_" + std::to_string(i) + "():" + end +
            "  # movel(p[1, 2, 3, 0, 0, 0]) in a comment" + end +
            "  textmsg(\"movej([0,0,0,0,0,0])\")" + end);
      m.Say("  movej([").Joints().Say("], a=1.4, v=1.05)" + end);
      if (i % 3 == 1) {
        Eigen::Isometry3d tool = Eigen::Isometry3d::Identity();
        tool.translation() = Eigen::Vector3d(0.01, 0.0, 0.15);
        m.Say("  set_tcp(p[0.01,0.0,.15,0.0,0.0,0.0])" + end).UseTool(tool);
      }
      m.Say("  movel( p[").Pose().Say("] , a=1.2, v=0.25, r=0.01)" + end);
      if (i % 2 == 0) {
        m.Say("  global wp_1=p[").Pose().Say("]" + end);
        m.Say(
            "  movej(get_inverse_kin(wp_1, qnear=[0,-1.2,1.4,0,0.9,0]), "
            "a=1, v=1)" +
            end);
      }
      m.Say("  movec(p[").Pose().Say("], p[").Pose().Say("], a=1.0)" + end);
      m.Say("  if (get_digital_in(1) == True):" + end);
      m.Say("    movep(p[").Pose().Say("], a=1.2)" + end + "  end" + end);
      m.Say(
          "  moved = pose_trans(get_actual_tcp_pose(), "
          "p[0,0,0.1,0,0,0])" +
          end + "  movel(moved)" + end + "end" + end);
    };
    return l;
  }();
  return *language;
}

inline std::string KrlPose(const Eigen::Isometry3d& pose, int decimals) {
  const Eigen::Vector3d rpy = RollPitchYaw(pose.linear()) / kDegree;
  std::vector<std::string> parts;
  for (int k = 0; k < 3; ++k) {
    parts.push_back(std::string(1, "XYZ"[k]) + " " +
                    Number(pose.translation()[k] * 1e3, decimals));
  }
  for (int k = 0; k < 3; ++k) {
    parts.push_back(std::string(1, "ABC"[k]) + " " +
                    Number(rpy[2 - k], decimals));
  }
  return Joined(parts, ",");
}

inline const Language& Krl() {
  static const auto* const language = [] {
    auto* l = new Language{"KRL", "irb120", "part.dat", 1e-6, 1e-6 * kDegree,
                           {},    {},       kDegree,    {}};
    l->write = [](const Position& p) {
      if (p.is_joints) {
        std::vector<std::string> parts;
        for (int j = 0; j < 6; ++j) {
          parts.push_back("A" + std::to_string(j + 1) + " " +
                          Number(p.joints[j] / kDegree, 6));
        }
        return Joined(parts, ",");
      }
      int turn = 0;
      for (int j = 0; j < 6; ++j) turn |= p.joints[j] < 0.0 ? 1 << j : 0;
      return KrlPose(p.pose, 6) + ",S 2,T " + std::to_string(turn);
    };
    l->read = [](const std::vector<double>& n) {
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      pose.translation() = Eigen::Vector3d(n[0], n[1], n[2]) * 1e-3;
      pose.linear() =
          FromRollPitchYaw(n[5] * kDegree, n[4] * kDegree, n[3] * kDegree);
      return pose;
    };
    l->make = [l](int i, Random* random, const Arm& arm, Program* program) {
      ProgramMaker m(*l, arm, random, program);
      const std::string end = i % 4 == 1 ? "\r\n" : "\n";
      const Eigen::Isometry3d tool = Frame(0.02, -0.01, 0.12, 0.3);
      const Eigen::Isometry3d base = Frame(0.1, 0.2, 0.05, -0.2);
      m.Say("&ACCESS RVP" + end + "DEFDAT part" + end +
            ";DECL E6POS XP0={X 1,Y 2,Z 3,A 0,B 0,C 0,S 2,T 0}" + end +
            "DECL BASIS_SUGG_T LAST_BASIS={POINT1[] \"P1 {X 1}\"}" + end);
      m.Say("DECL E6AXIS XHOME={").Joints().Say(",E1 0.0,E2 0.0}" + end);
      const std::string external = i % 2 == 0 ? ",E1 0.0,E2 0.0}" : "}";
      m.Say("decl e6pos xp1={").Pose().Say(external + end);
      m.Say(
          "DECL FDAT FP1={TOOL_NO 0,BASE_NO 0,IPO_FRAME #BASE,POINT2[] "
          "\" \",TQ_STATE FALSE}" +
          end);
      m.UseTool(tool).UseFrame(base);
      m.Say("DECL E6POS XP2 = {").Pose().Say(external + end);
      m.Say(
          "DECL FDAT FP2={TOOL_NO 1,BASE_NO 2,IPO_FRAME #BASE,POINT2[] "
          "\" \",TQ_STATE FALSE}" +
          end);
      m.Say("DECL PDAT PPDAT1={VEL 100.000,ACC 100.000,APO_DIST 100.000}" +
            end);
      m.Say("ENDDAT" + end);
    };
    return l;
  }();
  return *language;
}

inline const Language& KrlSource() {
  static const auto* const language = [] {
    auto* l = new Language(Krl());
    l->name = "KRLSource";
    l->file = "part.src";
    l->make = [l](int i, Random* random, const Arm& arm, Program* program) {
      ProgramMaker m(*l, arm, random, program);
      const Eigen::Isometry3d base = Frame(0.1, 0.2, 0.05, -0.2);
      m.Say("DEF part()\n;FOLD PTP {X 1,Y 2,Z 3,A 0,B 0,C 0}\n");
      m.Say("  BAS(#INITMOV,0)\n  $TOOL=$NULLFRAME\n  PTP {").Joints();
      m.Say("}\n  PTP {E6POS: ").Pose().Say("} C_PTP\n");
      if (i % 2 == 0) {
        m.Say("  $BASE={FRAME: " + KrlPose(base, 12) + "}\n").UseFrame(base);
      } else {
        m.Say("  BAS(#BASE,2)\n").UseFrame(base);
      }
      m.Say("  LIN {").Pose().Say("} C_DIS\n  CIRC {").Pose().Say("},{");
      m.Pose().Say("}\n  LIN_REL {X 10.0,Z -5}\n  target={").Pose();
      m.Say("}\n  SLIN target\n  BAS(#BASE,0)\nEND\n");
    };
    return l;
  }();
  return *language;
}

inline std::string RapidPose(const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  const Eigen::Vector3d t = pose.translation() * 1e3;
  return "[" + Number(t.x(), 4) + "," + Number(t.y(), 4) + "," +
         Number(t.z(), 4) + "],[" + Number(q.w(), 9) + "," + Number(q.x(), 9) +
         "," + Number(q.y(), 9) + "," + Number(q.z(), 9) + "]";
}

inline const Language& Rapid() {
  static const auto* const language = [] {
    auto* l = new Language{"RAPID", "irb120", "part.mod", 1e-7, 1e-8,
                           {},      {},       kDegree,    {}};
    l->write = [](const Position& p) {
      if (p.is_joints) {
        std::vector<std::string> parts;
        for (const double q : p.joints) parts.push_back(Number(q / kDegree, 6));
        return "[" + Joined(parts, ",") + "]";
      }
      const auto quadrant = [&](int j) {
        return std::to_string(
            static_cast<int>(std::floor(p.joints[j] / (90.0 * kDegree))));
      };
      return RapidPose(p.pose) + ",[" + quadrant(0) + "," + quadrant(3) + "," +
             quadrant(5) + ",0]";
    };
    l->read = [](const std::vector<double>& n) {
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      pose.translation() = Eigen::Vector3d(n[0], n[1], n[2]) * 1e-3;
      pose.linear() = Eigen::Quaterniond(n[3], n[4], n[5], n[6])
                          .normalized()
                          .toRotationMatrix();
      return pose;
    };
    l->make = [l](int i, Random* random, const Arm& arm, Program* program) {
      ProgramMaker m(*l, arm, random, program);
      const std::string none = ",[9E9,9E+09,9E9,9E9,9E9,9E9]]";
      Eigen::Isometry3d tool = Frame(0.02, -0.01, 0.12, 0.3);
      Eigen::Isometry3d base = Frame(0.1, 0.2, 0.05, -0.2);
      m.Say(
          "MODULE part\n  ! CONST robtarget p0:=[[1,2,3],[1,0,0,0],[0,0,0,"
          "0],[9E9,9E9,9E9,9E9,9E9,9E9]];\n");
      // As rounded as they stand in the program.
      const auto rounded = [&](const Eigen::Isometry3d& frame) {
        return l->read(NumbersIn(RapidPose(frame)));
      };
      tool = rounded(tool);
      base = rounded(base);
      m.Say("  PERS tooldata gun:=[TRUE,[" + RapidPose(tool) +
            "],[1,[0,0,50],[1,0,0,0],0,0,0]];\n");
      m.Say("  PERS wobjdata fixture:=[FALSE,TRUE,\"\",[" + RapidPose(base) +
            "],[[0,0,0],[1,0,0,0]]];\n");
      m.Say("  CONST jointtarget home:=[").Joints().Say(none + ";\n");
      m.Say("  CONST robtarget p10:=[").Pose().Say(none + ";\n");
      m.UseTool(tool).UseFrame(base);
      m.Say("  LOCAL CONST ROBTARGET p20 :=\n    [").Pose().Say(none + ";\n");
      m.Say(
          "  PROC main()\n    MoveAbsJ home\\NoEOffs,v1000,z50,tool0;\n"
          "    MoveJ p10,v1000,z50,tool0;\n"
          "    MoveL p20,v100,fine,gun\\WObj:=fixture;\n    MoveL [");
      m.Pose().Say(none + ",v100,z1,gun\\WObj:=fixture;\n");
      if (i % 2 == 0) {
        m.Say("    MoveL Offs(p20,0,0,50),v100,z1,gun\\WObj:=fixture;\n");
      }
      m.Say(
          "    MoveLDO p20,v100,fine,gun\\WObj:=fixture,do1,1;\n"
          "    TriggL p20,v100,open,fine,gun\\WObj:=fixture;\n"
          "    SearchL \\Stop,di1,found,p20,v10,gun\\WObj:=fixture;\n");
      m.Say("    TPWrite \"[[1,2,3]]\";\n  ENDPROC\nENDMODULE\n");
    };
    return l;
  }();
  return *language;
}

inline const Language& Fanuc() {
  static const auto* const language = [] {
    auto* l = new Language{"Fanuc", "irb120", "PART.LS", 1e-6, 1e-3 * kDegree,
                           {},      {},       kDegree,   {}};
    const auto wide = [](double value) {
      const std::string text = Number(value, 3);
      return std::string(10 - text.size(), ' ') + text;
    };
    l->write = [wide](const Position& p) {
      std::vector<std::string> parts;
      if (p.is_joints) {
        for (int j = 0; j < 6; ++j) {
          parts.push_back("\tJ" + std::to_string(j + 1) + "=" +
                          wide(p.joints[j] / kDegree) + " deg");
        }
        return Joined(parts, ",");
      }
      const Eigen::Vector3d rpy = RollPitchYaw(p.pose.linear()) / kDegree;
      for (int k = 0; k < 3; ++k) {
        parts.push_back(std::string("\t") + "XYZ"[k] + " =" +
                        wide(p.pose.translation()[k] * 1e3) + "  mm");
      }
      for (int k = 0; k < 3; ++k) {
        parts.push_back(std::string("\t") + "WPR"[k] + " =" + wide(rpy[k]) +
                        " deg");
      }
      return Joined(parts, ",");
    };
    l->read = [](const std::vector<double>& n) {
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      pose.translation() = Eigen::Vector3d(n[0], n[1], n[2]) * 1e-3;
      pose.linear() =
          FromRollPitchYaw(n[3] * kDegree, n[4] * kDegree, n[5] * kDegree);
      return pose;
    };
    l->make = [l](int i, Random* random, const Arm& arm, Program* program) {
      ProgramMaker m(*l, arm, random, program);
      const std::string end = i % 3 == 0 ? "\r\n" : "\n";
      m.Say("/PROG  PART" + end + "/MN" + end + "   1:J P[1] 100% FINE    ;" +
            end + "   2:L P[2:\"weld {X = 1}\"] 100mm/sec CNT50    ;" + end);
      if (i % 2 == 0) {
        m.Say("   3:L P[2] 100mm/sec FINE Offset,PR[1]    ;" + end);
      }
      m.Say("/POS" + end + "P[1]{" + end + "   GP1:" + end +
            "\tUF : 0, UT : 1,\t" + end);
      m.Joints().Say(end);
      if (i % 2 == 1) {
        m.Say("   GP2:" + end + "\tUF : 0, UT : 1,\t" + end +
              "\tJ1=   100.000  mm" + end);
      }
      m.Say("};" + end);
      m.UseTool(Frame(0.02, -0.01, 0.12, 0.3));
      for (int k = 2; k < 5; ++k) {
        if (k == 3) m.UseFrame(Frame(0.1, 0.2, 0.05, -0.2));
        m.Say("P[" + std::to_string(k) + (k == 2 ? ":\"weld\"" : "") + "]{" +
              end + "   GP1:" + end + "\tUF : " + (k < 3 ? "0" : "2") +
              ", UT : 1,\t\tCONFIG : 'N U T, 0, 0, 0'," + end);
        m.Pose().Say(end + "};" + end);
      }
      m.Say("/END" + end);
    };
    return l;
  }();
  return *language;
}

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_CLI_PROGRAM_LANGUAGES_H_
