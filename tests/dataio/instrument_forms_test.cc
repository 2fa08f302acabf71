// The forms of well-known instruments' exports, with joint values beside them,
// as people paste them together: made up here after the makers' manuals.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "alidade/units.h"
#include "src/dataio/dataset_csv.h"
#include "tests/support/io_test_util.h"

namespace alidade::internal {
namespace {

struct Form {
  const char* name;
  std::string text;
  std::vector<std::string> joints;
  std::vector<std::string> position;
  std::vector<std::string> orientation = {};
  std::vector<std::string> missing = {};
};

void PrintTo(const Form& form, std::ostream* out) { *out << form.name; }

class InstrumentFormTest : public ::testing::TestWithParam<Form> {};

// All of them say the same: joints at 12.5 and -45 degrees, then at 1 and 2,
// and the target at 1234.5, -200.25, 0.125 mm, then lost.
TEST_P(InstrumentFormTest, IsReadRight) {
  const Form& form = GetParam();
  const TestDirectory directory;
  Arm arm;
  arm.name = "two";
  arm.joints.resize(2);
  DataFormat format;
  format.ignore_others = true;
  format.columns.joints = form.joints;
  format.columns.position = form.position;
  format.columns.orientation = form.orientation;
  format.dialect.missing = form.missing;
  format.length_unit = FindUnit("mm");
  format.angle_unit = FindUnit("deg");
  References references;
  const LoadedData loaded = LoadData(directory.Write("data.txt", form.text),
                                     arm, format, &references);
  const Dataset& data = loaded.data;
  ASSERT_EQ(data.num_poses(), 1);
  EXPECT_EQ(loaded.rejected.size(), 1U);
  EXPECT_NEAR(data.joint_values(0, 0), 12.5 * kDegree, 1e-14);
  EXPECT_NEAR(data.joint_values(1, 0), -45.0 * kDegree, 1e-14);
  const ObservationBlock& block = data.blocks.at(0);
  EXPECT_NEAR(block.measured(0, 0), 1.2345, 1e-15);
  EXPECT_NEAR(block.measured(1, 0), -0.20025, 1e-15);
  EXPECT_NEAR(block.measured(2, 0), 0.000125, 1e-15);
  if (form.orientation.empty()) return;
  EXPECT_NEAR(block.measured(5, 0), 0.5 * kPi, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(
    Forms, InstrumentFormTest,
    ::testing::Values(
        Form{"SpatialAnalyzer",
             "// SA 2021.1.0713.5\n// Working frame: A::WORLD\n"
             "// X Y Z, millimeters\n"
             "A::Points p1 12.5 -45.0 1.2345000E+03 -2.0025000E+02 "
             "1.25000E-01\n"
             "A::Points p2 1.0 2.0 NaN NaN NaN\n",
             {"3", "4"},
             {"5", "6", "7"}},
        Form{"Tracker",
             "\xef\xbb\xbfProject;Cell 7;;;;;\r\nDate;29.11.2026;;;;;\r\n;;;;;;"
             "\r\nPoint Id;J1;J2;X [mm];Y [mm];Z [mm];RMS [mm]\r\n"
             "P1;12,5;-45;1.234,5000;-200,2500;0,1250;0,008\r\n"
             "P2;1;2;---;---;---;---\r\n",
             {"J1", "J2"},
             {"X", "Y", "Z"}},
        Form{"MeasuringArm",
             "Name\tNominal\t\t\tMeasured\t\t\tA1\tA2\n"
             "\tX\tY\tZ\tX\tY\tZ\tdeg\tdeg\n"
             "p1\t1234\t-200\t0\t1234.5\t-200.25\t0.125\t12.5\t-45\n"
             "p2\t1\t2\t3\t\t\t\t1\t2\n",
             {"A1 deg", "A2 deg"},
             {"Measured X", "Measured Y", "Measured Z"}},
        Form{"TimesAmongUnits",
             "Messung\n\nZeit;Pkt;Achse1 Soll;Achse2 Soll;X;Y;Z\n"
             "hh:mm:ss;;\xc2\xb0;\xc2\xb0;mm;mm;mm\n"
             "10:00:01;1;12,5;-45;1234,5;-200,25;0,125\n"
             "10:00:02;2;1;2;;;\n",
             {"Achse1 Soll", "Achse2 Soll"},
             {"X", "Y", "Z"}},
        Form{"UnknownAmongUnits",
             "Text;A 1;A 2;X;Y;Z\nfree;deg;deg;mm;mm;mm\n"
             "a;12,5;-45;1234,5;-200,25;0,125\nb;1;2;;;\n",
             {"A 1", "A 2"},
             {"X", "Y", "Z"}},
        Form{"MotionCapture",
             "Format Version,1.23,Take Name,Take 1,Export Frame Rate,120\n\n"
             ",,,,Rotation,Rotation,Rotation,Rotation,Position,Position,"
             "Position\n"
             "Frame,Time (Seconds),J1,J2,X,Y,Z,W,X,Y,Z\n"
             "0,0.000000,12.5,-45,0,0,0.70710678,0.70710678,1234.5,-200.25,"
             "0.125\n"
             "1,0.008333,1,2,,,,,,,\n",
             {"J1", "J2"},
             {"Position X", "Position Y", "Position Z"},
             {"Rotation W", "Rotation X", "Rotation Y", "Rotation Z"}},
        Form{"Trajectories",
             "Trajectories\n100\n,,Robot:Flange,,,,\n"
             "Frame,Sub Frame,X,Y,Z,J1,J2\n,,mm,mm,mm,deg,deg\n"
             "1,0,1234.5,-200.25,0.125,12.5,-45\n2,0,,,,1,2\n",
             {"J1", "J2"},
             {"X", "Y", "Z"}},
        Form{"Inspection",
             "sep=;\n\"Object\";\"Axis 1\";\"Axis 2\";\"Meas X\";\"Meas Y\";"
             "\"Meas Z\";\n\"p;1\";\"12.5\";\"-45.0\";\"1234.5\";\"-200.25\";"
             "\"0.125\";\n\"p2\";\"1\";\"2\";\"-9999.0\";\"-9999\";"
             "\"-9999.00\";\n",
             {"Axis 1", "Axis 2"},
             {"Meas X", "Meas Y", "Meas Z"},
             {},
             {"-9999"}},
        Form{"NumPy",
             "# q1, q2, x, y, z\n"
             "1.250000000000000000e+01 -4.500000000000000000e+01 "
             "1.234500000000000000e+03 -2.002500000000000000e+02 "
             "1.250000000000000000e-01\n"
             "1.0e+00 2.0e+00 nan nan nan\n",
             {"1", "2"},
             {"3", "4", "5"}},
        Form{"GermanSpreadsheet",
             "J1 [\xb0]\tJ2 [\xb0]\tX\tY\tZ\r\n"
             "12,5\t-45\t1\xa0"
             "234,50\t-200,25\t0,125\r\n"
             "1\t2\t#NV\t#NV\t#NV\r\n",
             {"J1", "J2"},
             {"X", "Y", "Z"}}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace alidade::internal
