"""The program's commands as functions."""

from __future__ import annotations

import json
import os
from typing import Any, Mapping, Sequence

import numpy as np

from . import _core
from ._arm import Arm, arm_of
from ._arrays import (Path, callable_or_none, integer, numbers, one_of,
                      path, positive, rows, seed_of, text, threads_of,
                      transforms)
from ._dataset import Dataset, dataset_of
from ._errors import CalibrationError, wrong
from ._options import nested, reading, takes_options, text_of
from ._record import Record, record, records
from ._results import Identification, MonteCarlo, Plan, Result


class Job:
    """A job file (docs/files.md) with the files that it names."""

    __slots__ = ("_core",)

    def __init__(self, file: Path, *, threads: int = 1) -> None:
        self._core = _core.Job.load(path(file, "file"), threads_of(threads))

    @property
    def title(self) -> str:
        return self._core.title

    @property
    def arm(self) -> Arm:
        """The nominal arm."""
        return Arm(self._core.arm)

    @property
    def data(self) -> Dataset:
        """The measurements to fit."""
        return Dataset._of(self._core.data())

    @property
    def validation(self) -> Dataset | None:
        """Those that the fit does not use."""
        core = self._core.validation()
        return None if core is None else Dataset._of(core)

    @property
    def input_files(self) -> list[str]:
        return self._core.input_files

    def __reduce__(self) -> Any:
        return Job, (os.path.abspath(self._core.path),)

    def __repr__(self) -> str:
        return f"Job({self._core.path!r}, {self.title!r})"


def _job_of(value: Any, threads: int) -> Job | None:
    if isinstance(value, Job):
        return value
    if isinstance(value, str) or hasattr(value, "__fspath__"):
        return Job(value, threads=threads)
    return None


def _laid_on(job: Job, keywords: Mapping[str, Any]) -> _core.Options:
    """A job's options, and the keywords beyond them."""
    options = job._core.options.copy()
    if nested("calibrate", keywords):
        with reading():
            options.read(text_of("calibrate", keywords), job._core.arm,
                         job._core.data())
    return options


def _refuse(whose: str, other: str, **keywords: Any) -> None:
    """What a file says cannot be said again."""
    for name, value in keywords.items():
        if value is not None:
            raise wrong(name, f"is {whose}, expected it there, or {other} and "
                        "keywords in place of the file")


def _set_truth(options: _core.Options, truth: Any, arm: Arm) -> None:
    if truth is None:
        return
    real = arm_of(truth, "truth")
    if list(real.parameters) != list(arm.parameters):
        raise wrong("truth", "is an arm of other joints or targets, expected "
                    "the same ones")
    # Rotations of base and tool count from the nominal ones.
    if not (np.allclose(real.base[:3, :3], arm.base[:3, :3], atol=1e-12)):
        raise wrong("truth", "has another rotation of the base, expected that "
                    "of the arm")
    options.set_truth(np.array(list(real.parameters.values())))


def _prepare(arm: Any, data: Any, threads: int,
             keywords: Mapping[str, Any]) -> tuple[Arm, Dataset,
                                                   _core.Options]:
    if data is None:
        raise wrong("data", "found None, expected a Dataset or the path of "
                    "one")
    nominal = arm_of(arm)
    measured = dataset_of(data, nominal, "data", threads)
    if not measured.kinds:
        raise wrong("data", "nothing is measured in it, expected positions or "
                    "other measurements")
    options = _core.Options()
    options.estimate_sigma = not measured.sigma_is_stated
    with reading():
        options.read(text_of("calibrate", keywords), nominal._core,
                     measured._core)
    return nominal, measured, options


