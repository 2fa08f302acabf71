"""What calibrations, plans and studies found out."""

from __future__ import annotations

import html
import json
from typing import Any

import numpy as np

from . import _core
from ._arm import Arm
from ._arrays import Array, Path, path
from ._errors import CalibrationError, wrong
from ._record import Figures, Record, Svg, record

_COLUMNS = ["name", "unit", "state", "nominal", "value", "deviation", "std"]


class Evaluation(Record):
    """Errors at the poses of one data set, before and after calibration:
    statistics (`before`, `after`: mean, rms, max ... in m) and an array each of
    joint_values, positions, residual_before, residual_after (predicted less
    measured, m), rotation_residual_before and _after (rad)."""

    def to_pandas(self) -> Any:
        """A row per observation (SI units)."""
        import pandas

        count = len(self["residual_after"])
        frame = pandas.DataFrame(index=pandas.RangeIndex(count))
        labels = self["labels"]
        at: Any = np.arange(count)
        if labels is not None:
            at = np.array([label[1] for label in labels], dtype=int)
            frame["kind"] = [label[0] for label in labels]
            frame["target"] = [label[2] for label in labels]
        frame["pose"] = at
        joints = self["joint_values"]
        for j in range(joints.shape[1]):
            frame[f"q{j + 1}"] = np.where(at >= 0, joints[at, j], np.nan)
        for k, axis in enumerate("xyz"):
            frame[axis] = self["positions"][:, k]
        for state in ("before", "after"):
            residual = self[f"residual_{state}"]
            for k, axis in enumerate("xyz"):
                frame[f"{state}_d{axis}"] = residual[:, k]
            frame[f"{state}_error"] = np.linalg.norm(residual, axis=1)
            turned = self[f"rotation_residual_{state}"]
            if turned.size:
                frame[f"{state}_rotation"] = np.linalg.norm(turned, axis=1)
        return frame


