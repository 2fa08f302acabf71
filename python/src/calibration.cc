#include "alidade/calibration.h"

#include <optional>
#include <utility>

#include "alidade/job.h"
#include "alidade/option_text.h"
#include "alidade/result_file.h"
#include "src/core.h"

namespace alidade::python {
namespace {

using Result = std::shared_ptr<CalibrationResult>;

// progress(iteration, rms error, largest error) after every iteration. Returns
// at once where Python has raised an exception: the next check ends the solve.
void SetProgress(const py::object& progress, PythonErrors* errors,
                 CalibrationOptions* options) {
  if (progress.is_none()) return;
  options->solver_options.on_iteration =
      [&progress, errors](const IterationRecord& record) {
        errors->Call(progress, record.iteration, record.rms_error,
                     record.max_error);
      };
}

Result CalibrateArm(const Arm& arm, const Measurements& measured,
                    const Measurements* validation, CalibrationOptions options,
                    int threads, const py::object& progress) {
  CalibrationData data(measured.data);
  data.references = measured.references;
  if (validation != nullptr) data.validation = validation->data;
  options.num_threads = threads;
  options.sigmas_are_stated = measured.sigmas_are_stated;
  PythonErrors errors;
  SetProgress(progress, &errors, &options);
  return RunUnlocked(&errors, [&] {
    return std::make_shared<CalibrationResult>(Calibrate(arm, data, options));
  });
}

Result RunJobFile(const Job& job, CalibrationOptions options, int threads,
                  const py::object& progress) {
  Job run = job;
  options.num_threads = threads;
  PythonErrors errors;
  SetProgress(progress, &errors, &options);
  run.options = std::move(options);
  return RunUnlocked(&errors, [&] {
    return std::make_shared<CalibrationResult>(RunJob(std::move(run)));
  });
}

py::dict Identify(const Arm& arm, const Measurements& measured,
                  CalibrationOptions options, int threads) {
  CalibrationData data(measured.data);
  data.references = measured.references;
  options.num_threads = threads;
  const IdentifiabilityResult result =
      RunUnlocked([&] { return AnalyzeIdentifiability(arm, data, options); });
  py::dict dict;
  py::list decisions;
  for (const ParameterDecision& decision : result.decisions) {
    py::dict one;
    one["name"] = decision.name;
    one["state"] = ToString(decision.state);
    one["rule"] = decision.rule;
    one["reason"] = decision.reason;
    one["identified_combination"] = decision.identified_combination;
    one["prior_std"] = decision.prior_std;
    one["predicted_std"] = decision.predicted_std;
    decisions.append(one);
  }
  dict["decisions"] = decisions;
  dict["json"] = FormatResult(result);
  dict["report"] = ReportText(result);
  return dict;
}

py::object LabelsOf(const EvaluatedSet& set) {
  if (set.labels.empty()) return py::none();
  py::list labels;
  for (const ObservationLabel& label : set.labels) {
    labels.append(py::make_tuple(label.kind, label.pose, label.target,
                                 label.where, label.has_length,
                                 label.has_rotation));
  }
  return std::move(labels);
}

py::dict ArraysOf(const EvaluatedSet& set) {
  py::dict dict;
  dict["joint_values"] = ViewOf(set.joint_values);
  dict["positions"] = ViewOf(set.positions);
  dict["residual_before"] = ViewOf(set.residual_before);
  dict["residual_after"] = ViewOf(set.residual_after);
  dict["rotation_residual_before"] = ViewOf(set.rotation_residual_before);
  dict["rotation_residual_after"] = ViewOf(set.rotation_residual_after);
  dict["labels"] = LabelsOf(set);
  return dict;
}

SharedMatrix CopyOf(const py::dict& arrays, const char* name) {
  const Rows rows = arrays[name].cast<Rows>();
  if (rows.size() == 0) return {};
  return Eigen::MatrixXd(AsMatrix(rows));
}

void SetArrays(const py::dict& arrays, EvaluatedSet* set) {
  set->joint_values = CopyOf(arrays, "joint_values");
  set->positions = CopyOf(arrays, "positions");
  set->residual_before = CopyOf(arrays, "residual_before");
  set->residual_after = CopyOf(arrays, "residual_after");
  set->rotation_residual_before = CopyOf(arrays, "rotation_residual_before");
  set->rotation_residual_after = CopyOf(arrays, "rotation_residual_after");
  if (arrays["labels"].is_none()) return;
  for (const py::handle item : arrays["labels"]) {
    const auto label = item.cast<py::tuple>();
    set->labels.push_back({label[0].cast<std::string>(), label[1].cast<int>(),
                           label[2].cast<std::string>(),
                           label[3].cast<std::string>(), label[4].cast<bool>(),
                           label[5].cast<bool>()});
  }
}

py::object WorkspaceOf(const Result& result) {
  if (!result->uncertainty || !result->uncertainty->workspace) {
    return py::none();
  }
  const PredictedMap& map = *result->uncertainty->workspace;
  const py::object owner = py::cast(result);
  py::dict dict;
  dict["joint_values"] = ViewOf(map.joint_values, owner);
  dict["positions"] = ViewOf(map.positions, owner);
  dict["position_std"] = ViewOf(map.position_std, owner);
  dict["semi_axes"] = ViewOf(map.semi_axes, owner);
  dict["rotation_std"] = ViewOf(map.rotation_std, owner);
  dict["true_error"] = ViewOf(map.true_error, owner);
  return std::move(dict);
}

py::list InfluenceOf(const CalibrationResult& result) {
  py::list poses;
  if (!result.uncertainty) return poses;
  for (const Influence& one : result.uncertainty->residuals.poses) {
    poses.append(py::make_tuple(one.pose, one.where, one.leverage,
                                one.cooks_distance, one.standardised));
  }
  return poses;
}

void SetInfluence(const py::list& poses, ResidualDiagnostics* residuals) {
  for (const py::handle item : poses) {
    const auto one = item.cast<py::tuple>();
    residuals->poses.push_back({one[0].cast<int>(), one[1].cast<std::string>(),
                                one[2].cast<double>(), one[3].cast<double>(),
                                one[4].cast<double>()});
  }
}

py::object JointResidualsOf(const Result& result) {
  if (!result->error_terms) return py::none();
  const JointResiduals& residuals = result->error_terms->residuals;
  const py::object owner = py::cast(result);
  py::dict dict;
  dict["poses"] = residuals.poses;
  dict["joint_values"] = ViewOf(residuals.joint_values, owner);
  dict["geometry"] = ViewOf(residuals.geometry, owner);
  dict["remaining"] = ViewOf(residuals.remaining, owner);
  return std::move(dict);
}

void SetJointResiduals(const py::dict& arrays, JointResiduals* residuals) {
  residuals->poses = arrays["poses"].cast<std::vector<int>>();
  residuals->joint_values = CopyOf(arrays, "joint_values").map();
  residuals->geometry = CopyOf(arrays, "geometry").map();
  residuals->remaining = CopyOf(arrays, "remaining").map();
}

void SetWorkspace(const py::dict& arrays, PredictedMap* map) {
  map->joint_values = CopyOf(arrays, "joint_values").map();
  map->positions = CopyOf(arrays, "positions").map();
  map->semi_axes = CopyOf(arrays, "semi_axes").map();
  const auto vector = [&arrays](const char* name) -> Eigen::VectorXd {
    const SharedMatrix numbers = CopyOf(arrays, name);
    return Eigen::Map<const Eigen::VectorXd>(numbers.data(), numbers.size());
  };
  map->position_std = vector("position_std");
  map->rotation_std = vector("rotation_std");
  map->true_error = vector("true_error");
}

py::object CovarianceOf(const Result& result) {
  if (!result->uncertainty) return py::none();
  std::vector<std::string> names;
  for (const ParameterUncertainty& one : result->uncertainty->parameters) {
    names.push_back(one.name);
  }
  return py::make_tuple(
      names, ViewOf(result->uncertainty->covariance, py::cast(result)));
}

// What __setstate__ of Python's result hands over.
Result Restore(const std::string& json, const std::string& status,
               const std::string& message, const Arm& arm,
               const py::dict& arrays) {
  auto result = std::make_shared<CalibrationResult>(ParseResult(json));
  for (int k = 0; k <= static_cast<int>(CalibrationStatus::kFailed); ++k) {
    const auto one = static_cast<CalibrationStatus>(k);
    if (status == ToString(one)) result->status = one;
  }
  result->message = message;
  result->arm = arm;
  SetArrays(arrays["train"], &result->train);
  if (result->validation) SetArrays(arrays["validation"], &*result->validation);
  if (result->error_terms) {
    SetJointResiduals(arrays["joint_residuals"],
                      &result->error_terms->residuals);
  }
  if (result->uncertainty) {
    SetInfluence(arrays["influence"], &result->uncertainty->residuals);
  }
  if (result->uncertainty && result->uncertainty->workspace) {
    SetWorkspace(arrays["workspace"], &*result->uncertainty->workspace);
  }
  return result;
}

py::list FiguresOf(const CalibrationResult& result) {
  py::list figures;
  for (const ReportFigure& figure : Figures(result)) {
    figures.append(
        py::make_tuple(figure.id, figure.title, figure.svg, figure.note));
  }
  return figures;
}

void DefineResult(py::module_* m) {
  py::class_<CalibrationResult, Result>(*m, "Result")
      .def_static(
          "load",
          [](const std::string& path) {
            return std::make_shared<CalibrationResult>(LoadResult(path));
          })
      .def_static("restore", Restore)
      .def_property_readonly("status",
                             [](const CalibrationResult& result) {
                               return ToString(result.status);
                             })
      .def_readonly("message", &CalibrationResult::message)
      .def_readonly("arm", &CalibrationResult::arm)
      .def("is_usable", &CalibrationResult::IsUsable)
      .def("is_rejected", &CalibrationResult::IsRejected)
      .def("json",
           [](const CalibrationResult& result) { return FormatResult(result); })
      .def("brief", &CalibrationResult::BriefReport)
      .def("report",
           [](const CalibrationResult& result) { return ReportText(result); })
      .def("page",
           [](const CalibrationResult& result) { return ReportPage(result); })
      .def("train",
           [](const CalibrationResult& result) {
             return ArraysOf(result.train);
           })
      .def("validation",
           [](const CalibrationResult& result) -> py::object {
             if (!result.validation) return py::none();
             return ArraysOf(*result.validation);
           })
      .def("workspace", WorkspaceOf)
      .def("influence", InfluenceOf)
      .def("joint_residuals", JointResidualsOf)
      .def("covariance", CovarianceOf)
      .def("figures", FiguresOf)
      .def("save", [](const CalibrationResult& result,
                      const std::string& directory, bool with_page) {
        SaveOptions options;
        options.report_page = with_page;
        return Save(result, directory, options);
      });
}

}  // namespace

void DefineCalibration(py::module_* m) {
  py::class_<CalibrationOptions>(*m, "Options")
      .def(py::init([] {
        // As in a job of today's format.
        CalibrationOptions options;
        options.errors.selection = ErrorTermSelection::kAuto;
        return options;
      }))
      .def("read",
           [](CalibrationOptions* options, const std::string& text,
              const Arm& arm, const Measurements& measured) {
             ReadOptions(text, arm, measured.references, options);
             options->errors.uses = measured.uses;
           })
      .def("copy", [](const CalibrationOptions& options) { return options; })
      .def_readwrite("estimate_sigma", &CalibrationOptions::estimate_sigma)
      .def("set_truth",
           [](CalibrationOptions* options, const py::array_t<double>& values) {
             options->true_values = Eigen::Map<const Eigen::VectorXd>(
                 values.data(), values.size());
           });
  py::class_<Job>(*m, "Job")
      .def_static("load",
                  [](const std::string& path, int threads) {
                    return RunUnlocked([&] { return LoadJob(path, threads); });
                  })
      .def_readonly("path", &Job::path)
      .def_readonly("title", &Job::title)
      .def_readonly("arm", &Job::arm)
      .def_readonly("options", &Job::options)
      .def_readonly("input_files", &Job::input_files)
      .def("data",
           [](const Job& job) {
             Measurements measured{job.data.training, job.data.references,
                                   job.options.errors.uses};
             measured.sigmas_are_stated = job.options.sigmas_are_stated;
             return measured;
           })
      .def("validation", [](const Job& job) -> std::optional<Measurements> {
        if (!job.data.validation) return std::nullopt;
        return Measurements{*job.data.validation, job.data.references,
                            job.options.errors.uses};
      });
  DefineResult(m);
  m->def("calibrate", CalibrateArm);
  m->def("run_job", RunJobFile);
  m->def("identify", Identify);
}

}  // namespace alidade::python
