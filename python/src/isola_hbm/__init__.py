"""Reads running Isola studies: forced responses of nonlinear structures, branch by branch, as NumPy arrays.

>>> import isola_hbm
>>> with isola_hbm.connect("tcp/127.0.0.1:7447") as bus:
...     for branch in bus.run().follow():
...         print(branch.name, branch.omega, branch.amplitudes)
"""

from .errors import Corrupt, IsolaError, NoAnswer, NoSuchRun, OtherVersion, Refused, Unreachable
from .live.bus import Bus, connect
from .live.run import Run
from .live.types import (
    Amplitude,
    Backbone,
    Branch,
    Certificate,
    Counts,
    Curve,
    Done,
    Element,
    FoldCurve,
    LevelStatus,
    LevelWindows,
    Manifest,
    Model,
    ModesFollowed,
    Progress,
    Reach,
    Result,
    SpecialPoint,
    Status,
    Window,
    WorkerStatus,
)
from .live.wire import NAMESPACE, VERSION

__all__ = [
    "NAMESPACE",
    "VERSION",
    "Amplitude",
    "Backbone",
    "Branch",
    "Bus",
    "Certificate",
    "Corrupt",
    "Counts",
    "Curve",
    "Done",
    "Element",
    "FoldCurve",
    "IsolaError",
    "LevelStatus",
    "LevelWindows",
    "Manifest",
    "Model",
    "ModesFollowed",
    "NoAnswer",
    "NoSuchRun",
    "OtherVersion",
    "Progress",
    "Reach",
    "Refused",
    "Result",
    "Run",
    "SpecialPoint",
    "Status",
    "Unreachable",
    "Window",
    "WorkerStatus",
    "connect",
]
