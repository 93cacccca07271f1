"""A study computed from Python: the program sweeps, this passes on how far it is, and hands back the run."""

from __future__ import annotations

import math
import os
import re
import shutil
import signal
import subprocess
import sys
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

from . import program, study
from .counted import count
from .errors import BadModel, Doubtful, FolderInUse, Incomplete
from .model import Model
from .stored.run import StoredRun, load
from .stored.store import FILE
from .study import Amplitudes

#: How long the program is given to end when it is asked to, s.
PATIENCE = 30.0
#: Between two lines that say how far it is, where nobody asked for all of them and there is no terminal, s.
NOW_AND_THEN = 10.0
#: How a line of the program begins that doubts something.
_DOUBT = "warning: "
#: How a line begins that says how far it is.
_ROUTINE = "running: "
#: All lines that say what happens, and those of its log, whose sum its last line tells.
_PROGRESS = re.compile(r"(warning: |note: |run \w+ in |computing |backbone|running: |finished: |\d+ levels?, |\d{4}-\d\d-\d\dT\d\d:)")


def sweep(
    model: Model | str | os.PathLike[str],
    amplitudes: Amplitudes | None = None,
    *,
    out: str | os.PathLike[str] | None = None,
    workers: int | None = None,
    progress: bool | Callable[[str], None] | None = None,
    **settings: Any,
) -> StoredRun:
    """Computes a study: backbones, windows, every branch of every forcing level. Returns the run.

    >>> from isola_hbm import Law, Model, sweep
    >>> run = sweep("models/duffing", amplitudes=[0.05, 0.1])
    >>> spring = Law("polynomial_spring", dof="x1", terms=[{"power": 3, "coefficient": 1}])
    >>> model = Model(M=[[1]], K=[[1]], damping={"default_ratio": 0.05}, laws=[spring])
    >>> run = sweep(model, amplitudes="0.02:0.1:0.04", harmonics={"count": 5}, search="none")

    Ctrl-C (in a notebook: interrupt) ends it; what was computed stays, ``isola resume`` goes on.

    Args:
        model: A :class:`Model`, the folder of a model or a study, or the file of a study.
        amplitudes: Forcing amplitudes A, in the model's unit of forcing; by default those of the study.
        out: Folder of the run; by default a new one in ``runs``.
        workers: Processes that compute; by default one a core.
        progress: Whether to show how far it is, and at the end what was found (:meth:`StoredRun.status`): on standard error, in a
            notebook below the cell. By default, where there is neither a terminal nor a notebook (a file, a window of an editor), what
            happens and every ten seconds at most how far it is; True: every line there as well; False: nothing. Or what to call with
            each line.
        settings: Keys of the study, by section: ``frequency={"min": 0.9}``, ``**{"harmonics.count": 20}``;
            ``search="thorough"``.

    Raises:
        FolderInUse: There is a run in `out`, or a file in its place.
        BadStudy: Amplitudes, settings or `workers` that make no sense, or a keyword is mistyped; where the program says so
            (:class:`StudyRefused`) with its own message.
        BadModel: It is no model, or has no study, and no amplitudes are given; or the program refuses it (:class:`ModelRefused`).
        NoProgram: The program is not there.
        ProgramFailed: It fails: with its own message.

    Warns:
        Doubtful: Something is probably not meant, as bounds in Hz, or was not given, as the damping.
        Incomplete: Tasks were given up, or a curve stopped before its end.
    """
    if not isinstance(model, (Model, str, os.PathLike)):
        raise BadModel(
            f"model: {type(model).__name__} given; a Model is needed, as Model(M, K) of matrices, or the path of a model or a study"
        )
    folder = Path(out) if out is not None else _new_folder(model)
    # What is wrong is refused before anything is written.
    if (folder / FILE).exists():
        raise FolderInUse(
            f"{folder}: this folder holds a run already, perhaps one that failed; give another `out`, or remove the folder;"
            f" `isola resume {folder}` goes on with the run"
        )
    study.require_meant(settings, ("amplitudes", "out", "workers", "progress"))
    options = study.options(amplitudes, workers, settings)
    program.find()
    if file := next(
        (path for path in (folder, *folder.parents) if path.exists() and not path.is_dir()), None
    ):
        raise FolderInUse(f"{file}: a file, where the folder of the run is to be; name another folder")
    is_new = not folder.exists()
    file = _study(model, folder, amplitudes)
    process = program.start(["sweep", str(file), "--out", str(folder), *options])
    said, code = _heard(process, show := _shown(progress))
    if code not in (0, 3, 4):
        is_written = isinstance(model, Model)
        if is_new and not (folder / FILE).exists():
            shutil.rmtree(folder, ignore_errors=True)
        raise study.refusal(said, code, file, is_written=is_written)
    for line in said:
        if line.startswith(_DOUBT):
            warnings.warn(line.removeprefix(_DOUBT).strip(), Doubtful, stacklevel=2)
    run = load(folder)
    show(f"{run.stage}: {count(len(run), 'branch', 'branches')} in {folder}\n")
    _tell(run, progress)
    if code != 0:
        notes = [line for line in said if not _PROGRESS.match(line)]
        warnings.warn("".join(notes).strip() or run.stage, Incomplete, stacklevel=2)
    return run