class Result:
    """A calibration's result.

    Everything that result.json holds (docs/files.md) is an attribute:
    `result.verdict.title`, `result.parameters[0].std`, `result.warnings`,
    `result.uncertainty`. `arm` is the calibrated arm, `train` and `validation`
    the errors at those poses with their arrays. Lengths in m, angles in rad.
    """

    __slots__ = ("_core", "_record")

    def __init__(self, core: _core.Result) -> None:
        self._core = core
        self._record: Record | None = None

    @classmethod
    def load(cls, directory: Path) -> Result:
        """A result directory, as `save` or the program has written it. Files
        state mm and deg: residuals are those of the result to rounding."""
        return cls(_core.Result.load(path(directory, "directory")))

    @property
    def arm(self) -> Arm:
        """The calibrated arm; the nominal one where the result is no good."""
        return Arm(self._core.arm)

    @property
    def status(self) -> str:
        return self._core.status

    @property
    def message(self) -> str:
        """Why the status is not "done"."""
        return self._core.message

    @property
    def is_usable(self) -> bool:
        """Whether a solution was found that may be used; acceptance limits do
        not matter."""
        return self._core.is_usable()

    @property
    def train(self) -> Evaluation:
        """Errors at the poses of the fit."""
        return self._evaluation("train", self._core.train())

    @property
    def validation(self) -> Evaluation | None:
        """Errors at poses that the fit did not use."""
        arrays = self._core.validation()
        return None if arrays is None else self._evaluation("validation",
                                                            arrays)

    def _evaluation(self, name: str, arrays: dict[str, Any]) -> Evaluation:
        statistics = self._data()["accuracy"].get(name, {})
        return Evaluation({**statistics, **arrays})

    @property
    def parameters(self) -> list[Record]:
        """All parameters: name, unit, nominal, value, deviation, std, state
        ("free", "fixed", "given"), assessment, reason ..."""
        parameters: list[Record] = self._data()["parameters"]
        return parameters

    def parameter(self, name: str) -> Record:
        """The parameter of this name: "d3"."""
        for one in self.parameters:
            if one["name"] == name:
                return one
        raise wrong("name", f"no parameter {name!r}, expected one of "
                    + ", ".join(one["name"] for one in self.parameters))

    def __getitem__(self, name: str) -> Record:
        return self.parameter(name)

    @property
    def covariance(self) -> Array | None:
        """Of the free parameters (m, rad), in the order of `free`."""
        found = self._core.covariance()
        return None if found is None else found[1]

    @property
    def free(self) -> list[str]:
        """Names of the estimated parameters."""
        return [one["name"] for one in self.parameters
                if one["state"] == "free"]

    @property
    def workspace(self) -> Record | None:
        """Predicted standard deviation over the workspace: joint_values,
        positions (m), position_std (m), semi_axes (m)."""
        arrays = self._core.workspace()
        if arrays is None:
            return None
        for name in ("position_std", "rotation_std", "true_error"):
            arrays[name] = arrays[name].reshape(-1)
        return Record(arrays)

    def influence(self) -> Any:
        """What each pose weighs in the fit, as a data frame: leverage, Cook's
        distance, standardised residual."""
        import pandas

        return pandas.DataFrame(
            self._core.influence(), columns=[
                "pose", "where", "leverage", "cooks_distance",
                "standardised"]).set_index("pose")

    @property
    def joint_residuals(self) -> Record | None:
        """Where error terms were estimated: residuals as what each joint would
        have to move further, with geometry alone and with the terms."""
        arrays = self._core.joint_residuals()
        return None if arrays is None else Record(arrays)

    @property
    def figures(self) -> Figures:
        """Figures as SVG: error_before, error_after, convergence, and of
        validation poses validation_before, validation_after."""
        return Figures((name, Svg(name, title, svg, note))
                       for name, title, svg, note in self._core.figures())

    def report(self) -> str:
        """report.txt."""
        self._need_solution("report")
        return self._core.report()

    def page(self) -> str:
        """report.html: one page that loads nothing."""
        self._need_solution("page")
        return self._core.page()

    def save(self, directory: Path, *, page: bool = False) -> list[str]:
        """A result directory as the program writes it; returns the paths.
        `page`: report.html too."""
        self._need_solution("save")
        return self._core.save(path(directory, "directory"), bool(page))

    def _need_solution(self, what: str) -> None:
        if not (self._core.is_usable() or self._core.is_rejected()):
            raise CalibrationError(
                f"no solution to {what}: {self.status}: {self.message}", self)

    def to_dict(self) -> dict[str, Any]:
        """result.json as a dict."""
        data: dict[str, Any] = json.loads(self._core.json())
        return data

    def to_pandas(self) -> Any:
        """A row per parameter."""
        import pandas

        frame = pandas.DataFrame(self.parameters)
        others = [name for name in frame.columns if name not in _COLUMNS]
        return frame[_COLUMNS + others].set_index("name")

    def _data(self) -> Record:
        if self._record is None:
            self._record = record(json.loads(self._core.json()))
        return self._record

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        data = self._data()
        if name in data:
            return data[name]
        raise AttributeError(f"a result has no {name!r}; it has "
                             + ", ".join(sorted(self.__dir__())))

    def __dir__(self) -> list[str]:
        return [name for name in (*super().__dir__(), *self._data())
                if not name.startswith("_")]

    def __repr__(self) -> str:
        return f"Result({self._core.brief()})"

    def _repr_html_(self) -> str:
        data = self._data()
        verdict = data["verdict"]
        parts = [f"<h3>{html.escape(data['title'] or data['arm'])}</h3>",
                 f"<p><b>{html.escape(verdict['title'] or self.status)}</b> "
                 f"{html.escape(verdict['sentence'] or self.message)}</p>"]
        if self._core.is_usable() or self._core.is_rejected():
            parts.append(_accuracy_table(data["accuracy"]))
            reasons = [finding["sentence"] for finding in verdict["findings"]
                       if finding["level"] in ("attention", "failed")]
            parts += [f"<li>{html.escape(reason)}</li>" for reason in reasons]
            figures = self.figures
            parts.append("<div style='display:flex;flex-wrap:wrap'>")
            parts += [figures[name]._repr_html_()
                      for name in ("error_before", "error_after")
                      if name in figures]
            parts.append("</div>")
        return "".join(parts)

    def __getstate__(self) -> dict[str, Any]:
        def copied(arrays: Any) -> Any:
            return None if arrays is None else {
                name: np.array(value) if isinstance(value, np.ndarray)
                else value for name, value in arrays.items()}

        return {"json": self._core.json(), "status": self._core.status,
                "message": self._core.message, "arm": Arm(self._core.arm),
                "arrays": {"train": copied(self._core.train()),
                           "validation": copied(self._core.validation()),
                           "workspace": copied(self._core.workspace()),
                           "influence": self._core.influence(),
                           "joint_residuals":
                           copied(self._core.joint_residuals())}}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self._core = _core.Result.restore(state["json"], state["status"],
                                          state["message"],
                                          state["arm"]._core, state["arrays"])
        self._record = None


def _accuracy_table(accuracy: Any) -> str:
    rows = []
    for name, of in (("train", "training poses"),
                     ("validation", "validation poses")):
        if name not in accuracy:
            continue
        for state in ("before", "after"):
            numbers = accuracy[name].get("without_rejected",
                                         accuracy[name])[state]
            cells = "".join(f"<td>{1e3 * numbers[key]:.4g}</td>"
                            for key in ("mean", "rms", "p95", "max"))
            rows.append(f"<tr><td>{of}, {state}</td>{cells}"
                        f"<td>{numbers['n']}</td></tr>")
    return ("<table><tr><th>error [mm]</th><th>mean</th><th>rms</th>"
            "<th>95 %</th><th>max</th><th>n</th></tr>" + "".join(rows)
            + "</table>")


