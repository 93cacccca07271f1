"""A study as the program is told it from Python: its file, the options, and what the program says of them."""

from __future__ import annotations

import difflib
import numbers
import os
import re
import subprocess
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias

from . import program, toml
from .errors import BadStudy, FolderInUse, ModelRefused, ProgramFailed, StudyRefused

#: Amplitudes: a list, or a text as ``"20:140:20"``.
Amplitudes: TypeAlias = "str | float | Iterable[str | float]"

#: How lines of ``isola check`` begin that are of the study, and of its amplitudes, not of the model.
_OF_STUDY = {"study ", "file ", "model "}
_OF_AMPLITUDES = {"amplitudes ", "warning     nothing touches", "warning     at A = "}
#: What a warning of an amplitude has somewhere.
_AT_AMPLITUDE = " the static response to A = "

#: How what is said of a model made in Python begins, and what its matrices are called there.
_GIVEN = "the model given: "
_MATRICES = {"matrices.mass": "M", "matrices.stiffness": "K", "matrices.damping": "C"}
#: Exit code of wrong usage.
_USAGE = 2
#: Goes on with a study as it was.
_AS_STARTED = "--as-started"
#: How the program begins to speak of the file of a model or a study, and of a setting.
_FILE = re.compile(r"(.+?\.(?:toml|mtx))(?:, line \d+)?: ")
_SETTING = re.compile(r"[a-z_]+\.[a-z_]+ = ")
#: What is written in files, and how Python has it.
_WORDS = {
    r"a single table, where a list of them is expected: each begins with `\[\[.*?\]\]`, in double brackets": (
        "a single dict, where a list of them is expected"
    ),
    r"a section or a table of keys": "a dict of its keys",
    r"write \[([\w.]+)\] and its keys below, or \S+ = value": r"give a dict of its keys, as \1={…}",
}

#: Sections of which a text alone is the effort.
EFFORTS = ("search", "verify")

#: Folder of a model made in Python, beside its study.
MODEL = "model"
#: Most entries of a folder that are named.
_NAMED = 3
#: First line of a study that is written here, not by a person.
_WRITTEN = "# Written by isola_hbm, and anew when it is asked again."


def options(amplitudes: Amplitudes | None, workers: int | None, settings: dict[str, Any]) -> list[str]:
    """The command line."""
    command = []
    if "model" in settings:
        raise BadStudy("model: a study is that of the model given; there is no other one to name")
    if amplitudes is not None:
        # Not after a space: what begins with a minus sign is refused by the program in better words.
        command.append(f"--amplitudes={typed(amplitudes)}")
    if workers is not None:
        if not isinstance(workers, numbers.Integral) or workers < 0:
            raise BadStudy(f"workers = {workers!r}: a number of processes is needed, 0 or more")
        command += ["--workers", str(workers)]
    for name in EFFORTS:
        if isinstance(settings.get(name), str):
            command.append(f"--{name}={settings.pop(name)}")
    try:
        for key, value in toml.dotted(settings):
            command += ["--set", f"{key}={value}"]
    except toml.NoName as error:
        raise BadStudy(f"settings: {error}") from None
    except TypeError as error:
        given = ", ".join(settings)
        raise BadStudy(f"{given}: {error}; leave a key out and it has its default") from None
    return command


def typed(amplitudes: Amplitudes) -> str:
    """As they are typed: levels have their names from this."""
    if isinstance(amplitudes, str):
        return amplitudes
    try:
        if isinstance(amplitudes, Mapping):
            raise TypeError
        values = list(amplitudes) if isinstance(amplitudes, Iterable) else [amplitudes]
        levels = ",".join(value if isinstance(value, str) else _shortest(float(value)) for value in values)
    except (TypeError, ValueError):
        raise BadStudy(
            f'amplitudes = {amplitudes!r}: give a list of numbers, as [20, 60], or a text, as "20:140:20"'
        ) from None
    if not values:
        raise BadStudy("amplitudes: the list is empty; give one forcing amplitude at least, as [20]")
    return levels


def _shortest(value: float) -> str:
    """A number in the shortest form that reads back the same but for what rounding adds: 0.1 + 0.2 is 0.3."""
    text = f"{value:g}"
    return text if float(text) == value else f"{value:.15g}"


def write(folder: Path, model: str, amplitudes: Amplitudes, settings: Mapping[str, Any] | None = None) -> Path:
    """The file of a study in `folder`, of a model whose folder is named as seen from there."""
    file, given = folder / "study.toml", settings or {}
    efforts = {name: {"effort": given[name]} for name in EFFORTS if isinstance(given.get(name), str)}
    lines = [_WRITTEN, f"model = {toml.literal(model)}", f"amplitudes = {toml.literal(typed(amplitudes))}"]
    lines += [f"{key} = {value}" for key, value in toml.dotted({**given, **efforts})]
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return file


