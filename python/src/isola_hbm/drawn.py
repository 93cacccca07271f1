"""Figures that the program draws, of a run on disk."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from .errors import ProgramFailed
from .program import message, start

if TYPE_CHECKING:
    from .stored.run import StoredRun


class Drawing:
    """A figure as SVG: a notebook shows it, a browser opens its file."""

    def __init__(self, svg: str) -> None:
        #: The figure.
        self.svg = svg

    def save(self, file: str | os.PathLike[str]) -> Path:
        """Writes it, as SVG; PDF and PNG come from ``isola plot``.

        Raises:
            ValueError: The name of the file promises something else.
        """
        path = Path(file)
        if path.suffix.lower() not in ("", ".svg"):
            raise ValueError(
                f"{path}: a figure is written as SVG: end it in .svg, or let `isola plot RUN --figure NAME -o {path.name}` make it"
            )
        path.write_text(self.svg, encoding="utf-8")
        return path

    def __repr__(self) -> str:
        return '<a figure: .save("figure.svg") writes it; a notebook shows it>'

    def _repr_svg_(self) -> str:
        return self.svg


class Drawn:
    """What of the figures of a run the program draws."""

    _run: StoredRun

    def figure(self, name: str, **options: str | float | Sequence[str | float]) -> Drawing:
        """A figure as ``isola plot`` draws it: ``backbone``, ``folds``, ``modes`` and ``resonance``, which are here alone, and
        ``response``, ``map``, ``balance`` and ``motion``.

        >>> drawing = run.plot.figure("backbone", units="mm,Hz")
        >>> drawing.svg[:4]
        '<svg'

        Needs the program.

        Args:
            name: Name of the figure.
            options: Those of ``isola plot`` (``isola plot --help``): `amplitude`, `mode`, `along`, `monitor`, `levels` (a list, or a text),
                `frequency`, `response`, `forcing` (two numbers each), `at`, `units`, `width`, …

        Raises:
            NoProgram: It is not there.
            ProgramFailed: There is no such figure or option, or the run has nothing for it yet: the message says which there are.
        """
        chosen: list[str] = []
        for key, value in options.items():
            values = [str(one) for one in value] if isinstance(value, (tuple, list)) else [str(value)]
            # Ends of an axis are two values, levels one list.
            chosen += [f"--{key.replace('_', '-')}", *([",".join(values)] if key == "levels" else values)]
        order = self._run.order
        if order is not None:
            chosen += ["--order", str(order)]
        with tempfile.TemporaryDirectory() as scratch:
            file = Path(scratch) / "figure.svg"
            command = ["plot", str(self._run.folder), "--figure", str(name), "--out", str(file), *chosen]
            with start(command) as process:
                _, said = process.communicate()
            if not file.is_file():
                raise ProgramFailed(message([said]), process.returncode)
            return Drawing(file.read_text(encoding="utf-8"))
