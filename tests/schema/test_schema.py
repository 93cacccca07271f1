"""What `isola schema` accepts is what the program accepts: of every shipped file, and of every key with values of all kinds."""

from __future__ import annotations

import json
import os
import re
import subprocess
import tomllib
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft7Validator

ROOT = Path(__file__).parents[2]
PROGRAM = Path(os.environ.get("ISOLA_BIN", ROOT / "target" / "release" / "isola"))

#: A model that any of its keys can be put into.
MODEL = """
dofs = ["x1", "x2"]
matrices = { mass = [[1, 0], [0, 1]], stiffness = [[2, -1], [-1, 2]] }
damping.ratios = [{ modes = 2, ratio = 0.02 }]
[[contact.nodes]]
normal = "x1"
tangential = ["x2"]
radius = 0.5
gap = 1e-3
[[laws]]
dof = "x1"
law = { polynomial_spring = { terms = [{ power = 3, coefficient = 0.5 }] } }
"""
#: Values of all kinds, good for some keys and bad for others.
VALUES: list[Any] = [
    *[True, -1, 0, 1, 2, 0.5, -0.5, 10.5, 12345678.5, "x1", "1-2", "auto", " ", "20:60:20"],
    *[[], ["x1"], ["x1", "x2"], ["x1", "x2", "x1"], ["x1", "x1"], [1, 2], [True], [[1, 0], [0, 1]], [["x"]]],
    *[{}, {"x1": 1}, {"x1": 0}, {"x1": "far"}, {"no_such_key": 1}, [{}], [{"no_such_key": 1}]],
]
#: Reasons that are not about a key alone: two keys contradict each other, a value is wrong for this model, or its text has
#: a grammar of its own.
OTHER = re.compile(
    r"there is no (?:[a-z_]+ )?`(?!no_such_key)|known here: `x1`|the model has modes|is used twice|cannot be read|no folder|no model\.toml|must have the same size"
    r"|row \d+|by exactly one of them|other than zero\)|need at least|forcing acts on harmonic|or are the two exchanged"
    r"|gives the damping already|within 1 to 2|give [0-9]+|already|range includes|leads away|is not positive definite"
    r"|negative eigenvalue|not symmetric|rigid-body|not a number; give a list|entry is empty|another name for one"
    r"|so `(radius|tangential)` is needed|above zero$|is overdamped|this forcing does nothing|give .* names|names? "
)


def isola(*arguments: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run([str(PROGRAM), *map(str, arguments)], capture_output=True, text=True, timeout=120, check=False)


@pytest.fixture(scope="module")
def schemas() -> dict[str, Draft7Validator]:
    if not PROGRAM.exists():
        pytest.skip("isola was not built, and ISOLA_BIN is not set")
    found = {}
    for name in ["model", "study"]:
        schema = json.loads(isola("schema", name).stdout)
        Draft7Validator.check_schema(schema)
        found[name] = Draft7Validator(schema)
    return found


def shipped() -> list[Path]:
    folders = [ROOT / "models", ROOT / "solver" / "tests" / "models", ROOT / "coordinator" / "templates"]
    return sorted(file for folder in folders for file in folder.glob("*/*.toml"))


def test_shipped_files_are_accepted(schemas: dict[str, Draft7Validator]) -> None:
    files = shipped()
    assert len([file for file in files if file.name == "model.toml"]) > 15 and len(files) > 30
    both = Draft7Validator(json.loads(isola("schema").stdout))
    for file in files:
        content = tomllib.loads(file.read_text("utf-8"))
        own, other = ("model", "study") if file.name == "model.toml" else ("study", "model")
        assert not list(schemas[own].iter_errors(content)), file
        assert both.is_valid(content), file
        if own == "study":
            assert not schemas[other].is_valid(content), f"{file} is taken for a model"


def leaves(schema: dict[str, Any], path: tuple[str | int, ...] = ()) -> Iterator[tuple[tuple[str | int, ...], dict[str, Any]]]:
    """All keys, those of sections too, with the first entry of every list of tables."""
    for name, below in schema.get("properties", {}).items():
        yield (*path, name), below
        yield from leaves(below, (*path, name))
        if "properties" in below.get("items", {}):
            yield from leaves(below["items"], (*path, name, 0))


def placed(path: tuple[str | int, ...], value: Any) -> tuple[str, Any]:
    """The key to type, and its value: laws and forcing shapes as a whole, since each has keys of its own."""
    for whole in [("laws", 0, "law"), ("forcing", "shape")]:
        if path[: len(whole)] == whole and len(path) > len(whole):
            for part in reversed(path[len(whole) :]):
                value = [value] if isinstance(part, int) else {part: value}
            path = whole
    return ".".join(map(str, path)), value


def toml(value: Any) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {toml(entry)}" for key, entry in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    return json.dumps(value)


def near_bounds(schema: dict[str, Any]) -> Iterator[float]:
    """The bounds themselves, and what lies just beyond."""
    for below in [schema, *schema.get("anyOf", [])]:
        for word, step in [("minimum", -1), ("maximum", 1), ("exclusiveMinimum", 0), ("exclusiveMaximum", 0)]:
            if word in below:
                yield below[word]
                yield below[word] + (step if below.get("type") == "integer" else step * 1e-9)


def put(content: dict[str, Any], key: str, value: Any) -> dict[str, Any]:
    """The content of a file with one key more."""
    at: Any = content
    *above, last = key.split(".")
    for part in above:
        at = at[int(part)] if isinstance(at, list) else at.setdefault(part, {})
    at[last] = value
    return content


def test_what_is_refused(schemas: dict[str, Draft7Validator], tmp_path: Path) -> None:
    """Wrong types, unknown keys and constants beyond their ranges are refused by both or by neither."""
    (tmp_path / "model.toml").write_text(MODEL, "utf-8")
    (tmp_path / "study.toml").write_text("amplitudes = 1\n", "utf-8")
    cases = []
    for path, schema in leaves(schemas["study"].schema):
        for value in [*VALUES, *near_bounds(schema)]:
            key, whole = placed(path, value)
            # As in a file of its own: what the key is merged with is valid.
            content = put(tomllib.loads(MODEL + "\n") | {"amplitudes": 1}, key, whole)
            cases.append((key, whole, next(schemas["study"].iter_errors(content), None)))
    assert len(cases) > 2000

    def program(case: tuple[str, Any, Any]) -> str:
        done = isola("check", tmp_path, "--set", f"{case[0]}={toml(case[1])}")
        assert "panicked" not in done.stderr, done.stderr
        return "" if done.returncode == 0 else done.stderr.strip() or "no message"

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        answers = list(pool.map(program, cases))
    wrong = []
    refused = 0
    for (key, value, error), answer in zip(cases, answers, strict=True):
        refused += bool(error and answer)
        if error and not answer:
            wrong.append(f"{key} = {toml(value)}: the schema alone refuses it: {error.message}")
        elif answer and not error and not OTHER.search(answer):
            wrong.append(f"{key} = {toml(value)}: the program alone refuses it: {answer}")
    assert not wrong, "\n".join(wrong)
    assert refused > 1000