@takes_options("calibrate")
def calibrate(arm: Any, data: Any = None, *, validation: Any = None,
              truth: Any = None, threads: int = 0, progress: Any = None,
              check: bool = True, **options: Any) -> Result:
    """Calibrates an arm.

    arm
        an `Arm` or the path of an arm file; or, without `data`, a `Job` or the
        path of a job file, whose options the keywords are laid on.
    data
        a `Dataset` or the path of one.
    validation
        another `Dataset`, which the fit does not use; or how to draw one from
        `data`, a dict of the section below.
    truth
        the real arm, where it is known: results then state the true error.
    threads
        results do not depend on it; 0: all processors.
    progress
        called as progress(iteration, rms error, largest error) (m).
    check
        raise CalibrationError where there is no usable result; otherwise its
        `status` and `message` say why.

    Every further keyword is an option, or a section of some as a dict; lengths
    in m, angles in rad:

    {options}

    Raises InputError where something given is wrong.
    """
    count = threads_of(threads)
    callable_or_none(progress, "progress")
    held: Dataset | None = None
    if isinstance(validation, Mapping):
        options["validation"] = validation
    if data is None:
        job = _job_of(arm, count)
        if job is None and not isinstance(arm, Arm):
            raise wrong("arm", f"found {type(arm).__name__}, expected an Arm "
                        "(with data), a Job or the path of a job file")
        if job is None:
            raise wrong("data", "found None, expected a Dataset or the path "
                        "of one")
        if validation is not None and not isinstance(validation, Mapping):
            raise wrong("validation", "is the job's, expected no other")
        if truth is not None:
            raise wrong("truth", "is the job's, expected no other")
        chosen = _laid_on(job, options)
        core = _core.run_job(job._core, chosen, count, progress)
    else:
        nominal, measured, chosen = _prepare(arm, data, count, options)
        if validation is not None and not isinstance(validation, Mapping):
            held = dataset_of(validation, nominal, "validation", count)
            measured, held = measured._with_references_of(held)
        _set_truth(chosen, truth, nominal)
        with reading():
            core = _core.calibrate(nominal._core, measured._core,
                                   None if held is None else held._core,
                                   chosen, count, progress)
    result = Result(core)
    if check and not result.is_usable:
        raise CalibrationError(f"{result.status}: {result.message}"
                               + _hint(result), result)
    return result


def _hint(result: Result) -> str:
    """Whoever has arrays has not thought of the instrument's frame yet."""
    are_given = all(one["state"] == "given" for one in result.parameters
                    if one["kind"] == "base")
    if result.status != "failed" or not are_given:
        return ""
    return ("; where the instrument stands or what it measures is not known: "
            'parameters=["joints", "base", "tool"]')


@takes_options("calibrate")
def identify(arm: Any, data: Any = None, *, threads: int = 0,
             **options: Any) -> Identification:
    """Which parameters these poses determine, and why not the others. Takes
    what `calibrate` takes: arm and data, or a job; what was measured does not
    matter, but where and with which sigmas.

    {options}
    """
    count = threads_of(threads)
    job = _job_of(arm, count) if data is None else None
    if job is not None:
        nominal, measured = job.arm, job.data
        chosen = _laid_on(job, options)
    else:
        nominal, measured, chosen = _prepare(arm, data, count, options)
    found = _core.identify(nominal._core, measured._core, chosen, count)
    result = record(json.loads(found["json"]))
    result["decisions"] = records(found["decisions"])
    result["text"] = found["report"]
    return Identification(result)


@takes_options("plan")
def plan(arm: Any, *, poses: Any = None, sigma: float | None = None,
         measured: Any = None, candidates: Any = None,
         seed: int | None = None, threads: int = 0, check: bool = True,
         **options: Any) -> Plan:
    """Chooses poses to measure.

    arm
        an `Arm` or the path of an arm file; or, alone, the path of a plan file.
    poses
        how many; or a dict of the section below.
    sigma
        standard deviation of each measured coordinate (m).
    measured
        a `Dataset` of what was measured already.
    candidates
        configurations (N, n) to choose from instead of drawn ones; or a dict of
        the section below.

    Every further keyword is an option, or a section of some as a dict; lengths
    in m, angles in rad:

    {options}
    """
    count = threads_of(threads)
    is_file = isinstance(arm, str) or hasattr(arm, "__fspath__")
    if is_file and poses is None and "accuracy" not in options:
        _refuse("the plan file's", "an Arm", sigma=sigma, measured=measured,
                candidates=candidates, seed=seed, **options)
        core = _core.plan_file(path(arm, "arm"), count)
    else:
        nominal = arm_of(arm)
        known = Dataset._of(_core.Measurements(
            np.empty((0, nominal.num_joints))))
        if measured is not None:
            known = dataset_of(measured, nominal, "measured", count)
        keywords = dict(options, sigma=sigma,
                        seed=seed_of(1 if seed is None else seed))
        if isinstance(poses, Mapping):
            keywords["poses"] = poses
        elif poses is not None:
            keywords["poses"] = {"count": integer(poses, "poses", 1)}
        table = None
        if isinstance(candidates, Mapping):
            keywords["candidates"] = candidates
        elif candidates is not None:
            table = rows(candidates, "candidates", nominal.num_joints,
                         "joint values (rad, m) of each candidate")
        with reading():
            core = _core.plan(nominal._core, known._core, table,
                              text_of("plan", keywords), count)
    if check and core.status != "done":
        raise CalibrationError(f"{core.status}: {core.message}", Plan(core))
    return Plan(core)


