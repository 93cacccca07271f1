"""A study computed from Python: the program sweeps, this passes on how far it is, and hands back the run."""

from __future__ import annotations

import numbers
import os
import re
import shutil
import signal
import subprocess
import sys
import time
import warnings
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, TypeAlias

from . import program, toml
from .errors import BadModel, BadStudy, FolderInUse, Incomplete, ProgramFailed
from .model import Model
from .stored.run import StoredRun, load
from .stored.store import FILE

#: How long the program is given to end when it is asked to, s.
PATIENCE = 30.0
#: Lines of the program that say how far it is.
_PROGRESS = re.compile(r"(run \w+ in |computing |backbone|running: |finished: |\d+ levels?, )")

#: Amplitudes: a list, or a text as ``"20:140:20"``.
Amplitudes: TypeAlias = "str | float | Iterable[str | float]"


def sweep(
    model: Model | str | os.PathLike[str],
    amplitudes: Amplitudes | None = None,
    *,
    out: str | os.PathLike[str] | None = None,
    workers: int | None = None,
    progress: bool | Callable[[str], None] = True,
    **settings: Any,
) -> StoredRun:
    """Computes a study: backbones, windows, every branch of every forcing level. Returns the run.

    >>> run = sweep("models/duffing", amplitudes=[0.05, 0.1])
    >>> run = sweep(model, amplitudes="20:140:20", contact={"friction": 0}, harmonics={"count": 20})

    Ctrl-C (in a notebook: interrupt) ends it; what was computed stays, ``isola resume`` goes on.

    Args:
        model: A :class:`Model`, the folder of a model or a study, or the file of a study.
        amplitudes: Forcing amplitudes A, in the model's unit of forcing; by default those of the study.
        out: Folder of the run; by default a new one in ``runs``.
        workers: Processes that compute; by default one a core.
        progress: Whether to show how far it is, on standard error; or what to call with a line that says so.
        settings: Keys of the study, by section: ``frequency={"min": 0.9}``, ``**{"harmonics.count": 20}``;
            ``search="thorough"``.

    Raises:
        FolderInUse: There is a run in `out`, or a file in its place.
        BadStudy: Amplitudes, settings or `workers` are not what can be given to the program at all.
        BadModel: The model has no study, and no amplitudes are given.
        NoProgram: The program is not there.
        ProgramFailed: It refuses the study, or fails: with its own message.

    Warns:
        Incomplete: Tasks were given up, or a curve stopped before its end.
    """
    folder = Path(out) if out is not None else _new_folder(model)
    # What is wrong is refused before anything is written.
    if (folder / FILE).exists():
        raise FolderInUse(f"{folder}: this folder holds a run already; name another folder")
    options = _options(amplitudes, workers, settings)
    program.find()
    if file := next((path for path in (folder, *folder.parents) if path.exists() and not path.is_dir()), None):
        raise FolderInUse(f"{file}: a file, where the folder of the run is to be; name another folder")
    study = _study(model, folder, amplitudes)
    process = program.start(["sweep", str(study), "--out", str(folder), *options])
    return _finished(process, folder, _shown(progress))


def _options(amplitudes: Amplitudes | None, workers: int | None, settings: dict[str, Any]) -> list[str]:
    """The command line."""
    options = []
    if amplitudes is not None:
        # Not after a space: what begins with a minus sign is refused by the program in better words.
        options.append(f"--amplitudes={_amplitudes(amplitudes)}")
    if workers is not None:
        if not isinstance(workers, numbers.Integral) or workers < 0:
            raise BadStudy(f"workers = {workers!r}: a number of processes is needed, 0 or more")
        options += ["--workers", str(workers)]
    for name in ("search", "verify"):
        if isinstance(settings.get(name), str):
            options.append(f"--{name}={settings.pop(name)}")
    try:
        for key, value in toml.dotted(settings):
            options += ["--set", f"{key}={value}"]
    except TypeError as error:
        given = ", ".join(settings)
        raise BadStudy(f"{given}: {error}; leave a key out and it has its default") from None
    return options


def _amplitudes(amplitudes: Amplitudes) -> str:
    """As they are typed: levels have their names from this."""
    if isinstance(amplitudes, str):
        return amplitudes
    values = amplitudes if isinstance(amplitudes, Iterable) else [amplitudes]
    try:
        return ",".join(value if isinstance(value, str) else _shortest(float(value)) for value in values)
    except (TypeError, ValueError):
        raise BadStudy(
            f'amplitudes = {amplitudes!r}: give a list of numbers, as [20, 60], or a text, as "20:140:20"'
        ) from None


def _shortest(value: float) -> str:
    """A number in the shortest form that reads back the same."""
    text = f"{value:g}"
    return text if float(text) == value else repr(value)


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
    at = model.save(folder / "model", overwrite=True) if isinstance(model, Model) else path
    where, study = os.path.relpath(at, folder), folder / "study.toml"
    levels = toml.literal(_amplitudes(amplitudes))
    study.write_text(f"model = {toml.literal(where)}\namplitudes = {levels}\n", encoding="utf-8")
    return study


def _shown(progress: bool | Callable[[str], None]) -> Callable[[str], None]:
    """What shows a line."""
    if callable(progress):
        return progress
    if not progress:
        return lambda line: None
    if _in_notebook():
        return _notebook_line()
    if not sys.stderr.isatty():
        return lambda line: None
    width = shutil.get_terminal_size().columns - 1

    def show(line: str) -> None:
        end = "\n" if line.endswith("\n") else ""
        print(f"\r{line.rstrip()[:width]:<{width}}", end=end, file=sys.stderr, flush=True)

    return show


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


def _finished(process: subprocess.Popen[str], folder: Path, show: Callable[[str], None]) -> StoredRun:
    """Passes on what the program says until it ends; the run."""
    said = []
    assert process.stderr is not None
    try:
        for line in process.stderr:
            said.append(line)
            show(line.rstrip())
        code = process.wait()
    except BaseException:
        _stop(process)
        raise
    finally:
        process.stderr.close()
    if code not in (0, 3, 4):
        raise ProgramFailed(program.message(said) or f"isola ended with {code}", code)
    run = load(folder)
    show(f"{run.stage}: {len(run)} branches in {folder}\n")
    if code != 0:
        notes = [line for line in said if not _PROGRESS.match(line)]
        warnings.warn("".join(notes).strip() or run.stage, Incomplete, stacklevel=3)
    return run


def _stop(process: subprocess.Popen[str]) -> None:
    """Asks the program to end, which keeps what it has computed."""
    if process.poll() is None:
        process.send_signal(signal.SIGINT if os.name == "posix" else signal.SIGTERM)
        try:
            process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
