"""A study computed from Python: the program sweeps, this passes on how far it is, and hands back the run."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
import time
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from . import program, study
from .counted import count
from .errors import BadModel, Doubtful, FolderInUse, Incomplete
from .model import Model
from .showing import Showing, shown, tell
from .stored.run import StoredRun, load
from .stored.store import FILE
from .study import Amplitudes

#: How long the program is given to end when it is asked to, s.
PATIENCE = 30.0
#: Exit codes of a run that has come to its end, with or without doubts.
_ENDED = (0, 3, 4)
#: How a line of the program begins that doubts something.
_DOUBT = "warning: "
#: All lines that say what happens, and those of its log, whose sum its last line tells.
_PROGRESS = re.compile(
    r"(warning: |note: |run \w+ in |computing |backbone|running: |finished: |\d+ levels?, |\d{4}-\d\d-\d\dT\d\d:)"
)


def sweep(
    model: Model | str | os.PathLike[str],
    amplitudes: Amplitudes | None = None,
    *,
    out: str | os.PathLike[str] | None = None,
    workers: int | None = None,
    progress: Showing = None,
    **settings: Any,
) -> StoredRun:
    """Computes a study: backbones, windows, every branch of every forcing level. Returns the run.

    >>> from isola_hbm import Law, Model, sweep
    >>> run = sweep("models/duffing", amplitudes=[0.05, 0.1])
    >>> spring = Law("polynomial_spring", dof="x1", terms=[{"power": 3, "coefficient": 1}])
    >>> model = Model(M=[[1]], K=[[1]], damping={"default_ratio": 0.05}, laws=[spring])
    >>> run = sweep(model, amplitudes="0.02:0.1:0.04", harmonics={"count": 5}, search="none")

    Ctrl-C (in a notebook: interrupt) ends it; what was computed stays, :func:`resume` goes on.

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
        FolderInUse: There is a run in `out`, or something else that is not this function's, or a file in its place.
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
            f" isola_hbm.resume({str(folder)!r}) goes on with the run, isola_hbm.extend({str(folder)!r}, amplitudes) adds levels to it"
        )
    study.require_meant(settings, ("amplitudes", "out", "workers", "progress"))
    written = dict(settings)
    options = study.options(amplitudes, workers, settings)
    program.find()
    if file := next(
        (path for path in (folder, *folder.parents) if path.exists() and not path.is_dir()), None
    ):
        raise FolderInUse(f"{file}: a file, where the folder of the run is to be; name another folder")
    is_new = not folder.exists()
    file = _study(model, folder, amplitudes, written)
    said, code = _heard(["sweep", str(file), "--out", str(folder), *options], folder, show := shown(progress))
    if code not in _ENDED:
        if is_new and not (folder / FILE).exists():
            shutil.rmtree(folder, ignore_errors=True)
        raise study.refusal(said, code, file, is_written=isinstance(model, Model))
    return _ended(load(folder), said, code, show, progress)


def extend(
    run: StoredRun | str | os.PathLike[str],
    amplitudes: Amplitudes,
    *,
    workers: int | None = None,
    as_started: bool = False,
    progress: Showing = None,
) -> StoredRun:
    """Adds forcing levels to a run, as ``isola extend``: computed with its settings, nothing twice. Whatever it left to do is done too.

    >>> from isola_hbm import extend, load
    >>> run = extend("runs/damper", [0.008])
    >>> run = extend(load("runs/damper"), "0.009:0.011:0.001")

    Args:
        run: The run, or its folder.
        amplitudes: Further forcing amplitudes A, in the model's unit of forcing; those that the run has are passed over.
        workers, progress: As of :func:`sweep`.
        as_started: Go on with the study as it was when the run began, though its file or model has changed.

    Raises:
        NoSuchRun: There is no run.
        BadStudy: Amplitudes that make no sense or of which none is new (:class:`StudyRefused`), or such `workers`; or the study has
            changed since the run began, or is gone.
        NoProgram: The program is not there.
        ProgramFailed: It fails, because somebody carries the run on already, say: with its own message.

    Warns:
        Incomplete: Tasks were given up, or a curve stopped before its end.
    """
    return _carried_on("extend", run, study.options(amplitudes, workers, {}), as_started, progress)


