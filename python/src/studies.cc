#include <optional>
#include <utility>

#include "alidade/batch_run.h"
#include "alidade/comparison.h"
#include "alidade/monte_carlo.h"
#include "alidade/option_text.h"
#include "alidade/plan.h"
#include "alidade/result_file.h"
#include "alidade/run_file.h"
#include "src/core.h"

namespace alidade::python {
namespace {

using Plan = std::shared_ptr<PlanResult>;
using Study = std::shared_ptr<MonteCarloResult>;

const char* NameOf(PlanStatus status) {
  switch (status) {
    case PlanStatus::kDone:
      return "done";
    case PlanStatus::kRefused:
      return "refused";
    case PlanStatus::kFailed:
      break;
  }
  return "failed";
}

Plan PlanArm(const Arm& arm, const Measurements& measured,
             const std::optional<Rows>& candidates, const std::string& options,
             int threads) {
  CalibrationData data(measured.data);
  data.references = measured.references;
  PlanOptions plan;
  CalibrationOptions calibration;
  ReadOptions(options, arm, measured.references, &plan, &calibration);
  calibration.errors.uses = measured.uses;
  if (candidates) plan.given_candidates = AsMatrix(*candidates);
  calibration.num_threads = threads;
  plan.design.num_threads = threads;
  return RunUnlocked([&] {
    return std::make_shared<PlanResult>(
        PlanPoses(arm, data, calibration, plan));
  });
}

py::list AsList(const std::vector<NamedFile>& files) {
  py::list list;
  for (const NamedFile& file : files) {
    list.append(py::make_tuple(file.name, py::bytes(file.content)));
  }
  return list;
}

void DefinePlan(py::module_* m) {
  py::class_<PlanResult, Plan>(*m, "Plan")
      .def_property_readonly(
          "status", [](const PlanResult& plan) { return NameOf(plan.status); })
      .def_readonly("message", &PlanResult::message)
      .def("json", [](const PlanResult& plan) { return FormatResult(plan); })
      .def("report", [](const PlanResult& plan) { return ReportText(plan); })
      .def("joint_values",
           [](const Plan& plan) {
             return ViewOf(plan->joint_values, py::cast(plan));
           })
      .def("pose_std",
           [](const Plan& plan) {
             return ViewOf(plan->pose_std, py::cast(plan));
           })
      .def("files",
           [](const PlanResult& plan) { return AsList(FilesOf(plan)); })
      .def("save", [](const PlanResult& plan, const std::string& directory) {
        return SaveFiles(FilesOf(plan), directory);
      });
  m->def("plan", PlanArm);
  m->def("plan_file", [](const std::string& path, int threads) {
    return RunUnlocked([&] {
      return std::make_shared<PlanResult>(RunPlanFile(path, threads));
    });
  });
}

py::dict AsDict(const Accuracy& accuracy) {
  py::dict dict;
  dict["mean"] = accuracy.mean;
  dict["rms"] = accuracy.rms;
  dict["std"] = accuracy.stddev;
  dict["median"] = accuracy.median;
  dict["p95"] = accuracy.p95;
  dict["min"] = accuracy.min;
  dict["max"] = accuracy.max;
  dict["n"] = accuracy.n;
  return dict;
}

py::dict AsDict(const Coverage& coverage) {
  py::dict dict;
  dict["held"] = coverage.held;
  dict["n"] = coverage.n;
  dict["rate"] = coverage.rate();
  dict["lower"] = coverage.lower;
  dict["upper"] = coverage.upper;
  return dict;
}

py::list ParametersOf(const MonteCarloResult& study) {
  py::list parameters;
  for (const SimulatedParameter& parameter : study.parameters) {
    py::dict dict;
    dict["name"] = parameter.name;
    dict["unit"] = parameter.dimension == Dimension::kLength ? "m" : "rad";
    dict["truth"] = parameter.truth;
    dict["bias"] = parameter.bias;
    dict["bias_error"] = parameter.bias_error;
    dict["spread"] = parameter.spread;
    dict["predicted_std"] = parameter.predicted_std;
    dict["bound"] = parameter.bound;
    dict["coverage"] = AsDict(parameter.coverage);
    dict["is_profile"] = parameter.is_profile;
    parameters.append(dict);
  }
  return parameters;
}

py::dict AsDict(const MonteCarloResult& study) {
  py::dict dict;
  dict["title"] = study.title;
  dict["truth"] = study.truth;
  dict["seed"] = study.seed;
  dict["trials_wanted"] = study.trials_wanted;
  dict["failed"] = study.failed;
  dict["stopped_early"] = study.stopped_early;
  dict["confidence"] = study.confidence;
  dict["sigma_estimated"] = study.sigma_estimated;
  dict["parameters"] = ParametersOf(study);
  dict["axes"] = AsDict(study.axes);
  dict["ellipsoids"] = AsDict(study.ellipsoids);
  dict["workspace_poses"] = study.workspace_poses;
  dict["workspace_before"] = study.workspace_before;
  dict["workspace_predicted"] = study.workspace_predicted;
  dict["workspace"] = AsDict(study.workspace);
  dict["inefficiency"] = study.inefficiency;
  dict["time_s"] = study.time_s;
  return dict;
}

// Estimates of all trials, NaN where one found none, and what goes with them.
py::tuple TrialsOf(const MonteCarloResult& study) {
  const auto count = static_cast<Eigen::Index>(study.trials.size());
  Eigen::MatrixXd estimates = Eigen::MatrixXd::Constant(
      static_cast<Eigen::Index>(study.parameters.size()), count,
      std::numeric_limits<double>::quiet_NaN());
  Eigen::MatrixXd rms(1, count);
  Eigen::MatrixXd chi_square(1, count);
  std::vector<bool> usable;
  for (Eigen::Index k = 0; k < count; ++k) {
    const SimulatedTrial& trial = study.trials[k];
    if (trial.usable) estimates.col(k) = trial.estimates;
    rms(0, k) = trial.workspace_rms;
    chi_square(0, k) = trial.reduced_chi_square;
    usable.push_back(trial.usable);
  }
  return py::make_tuple(Give(std::move(estimates)),
                        Give(std::move(rms), {count}),
                        Give(std::move(chi_square), {count}), usable);
}

TrialProgress ProgressOf(const py::object& progress, PythonErrors* errors) {
  if (progress.is_none()) return {};
  return [&progress, errors](int done, int wanted) {
    errors->Call(progress, done, wanted);
  };
}

Study MonteCarlo(const Arm& arm, const Measurements& measured,
                 CalibrationOptions options, const std::string& text,
                 int threads, const py::object& progress) {
  CalibrationData data(measured.data);
  data.references = measured.references;
  MonteCarloOptions study;
  if (options.true_values) study.truth = SimulatedTruth::kGiven;
  ReadOptions(text, &study);
  options.num_threads = threads;
  options.sigmas_are_stated = measured.sigmas_are_stated;
  PythonErrors errors;
  return RunUnlocked(&errors, [&] {
    return std::make_shared<MonteCarloResult>(RunMonteCarlo(
        arm, data, options, study, ProgressOf(progress, &errors)));
  });
}

void DefineMonteCarlo(py::module_* m) {
  py::class_<MonteCarloResult, Study>(*m, "Study")
      .def("to_dict",
           [](const MonteCarloResult& study) { return AsDict(study); })
      .def("trials", TrialsOf)
      .def("report",
           [](const MonteCarloResult& study) { return ReportText(study); })
      .def("files",
           [](const MonteCarloResult& study) { return AsList(FilesOf(study)); })
      .def("save",
           [](const MonteCarloResult& study, const std::string& directory) {
             return SaveFiles(FilesOf(study), directory);
           });
  m->def("save_files",
         [](const std::vector<std::pair<std::string, std::string>>& files,
            const std::string& directory) {
           std::vector<NamedFile> named;
           for (const auto& [name, content] : files) {
             named.push_back({name, content});
           }
           return SaveFiles(named, directory);
         });
  m->def("montecarlo", MonteCarlo);
  m->def("montecarlo_file",
         [](const std::string& path, int threads, const py::object& progress) {
           PythonErrors errors;
           return RunUnlocked(&errors, [&] {
             return std::make_shared<MonteCarloResult>(RunMonteCarloFile(
                 path, threads, ProgressOf(progress, &errors)));
           });
         });
}

py::dict AsDict(const FleetSummary& fleet) {
  py::dict dict;
  dict["title"] = fleet.title;
  dict["sentence"] = fleet.sentence;
  dict["is_small"] = fleet.is_small;
  py::list arms;
  for (const FleetArm& arm : fleet.arms) {
    py::dict one;
    one["result"] = arm.result;
    one["is_outlier"] = arm.is_outlier;
    one["score"] = arm.score;
    std::vector<std::string> sentences;
    for (const Finding& finding : arm.findings) {
      sentences.push_back(finding.sentence);
    }
    one["findings"] = sentences;
    arms.append(one);
  }
  dict["arms"] = arms;
  return dict;
}

py::dict AsDict(const DriftSummary& drift) {
  py::dict dict;
  dict["title"] = drift.title;
  dict["sentence"] = drift.sentence;
  py::list changes;
  for (const ParameterChange& change : drift.changes) {
    py::dict one;
    one["name"] = change.name;
    one["unit"] = change.dimension == Dimension::kLength ? "m" : "rad";
    one["from"] = change.from;
    one["before"] = change.before;
    one["after"] = change.after;
    one["difference"] = change.difference();
    one["std"] = change.std;
    one["score"] = change.score();
    one["is_significant"] = change.is_significant;
    changes.append(one);
  }
  dict["changes"] = changes;
  return dict;
}

py::dict AsDict(const MethodSummary& methods) {
  py::dict dict;
  dict["title"] = methods.title;
  dict["sentence"] = methods.sentence;
  dict["ranking"] = methods.ranking;
  return dict;
}

py::dict Compare(const std::vector<std::shared_ptr<CalibrationResult>>& results,
                 const std::vector<std::string>& labels,
                 const std::string& kind) {
  std::vector<ComparedResult> compared;
  for (std::size_t k = 0; k < results.size(); ++k) {
    compared.push_back(DescribeForComparison(labels[k], *results[k]));
  }
  if (kind == "fleet") return AsDict(CompareFleet(compared, 0));
  if (kind == "time") return AsDict(CompareOverTime(compared));
  return AsDict(CompareMethods(compared));
}

std::string Batch(const std::vector<std::string>& paths,
                  const std::string& directory, int threads, bool fail_fast,
                  const py::object& progress) {
  PythonErrors errors;
  BatchRunOptions options;
  options.directory = directory;
  options.num_threads = threads;
  options.fail_fast = fail_fast;
  if (!progress.is_none()) {
    options.on_finished = [&](std::int64_t done, std::int64_t jobs,
                              const std::string& name) {
      errors.Call(progress, done, jobs, name);
    };
  }
  return RunUnlocked(&errors, [&] { return RunBatchOfFiles(paths, options); });
}

}  // namespace

void DefineStudies(py::module_* m) {
  DefinePlan(m);
  DefineMonteCarlo(m);
  m->def("compare", Compare);
  m->def("batch", Batch);
}

}  // namespace alidade::python
