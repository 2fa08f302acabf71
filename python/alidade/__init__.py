"""Alidade: identifies the true geometry of robot arms from measured poses.

    import alidade

    arm = alidade.Arm.load("arm.yaml")
    data = alidade.Dataset(joint_values, positions, sigma=2e-5)
    result = alidade.calibrate(arm, data, parameters=["joints", "base", "tool"])
    result["d3"].value, result["d3"].std, result.validation, result.arm

Lengths are in metres, angles in radians. `help(alidade.calibrate)` lists all
options; docs/python.md is the guide.
"""

from . import _core
from ._arm import Arm
from ._calls import (Job, batch, calibrate, compare, correct, export, identify,
                     montecarlo, plan, simulate)
from ._dataset import Dataset
from ._errors import CalibrationError, InputError
from ._record import Figures, Record, Svg
from ._results import (Evaluation, Identification, MonteCarlo, Plan, Result)

__version__ = _core.version()

#: Units, to multiply by: ``positions = table * alidade.mm``.
mm = 1e-3
um = 1e-6
deg = 3.14159265358979323846 / 180.0
mrad = 1e-3

__all__ = [
    "Arm", "CalibrationError", "Dataset", "Evaluation", "Figures",
    "Identification", "InputError", "Job", "MonteCarlo", "Plan", "Record",
    "Result", "Svg", "batch", "calibrate", "compare", "correct", "deg",
    "export", "identify", "mm", "montecarlo", "mrad", "plan", "simulate", "um",
]