def resume(
    run: StoredRun | str | os.PathLike[str],
    *,
    workers: int | None = None,
    as_started: bool = False,
    progress: Showing = None,
) -> StoredRun:
    """Goes on with a run that was interrupted, as ``isola resume``; of a finished one there is nothing to do.

    >>> from isola_hbm import resume
    >>> run = resume("runs/damper")

    Args:
        run: The run, or its folder.
        workers, as_started, progress: As of :func:`extend`.

    Raises:
        NoSuchRun: There is no run.
        BadStudy: `workers` makes no sense; or the study has changed since the run began, or is gone (:class:`StudyRefused`).
        NoProgram: The program is not there.
        ProgramFailed: It fails, because somebody carries the run on already, say: with its own message.

    Warns:
        Incomplete: Tasks were given up, or a curve stopped before its end.
    """
    return _carried_on("resume", run, study.options(None, workers, {}), as_started, progress)


def _carried_on(
    command: str,
    run: StoredRun | str | os.PathLike[str],
    options: Sequence[str],
    as_started: bool,
    progress: Showing,
) -> StoredRun:
    """The run, when the program has done what `command` asks for."""
    run = run if isinstance(run, StoredRun) else load(run)
    unchanged = ["--as-started"] if as_started else []
    said, code = _heard([command, str(run.folder), *options, *unchanged], run.folder, show := shown(progress))
    if code not in _ENDED:
        raise study.refusal(said, code, None, is_written=False)
    # One that was loaded has the study and the facts of before.
    return _ended(load(run.folder, run._store.order), said, code, show, progress, callers=2)


def _ended(
    run: StoredRun,
    said: Sequence[str],
    code: int,
    show: Callable[[str], None],
    progress: Showing,
    callers: int = 1,
) -> StoredRun:
    """The run that the program has ended with `code`, with its doubts as warnings to whoever called `callers` functions of this file."""
    for line in said:
        if line.startswith(_DOUBT):
            warnings.warn(line.removeprefix(_DOUBT).strip(), Doubtful, stacklevel=2 + callers)
    show(f"{run.stage}: {count(len(run), 'branch', 'branches')} in {run.folder}\n")
    tell(run.status, progress)
    if code != 0:
        notes = [line for line in said if not _PROGRESS.match(line)]
        warnings.warn("".join(notes).strip() or run.stage, Incomplete, stacklevel=2 + callers)
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


def _study(
    model: Model | str | os.PathLike[str], folder: Path, amplitudes: Amplitudes | None, settings: dict[str, Any]
) -> Path:
    """The file of the study: of a model that has none, a new one beside its run."""
    if not isinstance(model, Model):
        path = Path(model)
        if not (path / "model.toml").is_file() or (path / "study.toml").exists():
            return path
    if amplitudes is None:
        raise BadModel(f"{model}: no study; give amplitudes, as in sweep(model, amplitudes=[20, 60])")
    study.require_own(folder)
    folder.mkdir(parents=True, exist_ok=True)
    at = model.save(folder / study.MODEL, overwrite=True) if isinstance(model, Model) else path
    return study.write(folder, os.path.relpath(at, folder), amplitudes, settings)


def _heard(arguments: Sequence[str], folder: Path, show: Callable[[str], None]) -> tuple[list[str], int]:
    """Starts the program and passes on what it says until it ends: all of it, and the exit code. Where it is interrupted, what goes on
    with the run in `folder`."""
    process, said = program.start(arguments), []
    assert process.stderr is not None
    try:
        for line in process.stderr:
            said.append(line)
            # What ends it is raised, in the words of Python.
            if not line.startswith("error: "):
                show(line.rstrip())
        return said, process.wait()
    except BaseException as error:
        _stop(process)
        if (folder / FILE).exists():
            on = f"interrupted: isola_hbm.resume({str(folder)!r}) goes on"
            show(f"{on}\n")
            # Below the traceback, which is all that is seen at last.
            if sys.version_info >= (3, 11):
                error.add_note(on)
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
