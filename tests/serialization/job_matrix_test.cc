#include "src/serialization/job_matrix.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "alidade/error.h"
#include "src/serialization/job_config.h"
#include "tests/support/config_files.h"
#include "tests/support/io_test_util.h"

namespace alidade::internal {
namespace {

namespace fs = std::filesystem;

constexpr char kFormat[] = "format: alidade-job-1\n";

std::vector<std::string> NamesOf(const JobMatrix& matrix) {
  std::vector<std::string> names;
  for (std::int64_t i = 0; i < matrix.size(); ++i) {
    names.push_back(matrix.NameOf(i));
  }
  return names;
}

class ExtendsTest : public ::testing::Test {
 protected:
  std::string Write(const std::string& text) const {
    return files_.directory().Write("child.yaml", kFormat + text);
  }
  std::string Path(const std::string& name) const {
    return files_.directory().Path(name);
  }

  ConfigFiles files_;
};

TEST_F(ExtendsTest, InheritsWhatIsNotSaidAnew) {
  const JobConfig base = LoadJob(files_.job());
  const JobConfig job =
      LoadJob(Write("extends: job.yaml\n"
                    "title: Another\n"
                    "solver: {max_iterations: 3}\n"
                    "identifiability: {fix: [r1]}\n"));
  EXPECT_EQ(job.title, "Another");
  // Maps are merged: the rest of `solver` is the base's.
  EXPECT_EQ(job.options.solver_options.max_iterations, 3);
  EXPECT_EQ(job.options.solver, base.options.solver);
  EXPECT_EQ(job.options.solver_options.wanted_precision,
            base.options.solver_options.wanted_precision);
  // Lists are replaced, not appended to.
  EXPECT_EQ(job.options.identifiability.fix, std::vector<std::string>{"r1"});
  EXPECT_EQ(job.data.training.positions(), base.data.training.positions());
}

TEST_F(ExtendsTest, AChainOfManyFilesIsRefused) {
  for (int k = 1; k <= 40; ++k) {
    files_.directory().Write("link" + std::to_string(k) + ".yaml",
                             std::string(kFormat) + "extends: link" +
                                 std::to_string(k + 1) + ".yaml\n");
  }
  ExpectInputError([&] { LoadJob(Write("extends: link1.yaml\n")); },
                   {2, 10, "extends", "more than 32 files extend each other"});
}

TEST_F(ExtendsTest, EveryFileIsAnInput) {
  const JobConfig job = LoadJob(Write("extends: job.yaml\n"));
  const std::vector<std::string> first = {Path("child.yaml"), Path("job.yaml"),
                                          Path("arm.yaml")};
  ASSERT_GE(job.input_files.size(), 3U);
  EXPECT_EQ(std::vector<std::string>(job.input_files.begin(),
                                     job.input_files.begin() + 3),
            first);
}

TEST_F(ExtendsTest, PathsAreRelativeToTheFileThatStatesThem) {
  fs::create_directories(Path("below"));
  files_.directory().Write("below/other.csv",
                           "q1_deg,q2_mm,x_mm,y_mm,z_mm\n1,2,7,8,9\n");
  const std::string child = files_.directory().Write(
      "below/child.yaml",
      std::string(kFormat) + "extends: ../job.yaml\ndata: other.csv\n");
  const JobConfig job = LoadJob(child);
  EXPECT_EQ(job.data.training.num_poses(), 1);
  EXPECT_EQ(job.data.training.name, Path("below/other.csv"));
  EXPECT_EQ(job.arm.name, "two joints");
}

TEST_F(ExtendsTest, NullTakesAKeyAway) {
  const JobConfig job =
      LoadJob(Write("extends: job.yaml\ntruth: ~\npublished: null\n"
                    "validation: {data: ~, fraction: 0.5}\n"));
  EXPECT_FALSE(job.options.true_values.has_value());
  EXPECT_FALSE(job.published.has_value());
  EXPECT_TRUE(job.options.holdout.has_value());
}

TEST_F(ExtendsTest, NullThatTakesNothingAwayIsAnError) {
  const std::string path = Write("extends: job.yaml\nsolver: {nme: ~}\n");
  ExpectInputError([&] { LoadJob(path); },
                   {3, 10, "solver.nme", "there is none of this name"});
}

TEST_F(ExtendsTest, AnEmptyValueIsStillAnError) {
  const std::string path = Write("extends: job.yaml\ntruth:\n");
  ExpectInputError([&] { LoadJob(path); },
                   {3, 1, "truth", "expected text, found nothing"});
}

TEST_F(ExtendsTest, ErrorsNameTheFileThatHasThem) {
  const std::string path = Write("extends: job.yaml\nsolver: {nme: ceres}\n");
  ExpectInputError([&] { LoadJob(path); },
                   {3, 10, "solver.nme", "unknown key \"nme\""});
  files_.directory().Write("base.yaml", std::string(kFormat) + "tilte: x\n");
  const std::string child = Write("extends: base.yaml\n");
  try {
    LoadJob(child);
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_EQ(error.location().file, Path("base.yaml"));
    EXPECT_EQ(error.location().line, 2);
  }
}

TEST_F(ExtendsTest, AMissingBaseIsAnErrorAtItsKey) {
  const std::string path = Write("extends: nowhere.yaml\n");
  ExpectInputError([&] { LoadJob(path); },
                   {2, 10, "extends", "nowhere.yaml: cannot be read"});
}

TEST_F(ExtendsTest, OtherUnitsAreRefused) {
  const std::string path =
      Write("extends: job.yaml\nunits: {length: mm, angle: rad}\n");
  ExpectInputError([&] { LoadJob(path); },
                   {3, 28, "units.angle", "expected the same units"});
}

TEST_F(ExtendsTest, ACircleIsAnErrorThatNamesIt) {
  files_.directory().Write("a.yaml", std::string(kFormat) + "extends: b.yaml");
  files_.directory().Write("b.yaml", std::string(kFormat) + "extends: c.yaml");
  files_.directory().Write("c.yaml",
                           std::string(kFormat) + "extends: ./a.yaml");
  try {
    LoadJob(Path("a.yaml"));
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_EQ(error.location().file, Path("c.yaml"));
    EXPECT_EQ(error.location().line, 2);
    EXPECT_NE(
        error.message().find(Path("a.yaml") + " -> " + Path("b.yaml") + " -> " +
                             Path("c.yaml") + " -> " + Path("a.yaml")),
        std::string::npos)
        << error.message();
  }
}

TEST_F(ExtendsTest, AMatrixIsForTheBatch) {
  const std::string path =
      Write("extends: job.yaml\nmatrix: {solver.max_iterations: [1, 2]}\n");
  ExpectInputError([&] { LoadJob(path); },
                   {3, 9, "matrix", "`alidade batch " + path + "`"});
}

using JobMatrixTest = ExtendsTest;

TEST_F(JobMatrixTest, AFileWithoutOneIsOneJob) {
  const JobMatrix matrix(files_.job());
  EXPECT_EQ(matrix.size(), 1);
  EXPECT_EQ(matrix.Load(0, {}).title, "A test");
  // A name that says nothing is that of its folder.
  EXPECT_EQ(JobMatrix::NameOfFile("cells/left.yaml"), "left");
  EXPECT_EQ(JobMatrix::NameOfFile("cells/left/job.yaml"), "left");
  EXPECT_EQ(JobMatrix::NameOfFile("job.yaml"), "job");
  EXPECT_EQ(JobMatrix::NameOfFile("../job.yaml"), "job");
}

TEST_F(JobMatrixTest, EveryCombinationIsAJobLastAxisFastest) {
  const JobMatrix matrix(
      Write("extends: job.yaml\n"
            "matrix:\n"
            "  solver.name: [ceres, pseudo_inverse]\n"
            "  compare_with: [[]]\n"
            "  measurement.sigma: [0.1, 0.25]\n"));
  EXPECT_EQ(NamesOf(matrix),
            (std::vector<std::string>{
                "child/ceres_compare_with-1_sigma-0.1",
                "child/ceres_compare_with-1_sigma-0.25",
                "child/pseudo_inverse_compare_with-1_sigma-0.1",
                "child/pseudo_inverse_compare_with-1_sigma-0.25"}));
  const JobConfig job = matrix.Load(1, {});
  EXPECT_EQ(job.options.solver, SolverName::kCeres);
  EXPECT_TRUE((job.data.training.sigmas().map().array() == 2.5e-4).all());
  EXPECT_EQ(job.options.solver_options.max_iterations, 12);
  EXPECT_EQ(job.title, "A test, ceres_compare_with-1_sigma-0.25");
}

TEST_F(JobMatrixTest, ChangesGoTogetherUnderANameOfOnesOwn) {
  files_.directory().Write("other.csv",
                           "q1_deg,q2_mm,x_mm,y_mm,z_mm\n1,2,7,8,9\n");
  const JobMatrix matrix(
      Write("extends: job.yaml\n"
            "matrix:\n"
            "  cell:\n"
            "    left: {data: data.csv}\n"
            "    right one: {data: other.csv, solver: {max_iterations: 4}}\n"));
  EXPECT_EQ(NamesOf(matrix),
            (std::vector<std::string>{"child/left", "child/right-one"}));
  EXPECT_EQ(matrix.Load(0, {}).data.training.num_poses(), 2);
  const JobConfig right = matrix.Load(1, {});
  EXPECT_EQ(right.data.training.num_poses(), 1);
  EXPECT_EQ(right.options.solver_options.max_iterations, 4);
  EXPECT_EQ(right.options.solver, SolverName::kPseudoInverse);
}

TEST_F(JobMatrixTest, RangesCountFromOneAndSortAsNumbers) {
  const JobMatrix matrix(
      Write("extends: job.yaml\n"
            "matrix: {solver.max_iterations: {range: 10},\n"
            "         identifiability.seed: {range: [7, 8]}}\n"));
  ASSERT_EQ(matrix.size(), 20);
  EXPECT_EQ(matrix.NameOf(0), "child/max_iterations-01_seed-7");
  EXPECT_EQ(matrix.NameOf(19), "child/max_iterations-10_seed-8");
  EXPECT_EQ(matrix.Load(19, {}).options.solver_options.max_iterations, 10);
  EXPECT_EQ(matrix.Load(18, {}).options.identifiability.seed, 7U);
}

TEST_F(JobMatrixTest, FilesGoByTheirNamesWithoutFolders) {
  fs::create_directories(Path("below"));
  files_.directory().Write("below/second.csv", kDataText);
  const JobMatrix matrix(
      Write("extends: job.yaml\nmatrix: {data: [data.csv, below/second.csv]}"));
  EXPECT_EQ(NamesOf(matrix),
            (std::vector<std::string>{"child/data", "child/second"}));
  const JobOutline outline = matrix.OutlineOf(1);
  EXPECT_EQ(outline.arm, Path("arm.yaml"));
  EXPECT_EQ(outline.data, Path("below/second.csv"));
}

TEST_F(JobMatrixTest, FingerprintsFollowWhatIsSaidAndNotHow) {
  const std::string text =
      "extends: job.yaml\nmatrix: {solver.max_iterations: [5, 6]}\n";
  const JobMatrix matrix(Write(text));
  EXPECT_NE(matrix.FingerprintOf(0), matrix.FingerprintOf(1));
  const JobMatrix again(Write("# a comment\n" + text));
  EXPECT_EQ(matrix.FingerprintOf(1), again.FingerprintOf(1));
  files_.directory().Write("job.yaml", Apply(kJobText, {"A test", "B test"}));
  EXPECT_NE(matrix.FingerprintOf(1), JobMatrix(Write(text)).FingerprintOf(1));
}

TEST_F(JobMatrixTest, FingerprintsFollowTheFilesOfAPattern) {
  const std::string path = Write("extends: job.yaml\ndata: data*.csv\n");
  const std::string before = JobMatrix(path).FingerprintOf(0);
  files_.directory().Write("data2.csv", kDataText);
  EXPECT_NE(JobMatrix(path).FingerprintOf(0), before);
}

TEST_F(JobMatrixTest, SimulatedDataAreAskedForWithWhatTheJobSays) {
  const JobMatrix matrix(
      Write("extends: job.yaml\n"
            "data:\n"
            "  simulate:\n"
            "    deviations: deviations.yaml\n"
            "    poses: {file: data.csv}\n"
            "    noise: {sigma: 0.5}\n"
            "    seed: 1\n"
            "matrix: {data.simulate.seed: {range: 3}}\n"));
  const JobConfig job = matrix.Load(2, {});
  EXPECT_EQ(job.data.training.files,
            std::vector<std::string>{"simulated, seed 3"});
  EXPECT_TRUE(
      (job.data.training.sigmas().map().array() - 5e-4).cwiseAbs().maxCoeff() <
      1e-18);
  EXPECT_EQ(matrix.OutlineOf(0).data, "simulated");
  // Another seed is another draw of the noise, of the sigma that was asked for.
  const JobConfig other = matrix.Load(1, {});
  const Eigen::Matrix3Xd difference = job.data.training.positions().map() -
                                      other.data.training.positions().map();
  EXPECT_GT(difference.cwiseAbs().minCoeff(), 0.0);
  EXPECT_LT(difference.cwiseAbs().maxCoeff(), 6.0 * 5e-4);
}

TEST_F(JobMatrixTest, AKeyThatOnlyTheJobsReaderKnowsIsToldAtItsAxis) {
  const JobMatrix matrix(
      Write("extends: job.yaml\nmatrix:\n  solver.nme: [ceres]\n"));
  ExpectInputError([&] { matrix.Load(0, {}); },
                   {4, 3, "solver.nme", "unknown key \"nme\""});
}

struct MatrixErrorCase {
  const char* name;
  std::string matrix;
  ExpectedError expected;
};

void PrintTo(const MatrixErrorCase& error_case, std::ostream* out) {
  *out << error_case.name;
}

class JobMatrixErrorTest : public ::testing::TestWithParam<MatrixErrorCase> {};

TEST_P(JobMatrixErrorTest, NamesLineColumnAndKey) {
  const ConfigFiles files;
  const std::string path = files.directory().Write(
      "child.yaml",
      std::string(kFormat) + "extends: job.yaml\n" + GetParam().matrix);
  ExpectInputError([&] { JobMatrix matrix(path); }, GetParam().expected);
}

INSTANTIATE_TEST_SUITE_P(
    All, JobMatrixErrorTest,
    ::testing::Values(
        MatrixErrorCase{
            "NoMap", "matrix: [1]\n", {3, 9, "matrix", "expected a map"}},
        MatrixErrorCase{
            "Empty", "matrix: {}\n", {3, 9, "matrix", "the map is empty"}},
        MatrixErrorCase{"EmptyList",
                        "matrix:\n  data: []\n",
                        {4, 9, "matrix.data", "no values here"}},
        MatrixErrorCase{"SingleValue",
                        "matrix:\n  data: data.csv\n",
                        {4, 9, "matrix.data", "expected a list of values"}},
        MatrixErrorCase{"MisspeltKey",
                        "matrix:\n  slover.name: [ceres]\n",
                        {4, 16, "matrix.slover.name",
                         "unknown key \"slover\", did you mean \"solver\"?"}},
        MatrixErrorCase{"UnitsAreFixed",
                        "matrix:\n  units.length: [mm, m]\n",
                        {4, 17, "matrix.units.length", "unknown key"}},
        MatrixErrorCase{"MisspeltChange",
                        "matrix:\n  cell: {left: {dta: a.csv}}\n",
                        {4, 17, "matrix.cell.left.dta",
                         "unknown key \"dta\", did you mean \"data\"?"}},
        MatrixErrorCase{
            "SameName",
            "matrix:\n  data: [data.csv, below/data.csv]\n",
            {4, 20, "matrix.data[2]", "a second value is called \"data\""}},
        MatrixErrorCase{"EmptyRange",
                        "matrix:\n  identifiability.seed: {range: 0}\n",
                        {4, 33, "matrix.identifiability.seed.range",
                         "expected an integer from 1"}},
        MatrixErrorCase{"RangeBackwards",
                        "matrix:\n  identifiability.seed: {range: [3, 2]}\n",
                        {4, 37, "matrix.identifiability.seed.range[2]",
                         "expected an integer from 3"}},
        MatrixErrorCase{"TooMany",
                        "matrix: {identifiability.seed: {range: 1000000},\n"
                        "  data: [a.csv, b.csv]}\n",
                        {3, 9, "matrix", "at most 1000000 combinations"}}),
    [](const ::testing::TestParamInfo<MatrixErrorCase>& test) {
      return test.param.name;
    });

TEST(JobMatrixFilesTest, TheBatchOfTheRepositoryIsAThousandJobs) {
  const JobMatrix matrix(SourcePath("configs/batches/rv2aj_1000.yaml"));
  ASSERT_EQ(matrix.size(), 1000);
  const std::vector<std::string> names = NamesOf(matrix);
  EXPECT_EQ(names.front(), "rv2aj_1000/seed-0001");
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), 1000U);
}

}  // namespace
}  // namespace alidade::internal
