"""The program `isola`, where it is needed: found, started, its messages passed on."""

from __future__ import annotations

import os
import shutil
import subprocess
import sysconfig
import tempfile
from collections.abc import Sequence
from pathlib import Path

from .errors import NoProgram, ProgramFailed

#: Environment variable that names the program.
VARIABLE = "ISOLA_BIN"


def find() -> str:
    """The program: what ``ISOLA_BIN`` names, or the one that was installed with this package, or `isola` on the path.

    Raises:
        NoProgram: There is none.
    """
    named = os.environ.get(VARIABLE)
    if named:
        found = shutil.which(named)
    else:
        # A notebook server or an environment that was not activated has the folder of scripts on no path.
        found = shutil.which("isola", path=sysconfig.get_path("scripts")) or shutil.which("isola")
    if found is None:
        what = (
            f"{VARIABLE} names `{named}`, which is no program"
            if named
            else "the program `isola` is not on the PATH"
        )
        raise NoProgram(
            f"{what}; install the wheel that carries it, or build it with `cargo build --release`, and put it on the PATH or name it"
            f" in {VARIABLE}"
        )
    return found


def start(arguments: Sequence[str], *, stdout: int = subprocess.DEVNULL) -> subprocess.Popen[str]:
    """Starts the program with its messages in a pipe, out of reach of Ctrl-C in this terminal.

    Raises:
        NoProgram: It is not there, or cannot be started.
    """
    command = [find(), *arguments]
    try:
        return subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=stdout,
            stderr=subprocess.PIPE,
            text=True,
            encoding="utf-8",
            start_new_session=True,
        )
    except OSError as error:
        raise NoProgram(f"{command[0]} cannot be started: {error}") from error


def message(lines: Sequence[str]) -> str:
    """Why the program failed, as it says itself."""
    said = "".join(lines).strip()
    _, found, reason = said.partition("error: ")
    return reason if found else said


def status(folder: Path) -> str:
    """What the program says of the run in `folder`, as ``isola status``.

    Raises:
        NoProgram: The program is not there.
        ProgramFailed: It cannot read the run.
    """
    with start(["status", str(folder)], stdout=subprocess.PIPE) as process:
        said, failed = process.communicate()
    if process.returncode not in (0, 3):
        raise ProgramFailed(message([failed]), process.returncode)
    return said.rstrip()


class Page:
    """The page of a run with all its figures: a notebook shows it, a browser opens its file."""

    def __init__(self, html: str) -> None:
        #: The page, which needs no network.
        self.html = html

    def save(self, file: str | os.PathLike[str]) -> Path:
        """Writes it."""
        path = Path(file)
        path.write_text(self.html, encoding="utf-8")
        return path

    def __repr__(self) -> str:
        return '<the page of a run: .save("report.html") writes it; a notebook shows it>'

    def _repr_html_(self) -> str:
        escaped = self.html.replace("&", "&amp;").replace('"', "&quot;")
        return f'<iframe srcdoc="{escaped}" style="width: 100%; height: 85vh; border: 0"></iframe>'


def page(folder: Path, order: int | None = None) -> Page:
    """The page of the run in `folder`, as ``isola report`` writes it; of its first order of motions, or of another one.

    Raises:
        NoProgram: The program is not there.
        ProgramFailed: It cannot read the run.
    """
    with tempfile.TemporaryDirectory() as scratch:
        file = Path(scratch) / "report.html"
        chosen = [] if order is None else ["--order", str(order)]
        with start(["report", str(folder), *chosen, "--out", str(file)]) as process:
            _, said = process.communicate()
        # A damaged run has a page that says so (3).
        if not file.is_file():
            raise ProgramFailed(message([said]), process.returncode)
        return Page(file.read_text(encoding="utf-8"))
