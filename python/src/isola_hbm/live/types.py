"""What is read from a run. Shapes are in brackets: p points, n dofs = modes, H harmonics. Units are SI."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, fields
from typing import Any, TypeVar

import numpy as np

from ..errors import Corrupt
from . import words
from .wire import Complexes, Floats, array, harmonics, is_array, variant

T = TypeVar("T")


def _plain(kind: type[T], message: dict[str, Any], **replaced: Any) -> T:
    """The dataclass from the fields of the same name; fields that are not known are left out."""
    try:
        values = {f.name: replaced[f.name] if f.name in replaced else message[f.name] for f in fields(kind)}  # type: ignore[arg-type]
    except (KeyError, TypeError) as error:
        raise Corrupt(f"{kind.__name__} without field {error}") from error
    return kind(**values)


def _optional(kind: type[T], message: dict[str, Any] | None) -> T | None:
    return None if message is None else _plain(kind, message)


@dataclass(frozen=True)
class Amplitude:
    """A forcing amplitude."""

    #: As typed: names tasks and files.
    text: str
    #: A, a factor of the forcing shape.
    value: float


@dataclass(frozen=True)
class Reach:
    """Within which frequencies and amplitudes branches are followed."""

    #: Lowest and highest frequency, rad/s.
    frequency: tuple[float, float]
    #: Largest amplitude of the first monitored dof, m.
    amplitude: float


@dataclass(frozen=True)
class ModesFollowed:
    """Which modes have a backbone, and which not. Modes count from 0."""

    #: The primary mode first.
    followed: tuple[int, ...]
    #: The others, with the reasons in words.
    left_out: tuple[tuple[int, str], ...]

    @classmethod
    def read(cls, message: dict[str, Any]) -> ModesFollowed:
        """From a part of the message."""
        left_out = ((mode, words.left_out(why)) for mode, why in message["left_out"])
        return cls(tuple(message["followed"]), tuple(left_out))


@dataclass(frozen=True)
class Manifest:
    """What a run is."""

    #: Version of the messages.
    protocol: int
    #: Version of the program.
    program: str
    #: Name of the run.
    run: str
    #: Name of the study.
    name: str
    #: SHA-256 of the model message.
    model_sha256: str
    #: Numerical settings, as in a study file.
    settings: dict[str, Any]
    #: None as long as the backbone is not known.
    reach: Reach | None
    #: Which modes have a backbone and which not; None as long as that is not known.
    modes: ModesFollowed | None
    #: Forcing levels.
    amplitudes: tuple[Amplitude, ...]
    #: Names of the monitored dofs; the first one is plotted.
    monitors: tuple[str, ...]
    #: ``backbone``, ``sweep``, ``finished`` or ``cancelled``.
    stage: str

    @classmethod
    def read(cls, message: dict[str, Any]) -> Manifest:
        """From the message."""
        reach = message.get("reach")
        return _plain(
            cls,
            message,
            reach=reach and Reach(tuple(reach["frequency"]), reach["amplitude"]),
            modes=ModesFollowed.read(message["modes"]) if message.get("modes") else None,
            amplitudes=tuple(_plain(Amplitude, a) for a in message["amplitudes"]),
            monitors=tuple(message["monitors"]),
        )


@dataclass(frozen=True)
class Progress:
    """Where a curve under way is."""

    #: Points so far.
    points: int
    #: ω, rad/s.
    omega: float
    #: Amplitude of the first monitored dof, m.
    amplitude: float


@dataclass(frozen=True)
class Counts:
    """Tasks by state, and branches found."""

    done: int
    skipped: int
    running: int
    waiting: int
    dead: int
    branches: int


@dataclass(frozen=True)
class LevelStatus:
    """A forcing level under way."""

    #: Forcing amplitude, as typed.
    amplitude: str
    #: Tasks done or not needed.
    done: int
    #: Tasks in all.
    total: int
    #: Branches found.
    branches: int
    #: Where the branch under way is.
    progress: Progress | None


@dataclass(frozen=True)
class WorkerStatus:
    """A worker process."""

    #: Its name.
    worker: str
    #: Tasks under way, one per computing thread.
    tasks: tuple[str, ...]
    #: Number of tasks done.
    done: int
    #: Where its (first) branch is.
    progress: Progress | None


@dataclass(frozen=True)
class StalledTask:
    """A task under way of which nothing new has come for long, though its worker gives signs of life."""

    #: Which.
    task: str
    #: Who has it.
    worker: str
    #: For how long, s.
    seconds: float


@dataclass(frozen=True)
class Status:
    """How a run is doing; new every second."""

    run: str
    name: str
    #: ``backbone``, ``sweep``, ``finished`` or ``cancelled``.
    stage: str
    #: Where the backbone is.
    backbone: Progress | None
    tasks: Counts
    #: Number of levels.
    levels: int
    #: Levels whose tasks are all done.
    levels_done: int
    active: tuple[LevelStatus, ...]
    workers: tuple[WorkerStatus, ...]
    #: Tasks that do not get on, though their workers give signs of life.
    stalled: tuple[StalledTask, ...]
    #: Number of announcements so far.
    sequence: int
    #: Time since the coordinator started, s.
    elapsed: float
    #: Time to the end, estimated, s.
    eta: float | None

    @property
    def is_over(self) -> bool:
        """Whether no branch will come any more."""
        return self.stage in ("finished", "cancelled")

    @classmethod
    def read(cls, message: dict[str, Any]) -> Status:
        """From the message."""

        def progress(part: dict[str, Any]) -> Progress | None:
            return _optional(Progress, part["progress"])

        return _plain(
            cls,
            message,
            backbone=_optional(Progress, message["backbone"]),
            tasks=_plain(Counts, message["tasks"]),
            active=tuple(_plain(LevelStatus, a, progress=progress(a)) for a in message["active"]),
            workers=tuple(
                _plain(WorkerStatus, w, tasks=tuple(w["tasks"]), progress=progress(w))
                for w in message["workers"]
            ),
            stalled=tuple(_plain(StalledTask, s) for s in message.get("stalled", ())),
        )


@dataclass(frozen=True)
class Element:
    """A nonlinear element."""

    #: Name shown to people (a contact node, say).
    name: str
    #: One list of (dof, coefficient) pairs per argument of the law.
    channels: tuple[tuple[tuple[int, float], ...], ...]
    #: Name of the law: ``contact``, ``penalty_spring``, ``polynomial_spring``, …
    law: str
    #: Its parameters, SI units.
    parameters: dict[str, Any]


@dataclass(frozen=True, eq=False)
class Model:
    """The structure, n dofs."""

    name: str
    #: Names of the dofs, n.
    dofs: tuple[str, ...]
    #: Mass matrix [n, n], kg.
    mass: Floats = field(repr=False)
    #: Stiffness matrix [n, n], N/m.
    stiffness: Floats = field(repr=False)
    #: Eigenfrequencies [n], rad/s.
    frequencies: Floats = field(repr=False)
    #: Mass-normalised mode shapes [n, n], a column per mode.
    shapes: Floats = field(repr=False)
    #: Modal damping [n], or a full matrix in modal coordinates [n, n], 1/s.
    damping: Floats = field(repr=False)
    #: Forcing shape [n], N per unit of A.
    forcing: Floats = field(repr=False)
    #: Harmonic of the response that is forced.
    forcing_harmonic: int
    elements: tuple[Element, ...] = field(repr=False)
    #: Indices of the monitored dofs.
    monitors: tuple[int, ...]

    @property
    def C(self) -> Floats:
        """Damping matrix [n, n], N·s/m, that was computed with: the one that damps the modes so where the model or the study gives ratios."""
        modal = np.diag(self.damping) if self.damping.ndim == 1 else self.damping
        weighted = self.mass @ self.shapes
        damping: Floats = weighted @ modal @ weighted.T
        return damping

    def index(self, dof: str | int) -> int:
        """Index of a dof by its name (an index is checked and returned, negative ones count from the end)."""
        if isinstance(dof, str):
            if dof not in self.dofs:
                known = ", ".join(self.dofs[:12]) + (", …" if len(self.dofs) > 12 else "")
                raise KeyError(f"no dof `{dof}`; there are {known}")
            return self.dofs.index(dof)
        return range(len(self.dofs))[dof]

    @classmethod
    def read(cls, message: dict[str, Any]) -> Model:
        """From the message."""

        def element(part: dict[str, Any]) -> Element:
            channels = tuple(tuple((dof, factor) for dof, factor in channel) for channel in part["channels"])
            return Element(part["name"], channels, *variant(part["law"]))

        names = ("mass", "stiffness", "frequencies", "shapes", "damping", "forcing")
        return _plain(
            cls,
            message,
            dofs=tuple(message["dofs"]),
            elements=tuple(element(e) for e in message["elements"]),
            monitors=tuple(message["monitors"]),
            **{name: array(message[name]) for name in names},
        )


@dataclass(frozen=True)
class Window:
    """An arc of a backbone along which forced responses are predicted at a level."""

    #: Mode of the backbone, from 0.
    mode: int
    #: Indices of its first and last backbone point, and of the one with the smallest threshold.
    first: int
    last: int
    best: int
    #: Smallest threshold amplitude A* inside.
    threshold: float
    #: Lowest and highest frequency inside, rad/s.
    omega: tuple[float, float]


@dataclass(frozen=True)
class LevelWindows:
    """The windows of a level, backbone by backbone."""

    amplitude: Amplitude
    windows: tuple[Window, ...]

    @classmethod
    def read(cls, message: dict[str, Any]) -> LevelWindows:
        """From a part of the message."""
        return cls(
            _plain(Amplitude, message["amplitude"]),
            tuple(
                _plain(Window, w, mode=w.get("mode", 0), omega=tuple(w["omega"])) for w in message["windows"]
            ),
        )


@dataclass(frozen=True, eq=False)
class Curve:
    """p periodic motions of a structure: what branches and the backbone share."""

    #: ω [p], rad/s.
    omega: Floats = field(repr=False)
    #: Decay rate ζ [p], 1/s; zero on forced responses.
    decay: Floats = field(repr=False)
    #: Forcing amplitude A [p]; zero on a backbone of free motions.
    forcing: Floats = field(repr=False)
    #: Largest |x| over the period of every monitored dof [p, monitors], m.
    amplitudes: Floats = field(repr=False)
    #: Root mean square of every monitored dof [p, monitors], m.
    rms: Floats = field(repr=False)
    #: Share of the period in contact [p, contact elements].
    contact: Floats = field(repr=False)
    #: Largest scaled residual [p].
    residual: Floats = field(repr=False)
    #: Share of the two highest harmonics in the norm of the motion [p].
    high_harmonics: Floats = field(repr=False)
    #: Newton iterations [p].
    iterations: Floats = field(repr=False)
    #: Every array with one row a point that was sent (those of a backbone win), also those that have no attribute
    #: here, by the names of ``MESSAGES.md`` [p, …].
    columns: Mapping[str, Floats] = field(repr=False)
    #: Complex harmonics of the modal amplitudes [p, n, H + 1], kg^½·m.
    modal: Complexes = field(repr=False)
    #: Complex harmonics of the arguments of all laws [p, arguments, H + 1]: predicted pressure in N for the first
    #: argument of contacts, relative displacement in m for everything else.
    arguments: Complexes = field(repr=False)
    #: The structure.
    model: Model = field(repr=False)

    def __len__(self) -> int:
        """Number of points p."""
        return len(self.omega)

    @property
    def harmonics(self) -> int:
        """Number of harmonics H."""
        return int(self.modal.shape[-1]) - 1

    def displacement(self, dofs: str | int | Iterable[str | int] | None = None) -> Complexes:
        """Complex harmonics X_k of displacements, m: x(t) = Re Σ_k X_k exp(i k ω t), k = 0 … H.

        For one dof (name or index) [p, H + 1]; for several [p, dofs, H + 1]; all dofs by default.
        """
        if isinstance(dofs, (str, int, np.integer)):
            return self.displacement([dofs])[:, 0]
        chosen = range(len(self.model.dofs)) if dofs is None else [self.model.index(dof) for dof in dofs]
        return np.matmul(self.model.shapes[list(chosen)], self.modal)

    def over_period(
        self, dof: str | int, samples: int = 256, points: int | slice | Sequence[int] = slice(None)
    ) -> Floats:
        """x(t) of one dof at t = 0, T/samples, … (the end of the period left out), m.

        [points, samples] for the points chosen (all by default), [samples] for one index.
        """
        values = self.displacement(dof)[points]
        angles = 2j * np.pi * np.outer(np.arange(self.harmonics + 1), np.arange(samples)) / samples
        return np.real(values @ np.exp(angles))


def columns_of(message: dict[str, Any]) -> dict[str, Floats]:
    """The arrays of real numbers among the fields of a message: what is not known here and no sound array is left out."""
    columns = {}
    for name, value in message.items():
        if isinstance(name, str) and is_array(value):
            with suppress(Corrupt):
                columns[name] = array(value)
    return columns


def curve_fields(
    message: dict[str, Any], model: Model, others: Mapping[str, Floats] | None = None
) -> dict[str, Any]:
    """Fields of a :class:`Curve` from a `points` part of a message; `others` are columns that stand beside it."""
    motions = message["motions"]
    names = ("rms", "contact", "residual", "high_harmonics", "iterations")
    columns = {**columns_of(message), **(others or {})}
    read = {
        "omega": array(motions["omega"]),
        "decay": array(motions["decay"]),
        "forcing": array(motions["forcing"]),
        "modal": harmonics(motions["modal"]),
        "arguments": harmonics(motions["argument"]),
        "amplitudes": array(message["amplitude"]),
        **{name: array(message[name]) for name in names},
    }
    count, modes = len(read["omega"]), len(model.dofs)
    if any(values.shape[:1] != (count,) for values in read.values()) or read["modal"].shape[1] != modes:
        shapes = {name: values.shape for name, values in read.items()}
        raise Corrupt(f"arrays do not fit a model of {modes} modes: {shapes}")
    # What is not known may be of something else than points.
    columns = {name: values for name, values in columns.items() if values.shape[:1] == (count,)}
    return {**read, "columns": columns, "model": model}


@dataclass(frozen=True, eq=False)
class Backbone(Curve):
    """The nonlinear normal mode with its energy balance, p points."""

    #: Mode it starts from, from 0.
    mode: int
    #: How it begins and ends, in words.
    outcome: str
    #: Steps refused and repeated shorter.
    rejections: int
    #: Dissipated by the linear damping [p], J a period.
    r_lin: Floats = field(repr=False)
    #: Dissipated by the nonlinear forces [p], J a period.
    r_nl: Floats = field(repr=False)
    #: Largest work of the forcing per unit of A [p], J a period.
    work_per_amplitude: Floats = field(repr=False)
    #: Relative defect of the energy balance [p].
    certificate: Floats = field(repr=False)
    #: Threshold A* [p]: forced responses are predicted for A > A*; infinite where the forcing does no work.
    threshold: Floats = field(repr=False)
    #: Scaled arc length [p].
    arc: Floats = field(repr=False)
    #: Shares of the modes [p, n], summing to 1.
    contributions: Floats = field(repr=False)

    @classmethod
    def read(cls, message: dict[str, Any], model: Model) -> Backbone:
        """From the message."""
        names = ("r_lin", "r_nl", "work_per_amplitude", "certificate", "threshold", "arc", "contributions")
        arrays: dict[str, Any] = {name: array(message[name]) for name in names}
        return cls(
            **curve_fields(message["points"], model, columns_of(message)),
            mode=message["mode"],
            outcome=words.outcome(message["outcome"]),
            rejections=message["rejections"],
            **arrays,
        )


@dataclass(frozen=True)
class SpecialPoint:
    """A point of a branch worth a mark."""

    #: ``start``, ``peak`` or ``fold``.
    kind: str
    #: Its index among the points.
    index: int


@dataclass(frozen=True)
class Certificate:
    """What is known of the harmonics beyond H that a branch leaves out; None where it was not computed."""

    #: Largest penetration of a contact over its gap.
    penetration: float | None
    #: Largest share (rms) of the contact pressure beyond H.
    pressure_beyond: float | None
    #: Largest amplitude of the first monitored dof with the peak converged again at 2 H, m.
    amplitude_2h: float | None
    #: Relative shift of the peak's frequency then.
    shift_2h: float | None
    #: Lowest frequency of an isola with its folds converged again at 2 H, rad/s.
    omega_min_2h: float | None
    #: Highest frequency then, rad/s.
    omega_max_2h: float | None
    #: How far the branch moves at most with 2 H harmonics at points compared, relative to frequency and amplitude;
    #: None where near most of them no motion was found.
    change_2h: float | None
    #: Frequency there, rad/s.
    change_omega_2h: float | None
    #: Lowest and highest frequency at which a contact touches, located between points, rad/s; None where none does.
    contact_omega: tuple[float, float] | None
    #: Slowest sliding of a contact along the rotation while it presses, over the speed of the rotor there: where it is not above zero the
    #: sliding stops or turns round, for which the law of friction is not made. None where none with friction presses.
    slowest_sliding: float | None

    @classmethod
    def read(cls, message: dict[str, Any] | None) -> Certificate:
        """From the message; runs of the first programs have none."""
        message = message or {}
        doubled = message.get("doubled") or {}
        low, high = doubled.get("range") or (None, None)
        elsewhere = message.get("elsewhere") or {}
        return cls(
            penetration=message.get("penetration"),
            pressure_beyond=message.get("pressure_beyond"),
            amplitude_2h=doubled.get("amplitude"),
            shift_2h=doubled.get("shift"),
            omega_min_2h=low,
            omega_max_2h=high,
            change_2h=elsewhere.get("share"),
            change_omega_2h=elsewhere.get("omega"),
            contact_omega=tuple(message["contact_omega"]) if message.get("contact_omega") else None,
            slowest_sliding=message.get("slowest_sliding"),
        )


@dataclass(frozen=True, eq=False)
class Branch(Curve):
    """A forced-response branch at one forcing amplitude; a closed one does not repeat its first point."""

    #: Task that found it.
    task: str
    #: Forcing amplitude A.
    amplitude: float
    #: A as typed.
    amplitude_text: str
    #: ``main`` (ordinary continuation reaches it), ``isola`` (closed), ``open`` (detached, from frequency bound to
    #: frequency bound), ``cut`` (leaves through a bound that was given), ``branched`` (branches off others, less symmetric or of
    #: a longer period) or ``unfinished``.
    kind: str
    #: Number within its level and kind, from 1; 0 for the first main branch.
    number: int
    #: Whether it is a closed curve.
    closed: bool
    #: How it ends, in words.
    outcome: str
    #: Start, peak and folds.
    special: tuple[SpecialPoint, ...]
    #: Steps refused and repeated shorter.
    rejections: int
    #: ``at``: the largest amplitude is that of a maximum; ``at_least``: it is only as far as the branch is known. None
    #: in runs of the first programs.
    peak_standing: str | None
    #: What is known of the harmonics left out.
    certificate: Certificate

    @property
    def name(self) -> str:
        """``main``, ``isola 1``, …"""
        return f"{self.kind} {self.number}" if self.number else self.kind

    @property
    def peak(self) -> int:
        """Index of the point of largest amplitude of the first monitored dof."""
        return int(np.argmax(self.amplitudes[:, 0]))

    def __repr__(self) -> str:
        return f"<Branch {self.name} at A = {self.amplitude_text}, {len(self)} points, {self.outcome}>"


@dataclass(frozen=True, eq=False)
class FoldCurve(Curve):
    """Folds of branches, or responses of open ones at one frequency, followed over the forcing amplitude; a closed curve does not repeat its first point."""

    #: Task that found it.
    task: str
    #: What has an extremum along the branch at its points: ``"frequency"``, or nothing at one frequency.
    quantity: str | None
    #: Whether it is a closed curve.
    closed: bool
    #: How it begins and ends, in words.
    outcome: str
    #: Where isolas are born (``birth``) or vanish (``death``), branches merge (``merge``), two folds meet (``cusp``).
    events: tuple[SpecialPoint, ...]
    #: Steps refused and repeated shorter.
    rejections: int

    def __repr__(self) -> str:
        return f"<FoldCurve of {len(self)} points, {self.outcome}>"


@dataclass(frozen=True)
class Done:
    """Announcement of a stored result."""

    #: Counts the announcements of a run, from 1.
    sequence: int
    #: Task.
    task: str
    amplitude: Amplitude
    #: What became of it, in words.
    outcome: str
    #: Name of the new branch, if it found one: ``main``, ``isola 1``, …
    branch: str | None
    #: Size of the result, bytes.
    size: int
    #: SHA-256 of the result.
    sha256: str

    @classmethod
    def read(cls, message: dict[str, Any]) -> Done:
        """From the message."""
        branch = message["branch"]
        return _plain(
            cls,
            message,
            amplitude=_plain(Amplitude, message["amplitude"]),
            outcome=words.seed_outcome(message["outcome"]),
            branch=None if branch is None else words.branch_name(branch),
        )


@dataclass(frozen=True)
class Result:
    """What a task led to."""

    task: str
    #: Which attempt was accepted, from 1.
    attempt: int
    amplitude: Amplitude
    #: What was to be done: ``"main"``, ``{"main": "above"}``, ``{"land": {…}}``, ``{"seed": {…}}``, ``{"fold": {…}}``,
    #: ``{"crossing": {…}}``, ``{"start": {…}}``, ``{"begin": {…}}``, ``{"scout": {…}}``, ``{"verify": {…}}``, ``{"disturb": {…}}``,
    #: ``{"march": {…}}``, ``{"carry": {…}}`` or ``{"switch": {…}}``.
    work: Any
    #: What became of it, in words.
    outcome: str
    #: The new branch, if it found one.
    branch: Branch | None
    #: The new curve over the forcing, if it found one.
    curve: FoldCurve | None
    #: What marching says of a branch, as in the message, if the task verified one.
    verification: dict[str, Any] | None
    #: Where pushes end, as in the message, if the task marched some.
    disturbance: dict[str, Any] | None
    #: What an unstable motion turns into, as in the message, if the task followed one.
    settling: dict[str, Any] | None
    #: Who computed it.
    worker: str
    #: With which version of the program.
    program: str
    #: Computing time, s.
    seconds: float

    @classmethod
    def read(cls, message: dict[str, Any], model: Model) -> Result:
        """From the message."""
        amplitude = _plain(Amplitude, message["amplitude"])
        part, branch = message["branch"], None
        if part is not None:
            kind, number = variant(message["name"])
            branch = Branch(
                **curve_fields(part["points"], model),
                task=message["task"],
                amplitude=part["amplitude"],
                amplitude_text=amplitude.text,
                kind=kind,
                number=0 if number is None else number + 1,
                closed=part["outcome"] == "closed",
                outcome=words.outcome(part["outcome"]),
                special=tuple(_plain(SpecialPoint, s) for s in part["special"]),
                rejections=part["rejections"],
                peak_standing=part.get("peak_standing"),
                certificate=Certificate.read(part.get("certificate")),
            )
        outcome, curve = words.seed_outcome(message["outcome"]), None
        if (part := message.get("curve")) is not None:
            curve = FoldCurve(
                **curve_fields(part["points"], model),
                task=message["task"],
                quantity=part["quantity"],
                closed=part["outcome"] == "closed",
                outcome=words.outcome(part["outcome"]),
                events=tuple(_plain(SpecialPoint, event) for event in part["events"]),
                rejections=part["rejections"],
            )
        found = {"branch": branch, "curve": curve}
        found |= {name: message.get(name) for name in ("verification", "disturbance", "settling")}
        return _plain(cls, message, amplitude=amplitude, outcome=outcome, **found)