def _new_folder(model: Model | str | os.PathLike[str]) -> Path:
    """A new folder for a run."""
    if isinstance(model, Model):
        name = model.name
    else:
        path = Path(model).absolute()
        name = path.parent.name if path.name == "study.toml" else path.stem
    slug = re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-") or "run"
    folder = Path("runs") / f"{slug}-{time.strftime('%Y%m%d-%H%M%S')}"
    number = 1
    while folder.exists():
        number += 1
        folder = folder.with_name(f"{slug}-{time.strftime('%Y%m%d-%H%M%S')}-{number}")
    return folder


def _study(model: Model | str | os.PathLike[str], folder: Path, amplitudes: Amplitudes | None) -> Path:
    """The file of the study: of a model that has none, a new one beside its run."""
    if not isinstance(model, Model):
        path = Path(model)
        if not (path / "model.toml").is_file() or (path / "study.toml").exists():
            return path
    if amplitudes is None:
        raise BadModel(f"{model}: no study; give amplitudes, as in sweep(model, amplitudes=[20, 60])")
    folder.mkdir(parents=True, exist_ok=True)
    at = model.save(folder / study.MODEL, overwrite=True) if isinstance(model, Model) else path
    return study.write(folder, os.path.relpath(at, folder), amplitudes)


def _shown(progress: bool | Callable[[str], None] | None) -> Callable[[str], None]:
    """What shows a line."""
    if callable(progress):
        return progress
    if progress is False:
        return lambda line: None
    if _in_notebook():
        return _notebook_line()
    if not sys.stderr.isatty():
        return _plain if progress else _now_and_then()
    width = shutil.get_terminal_size().columns - 1

    def show(line: str) -> None:
        end = "\n" if line.endswith("\n") else ""
        print(f"\r{line.rstrip()[:width]:<{width}}", end=end, file=sys.stderr, flush=True)

    return show


def _tell(run: StoredRun, progress: bool | Callable[[str], None] | None) -> None:
    """Says what was found, to whoever was shown how far it is."""
    if progress is False or callable(progress):
        return
    print(run.status(), file=sys.stdout if _in_notebook() else sys.stderr, flush=True)


def _now_and_then() -> Callable[[str], None]:
    """What shows what happens, and now and then how far it is."""
    last = -math.inf

    def show(line: str) -> None:
        nonlocal last
        if line.startswith(_ROUTINE):
            if time.monotonic() - last < NOW_AND_THEN:
                return
            last = time.monotonic()
        _plain(line)

    return show


def _plain(line: str) -> None:
    print(line.rstrip(), file=sys.stderr, flush=True)


def _in_notebook() -> bool:
    ipython = sys.modules.get("IPython")
    return ipython is not None and hasattr(ipython.get_ipython(), "kernel")


def _notebook_line() -> Callable[[str], None]:
    """What shows a line below a notebook's cell, in place of the last one."""
    from IPython.display import DisplayHandle

    handle, shown = DisplayHandle(), False

    def show(line: str) -> None:
        nonlocal shown
        (handle.update if shown else handle.display)({"text/plain": line.rstrip()}, raw=True)
        shown = True

    return show


def _heard(process: subprocess.Popen[str], show: Callable[[str], None]) -> tuple[list[str], int]:
    """Passes on what the program says until it ends: all of it, and the exit code."""
    said = []
    assert process.stderr is not None
    try:
        for line in process.stderr:
            said.append(line)
            show(line.rstrip())
        return said, process.wait()
    except BaseException:
        _stop(process)
        raise
    finally:
        process.stderr.close()


def _stop(process: subprocess.Popen[str]) -> None:
    """Asks the program to end, which keeps what it has computed."""
    if process.poll() is None:
        process.send_signal(signal.SIGINT if os.name == "posix" else signal.SIGTERM)
        try:
            process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