def simulate(arm: Any, joint_values: Any = None, *, count: int | None = None,
             sigma: float | None = None, seed: int | None = None) -> Dataset:
    """Positions of an arm's first target with Gaussian noise: what a real arm
    of this geometry would be measured as.

    arm
        the real arm; or, alone, the path of a simulation file.
    joint_values, count
        (N, n) configurations, or how many are drawn within the limits.
    sigma
        standard deviation of each coordinate (m); none: exact.
    """
    if joint_values is None and count is None:
        if isinstance(arm, Arm):
            raise wrong("joint_values", "found None, expected configurations "
                        "or their count")
        file = path(arm, "arm")
        _refuse("the simulation file's", "an Arm", sigma=sigma, seed=seed)
        return Dataset._of(_core.simulate_file(file)["data"])
    real = arm_of(arm)
    number = seed_of(1 if seed is None else seed)
    if joint_values is None:
        joints = real.draw(integer(count, "count", 1, 10**7), seed=number)
    elif count is not None:
        raise wrong("count", "found beside joint_values, expected one of both")
    else:
        joints = rows(joint_values, "joint_values", real.num_joints,
                      "joint values (rad, m)")
    noise = numbers(0.0 if sigma is None else sigma, "sigma", "a length (m)")
    if noise.ndim or not noise >= 0 or not np.isfinite(noise):
        raise wrong("sigma", f"found {sigma!r}, expected a length (m), 0 or "
                    "more")
    return Dataset._of(_core.simulate_at(real._core, joints, float(noise),
                                         number))


@takes_options("calibrate", "montecarlo")
def montecarlo(arm: Any, data: Any = None, *, trials: int | None = None,
               seed: int | None = None, study: Mapping[str, Any] | None = None,
               truth: Any = None, threads: int = 0, progress: Any = None,
               **options: Any) -> MonteCarlo:
    """Many simulated calibrations of the same poses and sigmas: bias and spread
    of every parameter, how often intervals hold the truth, the error over the
    workspace (docs/uncertainty.md).

    arm, data, **options
        as of `calibrate`; or the path of a job file alone, with its
        `montecarlo` (a `Job` and keywords of one's own otherwise).
    trials, seed
        1000 and 1 by default.
    truth
        the real arm, which trials simulate; None: the arm that the data
        identify.
    study
        further options of the study, a dict:

    {options}

    progress
        called as progress(done, wanted).
    """
    count = threads_of(threads)
    callable_or_none(progress, "progress")
    if data is None and (isinstance(arm, str) or hasattr(arm, "__fspath__")):
        _refuse("the job's", "a Job", trials=trials, seed=seed, study=study,
                truth=truth, **options)
        return MonteCarlo(_core.montecarlo_file(path(arm, "arm"), count,
                                                progress))
    if isinstance(arm, Job):
        nominal, measured = arm.arm, arm.data
        chosen = _laid_on(arm, options)
    else:
        nominal, measured, chosen = _prepare(arm, data, count, options)
    _set_truth(chosen, truth, nominal)
    keywords = dict(
        study or {}, seed=seed_of(1 if seed is None else seed),
        trials=integer(1000 if trials is None else trials, "trials", 2))
    with reading():
        return MonteCarlo(_core.montecarlo(
            nominal._core, measured._core, chosen,
            text_of("montecarlo", keywords), count, progress))


