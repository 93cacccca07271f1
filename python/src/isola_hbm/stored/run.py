"""A run, finished, running or damaged, as its store has it."""

from __future__ import annotations

import html
import sys
import warnings
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import pandas as pd
import xarray as xr

from ..counted import count
from ..errors import Damaged, LeftOut, NoSuchBranch, NoSuchRun
from ..live import types
from ..program import Page, page, status
from . import check, curves, outcomes, tables
from .keys import Key, find, missing
from .levels import Omissions, levels, named
from .motions import Motions, index_of
from .names import Names, model
from .store import Reading, Store

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

if TYPE_CHECKING:
    from ..plots import Plots

T = TypeVar("T")


def load(where: str | PathLike[str], order: int | None = None) -> StoredRun:
    """Opens a run on disk, whether it is finished, goes on or is damaged. Needs neither the program nor a bus.

    >>> from isola_hbm import load
    >>> run = load("runs/damper")
    >>> run.summary
    >>> run["0.006/isola 1"].amplitude

    Args:
        where: Folder of the run, or its file ``run.sqlite``.
        order: Of a run that looks for several orders of motions (``search.harmonics``): which one is told of, as of a run of its own. Those
            of order m last m periods of the force. By default the first one, whose main branches are followed; see
            :attr:`StoredRun.orders`. Backbones are those of the first order, others are without.

    Raises:
        NoSuchRun: There is no run, or something that is none, or it does not look for this order.
        OtherVersion: It was written by a later program.
        Damaged: Nothing of it can be read.
    """
    store = Store(where)
    if order is None:
        return StoredRun(store)
    run = StoredRun(store)
    first, further = run.model.forcing_harmonic, store.orders()
    if order != first and order not in further:
        there = ", ".join(str(known) for known in [first, *further])
        raise NoSuchRun(f"{store.file}: there are no motions of order {order} in it, but of {there}")
    return run if order == first else StoredRun(Store(where, order))


