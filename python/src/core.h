#ifndef ALIDADE_PYTHON_SRC_CORE_H_
#define ALIDADE_PYTHON_SRC_CORE_H_

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "alidade/arm.h"
#include "alidade/calibration_options.h"
#include "alidade/dataset.h"
#include "alidade/interruption.h"
#include "alidade/shared_matrix.h"

namespace alidade::python {

namespace py = pybind11;

/// Rows of numbers as the package hands them over: two dimensions, of which the
/// last is contiguous. A row is a column of Eigen's.
using Rows = py::array_t<double>;

/// More targets than an arm has.
inline constexpr int kNamedTargets = 64;

/// What was measured, and against what.
struct Measurements {
  Dataset data;
  References references;
  std::vector<CovariateUse> uses = {};  ///< of the data's covariates
  std::vector<std::string> sets = {};   ///< of each pose; empty: none
  /// Names of targets that stand for numbers from kNamedTargets on: which of
  /// the arm's they are is known once there is an arm.
  std::vector<std::string> target_names = {};
  std::string first_station =
      {};  ///< whose base is the arm's; empty: no others
  /// Rows of files that hold no measurement: file, line, reason.
  std::vector<std::tuple<std::string, int, std::string>> rejected = {};
  /// Somebody has stated sigmas, if only one for all.
  bool sigmas_are_stated = true;
};

/// The parts that the module is made of.
void DefineArm(py::module_* m);
void DefineMeasurements(py::module_* m);
void DefineCalibration(py::module_* m);
void DefineStudies(py::module_* m);

// A matrix that is an array's own memory; it keeps the array alive.
SharedMatrix Share(const Rows& rows);
inline Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>> AsMatrix(
    const Rows& rows) {
  return {rows.data(), rows.shape(1), rows.shape(0),
          Eigen::OuterStride<>(rows.strides(0) /
                               static_cast<py::ssize_t>(sizeof(double)))};
}

// Read-only arrays with a row for each column. The first shares the numbers,
// the second those of a matrix that `owner` keeps, the third takes them over.
py::array ViewOf(const SharedMatrix& matrix);
py::array ViewOf(const Eigen::Ref<const Eigen::MatrixXd>& matrix,
                 const py::object& owner);
py::array Give(Eigen::MatrixXd matrix);
py::array Give(Eigen::MatrixXd matrix, std::vector<py::ssize_t> shape);

// A 4 x 4 matrix, and back. The rotation is taken as it is.
py::array_t<double> AsArray(const Eigen::Isometry3d& transform);
Eigen::Isometry3d AsTransform(const py::array_t<double>& rows);
std::vector<Eigen::Isometry3d> AsTransforms(const py::array_t<double>& rows);

/// Python has raised an exception while the library worked.
struct Interrupted {};

/// Ctrl-C and exceptions of callbacks, while the library works.
class PythonErrors {
 public:
  /// Keeps the exception that is being raised. @pre the interpreter is locked.
  void Keep() {
    if (!raised_) raised_ = std::make_unique<py::error_already_set>();
  }
  void Check() {
    const py::gil_scoped_acquire locked;
    if (!raised_ && PyErr_CheckSignals() != 0) Keep();
    if (raised_) throw Interrupted();
  }
  /// Raises it again, if there is one. @pre the interpreter is locked.
  void Raise() {
    if (!raised_) return;
    raised_->restore();
    raised_.reset();
    throw py::error_already_set();
  }
  /// Calls Python from the library's work; what it raises ends that.
  template <typename... Arguments>
  void Call(const py::object& function, const Arguments&... arguments) {
    const py::gil_scoped_acquire locked;
    if (raised_) return;
    try {
      function(arguments...);
    } catch (py::error_already_set& error) {
      error.restore();
      Keep();
    }
  }

 private:
  std::unique_ptr<py::error_already_set> raised_;
};

/// work() without the interpreter's lock; ended by Ctrl-C and by exceptions of
/// callbacks.
template <typename Work>
auto RunUnlocked(PythonErrors* errors, const Work& work) {
  using Result = decltype(work());
  std::unique_ptr<Result> result;
  try {
    const py::gil_scoped_release unlocked;
    const InterruptionScope scope([errors] { errors->Check(); });
    result = std::make_unique<Result>(work());
  } catch (const Interrupted&) {
  }
  errors->Raise();
  return std::move(*result);
}
template <typename Work>
auto RunUnlocked(const Work& work) {
  PythonErrors errors;
  return RunUnlocked(&errors, work);
}

}  // namespace alidade::python

#endif  // ALIDADE_PYTHON_SRC_CORE_H_
