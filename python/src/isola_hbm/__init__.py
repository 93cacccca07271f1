"""Isola from Python: forced responses of nonlinear structures, with their isolas.

A run on disk, finished or not, as data frames and datasets:

>>> import isola_hbm
>>> run = isola_hbm.load("runs/damper")
>>> run.summary  # a row a branch
>>> print(run.status())  # what the program says of it
>>> run["0.006/isola 1"].time()

A model made of matrices, and its sweep; figures:

>>> spring = isola_hbm.Law("polynomial_spring", dof="x1", terms=[{"power": 3, "coefficient": 1}])
>>> model = isola_hbm.Model(M=[[1]], K=[[1]], damping={"default_ratio": 0.05}, laws=[spring])
>>> print(model.check())  # what the program makes of it
>>> run = isola_hbm.sweep(model, amplitudes=[0.02, 0.05, 0.1])  # the resonance leans to higher frequencies
>>> run.plot.response()
>>> run = isola_hbm.extend(run, [0.07])  # a level more; isola_hbm.resume(run) goes on with an interrupted one

A run that goes on, from anywhere on its bus, branch by branch:

>>> with isola_hbm.connect("tcp/127.0.0.1:7447") as bus:
...     for branch in bus.run().follow():
...         print(branch.name, branch.omega, branch.amplitudes)
"""

from .errors import (
    BadModel,
    BadStudy,
    Corrupt,
    Damaged,
    Doubtful,
    FolderInUse,
    Incomplete,
    IsolaError,
    LeftOut,
    ModelRefused,
    NoAnswer,
    NoProgram,
    NoSuchBranch,
    NoSuchRun,
    OtherVersion,
    ProgramFailed,
    Refused,
    StudyRefused,
    Unreachable,
)
from .laws import Contact, Law
from .live.asynchronous import Following
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
    ModesFollowed,
    Progress,
    Reach,
    Result,
    SpecialPoint,
    StalledTask,
    Status,
    Window,
    WorkerStatus,
)
from .live.wire import NAMESPACE, VERSION
from .model import Model
from .stored.motions import Motions
from .stored.run import StoredRun, load
from .sweeps import extend, resume, sweep

__all__ = [
    "NAMESPACE",
    "VERSION",
    "Amplitude",
    "Backbone",
    "BadModel",
    "BadStudy",
    "Branch",
    "Bus",
    "Certificate",
    "Contact",
    "Corrupt",
    "Counts",
    "Curve",
    "Damaged",
    "Done",
    "Doubtful",
    "Element",
    "FoldCurve",
    "FolderInUse",
    "Following",
    "Incomplete",
    "IsolaError",
    "Law",
    "LeftOut",
    "LevelStatus",
    "LevelWindows",
    "Manifest",
    "Model",
    "ModelRefused",
    "ModesFollowed",
    "Motions",
    "NoAnswer",
    "NoProgram",
    "NoSuchBranch",
    "NoSuchRun",
    "OtherVersion",
    "ProgramFailed",
    "Progress",
    "Reach",
    "Refused",
    "Result",
    "Run",
    "SpecialPoint",
    "StalledTask",
    "Status",
    "StoredRun",
    "StudyRefused",
    "Unreachable",
    "Window",
    "WorkerStatus",
    "connect",
    "extend",
    "load",
    "resume",
    "sweep",
]