class StoredRun(Mapping[str, Motions]):
    """A run on disk: its branches by name (``"60/isola 1"``), and tables of what was found.

    Everything is read when it is asked for, and is what the run has at that moment; a run in progress grows. What cannot
    be read of a damaged run is left out with a warning (:class:`LeftOut`); asked for by name it raises :class:`Damaged`.

    ``isola schema --columns`` says what words and columns of tables mean, :meth:`status` what was found, in sentences.
    """

    def __init__(self, store: Store) -> None:
        self._store = store
        self._known_names: Names | None = None
        with store.read() as reading:
            #: Facts about the run as the table `meta` has them: run, name, program, created, study, ….
            self.meta: Mapping[str, str] = _facts(reading)

    @property
    def folder(self) -> Path:
        """Folder of the run."""
        return self._store.folder

    @property
    def orders(self) -> list[int]:
        """Orders of motions that the run looks for, the first one first: ``load(folder, order=3)`` tells of another one."""
        with Store(self._store.file).read() as reading:
            return [model(reading).forcing_harmonic, *self._store.orders()]

    @property
    def name(self) -> str:
        """Name of the study."""
        return str(self.meta.get("name", self.folder.name))

    @property
    def study(self) -> str:
        """The study with every setting spelled out, TOML."""
        return str(self.meta.get("study", ""))

    @property
    def units(self) -> str:
        """Units in which the run is shown, as ``isola sweep --units`` takes them; numbers of the run are in SI units."""
        return self._kept_units() or "m,rad/s"

    def _kept_units(self) -> str:
        """Those that its study names."""
        try:
            study = tomllib.loads(self.study)
        except tomllib.TOMLDecodeError:
            study = {}
        return str(study.get("units", "")).replace("µm", "um")

    @property
    def stage(self) -> str:
        """Where the run is: ``backbone``, ``sweep``, ``finished`` or ``cancelled``."""
        return self._read(lambda reading, _: str(reading.fact("stage") or "unknown"))

    @property
    def counts(self) -> types.Counts:
        """Tasks by state, and branches found."""

        def read(reading: Reading, _: Omissions) -> types.Counts:
            rows = reading.rows("SELECT state, count(*) AS number FROM tasks GROUP BY state")
            of = {row["state"]: row["number"] for row in rows}
            states = {name: of.get(name, 0) for name in ("done", "skipped", "waiting", "dead")}
            branches = reading.column("SELECT count(*) FROM branches")[0]
            return types.Counts(**states, running=of.get("leased", 0), branches=branches)

        return self._read(read)

    @property
    def summary(self) -> pd.DataFrame:
        """A row a branch, by the name that the run has it by: the columns of ``summary.csv``, and what else the store has.

        `amplitude` is the forcing A; `omega_…` in rad/s, `amplitude_max` in m (first monitored dof): SI whatever the units of the run,
        as ``summary.attrs["units"]`` says. What matters most stands first. Names count the branches of each
        level by themselves: `family` says which isolas of several levels are taken to be one.
        """
        return self._read(tables.summary)

    @property
    def windows(self) -> pd.DataFrame:
        """Every window that the energy balance predicts, with the branches that its seeds led to or the reason why
        to none: the columns of ``windows.csv`` (rad/s; modes from 1; points of the backbone from 0). `outcome` is ``found``,
        ``elsewhere`` (none of the branches has its frequencies), ``passed`` (no seed landed near it, but known branches pass by),
        ``not_found`` or ``pending``."""
        return self._read(tables.windows)

    @property
    def folds(self) -> pd.DataFrame:
        """Fold curves: where branches turn back, over the forcing. The columns of ``folds.csv`` (rad/s, m)."""
        return self._read(lambda reading, _: tables.folds(reading))

    @property
    def events(self) -> pd.DataFrame:
        """Births, deaths and merges of isolas, `computed` along fold curves and `predicted` by the energy balance: the
        columns of ``events.csv`` (rad/s, m). `mode` is the one that contributes most beside that of the `backbone`; `outcome`, what branches
        do where they merge or part, is what that file says, empty as long as it is not there. Of a further order of motions, without what is
        predicted."""
        files = self.folder if self.order is None else self.folder / f"m{self.order}"
        return outcomes.told(self._read(tables.events), files / "events.csv")

    @property
    def bifurcations(self) -> pd.DataFrame:
        """Where marched orbits of branches lose or regain stability: the columns of ``bifurcations.csv`` (rad/s, m)."""
        return self._read(lambda reading, _: tables.bifurcations(reading))

    @property
    def motions(self) -> pd.DataFrame:
        """What unstable motions turn into, by time marching: the columns of ``motions.csv`` (rad/s, m), and how many periods were
        marched. Empty unless branches were verified with the effort ``all``."""
        return self._read(lambda reading, _: tables.motions(reading))

    @property
    def pushes(self) -> pd.DataFrame:
        """The smallest impulses found that throw the structure from its main branch onto another one, mode by mode: the columns of
        ``pushes.csv`` (rad/s; N s at `monitor`; m/s; J), and why nothing was scanned. Empty before ``isola disturb``."""
        return self._read(lambda reading, _: tables.pushes(reading))

    @property
    def backbones(self) -> pd.DataFrame:
        """Points of the backbones of all modes followed: the columns of ``backbone.csv`` and what else the store has (rad/s, 1/s,
        m, J a period). `omega` and `amplitude` of the free motion of `mode`; `threshold` is A*, from which forcing on a response is
        predicted there, and `work_per_amplitude` the work of the forcing a period for A = 1. `piece` 0 grows out of the linear mode; further
        pieces are curves that cross it, or each other, at branch points, or what it goes on as beyond a tongue."""
        return self._read(tables.backbones)

    @property
    def points(self) -> pd.DataFrame:
        """Points of all branches in one table: name of the branch, forcing, and one number for each column of the store
        (of the first monitored dof; the largest over the contacts). For what every dof does, see ``run[name]``."""
        return self.columns()

    def columns(self, *names: str) -> pd.DataFrame:
        """As :attr:`points`, of these columns only: ``run.columns("omega", "amplitude")``.

        Raises:
            KeyError: There is no such column.
        """

        def read(reading: Reading, omissions: Omissions) -> pd.DataFrame:
            known = reading.columns("points")
            for name in names:
                if name not in known:
                    raise KeyError(f"no column `{name}`; there are {', '.join(known[2:])}")
            return tables.points(reading, omissions, names)

        return self._read(read)

    @cached_property
    def model(self) -> types.Model:
        """The structure as it was computed: matrices, mode shapes, dofs, elements with their laws. What the study gives over the file
        of the model, another damping say, is in it; :class:`isola_hbm.Model` is what such a file is written from."""
        return self._read(lambda reading, _: model(reading))

    @property
    def shapes(self) -> xr.DataArray:
        """Mode shapes Φ of all dofs, mass-normalised (kg^-0.5): x = Φ y. ``xr.dot(run.shapes, branch.modal, dim="mode")``
        has the harmonics of every dof."""
        structure = self.model
        coordinates = {"dof": list(structure.dofs), "mode": range(1, structure.shapes.shape[1] + 1)}
        attributes = {"long_name": "Mode shapes", "units": "kg^-0.5"}
        return xr.DataArray(structure.shapes, coordinates, ("dof", "mode"), "shapes", attributes)

    def table(self, name: str) -> pd.DataFrame:
        """A table of the store as it is, also one that this package knows nothing of: ``run.table("attempts")``.

        Raises:
            KeyError: There is no such table.
        """
        return self._read(lambda reading, _: tables.table_of(reading, name))

    def backbone(self, mode: int | None = None) -> Motions:
        """The backbone of a mode, from 1 (by default of the primary one), with its harmonics.

        Raises:
            NoSuchBranch: No backbone of this mode was followed, or it is not known yet.
        """

        def read(reading: Reading, _: Omissions) -> Motions:
            rows = tables.modes(reading)
            for row in rows:
                if mode in (None, row["mode"]):
                    return curves.backbone(
                        reading, row["mode"], row["owner"], row["outcome"], self._names(reading)
                    )
            followed = ", ".join(str(row["mode"]) for row in rows)
            raise NoSuchBranch(
                f"there is no backbone of mode {mode!r}; modes followed: {followed}"
                if rows
                else "there is no backbone yet"
            )

        return self._read(read)

    def state(self, branch: Key, point: int | str = "peak") -> xr.Dataset:
        """The motion at a point of a branch at t = 0, of all dofs: `displacement` x(0) in m and `velocity` v(0) in m/s. From there
        M x'' + C x' + K x + f(x, x') = A s cos(m ω t) can be integrated in time, f being the laws, A the forcing amplitude
        (`attrs["forcing"]`), s the shape of the forcing and m its harmonic (``run.model``), ω the coordinate `omega`. Of laws with memory
        (``jenkins``) the forces of the sliders at t = 0 belong to the state as well and are not here: begin with any, and leave out the
        first periods, in which they settle where the motion is stable.

        >>> start = run.state("0.006/isola 1")
        >>> start["displacement"].sel(dof="x1"), start["velocity"].values, float(start["omega"])

        Args:
            branch: Name of the branch, ``"60/isola 1"``.
            point: Index of the point from 0, ``"peak"`` or ``"start"``.

        Raises:
            NoSuchBranch: There is no such branch.
            IndexError: It has no such point.
            Damaged: Its harmonics cannot be read.
        """
        curve, shapes = self[branch], self.shapes
        index = index_of(curve, point)
        at = curve.isel(point=index)
        # x(t) = Re Σ_k X_k exp(i k ω t), and so is its derivative.
        harmonics = xr.dot(shapes, at["modal"].load(), dim="mode")
        rates = 1j * at["omega"] * at["harmonic"]
        displacement = harmonics.sum("harmonic").real.drop_vars("omega", errors="ignore")
        velocity = (rates * harmonics).sum("harmonic").real.drop_vars("omega", errors="ignore")
        attributes = {name: curve.attrs[name] for name in ("name", "level")}
        attributes |= {"forcing": curve.attrs["level_value"], "point": index}
        return xr.Dataset(
            {
                "displacement": ("dof", displacement.values, {"long_name": "Displacements at t = 0", "units": "m"}),
                "velocity": ("dof", velocity.values, {"long_name": "Velocities at t = 0", "units": "m/s"}),
            },
            {"dof": shapes["dof"], "omega": at["omega"].drop_vars("omega", errors="ignore").variable},
            attributes,
        )

    def check(self) -> list[str]:
        """Everything that is damaged, gone or not there yet, in sentences; none of a finished run that is whole.

        Reads and verifies every number: of each branch the SHA-256 that was announced when it was found.
        """
        return self._read(lambda reading, _: check.check(reading))

    @property
    def order(self) -> int | None:
        """How many periods of the force the motions last, where they are of a further order that the run looks for; else `None`."""
        return self._store.order

    @property
    def plot(self) -> Plots:
        """Figures with matplotlib: ``run.plot.response()``, ``.map()``, ``.balance()``, ``.motion(…)``; and all that the program draws:
        ``run.plot.figure("folds")``."""
        from ..plots import Plots

        return Plots(self)

    def explore(self) -> Page:
        """The page with all figures, linked to each other: shown where it is the last value of a notebook's cell.

        Needs the program (``isola report``).

        Raises:
            NoProgram: It is not there.
            ProgramFailed: It cannot read the run.
        """
        # Without an order the program would write the pages of all of them.
        first = self.orders[0] if self._store.orders() else None
        return page(self.folder, self._store.order or first)

    def status(self) -> str:
        """What the program says of the run, as ``isola status``: the table of all levels with what was found, why nothing is where
        something was predicted, what is stable, where isolas are born, what was looked for and how surely. For people:
        ``print(run.status())``; numbers are in :attr:`summary` and the other tables.

        Needs the program.

        Raises:
            NoProgram: It is not there.
            ProgramFailed: It cannot read the run.
        """
        return status(self.folder)

    def __getitem__(self, key: Key) -> Motions:
        """A branch by its name: ``run["60/isola 1"]`` or ``run[60, "isola 1"]``.

        Raises:
            NoSuchBranch: There is none of this name (yet).
            Damaged: It cannot be read.
        """

        def read(reading: Reading, _: Omissions) -> Motions:
            found = find(reading, key)
            if found is None:
                raise NoSuchBranch(missing(reading, key))
            return curves.branch(reading, *found, self._names(reading))

        return self._read(read)

    def __iter__(self) -> Iterator[str]:
        return iter(self._read(_branches))

    def __len__(self) -> int:
        return len(self._read(_branches))

    def __contains__(self, key: object) -> bool:
        return self._read(lambda reading, _: find(reading, key)) is not None

    # Two runs are the same if they are one object: comparing all numbers is no question to ask in passing.
    __eq__ = object.__eq__
    __hash__ = object.__hash__

    def __repr__(self) -> str:
        return (
            f"<StoredRun {self.name}, {self.stage}: {self._content()}, in {self.folder}; "
            f"more: print(run.status()), run.summary, run.plot, run.explore(){self._further()}>"
        )

    def _repr_html_(self) -> str:
        name, folder = (html.escape(str(text)) for text in (self.name, self.folder))
        further = html.escape(self._further())
        more = f"<code>print(run.status())</code>, <code>run.plot</code>, <code>run.explore()</code>{further}"
        head = f"<b>{name}</b>, {self.stage}: {self._content()}, in <code>{folder}</code>; more: {more}"
        return f"<p>{head}</p>{self.summary.to_html()}"

    def _content(self) -> str:
        """How much there is: ``3 levels, 5 branches (2 isolas)``."""
        found = self._read(levels)
        kinds = [branch["kind"] for level in found for branch in level.branches]
        isolas = count(kinds.count("isola"), "isola")
        return f"{count(len(found), 'level')}, {count(len(kinds), 'branch', 'branches')} ({isolas})"

    def _further(self) -> str:
        """How motions of further orders are read, where this tells of the first."""
        orders = self._store.orders() if self._store.order is None else []
        folder = repr(str(self.folder))
        told = (f"motions of {m} periods of the force{self._isolas_of(m)}: isola_hbm.load({folder}, order={m})" for m in orders)
        return "".join(f", {one}" for one in told)

    def _isolas_of(self, order: int) -> str:
        """How many isolas a further order has, if any."""
        with Store(self._store.file, order).read() as reading:
            kinds = reading.column("SELECT kind FROM branches WHERE kind = 'isola'")
        return f" ({count(len(kinds), 'isola')})" if kinds else ""

    def _folds(self) -> dict[str, list[int]]:
        """Points at which branches turn back, by the names of these."""
        return self._read(curves.folds)

    def _names(self, reading: Reading) -> Names:
        """Names along axes, which do not change."""
        if self._known_names is None:
            self._known_names = Names.read(reading)
        return self._known_names

    def _read(self, read: Callable[[Reading, Omissions], T]) -> T:
        """What `read` makes of the store; what it had to leave out is a warning."""
        omissions = Omissions()
        with self._store.read() as reading:
            found = read(reading, omissions)
        for sentence in omissions.sentences:
            warnings.warn(sentence, LeftOut, stacklevel=3)
        return found


def _facts(reading: Reading) -> dict[str, str]:
    """Facts in readable form. Of a damaged file nothing at all."""
    try:
        rows = reading.rows("SELECT key, value FROM meta")
    except Damaged:
        reading.column("SELECT count(*) FROM levels")
        return {}
    return {row["key"]: row["value"] for row in rows if not isinstance(row["value"], bytes)}


def _branches(reading: Reading, omissions: Omissions) -> list[str]:
    return [named(level, branch) for level in levels(reading, omissions) for branch in level.branches]
