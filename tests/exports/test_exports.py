"""What `isola export` writes against what the run has stored, to the last bit, as NumPy and SciPy read it."""

from __future__ import annotations

import csv
import json
import os
import sqlite3
import subprocess
from pathlib import Path

import numpy as np
import pytest
import scipy.io

ROOT = Path(__file__).parents[2]
STUDY = ROOT / "models" / "rotor67" / "study.toml"
ISOLA = os.environ.get("ISOLA_BIN", str(ROOT / "target" / "release" / "isola"))
COMPLEX = ["argument", "modal", "displacement"]
RENAMED = {"zeta": "decay"}


def isola(*arguments: object) -> subprocess.CompletedProcess[str]:
    """Runs the program."""
    return subprocess.run([ISOLA, *map(str, arguments)], capture_output=True, text=True, check=False, timeout=300)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A finished run of two levels, exported in all formats."""
    folder = tmp_path_factory.mktemp("exports") / "run"
    coarse = ["--set", "harmonics.count=3"]
    sweep = isola("sweep", STUDY, "--out", folder, "--amplitudes", "20,40", "--workers", 2, *coarse)
    assert sweep.returncode == 0, sweep.stderr
    for kind in ["csv", "mat", "npz"]:
        export = isola("export", folder, "--format", kind, "--to", folder.parent / kind)
        assert (export.returncode, export.stderr) == (0, "")
    return folder


@pytest.fixture(scope="module")
def store(run: Path) -> sqlite3.Connection:
    """Its store."""
    return sqlite3.connect(run / "run.sqlite")


def arrays(store: sqlite3.Connection, owner: str) -> dict[str, np.ndarray]:
    """The arrays of a curve or the model."""
    found = {}
    for name, shape, data in store.execute("SELECT name, shape, data FROM arrays WHERE owner = ?", [owner]):
        array = np.frombuffer(data, "<f8").reshape(json.loads(shape))
        found[name] = array.view("<c16")[..., 0] if name in COMPLEX else array
    return found


def columns(store: sqlite3.Connection, table: str) -> dict[str, str]:
    """Names of the columns of numbers of a table of points, and of the arrays that they hold."""
    names = [name for _, name, *_ in store.execute(f"PRAGMA table_info({table})")]
    return {name: RENAMED.get(name, name) for name in names if name not in ("branch", "mode", "i", "stable", "multiplier")}


def marched(store: sqlite3.Connection, branch: int) -> tuple[list[str], list[float]]:
    """What time marching says of the points of a branch: verdicts, empty where there is none, and moduli, NaN there."""
    sql = "SELECT coalesce(stable, ''), multiplier FROM points WHERE branch = ? ORDER BY i"
    verdicts, moduli = zip(*store.execute(sql, [branch]))
    return list(verdicts), [np.nan if modulus is None else modulus for modulus in moduli]


def branches(store: sqlite3.Connection) -> list[tuple[int, str, str]]:
    """Number, task and file of every branch."""
    sql = "SELECT id, task, amplitude || '-' || kind || '-' || number FROM branches ORDER BY id"
    rows = store.execute(sql).fetchall()
    assert len(rows) >= 2
    return rows


def read(file: Path) -> dict[str, object]:
    """All values of a file, by documented name."""
    if file.suffix == ".npz":
        with np.load(file) as found:
            return dict(found)
    values = {}
    for name, value in scipy.io.loadmat(file, simplify_cells=True).items():
        fields = {f"{name}.{key}": field for key, field in value.items()} if isinstance(value, dict) else {name: value}
        values.update({name: value for name, value in fields.items() if not name.startswith("__")})
    return values


def assert_same(found: object, expected: np.ndarray, name: str) -> None:
    """Equal to the last bit; SciPy drops axes of length one."""
    found = np.ascontiguousarray(found, expected.dtype).reshape(expected.shape)
    assert found.tobytes() == np.ascontiguousarray(expected).tobytes(), name


@pytest.mark.parametrize("kind", ["mat", "npz"])
def test_branches(run: Path, store: sqlite3.Connection, kind: str) -> None:
    for number, task, name in branches(store):
        found = read(run.parent / kind / "branches" / f"{name}.{kind}")
        expected = arrays(store, task)
        for column, array in columns(store, "points").items():
            if array not in expected:
                rows = store.execute(f"SELECT {column} FROM points WHERE branch = ? ORDER BY i", [number]).fetchall()
                expected[array] = np.array(rows, dtype="<f8")[:, 0]
        assert {"modal", "displacement", "contact", "residual", "iterations"} < expected.keys()
        for array, values in expected.items():
            assert_same(found[array], values, f"{name}: {array}")
        verdicts, moduli = marched(store, number)
        # An empty text of a MAT file is an array without elements.
        assert ["" if np.size(verdict) == 0 else str(verdict) for verdict in found["stable"]] == verdicts
        assert_same(found["multiplier"], np.array(moduli), f"{name}: multiplier")
        status, special = store.execute("SELECT status, special FROM branches WHERE id = ?", [number]).fetchone()
        assert str(found["status"]) == status and bool(found["closed"]) == (status == "closed")
        assert [str(point) for point in found["special_kind"]] == [point["kind"] for point in json.loads(special)]
        assert [int(index) for index in found["special_index"]] == [point["index"] for point in json.loads(special)]
        worker = store.execute("SELECT worker, program, seconds FROM results WHERE task = ?", [task]).fetchone()
        assert (str(found["worker"]), str(found["program"]), float(found["seconds"])) == worker


@pytest.mark.parametrize("kind", ["mat", "npz"])
def test_the_run(run: Path, store: sqlite3.Connection, kind: str) -> None:
    found = read(run.parent / kind / f"run.{kind}")
    model = arrays(store, "model")
    model["forcing_shape"] = model.pop("forcing")
    for array, values in model.items():
        assert_same(found[f"model.{array}"], values, f"model: {array}")
    for mode, owner, group in [(1, "backbone", "backbone"), (2, "backbone/2", "backbone_2")]:
        backbone = arrays(store, owner)
        for column, array in columns(store, "backbone").items():
            if array not in backbone:
                rows = store.execute(f"SELECT {column} FROM backbone WHERE mode = ? ORDER BY i", [mode]).fetchall()
                backbone[array] = np.array(rows, dtype="<f8")[:, 0]
        assert {"decay", "residual", "r_lin", "threshold", "certificate", "arc"} < backbone.keys()
        for array, values in backbone.items():
            assert_same(found[f"{group}.{array}"], values, f"{group}: {array}")
    names = store.execute("SELECT dofs, displacement_dofs, contacts FROM model").fetchone()
    for key, texts in zip(["dofs", "displacement_dofs", "contacts"], names):
        assert [str(text) for text in found[f"model.{key}"]] == json.loads(texts)
    for key in ["omega_min", "omega_max", "threshold", "first", "last", "best"]:
        windows = "SELECT {} FROM windows JOIN levels USING (level) ORDER BY value, window"
        rows = store.execute(windows.format(f"windows.{key}")).fetchall()
        assert_same(found[f"windows.{key}"], np.array(rows, dtype="<f8")[:, 0], key)
    assert {str(file) for file in found["branches.file"]} == {name for _, _, name in branches(store)}
    assert len(found["run.missing"]) == 0


#: Columns that count from 1 in CSV files and from 0 elsewhere.
MODES = ["mode", "backbone"]


@pytest.mark.parametrize("kind", ["mat", "npz"])
def test_lists_are_those_of_the_csv_files(run: Path, kind: str) -> None:
    found = read(run.parent / kind / f"run.{kind}")
    written = {}
    for name in ["folds", "events", "bifurcations", "motions", "pushes"]:
        file = run.parent / "csv" / f"{name}.csv"
        columns = [key.removeprefix(f"{name}.") for key in found if key.startswith(f"{name}.")]
        assert len(columns) >= 5
        if not file.exists():
            assert all(np.size(found[f"{name}.{column}"]) == 0 for column in columns)
            continue
        with file.open() as text:
            reader = csv.DictReader(text)
            rows = list(reader)
        written[name] = len(rows)
        assert list(reader.fieldnames or []) == columns[: len(reader.fieldnames or [])]
        for column in reader.fieldnames or []:
            values = np.atleast_1d(found[f"{name}.{column}"])
            cells = [row[column] for row in rows]
            if values.dtype.kind in "fi":
                numbers = np.array([float(cell or "nan") - (column in MODES) for cell in cells])
                np.testing.assert_array_equal(values, numbers, f"{name}: {column}")
            else:
                assert ["" if np.size(value) == 0 else str(value) for value in values] == cells, f"{name}: {column}"
    assert written["folds"] > 10 and written["events"] > 0, written


@pytest.mark.parametrize("kind", ["csv", "mat", "npz"])
def test_what_was_written_is_named(run: Path, tmp_path: Path, kind: str) -> None:
    export = isola("export", run, "--format", kind, "--to", tmp_path / kind)
    assert export.returncode == 0, export.stderr
    files = [file.name + ("/" if file.is_dir() else "") for file in (tmp_path / kind).iterdir()]
    named, folder = export.stdout.strip().split(" are in ")
    assert sorted(named.replace(" and ", ", ").split(", ")) == sorted(files)
    assert Path(folder) == tmp_path / kind


@pytest.mark.parametrize("kind", ["mat", "npz"])
def test_all_documented_names_are_there(run: Path, store: sqlite3.Connection, kind: str) -> None:
    document = (ROOT / "results" / "EXPORTS.md").read_text()
    names = [line.split("`")[1] for line in document.splitlines() if line.startswith("| `")]
    _, _, branch = branches(store)[0]
    # Backbones of further modes are written like the first one.
    written = {name.replace("backbone_2.", "backbone.") for name in read(run.parent / kind / f"run.{kind}")}
    assert written == {name for name in names if "." in name}
    assert set(read(run.parent / kind / "branches" / f"{branch}.{kind}")) == {name for name in names if "." not in name}


def test_text(run: Path, store: sqlite3.Connection) -> None:
    first = ["omega", "amplitude", "rms", "contact", "residual", "high_harmonics"]
    for number, _, name in branches(store):
        with (run.parent / "csv" / "branches" / f"{name}.csv").open() as file:
            rows = list(csv.DictReader(file))
        assert list(rows[0])[: len(first)] == first
        common = [column for column in rows[0] if column in columns(store, "points")]
        sql = f"SELECT {', '.join(common)} FROM points WHERE branch = ? ORDER BY i"
        expected = store.execute(sql, [number]).fetchall()
        assert [tuple(float(row[column]) for column in common) for row in rows] == expected
        verdicts, moduli = marched(store, number)
        assert [row["stable"] for row in rows] == verdicts
        np.testing.assert_array_equal([float(row["multiplier"] or "nan") for row in rows], moduli)


def test_a_damaged_branch_is_named_and_the_rest_written(run: Path, store: sqlite3.Connection, tmp_path: Path) -> None:
    (tmp_path / "run").mkdir()
    with sqlite3.connect(tmp_path / "run" / "run.sqlite") as copy:
        store.backup(copy)
        copy.execute("UPDATE points SET omega = omega + 1e-9 WHERE branch = 1 AND i = 3")
    copy.close()
    names = [name for _, _, name in branches(store)]
    for kind in ["csv", "mat", "npz"]:
        export = isola("export", tmp_path / "run", "--format", kind, "--to", tmp_path / kind)
        assert export.returncode == 3, export.stderr
        assert f"Branch {names[0]} is left out" in export.stderr
        files = {file.name for file in (tmp_path / kind / "branches").iterdir()}
        assert files == {f"{name}.{kind}" for name in names[1:]}