def correct(nominal: Any, real: Any, *, poses: Any = None,
            joint_values: Any = None, inverse: bool = False,
            calibrated_tool: bool = False, task: str = "auto", target: int = 0,
            trials: int = 200, seed: int = 1, max_joint_change: float = 0.5,
            threads: int = 0) -> Record:
    """What to command so that the real arm goes where the nominal one was asked
    to (docs/robot.md).

    nominal, real
        the arm that the controller believes in, and the calibrated one (or the
        `Result`). Both get base and tool of the nominal one.
    poses
        targets (N, 4, 4) in the nominal arm's frame; with `joint_values`
        beside them, these choose the posture.
    joint_values
        (N, n): targets are where the nominal arm is with them.

    Returns joint_values and poses to command, status ("reached" ...) of each,
    asked_joints, shift (m), turn (rad), position_error (m), rotation_error.
    """
    believed = arm_of(nominal, "nominal")
    true = real.arm if isinstance(real, Result) else arm_of(real, "real")
    if believed.joint_types != true.joint_types:
        raise wrong("real", "has other joints than nominal, expected the same "
                    "number and types")
    if poses is None and joint_values is None:
        raise wrong("poses", "found None, expected poses or joint_values")
    targets = None if poses is None else transforms(poses, "poses")
    motors = None
    if joint_values is not None:
        motors = rows(joint_values, "joint_values", believed.num_joints,
                      "joint values (rad, m)",
                      None if targets is None else len(targets))
    options = dict(
        task=one_of(task, "task", ["auto", "pose", "axis", "position"]),
        target=believed._target(target), trials=integer(trials, "trials", 0),
        seed=seed_of(seed), threads=threads_of(threads),
        inverse=bool(inverse), calibrated_tool=bool(calibrated_tool),
        max_joint_change=positive(max_joint_change, "max_joint_change",
                                  "an angle (rad)"))
    true._target(target)
    if motors is not None and believed.has_motor_map:
        motors = believed.motors_from_joints(motors)
    done = record(_core.correct(believed._core, true._core, targets, motors,
                                options))
    if believed.has_motor_map:
        for name in ("joint_values", "asked_joints"):
            done[name] = believed.joints_from_motors(done[name])
    return done


def export(arm: Any, format: str, **keywords: Any) -> Record:
    """`Arm.export` of an arm, its file, or a result."""
    given = arm.arm if isinstance(arm, Result) else arm_of(arm)
    return given.export(format, **keywords)


def compare(results: Sequence[Any], *, kind: str = "fleet",
            labels: Sequence[str] | None = None) -> Record:
    """Several results side by side: as a ``fleet`` (which arm is an outlier),
    one arm over ``time`` (which parameters changed), or ``methods`` of
    calibrating the same data (which leaves the lowest error). `results`:
    `Result`s or their directories."""
    if isinstance(results, (str, Result)) or not hasattr(results, "__iter__"):
        raise wrong("results", "expected a list of results")
    loaded = [one if isinstance(one, Result) else Result.load(
        path(one, f"results[{k}]")) for k, one in enumerate(results)]
    names = [str(k + 1) for k in range(len(loaded))]
    if labels is not None:
        names = [text(label, "labels") for label in labels]
        if len(names) != len(loaded):
            raise wrong("labels", f"found {len(names)}, expected {len(loaded)}"
                        ", one per result")
    return record(_core.compare([one._core for one in loaded], names,
                                one_of(kind, "kind",
                                       ["fleet", "time", "methods"])))


def batch(files: Any, directory: Path, *, threads: int = 0,
          fail_fast: bool = False, progress: Any = None) -> Record:
    """Runs every job of job files and folders that is not done already and
    writes their results below `directory` (docs/batch.md). Returns
    summary.json. `progress`: called as progress(done, jobs, name)."""
    if isinstance(files, str) or hasattr(files, "__fspath__"):
        files = [files]
    if not hasattr(files, "__iter__"):
        raise wrong("files", "expected a list of job files and folders")
    paths = [path(one, f"files[{k}]") for k, one in enumerate(files)]
    if not paths:
        raise wrong("files", "is empty, expected job files or folders")
    callable_or_none(progress, "progress")
    summary = _core.batch(paths, path(directory, "directory"),
                          threads_of(threads), bool(fail_fast), progress)
    return record(json.loads(summary))