class Identification(Record):
    """What poses determine: `decisions` (name, state, rule, reason,
    predicted_std ...), `relations`, `advice`, `num_free`, ranks and
    observability indices (docs/identifiability.md)."""

    @property
    def free(self) -> list[str]:
        return [one["name"] for one in self["decisions"]
                if one["state"] == "free"]

    def report(self) -> str:
        text: str = self["text"]
        return text

    def to_pandas(self) -> Any:
        """A row per parameter."""
        import pandas

        return pandas.DataFrame(self["decisions"]).set_index("name")

    def __repr__(self) -> str:
        return (f"Identification({len(self.free)} of "
                f"{self['num_candidates'] or len(self['decisions'])} candidates"
                " are identifiable)")


class _Restored:
    """What the library's object answered when it was pickled."""

    def __init__(self, answers: dict[str, Any]) -> None:
        self.answers = answers

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name == "answers":
            raise AttributeError(name)
        return lambda: self.answers[name]

    def save(self, directory: str) -> list[str]:
        return _core.save_files(self.answers["files"], directory)


def _restore(kind: Any, answers: dict[str, Any]) -> Any:
    return kind(_Restored(answers))


class _WithFiles:
    """What has files and a report, from the library."""

    __slots__ = ("_core",)
    _core: Any
    _ANSWERS: tuple[str, ...] = ()

    def __reduce__(self) -> Any:
        return _restore, (type(self), {name: getattr(self._core, name)()
                                       for name in self._ANSWERS})

    def report(self) -> str:
        text: str = self._core.report()
        return text

    @property
    def figures(self) -> Figures:
        """Figures as SVG."""
        return Figures((name[:-4], Svg(name[:-4], "", content.decode()))
                       for name, content in self._core.files()
                       if name.endswith(".svg"))

    def save(self, directory: Path) -> list[str]:
        """The files that the program writes; returns their paths."""
        paths: list[str] = self._core.save(path(directory, "directory"))
        return paths


class Plan(_WithFiles):
    """Poses to measure. `joint_values` (N, n) in the order to be measured;
    everything of plan.json is an attribute too (docs/planning.md)."""

    __slots__ = ("_record",)
    _ANSWERS = ("json", "report", "joint_values", "pose_std", "files")

    def __init__(self, core: Any) -> None:
        self._core = core
        self._record: Record = record(json.loads(core.json()))

    @property
    def joint_values(self) -> Array:
        values: Array = self._core.joint_values()
        return values

    @property
    def pose_std(self) -> Array:
        """Predicted standard deviation of the position at each (m)."""
        values: Array = self._core.pose_std()
        return values.reshape(-1)

    def to_dict(self) -> dict[str, Any]:
        data: dict[str, Any] = json.loads(self._core.json())
        return data

    def to_pandas(self) -> Any:
        """A row per pose (rad, m)."""
        import pandas

        joints = self.joint_values
        frame = pandas.DataFrame(
            joints, columns=[f"q{j + 1}" for j in range(joints.shape[1])])
        frame["pose_std"] = self.pose_std
        return frame

    def __getattr__(self, name: str) -> Any:
        if not name.startswith("_") and name in self._record:
            return self._record[name]
        raise AttributeError(f"a plan has no {name!r}")

    def __len__(self) -> int:
        return len(self.joint_values)

    def __repr__(self) -> str:
        return f"Plan({len(self)} poses, criterion {self.criterion})"

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(self.report())}</pre>" + (
            self.figures._repr_html_())


class MonteCarlo(_WithFiles):
    """Many simulated calibrations: everything that they showed is an attribute
    (`parameters`: bias, spread, coverage ...; `workspace`), and of each trial
    `estimates` (trials, parameters), `workspace_rms` (m)."""

    __slots__ = ("_record", "estimates", "workspace_rms",
                 "reduced_chi_square", "usable")
    _ANSWERS = ("to_dict", "report", "trials", "files")

    def __init__(self, core: Any) -> None:
        self._core = core
        self._record: Record = record(core.to_dict())
        (self.estimates, self.workspace_rms, self.reduced_chi_square,
         usable) = core.trials()
        self.usable = np.array(usable, dtype=bool)

    @property
    def names(self) -> list[str]:
        """Of the columns of `estimates`."""
        return [one["name"] for one in self._record["parameters"]]

    def to_dict(self) -> dict[str, Any]:
        data: dict[str, Any] = self._core.to_dict()
        return data

    def to_pandas(self) -> Any:
        """A row per parameter (m, rad)."""
        import pandas

        frame = pandas.DataFrame(self._record["parameters"])
        frame["coverage"] = [one["coverage"]["rate"]
                             for one in self._record["parameters"]]
        return frame.set_index("name")

    def __getattr__(self, name: str) -> Any:
        if not name.startswith("_") and name in self._record:
            return self._record[name]
        raise AttributeError(f"a study has no {name!r}")

    def __repr__(self) -> str:
        return (f"MonteCarlo({len(self.estimates)} trials, "
                f"{self._record['failed']} failed)")

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(self.report())}</pre>" + (
            self.figures._repr_html_())