def require_own(folder: Path) -> None:
    """Refuses a folder for a run and its study that holds anything of somebody else's."""
    if not folder.is_dir():
        return
    file = folder / "study.toml"
    if file.exists():
        if not file.read_text(encoding="utf-8", errors="replace").startswith(_WRITTEN):
            raise FolderInUse(f"{file}: a study already; give another `out`")
        return
    if foreign := sorted(entry.name for entry in folder.iterdir() if not entry.name.startswith(".")):
        more = f" and {len(foreign) - _NAMED} more" if len(foreign) > _NAMED else ""
        raise FolderInUse(
            f"{folder}: this folder holds {', '.join(foreign[:_NAMED])}{more}, and no run; give an `out` that is new or empty"
        )


def check(folder: Path, amplitudes: Amplitudes | None, settings: dict[str, Any]) -> str:
    """What the program says of the model in `folder`, and of its forcing amplitudes if they are given."""
    command = options(amplitudes, None, settings)
    file = write(folder, MODEL, "1" if amplitudes is None else amplitudes)
    with program.start(["check", str(file), *command], stdout=subprocess.PIPE) as process:
        found, said = process.communicate()
    if process.returncode != 0:
        raise refusal([said], process.returncode, file, is_written=True)
    # What is of the study here is that of this function.
    hidden = _OF_STUDY if amplitudes is not None else _OF_STUDY | _OF_AMPLITUDES
    lines = (line for line in found.splitlines() if not line.startswith(tuple(hidden)))
    return "\n".join(line for line in lines if amplitudes is not None or _AT_AMPLITUDE not in line)


def require_meant(settings: dict[str, Any], keywords: Iterable[str]) -> None:
    """Refuses settings that are keywords of a function but for a letter or two."""
    for key in settings:
        if meant := difflib.get_close_matches(key, keywords, n=1, cutoff=0.75):
            raise BadStudy(f"{key}: neither a key of a study nor a keyword; did you mean `{meant[0]}`?")


def refusal(said: Sequence[str], code: int, file: Path | None, *, is_written: bool) -> ProgramFailed:
    """Why the program does not compute: a refusal of the study or the model, if it speaks of these, else a failure. What it says is
    that of :func:`reason`."""
    given, why = program.message(said), reason(said, code, file, is_written=is_written)
    named = _FILE.match(given)
    # Whatever has changed in study or model since a run began: it is not the run's.
    if given.startswith("--") or code == _USAGE or _AS_STARTED in given:
        return StudyRefused(why, code)
    if named and (is_written or named[1].endswith(("model.toml", ".mtx"))):
        return ModelRefused(why, code)
    # Bounds that no backbone reaches are seen when there is one.
    is_of_study = named or (file is not None and given.startswith(f"{file}: ")) or _SETTING.match(given)
    return (StudyRefused if is_of_study else ProgramFailed)(why, code)


def reason(said: Sequence[str], code: int, file: Path | None, *, is_written: bool) -> str:
    """Why the program ended, as it says itself; what Python wrote (`is_written`: of a model that was given), options and inline tables
    are called what they are in Python."""
    why = program.message(said) or f"isola ended with {code}"
    if is_written and file is not None:
        # The key numbers its entry as Python does.
        listed = r"((\w+ entry|entry \d+ \(counted from 1\)) of [a-z.]+: )?"
        written = rf"^{re.escape(str(file.parent))}{re.escape(os.sep)}[^:]*\.(toml|mtx)(, line \d+)?: {listed}"
        why = re.sub(written, _GIVEN, why)
        for matrix, name in _MATRICES.items():
            why = why.replace(f"`{matrix}`", f"`{name}`")
        why = why.replace("`contact.nodes[", "`contacts[")
    why = re.sub(r"^--set ([^=]+)=", r"\1 = ", why)
    why = re.sub(r"^--(\w+): ", r"\1: ", why)
    why = re.sub(r"^--(\w+) ([^:]+(?::[^: ]+)*): ", r"\1 = \2: ", why)
    why = why.replace(f"add {_AS_STARTED}", "give as_started=True")
    # The program names the option, and the key that it sets.
    why = re.sub(r"^([^=:]+) = ([^:]*): `\1`( = [^:]*)?: ", r"\1 = \2: ", why)
    why = re.sub(r"^(\w+): `\1` = ", r"\1 = ", why)
    for of_files, of_python in _WORDS.items():
        why = re.sub(of_files, of_python, why)
    return re.sub(r"\{\w+ = [^{}]*\}", lambda table: re.sub(r"(\w+) = ", r'"\1": ', table[0]), why)
