#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "alidade/error.h"
#include "alidade/parameter_layout.h"
#include "alidade/units.h"
#include "src/common/files.h"
#include "src/serialization/config_file.h"
#include "src/serialization/job_config.h"
#include "tests/support/config_files.h"
#include "tests/support/io_test_util.h"

namespace alidade::internal {
namespace {

namespace fs = std::filesystem;

TEST(DetectFormatTest, TellsEveryFormat) {
  const ConfigFiles files;
  const TestDirectory& directory = files.directory();
  EXPECT_EQ(DetectFormat(directory.Path("arm.yaml")), FileFormat::kArm);
  EXPECT_EQ(DetectFormat(directory.Path("deviations.yaml")),
            FileFormat::kDeviations);
  EXPECT_EQ(DetectFormat(files.job()), FileFormat::kJob);
  EXPECT_EQ(DetectFormat(files.simulation()), FileFormat::kSimulation);
}

TEST(DetectFormatTest, RefusesWhatHasNoFormat) {
  const TestDirectory directory;
  const std::string path = directory.Write("x.yaml", "a: 1\nb: 2\n");
  ExpectInputError([&] { DetectFormat(path); },
                   {1, 1, "", "expected a map with the key \"format\""});
  directory.Write("x.yaml", "a: 1\nformat: alidade-robot-1\n");
  ExpectInputError([&] { DetectFormat(path); },
                   {2, 9, "format", "unknown format \"alidade-robot-1\""});
  directory.Write("x.yaml", "format: [1]\n");
  ExpectInputError([&] { DetectFormat(path); },
                   {1, 9, "format", "expected text, found a list"});
}

TEST(LoadJobTest, ReadsTheDataAndWhatIsKnown) {
  const ConfigFiles files;
  const JobConfig job = LoadJob(files.job());
  EXPECT_EQ(job.path, files.job());
  EXPECT_EQ(job.title, "A test");
  EXPECT_EQ(job.arm.name, "two joints");
  EXPECT_EQ(job.data.training.num_poses(), 2);
  EXPECT_TRUE((job.data.training.sigmas().map().array() == 2e-5).all());
  ASSERT_TRUE(job.data.validation.has_value());
  EXPECT_EQ(job.data.validation->positions(), job.data.training.positions());
  ASSERT_TRUE(job.options.true_values.has_value());
  const ParameterLayout layout(2);
  const Eigen::VectorXd deviations =
      *job.options.true_values - layout.Values(job.arm);
  EXPECT_NEAR(deviations[*layout.Find("r1")], 0.0005, 1e-16);
  EXPECT_NEAR(deviations[*layout.Find("alpha2")], 0.002, 1e-15);
  EXPECT_NEAR(deviations.cwiseAbs().sum(), 0.0025, 1e-15);
}

TEST(LoadJobTest, ReadsTheIdentifiabilityOptions) {
  const JobConfig job = LoadJob(ConfigFiles().job());
  const IdentifiabilityOptions& options = job.options.identifiability;
  EXPECT_EQ(options.fix, (std::vector<std::string>{"alpha2", "d1"}));
  EXPECT_TRUE(options.proceed_beyond_rank);
  EXPECT_EQ(options.angle_tolerance, 0.0005);
  EXPECT_EQ(options.relative_tolerance, 1e-8);
  EXPECT_EQ(options.perturbation, 0.02);
  EXPECT_EQ(options.seed, 7U);
}

TEST(LoadJobTest, ReadsTheSolverAndItsLimits) {
  const JobConfig job = LoadJob(ConfigFiles().job());
  EXPECT_EQ(job.options.solver, SolverName::kPseudoInverse);
  EXPECT_EQ(job.options.solver_options.max_iterations, 12);
  EXPECT_EQ(job.options.solver_options.function_tolerance, 1e-14);
  EXPECT_EQ(job.options.solver_options.precision_limit_factor, 2.0);
  EXPECT_EQ(job.options.solver_options.wanted_precision, 1e-6);
  EXPECT_EQ(job.options.solver_options.initial_trust_region_radius, 1e6);
  EXPECT_EQ(job.options.solver_options.pseudo_inverse_tolerance, 1e-9);
  EXPECT_EQ(job.options.compare_with,
            std::vector<SolverName>{SolverName::kCeres});
  EXPECT_EQ(job.options.acceptance.train_rms, 1e-4);
  EXPECT_EQ(job.options.acceptance.train_max, 2e-4);
  EXPECT_EQ(job.options.acceptance.validation_rms, 3e-4);
  EXPECT_EQ(job.options.acceptance.validation_max, 4e-4);
}

// Jobs that were written for earlier versions keep loading.
TEST(LoadJobTest, TakesFormerNames) {
  const JobConfig limit =
      LoadJob(ConfigFiles({"validation_max", "heldout_max"}).job());
  EXPECT_EQ(limit.options.acceptance.validation_max, 4e-4);
  const JobConfig factor = LoadJob(
      ConfigFiles({"precision_limit_factor", "rounding_floor_factor"}).job());
  EXPECT_EQ(factor.options.solver_options.precision_limit_factor, 2.0);
}

TEST(LoadJobTest, RefusesBothNamesOfOneKey) {
  const ConfigFiles files(
      {"validation_max: 0.4", "validation_max: 0.4, heldout_max: 0.4"});
  try {
    LoadJob(files.job());
    ADD_FAILURE() << "no error";
  } catch (const InputError& error) {
    EXPECT_EQ(error.location().key, "acceptance.heldout_max");
    EXPECT_EQ(error.message(),
              "is the former name of validation_max, which is there too: "
              "remove one");
  }
}

TEST(LoadJobTest, ReadsTheEvaluation) {
  EXPECT_EQ(LoadJob(ConfigFiles().job()).options.solver_options.evaluation,
            Evaluation::kAutomatic);
  for (const auto& [name, evaluation] :
       {std::pair("auto", Evaluation::kAutomatic),
        std::pair("autodiff", Evaluation::kAutodiff),
        std::pair("reduced", Evaluation::kReduced),
        std::pair("compressed", Evaluation::kReduced)}) {
    const ConfigFiles files({"  max_iterations: 12\n",
                             std::string("  evaluation: ") + name + "\n"});
    EXPECT_EQ(LoadJob(files.job()).options.solver_options.evaluation,
              evaluation);
  }
}

TEST(LoadJobTest, ReadsThePublishedStudy) {
  const JobConfig job = LoadJob(ConfigFiles().job());
  ASSERT_TRUE(job.published.has_value());
  EXPECT_EQ(job.published->source, "A study");
  EXPECT_EQ(job.published->deviations[*ParameterLayout(2).Find("r1")], 4e-4);
  EXPECT_EQ(job.published->deviations.cwiseAbs().sum(), 4e-4);
  EXPECT_EQ(job.published->angle_decimals, 3);
  EXPECT_EQ(job.published->length_decimals, 2);
  EXPECT_EQ(job.published->baseline_iterations, 5);
  EXPECT_EQ(job.published->baseline_time_s, 60.5);
  ASSERT_EQ(job.published->figures.size(), 1U);
  EXPECT_EQ(job.published->figures[0].quantity, "after_max");
  EXPECT_EQ(job.published->figures[0].published, "1 mm");
}

TEST(LoadJobTest, ListsEveryFileItRead) {
  const ConfigFiles files;
  std::vector<std::string> expected = {files.job()};
  for (const char* name :
       {"arm.yaml", "data.csv", "validation.csv", "deviations.yaml"}) {
    expected.push_back(files.directory().Path(name));
  }
  EXPECT_EQ(LoadJob(files.job()).input_files, expected);
}

TEST(LoadJobTest, ListsTheUrdfOfItsArm) {
  const ConfigFiles files;
  const TestDirectory& directory = files.directory();
  directory.Write("arm.urdf",
                  "<robot><link name='a'/><link name='b'/><link name='c'/>"
                  "<joint name='j' type='continuous'><parent link='a'/>"
                  "<child link='b'/><axis xyz='0 0 1'/></joint>"
                  "<joint name='k' type='prismatic'><parent link='b'/>"
                  "<child link='c'/><axis xyz='1 0 0'/>"
                  "<limit lower='0' upper='1'/></joint></robot>");
  directory.Write("arm.yaml",
                  "format: alidade-arm-1\nname: x\n"
                  "units: {length: mm, angle: deg}\n"
                  "urdf: {file: arm.urdf, base_link: a, tip_link: c}\n");
  const JobConfig job = LoadJob(files.job());
  EXPECT_EQ(job.input_files.at(2), directory.Path("arm.urdf"));
}

TEST(LoadJobTest, NeedsOnlyAnArmAndData) {
  const ConfigFiles files;
  const std::string path = files.directory().Write(
      "short.yaml",
      "format: alidade-job-1\ntitle: Short\n"
      "units: {length: m, angle: rad}\narm: arm.yaml\ndata: data.csv\n"
      "measurement: {sigma: 0.001}\n");
  const JobConfig job = LoadJob(path);
  EXPECT_EQ(job.options.solver, SolverName::kCeres);
  EXPECT_EQ(job.options.solver_options.max_iterations,
            SolverOptions().max_iterations);
  EXPECT_EQ(job.options.identifiability.seed, IdentifiabilityOptions().seed);
  EXPECT_TRUE(job.options.compare_with.empty());
  EXPECT_FALSE(job.data.validation || job.options.true_values || job.published);
  EXPECT_FALSE(job.options.acceptance.train_rms ||
               job.options.acceptance.train_max);
}

class LoadJobErrorTest : public ::testing::TestWithParam<ConfigErrorCase> {};

TEST_P(LoadJobErrorTest, NamesLineColumnKeyAndWhatWasExpected) {
  const ConfigFiles files(GetParam().edit);
  ExpectInputError([&] { LoadJob(files.job()); }, GetParam().expected);
}

INSTANTIATE_TEST_SUITE_P(
    Jobs, LoadJobErrorTest,
    ::testing::Values(
        ConfigErrorCase{"UnknownKey",
                        {"truth:", "thruth:"},
                        {7, 1, "thruth", "did you mean \"truth\"?"}},
        ConfigErrorCase{"NoTitle",
                        {"title: A test\n", ""},
                        {1, 1, "title", "missing, expected this key"}},
        ConfigErrorCase{"NoSigma",
                        {"{sigma: 0.02}", "{}"},
                        {6, 14, "measurement.sigma", "missing"}},
        ConfigErrorCase{
            "ZeroSigma",
            {"sigma: 0.02", "sigma: 0"},
            {6, 22, "measurement.sigma", "expected a length above 0, found 0"}},
        ConfigErrorCase{"UnknownMethod",
                        {"method: rules", "method: svd"},
                        {10, 11, "identifiability.method",
                         "unknown method \"svd\", expected one of rules"}},
        ConfigErrorCase{"UnknownFix",
                        {"[alpha2, d1]", "[alpha2, dd1]"},
                        {11, 17, "identifiability.fix[2]",
                         "unknown parameter \"dd1\", did you mean \"d1\"?"}},
        ConfigErrorCase{"RepeatedFix",
                        {"[alpha2, d1]", "[d1, d1]"},
                        {11, 13, "identifiability.fix[2]", "is repeated"}},
        ConfigErrorCase{"InvalidOption",
                        {"perturbation: 0.02", "perturbation: -1"},
                        {15, 17, "identifiability.perturbation",
                         "expected a number above 0 and below 0.5, found -1"}},
        ConfigErrorCase{"UnknownSolver",
                        {"pseudo_inverse\n", "cere\n"},
                        {18, 9, "solver.name",
                         "unknown solver \"cere\", did you mean \"ceres\"?"}},
        ConfigErrorCase{"NoIterations",
                        {"max_iterations: 12", "max_iterations: 0"},
                        {19, 19, "solver.max_iterations",
                         "expected an integer of 1 or more, found 0"}},
        ConfigErrorCase{"SolverTwice",
                        {"[ceres]", "[pseudo_inverse]"},
                        {25, 16, "compare_with[1]", "runs already"}},
        ConfigErrorCase{"ComparedTwice",
                        {"[ceres]", "[ceres, ceres]"},
                        {25, 23, "compare_with[2]",
                         "\"ceres\" is repeated, expected each solver once"}},
        ConfigErrorCase{"NegativeLimit",
                        {"train_max: 0.2", "train_max: -1"},
                        {26, 41, "acceptance.train_max",
                         "expected a length above 0, found -1"}},
        ConfigErrorCase{
            "ValidationWithoutValidation",
            {"validation: {data: validation.csv}\n", ""},
            {25, 62, "acceptance.validation_rms", "add \"validation\""}},
        ConfigErrorCase{"ValidationIsText",
                        {"{data: validation.csv}", "validation.csv"},
                        {8, 13, "validation", "expected a map of data"}},
        ConfigErrorCase{"UnknownPublished",
                        {"{r1: 0.4}", "{r9: 0.4}"},
                        {29, 16, "published.deviations.r9", "unknown key"}},
        ConfigErrorCase{"TooManyDecimals",
                        {"angle_decimals: 3", "angle_decimals: 99"},
                        {30, 19, "published.angle_decimals",
                         "expected an integer from 0 to 15, found 99"}},
        ConfigErrorCase{"NoBaselineTime",
                        {", time_s: 60.5", ""},
                        {32, 13, "published.baseline.time_s", "missing"}},
        ConfigErrorCase{"ZeroBaselineTime",
                        {"time_s: 60.5", "time_s: 0"},
                        {32, 37, "published.baseline.time_s",
                         "expected a number above 0, found 0"}},
        ConfigErrorCase{"UnknownQuantity",
                        {"after_max", "after_maxx"},
                        {34, 18, "published.figures[1].quantity",
                         "unknown quantity \"after_maxx\", did you mean"}},
        ConfigErrorCase{
            "RepeatedQuantity",
            {"published: 1 mm}\n",
             "published: 1 mm}\n"
             "    - {quantity: after_max, published: 2 mm}\n"},
            {35, 18, "published.figures[2].quantity", "is repeated"}},
        ConfigErrorCase{
            "MissingData",
            {"data: data.csv", "data: none.csv"},
            {5, 7, "data", "none.csv: cannot be read: No such file"}},
        ConfigErrorCase{
            "MissingArm",
            {"arm: arm.yaml", "arm: none.yaml"},
            {4, 6, "arm", "none.yaml: cannot be read: No such file"}},
        ConfigErrorCase{"ArmIsDirectory",
                        {"arm: arm.yaml", "arm: ."},
                        {4, 6, "arm", "cannot be read: Is a directory"}},
        ConfigErrorCase{"ArmIsOtherFormat",
                        {"arm: arm.yaml", "arm: deviations.yaml"},
                        {1, 9, "format", "job.yaml:4: arm)"}}),
    CaseName);

TEST(LoadJobTest, NamesBothFilesWhereJointCountsDiffer) {
  const ConfigFiles files;
  const std::string data = files.directory().Write(
      "data.csv", "# c\nq1_deg,q2_mm,q3_deg,x_mm,y_mm,z_mm\n1,2,3,4,5,6\n");
  try {
    LoadJob(files.job());
    FAIL() << "expected an InputError";
  } catch (const InputError& error) {
    EXPECT_EQ(error.location().file, data);
    EXPECT_EQ(error.location().line, 2);
    EXPECT_EQ(error.message(),
              "data set has 3 joints, arm \"two joints\" has 2 (named in " +
                  files.job() + ":5: data, for the arm of " +
                  files.directory().Path("arm.yaml") + ")");
  }
}

TEST(LoadJobTest, NamesTheFileThatAnErrorIsIn) {
  const ConfigFiles files;
  const std::string path = files.directory().Write(
      "deviations.yaml",
      "format: alidade-deviations-1\nunits: {length: mm, angle: rad}\n"
      "deviations: {r3: 1}\n");
  try {
    LoadJob(files.job());
    FAIL() << "expected an InputError";
  } catch (const InputError& error) {
    EXPECT_EQ(error.location().file, path);
    EXPECT_EQ(error.location().key, "deviations.r3");
  }
}

// The smallest job, with `more` after it.
std::string WriteJob(const TestDirectory& directory, const std::string& data,
                     const std::string& more = "") {
  directory.Write("arm.yaml", kArmText);
  return directory.Write("job.yaml",
                         "format: alidade-job-1\n"
                         "title: A test\n"
                         "units: {length: mm, angle: deg}\n"
                         "arm: arm.yaml\n"
                         "measurement: {sigma: 0.02}\n" +
                             data + more);
}

TEST(LoadJobTest, ReadsForeignHeaders) {
  const TestDirectory directory;
  directory.Write("foreign.csv",
                  "id,axis1_deg,q1_deg,slide_m,probe_x_mm,py_mm,pz_m,q9\n"
                  "first,10,99,0.1,1,2,0.003,\n");
  const JobConfig job = LoadJob(WriteJob(
      directory,
      "data:\n"
      "  file: foreign.csv\n"
      "  columns: {joints: [axis1_deg, slide_m], position: [probe_x_mm, py_mm, "
      "pz_m]}\n"));
  EXPECT_NEAR(job.data.training.joint_values(0, 0), 10.0 * kDegree, 1e-15);
  EXPECT_EQ(job.data.training.joint_values(1, 0), 0.1);
  EXPECT_EQ(job.data.training.positions().col(0),
            Eigen::Vector3d(0.001, 0.002, 0.003));
  EXPECT_EQ(job.data.training.sigmas()(2, 0), 2e-5);
}

TEST(LoadJobTest, NamesTheForeignHeaderThatIsMissing) {
  const TestDirectory directory;
  directory.Write("foreign.csv", "a_deg,q2_mm,x_mm,y_mm,z_mm\n1,2,3,4,5\n");
  const std::string job = WriteJob(
      directory,
      "data: {file: foreign.csv, columns: {joints: [b_deg, q2_mm]}}\n");
  ExpectInputError([&] { LoadJob(job); },
                   {1, 0, "b_deg",
                    "column is missing, expected b_deg, did you mean "
                    "\"a_deg\"? The columns are a_deg, q2_mm, x_mm, y_mm, "
                    "z_mm (named in"});
}

TEST(LoadJobTest, HoldsOutAFractionOfTheConfigurations) {
  const TestDirectory directory;
  std::string text = "q1_deg,q2_mm,x_mm,y_mm,z_mm\n";
  for (int i = 0; i < 20; ++i) {
    text += std::to_string(i / 2) + ",100,1,2,3\n";
  }
  directory.Write("data.csv", text);
  const JobConfig job = LoadJob(WriteJob(
      directory, "data: data.csv\n", "validation: {fraction: 0.3, seed: 4}\n"));
  EXPECT_EQ(job.data.training.num_poses(), 14);
  ASSERT_TRUE(job.data.validation.has_value());
  EXPECT_EQ(job.data.validation->num_poses(), 6);
  EXPECT_EQ(job.options.holdout->seed, 4U);
}

TEST(LoadJobTest, RefusesFractionsThatLeaveNothing) {
  const TestDirectory directory;
  directory.Write("data.csv", kDataText);
  const std::string path =
      WriteJob(directory, "data: data.csv\n", "validation: {fraction: 1.5}\n");
  ExpectInputError([&] { LoadJob(path); },
                   {7, 24, "validation.fraction", "above 0 and below 1"});
  WriteJob(directory, "data: data.csv\n", "validation: {fraction: 0.01}\n");
  ExpectInputError([&] { LoadJob(path); },
                   {7, 24, "validation.fraction", "no configuration"});
  WriteJob(directory, "data: data.csv\n",
           "validation: {fraction: 0.5, data: data.csv}\n");
  ExpectInputError([&] { LoadJob(path); }, {7, 13, "validation", "not both"});
}

TEST(LoadJobTest, ReadsLossAndSigmaToEstimate) {
  const TestDirectory directory;
  directory.Write("data.csv", kDataText);
  const std::string path =
      WriteJob(directory, "data: data.csv\n", "robust: {loss: cauchy}\n");
  EXPECT_EQ(LoadJob(path).options.loss, LossKind::kCauchy);
  EXPECT_FALSE(LoadJob(path).options.estimate_sigma);
  std::string text = ReadFile(path);
  directory.Write("job.yaml", Apply(text, {"sigma: 0.02", "sigma: estimate"}));
  EXPECT_TRUE(LoadJob(path).options.estimate_sigma);
  WriteJob(directory, "data: data.csv\n",
           "robust: {loss: tukey}\nsolver: {name: pseudo_inverse}\n");
  ExpectInputError([&] { LoadJob(path); },
                   {7, 16, "robust.loss", "least squares"});
}

TEST(LoadJobTest, ReadsUncertaintyAndMonteCarlo) {
  const TestDirectory directory;
  directory.Write("data.csv", kDataText);
  const JobConfig job = LoadJob(WriteJob(
      directory, "data: data.csv\n",
      "uncertainty: {confidence: 0.99, intervals: profile, map: 0, seed: 7}\n"
      "montecarlo: {trials: 50, seed: 3, truth: priors, precision: 0.01,\n"
      "  outliers: {fraction: 0.05, size: 2}, workspace_poses: 9,\n"
      "  joint_repeatability: {length: 0.01}}\n"));
  EXPECT_EQ(job.options.uncertainty.confidence, 0.99);
  EXPECT_EQ(job.options.uncertainty.intervals, IntervalMethod::kProfile);
  EXPECT_EQ(job.options.uncertainty.map_configurations, 0);
  EXPECT_EQ(job.options.uncertainty.seed, 7u);
  EXPECT_EQ(job.montecarlo.trials, 50);
  EXPECT_EQ(job.montecarlo.seed, 3u);
  EXPECT_EQ(job.montecarlo.truth, SimulatedTruth::kPriors);
  EXPECT_EQ(job.montecarlo.outlier_fraction, 0.05);
  EXPECT_NEAR(job.montecarlo.outlier_size, 2e-3, 1e-18);
  EXPECT_NEAR(job.montecarlo.joint_length_sigma, 1e-5, 1e-20);
  EXPECT_EQ(job.montecarlo.joint_angle_sigma, 0.0);
  EXPECT_EQ(job.montecarlo.workspace_poses, 9);
  EXPECT_EQ(job.montecarlo.precision, 0.01);
}

TEST(LoadJobTest, RefusesWrongUncertaintyAndMonteCarlo) {
  const TestDirectory directory;
  directory.Write("data.csv", kDataText);
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"uncertainty: {confidence: 1.5}\n", "above 0 and below 1, found 1.5"},
      {"uncertainty: {intervals: wide}\n", "wide"},
      {"uncertainty: {nonlinearity_limit: 0}\n", "above 0"},
      {"montecarlo: {trials: 1}\n", "montecarlo.trials"},
      {"montecarlo: {truth: given}\n", "`truth`"},
      {"montecarlo: {outliers: {fraction: 0.1}}\n", "size"},
      {"montecarlo: {trial: 5}\n", "trial"}};
  for (const auto& [section, part] : cases) {
    const std::string path = WriteJob(directory, "data: data.csv\n", section);
    try {
      LoadJob(path);
      ADD_FAILURE() << section << " was taken";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos)
          << error.what();
      EXPECT_GT(error.location().line, 0);
    }
  }
}

TEST(LoadJobTest, FindsDataByAnEnvironmentVariable) {
  const TestDirectory directory;
  directory.Write("data.csv", kDataText);
  const std::string path =
      WriteJob(directory, "data: \"${ALIDADE_TEST_DIRECTORY}/data.csv\"\n");
  ASSERT_EQ(unsetenv("ALIDADE_TEST_DIRECTORY"), 0);
  ExpectInputError([&] { LoadJob(path); }, {6, 7, "data", "is not set"});
  const std::string parent =
      fs::path(directory.Path("data.csv")).parent_path().string();
  ASSERT_EQ(setenv("ALIDADE_TEST_DIRECTORY", parent.c_str(), 1), 0);
  EXPECT_EQ(LoadJob(path).data.training.num_poses(), 2);
  unsetenv("ALIDADE_TEST_DIRECTORY");
}

}  // namespace
}  // namespace alidade::internal
