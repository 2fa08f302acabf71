#include <glog/logging.h>

#include <utility>

#include "alidade/error.h"
#include "alidade/option_text.h"
#include "alidade/version.h"
#include "src/core.h"

namespace alidade::python {
namespace {

constexpr auto kDouble = static_cast<py::ssize_t>(sizeof(double));

// Python owns the array; whoever shares the numbers owns a part of it.
std::shared_ptr<const double> KeepAlive(const Rows& rows) {
  return {rows.data(), [array = rows.inc_ref().ptr()](const double*) {
            if (!Py_IsInitialized()) return;
            const py::gil_scoped_acquire locked;
            Py_DECREF(array);
          }};
}

py::array ReadOnly(py::array array) {
  array.attr("flags").attr("writeable") = false;
  return array;
}

void RaiseInputError(const InputError& error) {
  const SourceLocation& where = error.location();
  const py::object type =
      py::module_::import("alidade._errors").attr("InputError");
  const py::object instance =
      type(error.message(), where.file, where.line, where.column, where.key);
  PyErr_SetObject(type.ptr(), instance.ptr());
}

py::dict AsDict(const OptionDescription& option) {
  py::dict dict;
  dict["name"] = option.name;
  dict["text"] = option.text;
  dict["type"] = option.type;
  dict["default"] = option.default_value;
  dict["range"] = option.range;
  dict["unit"] = option.unit;
  dict["required"] = option.is_required;
  dict["words"] = option.words;
  py::list fields;
  for (const OptionDescription& field : option.fields) {
    fields.append(AsDict(field));
  }
  dict["fields"] = fields;
  return dict;
}

py::list OptionsOf(const std::string& command) {
  py::list options;
  for (const OptionDescription& option :
       command == "plan"         ? OptionsOfPlan()
       : command == "montecarlo" ? OptionsOfMonteCarlo()
       : command == "data"       ? OptionsOfData()
                                 : OptionsOfCalibration()) {
    options.append(AsDict(option));
  }
  return options;
}

}  // namespace

SharedMatrix Share(const Rows& rows) {
  if (rows.size() == 0) return Eigen::MatrixXd(rows.shape(1), rows.shape(0));
  return {KeepAlive(rows), rows.shape(1), rows.shape(0),
          rows.strides(0) / kDouble};
}

py::array ViewOf(const SharedMatrix& matrix) {
  using Owner = SharedMatrix;
  py::capsule owner(new Owner(matrix),
                    [](void* kept) { delete static_cast<Owner*>(kept); });
  return ReadOnly(py::array_t<double>({matrix.cols(), matrix.rows()},
                                      {matrix.stride() * kDouble, kDouble},
                                      matrix.data(), owner));
}

py::array ViewOf(const Eigen::Ref<const Eigen::MatrixXd>& matrix,
                 const py::object& owner) {
  return ReadOnly(py::array_t<double>({matrix.cols(), matrix.rows()},
                                      {matrix.outerStride() * kDouble, kDouble},
                                      matrix.data(), owner));
}

py::array Give(Eigen::MatrixXd matrix) {
  const auto cols = matrix.cols(), rows = matrix.rows();
  return Give(std::move(matrix), {cols, rows});
}

py::array Give(Eigen::MatrixXd matrix, std::vector<py::ssize_t> shape) {
  auto* const kept = new Eigen::MatrixXd(std::move(matrix));
  py::capsule owner(
      kept, [](void* owned) { delete static_cast<Eigen::MatrixXd*>(owned); });
  return py::array_t<double>(std::move(shape), kept->data(), owner);
}

py::array_t<double> AsArray(const Eigen::Isometry3d& transform) {
  py::array_t<double> rows({4, 4});
  Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(
      rows.mutable_data()) = transform.matrix();
  return rows;
}

Eigen::Isometry3d AsTransform(const py::array_t<double>& rows) {
  Eigen::Isometry3d transform = Eigen::Isometry3d::Identity();
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 4; ++col) {
      transform(row, col) = rows.at(row, col);
    }
  }
  return transform;
}

std::vector<Eigen::Isometry3d> AsTransforms(const py::array_t<double>& rows) {
  std::vector<Eigen::Isometry3d> transforms;
  transforms.reserve(static_cast<std::size_t>(rows.shape(0)));
  const auto numbers = rows.unchecked<3>();
  for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
    Eigen::Isometry3d& transform =
        transforms.emplace_back(Eigen::Isometry3d::Identity());
    for (int row = 0; row < 3; ++row) {
      for (int col = 0; col < 4; ++col) {
        transform(row, col) = numbers(i, row, col);
      }
    }
  }
  return transforms;
}

}  // namespace alidade::python

PYBIND11_MODULE(_core, m) {
  namespace py = pybind11;
  // What is worth saying is in results: nothing is printed beside Python.
  FLAGS_minloglevel = google::GLOG_ERROR;
  m.doc() = "The public API of the library, as the package alidade uses it.";
  py::register_exception_translator([](std::exception_ptr error) {
    try {
      if (error) std::rethrow_exception(error);
    } catch (const alidade::InputError& wrong) {
      alidade::python::RaiseInputError(wrong);
    }
  });
  m.def("version", [] { return std::string(alidade::Version()); });
  m.def("options_of", alidade::python::OptionsOf);
  alidade::python::DefineArm(&m);
  alidade::python::DefineMeasurements(&m);
  alidade::python::DefineCalibration(&m);
  alidade::python::DefineStudies(&m);
}
