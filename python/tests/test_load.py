"""What `load` reads against what the program exports, to the last bit."""

from __future__ import annotations

import re
import sqlite3
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from runs import MODELS, ROOT, change, isola

import isola_hbm
from isola_hbm.stored.columns import documented

#: Names of the exported files whose numbers stand elsewhere in a dataset, or nowhere: axes and texts.
COORDINATES = {
    "displacement_dofs": "dof",
    "monitors": "monitor",
    "contacts": "element",
    "arguments": "channel",
}


def exported(folder: Path, to: Path, kind: str, code: int = 0) -> Path:
    """The run as files."""
    isola("export", folder, "--format", kind, "--to", to, code=code)
    return to


def assert_bits(found: object, expected: np.ndarray, name: str) -> None:
    """Equal to the last bit."""
    found = np.ascontiguousarray(found, expected.dtype)
    assert (found.shape, found.tobytes()) == (expected.shape, np.ascontiguousarray(expected).tobytes()), name


def assert_is_file(frame: pd.DataFrame, file: Path, texts: set[str]) -> None:
    """A data frame has the columns of a CSV file, and these the same cells."""
    cells = pd.read_csv(file, dtype=str, keep_default_na=False)
    assert set(cells.columns) <= set(frame.columns)
    assert len(cells) == len(frame)
    for name in cells.columns:
        if name in texts:
            assert list(cells[name]) == list(frame[name]), name
        else:
            expected = np.array([float(cell) if cell else np.nan for cell in cells[name]])
            assert_bits(frame[name].to_numpy(float, na_value=np.nan), expected, name)


@pytest.fixture(params=["blade", "damper"])
def folder(request: pytest.FixtureRequest) -> Path:
    """Both runs."""
    found: Path = request.getfixturevalue(request.param)
    return found


def test_columns_of_tables_are_explained(folder: Path) -> None:
    run = isola_hbm.load(folder)
    text = (ROOT / "results" / "COLUMNS.md").read_text(encoding="utf-8")

    def explained(text: str) -> set[str]:
        rows = [line.split("|")[1] for line in text.splitlines() if line.startswith("| `")]
        return {name for row in rows for name in re.findall("`([^`]+)`", row)}

    for name in ("summary", "windows", "folds", "events", "bifurcations", "motions", "pushes"):
        assert set(getattr(run, name).columns) <= explained(text), name
    # What tables have besides the files stands in a section of its own; motions and pushes are of runs that have some.
    besides = explained(text.split("\n## Tables in Python")[1])
    in_tables = {*run.summary.columns, *run.windows.columns}
    assert besides - in_tables == {"periods"}
    assert {"task", "closed", "rejections", "first", "last", "best", "reason"} <= besides


def test_tables_say_their_units_and_pages_how_they_are_saved(damper: Path, tmp_path: Path) -> None:
    """Numbers are SI, whatever units the run keeps."""
    run = isola_hbm.load(damper)
    assert list(run.summary)[:8] == [
        *("amplitude", "branch", "kind", "omega_min", "omega_max", "amplitude_max", "omega_at_max", "stable"),
    ]
    units = run.summary.attrs["units"]
    assert (units["omega_at_max"], units["amplitude_max"]) == ("rad/s", "m")
    assert "amplitude" not in units, "the forcing"
    assert run.folds.attrs["units"] == {"omega": "rad/s", "omega_2h": "rad/s", "amplitude": "m"}
    assert ".save(" in repr(run.explore())
    figure = run.plot.figure("response")
    assert ".save(" in repr(figure)
    assert figure.save(tmp_path / "response.svg").read_text(encoding="utf-8") == figure.svg
    with pytest.raises(ValueError, match=r"response\.png: a figure is written as SVG: end it in \.svg, or let `isola plot"):
        figure.save(tmp_path / "response.png")
    assert not (tmp_path / "response.png").exists()


def test_tables_are_the_csv_files(folder: Path) -> None:
    run = isola_hbm.load(folder)
    texts = {"kind", "status", "peak_standing", "outcome", "reason", "source"}
    assert_is_file(run.summary, folder / "summary.csv", texts)
    assert_is_file(run.windows, folder / "windows.csv", texts | {"branch"})
    assert_is_file(run.folds, folder / "folds.csv", texts)
    assert_is_file(run.events, folder / "events.csv", texts)
    assert_is_file(run.bifurcations, folder / "bifurcations.csv", texts | {"branch"})
    assert run.motions.empty and "onto" in run.motions and not (folder / "motions.csv").exists()
    assert_is_file(run.backbones, folder / "backbone.csv", texts)
    assert run.check() == []
    assert (run.stage, run.name) == ("finished", run.meta["name"])


def test_what_unstable_motions_turn_into_is_the_csv_file(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    study = MODELS / "nltva" / "study.toml"
    isola("sweep", study, "--out", folder, "--amplitudes", "0.18", "--search", "none", "--verify", "all")
    run = isola_hbm.load(folder)
    assert_is_file(run.motions, folder / "motions.csv", {"branch", "motion", "onto"})
    # The absorber's well-known strongly modulated response.
    modulated = run.motions[(run.motions["branch"] == "main") & (run.motions["motion"] == "quasi_periodic")]
    assert len(modulated) >= 2
    assert (modulated["amplitude_max"] > 2 * modulated["amplitude_min"]).any()


def test_branches_are_the_npz_files(folder: Path, tmp_path: Path) -> None:
    run = isola_hbm.load(folder)
    files = exported(folder, tmp_path, "npz")
    assert len(run) == len(list(run)) == len(run.summary) >= 2
    for name, row in run.summary.iterrows():
        branch = run[str(name)]
        level = str(name).split("/")[0]
        with np.load(files / "branches" / f"{level}-{row['kind']}-{row['branch']}.npz") as file:
            expected = dict(file)
        special = zip(expected.pop("special_kind"), expected.pop("special_index"))
        found = [(kind, branch.attrs[kind]) for kind in ("start", "peak") if kind in branch.attrs]
        found += [("fold", index) for index in branch.attrs["folds"]]
        assert sorted(found) == sorted((str(kind), int(index)) for kind, index in special)
        changes = zip(expected.pop("bifurcation_kind"), expected.pop("bifurcation_omega"))
        expected.pop("bifurcation_index")
        rows = run.bifurcations[
            (run.bifurcations["forcing"] == row["amplitude"])
            & (run.bifurcations["branch"] == str(name).split("/")[1])
        ]
        assert [(str(kind), omega) for kind, omega in changes] == list(zip(rows["kind"], rows["omega"]))
        assert int(expected.pop("harmonics")) == branch.sizes["harmonic"] - 1
        assert list(expected.pop("modes")) == [f"mode {mode}" for mode in branch["mode"].values]
        for key, axis in COORDINATES.items():
            assert list(expected.pop(key)) == list(branch[axis].values if axis in branch.sizes else []), key
        for key, values in expected.items():
            if values.ndim:
                assert_bits(branch[key].values, values, f"{name}: {key}")
            elif key in branch.attrs:
                assert branch.attrs[key] == values[()], key
            else:
                # Not known: it is not there.
                assert np.isnan(values), key
        assert (branch.attrs["name"], branch.attrs["level"]) == (str(name).split("/")[1], level)


def test_backbones_and_the_model_are_the_npz_file(folder: Path, tmp_path: Path) -> None:
    run = isola_hbm.load(folder)
    with np.load(exported(folder, tmp_path, "npz") / "run.npz") as file:
        expected = dict(file)
    modes = run.backbones["mode"].unique()
    assert list(modes) == [mode + 1 for mode in expected["modes.followed"]]
    for mode in modes:
        backbone = run.backbone(mode)
        group = "backbone" if mode == modes[0] else f"backbone_{mode}"
        arrays = {
            key: values for key, values in expected.items() if key.startswith(f"{group}.") and values.ndim
        }
        assert len(arrays) >= 15
        for key, values in arrays.items():
            assert_bits(backbone[key.removeprefix(f"{group}.")].values, values, key)
        assert backbone.attrs["status"] == expected[f"{group}.status"]
    assert run.backbone().identical(run.backbone(modes[0]))
    assert_bits(run.shapes.values, expected["model.shapes"], "shapes")
    assert_bits(run.model.mass, expected["model.mass"], "mass")
    with pytest.raises(isola_hbm.NoSuchBranch, match="no backbone of mode 17; modes followed: 1"):
        run.backbone(17)


def test_units_and_meanings_are_those_of_the_documentation(blade: Path) -> None:
    rows = (line.split(" | ") for line in (ROOT / "results" / "EXPORTS.md").read_text().splitlines())
    cells = {row[0].strip("| `"): row[3].strip(" |") for row in rows if len(row) == 4}
    meanings = {name.removeprefix("backbone."): meaning for name, meaning in cells.items()}
    backbone = isola_hbm.load(blade).backbone()
    assert {"amplitude", "r_lin", "contributions", "modal", "threshold"} < set(backbone.data_vars)
    for name, variable in {**backbone.data_vars, "omega": backbone["omega"]}.items():
        meaning, units = variable.attrs["long_name"], variable.attrs["units"]
        described = meaning if units == "1" else f"{meaning}, {units}"
        # The file says of displacements which, and of frequencies and forces that all are in SI units.
        expected = meanings[str(name)].replace("\\|", "|").replace(" of `displacement_dofs`", "")
        assert described.lower().startswith(expected.lower()), name


def test_one_period(blade: Path) -> None:
    branch = isola_hbm.load(blade)["20/main"]
    series = branch.time(samples=500)
    assert series.dims == ("point", "dof", "time")
    assert series.attrs["units"] == "m" and "comment" not in series.attrs
    assert "exp(i k ω t)" in branch["displacement"].attrs["comment"]
    # The largest |x| of the program is refined between its samples.
    top = abs(series.sel(dof="b0.r")).max("time")
    np.testing.assert_allclose(top, branch["amplitude"].isel(monitor=0), rtol=1e-3)
    x = branch["displacement"].isel(point=7).sel(dof="b3.theta").values
    t = np.arange(500) / 500
    expected = sum((x[k] * np.exp(2j * np.pi * k * t)).real for k in range(4))
    np.testing.assert_allclose(series.isel(point=7).sel(dof="b3.theta"), expected, rtol=0, atol=1e-15)
    chosen = branch.isel(point=[3, 5]).time(samples=500).sel(dof=["b1.r", "b0.r"]).isel(time=slice(10, 20))
    np.testing.assert_array_equal(
        chosen, series.isel(point=[3, 5], time=slice(10, 20)).sel(dof=["b1.r", "b0.r"])
    )
    # Predicted pressure, and friction's displacements.
    pressure = branch.time("argument").sel(channel="b0 1")
    assert str(pressure["unit"].values) == "N"
    assert float(pressure.max()) > 0
    with pytest.raises(
        ValueError, match="`rms` has no harmonics; those that have: argument, modal, displacement"
    ):
        branch.time("rms")
    with pytest.raises(TypeError, match="'str' object cannot be interpreted as an integer"):
        branch.time(samples="many")
    with pytest.raises(ValueError, match="samples = 0"):
        branch.time(samples=0)


def test_a_state_to_integrate_from(blade: Path, damper: Path) -> None:
    run = isola_hbm.load(blade)
    branch, start = run["20/main"], run.state("20/main", 7)
    assert start["displacement"].attrs["units"] == "m" and start["velocity"].attrs["units"] == "m/s"
    assert list(start["dof"].values) == list(run.model.dofs)
    # At t = 0 that is what `time` has of some dofs, and its slope there.
    stored = branch["dof"].values
    series = branch.isel(point=7).time(samples=4096).transpose("dof", "time")
    np.testing.assert_allclose(start["displacement"].sel(dof=stored), series.isel(time=0), rtol=1e-9, atol=1e-15)
    step = 2 * np.pi / float(branch["omega"][7]) / 4096
    slope = (series.isel(time=1) - series.isel(time=-1)) / (2 * step)
    size = float(abs(start["velocity"]).max())
    assert size > 0.0
    np.testing.assert_allclose(start["velocity"].sel(dof=stored), slope, rtol=0, atol=1e-5 * size)
    assert run.state((20, "main"), "peak").attrs["point"] == branch.attrs["peak"]
    assert float(start["omega"]) == float(branch["omega"][7])
    with pytest.raises(IndexError, match="point 'top' of"):
        run.state("20/main", "top")

    # Marched over a period, the damper comes back to where it began: x'' + 0.018 x' + x - 0.01 x'^3 + 0.00144 x'^5 = A cos ωt.
    run = isola_hbm.load(damper)
    start = run.state("0.006/isola 1")
    omega, forcing = float(start["omega"]), start.attrs["forcing"]

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        x, v = y
        return np.array([v, forcing * np.cos(omega * t) - x - 0.018 * v + 0.01 * v**3 - 0.00144 * v**5])

    y = begun = np.array([float(start["displacement"][0]), float(start["velocity"][0])])
    steps = 2000
    h = 2 * np.pi / omega / steps
    for i in range(steps):
        k1 = rate(i * h, y)
        k2 = rate((i + 0.5) * h, y + 0.5 * h * k1)
        k3 = rate((i + 0.5) * h, y + 0.5 * h * k2)
        k4 = rate((i + 1) * h, y + h * k3)
        y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    # As far as the harmonics that were left out allow.
    np.testing.assert_allclose(y, begun, rtol=0, atol=1e-3 * abs(begun).max())


def test_multipliers_are_those_of_verified_points(damper: Path) -> None:
    run = isola_hbm.load(damper)
    isola = run["0.006/isola 1"]
    assert isola.verified().sizes["point"] == isola.sizes["point"]
    branch = run["0.006/main"]  # around its peak
    known = branch.verified()
    assert 0 < known.sizes["point"] < branch.sizes["point"] and isinstance(known, type(branch))
    assert np.isfinite(known["multiplier"]).all()
    rest = np.setdiff1d(branch["omega"], known["omega"])
    assert np.isnan(branch["multiplier"][np.isin(branch["omega"], rest)]).all()
    assert branch["multiplier"].attrs["comment"].startswith("NaN at points whose frequency no marched orbit has")
    assert set(known["stable"].values) <= {"stable", "unstable", "marginal"}
    assert run.backbone().verified().sizes["point"] == 0


def test_an_event_that_two_curves_share_stands_once(copy: Path) -> None:
    before = isola_hbm.load(copy).events
    assert (before["source"] == "computed").any()
    change(
        copy,
        "INSERT INTO curve_points SELECT curve + 100, i, "
        + ", ".join(
            f"{name} * (1 + 1e-7)" if name == "forcing" else name
            for name in isola_hbm.load(copy).table("curve_points").columns[2:]
        )
        + " FROM curve_points",
    )
    pd.testing.assert_frame_equal(isola_hbm.load(copy).events, before)


def test_windows_that_led_elsewhere(copy: Path, tmp_path: Path) -> None:
    before = isola_hbm.load(copy).windows
    led = before["branch"].str.contains("isola")
    assert led.any() and (before["outcome"][led] == "found").all()
    # An isola that lies elsewhere: the numbers of its points are not looked at.
    change(copy, "UPDATE branches SET omega_min = 7, omega_max = 8 WHERE kind = 'isola'")
    run = isola_hbm.load(copy)
    after = run.windows
    only = led & ~before["branch"].str.contains("main")
    assert only.any() and (after["outcome"][only] == "elsewhere").all()
    assert (after["outcome"][~only] == before["outcome"][~only]).all()
    isola("export", copy, "--to", tmp_path / "csv", code=3)
    assert_is_file(after, tmp_path / "csv" / "windows.csv", {"outcome", "reason", "branch"})


def test_every_dof_follows_from_shapes_and_modal_amplitudes(blade: Path) -> None:
    run = isola_hbm.load(blade)
    branch = run["20/main"]
    everything = (run.shapes * branch["modal"]).sum("mode")
    np.testing.assert_allclose(
        everything.sel(dof=branch["dof"]).transpose("point", "dof", "harmonic"),
        branch["displacement"],
        rtol=1e-9,
        atol=1e-18,
    )


def test_nothing_is_read_before_it_is_needed(copy: Path) -> None:
    run = isola_hbm.load(copy)
    branch = run["0.005/isola 1"]
    later = run["0.005/main"].time().isel(point=slice(2, 4))
    change(copy, "DELETE FROM arrays WHERE owner IN (SELECT task FROM branches WHERE amplitude = '0.005')")
    assert float(branch["amplitude"].max()) > 2
    for harmonics in (branch["modal"], later):
        with pytest.raises(
            isola_hbm.Damaged, match="the result of task 0.005-.* is not what was stored|is gone"
        ):
            harmonics.load()


def test_names_of_branches(damper: Path) -> None:
    run = isola_hbm.load(damper)
    names = list(run)
    assert names[:3] == ["0.004/main", "0.005/main", "0.005/isola 1"]
    assert "0.005/isola 1" in run
    assert (0.005, "isola 1") in run
    assert "0.005/isola 7" not in run
    assert 7 not in run
    assert run[0.005, "isola 1"].identical(run["0.005/isola 1"])
    assert run["5e-3/isola 1"].identical(run["0.005/isola 1"])
    assert list(run.summary.index) == names
    for name, message in {
        "0.005/isola 7": "there is no branch `isola 7` at A = 0.005; there are main, isola 1",
        "0.3/main": "there is no branch `main` at A = 0.3; levels are 0.004, 0.005, 0.006, 0.007",
        "0.005/isola x": "there is no branch `isola x`",
        # What says but a part of the name is answered with what there is of it, and how that is written.
        # What says but a part of a name is answered with what there is of it, and how that is written.
        "main": '`main` is a branch at A = 0.004, 0.005, 0.006, 0.007: write run["0.004/main"] or run[0.004, "main"]',
        "isola 1": '`isola 1` is a branch at A = 0.005, 0.006, 0.007: write run["0.005/isola 1"] or run[0.005, "isola 1"]',
        0.005: '`0.005` is a level, with main, isola 1: write run["0.005/isola 1"] or run[0.005, "isola 1"]',
        "5e-3": "`5e-3` is a level, with main, isola 1: ",
        6000: '`6000` is no level and no branch; levels are 0.004, 0.005, 0.006, 0.007, branches main, isola 1: write run["0.007/isola 1"]',
        "isola 9": "`isola 9` is no level and no branch; levels are 0.004, ",
        None: "`None` is no level and no branch",
    }.items():
        with pytest.raises(isola_hbm.NoSuchBranch, match=re.escape(message)):
            run[name]
        with pytest.raises(KeyError):
            run[name]
    assert run != isola_hbm.load(damper)
    assert len({run, run}) == 1
    for text in (repr(run), run._repr_html_()):
        assert f"finished: 4 levels, {len(run)} branches (3 isolas), in " in text
        assert "print(run.status())" in text and "run.explore()" in text
    assert "<table" in run._repr_html_()


def test_what_a_later_program_adds_appears_by_itself(copy: Path) -> None:
    change(
        copy,
        "ALTER TABLE branches ADD COLUMN worn REAL; UPDATE branches SET worn = 0.25 WHERE kind = 'main';"
        "ALTER TABLE branches ADD COLUMN verdict TEXT; UPDATE branches SET verdict = 'flutter';"
        "ALTER TABLE points ADD COLUMN wear REAL; UPDATE points SET wear = i;"
        "ALTER TABLE points ADD COLUMN noise TEXT; UPDATE points SET noise = 'marginal' WHERE i > 2;"
        "CREATE TABLE cracks (omega REAL, kind TEXT, record BLOB); INSERT INTO cracks VALUES (1.5, 'edge', x'00');"
        "INSERT INTO arrays SELECT task, 'twins', '<f8', json_array(points, 2), zeroblob(16 * points) FROM branches",
    )
    run = isola_hbm.load(copy)
    assert list(run.summary["worn"].isna()) == list(run.summary["kind"] != "main")
    assert list(run.summary["verdict"]) == ["flutter"] * len(run)
    branch = run["0.005/isola 1"]
    np.testing.assert_array_equal(branch["wear"], np.arange(branch.sizes["point"]))
    assert list(branch["noise"].values[:5]) == ["", "", "", "marginal", "marginal"]
    assert set(run.points["noise"]) == {"", "marginal"}
    assert run.points["omega"].dtype == float
    assert run.table("cracks").to_dict("records") == [{"omega": 1.5, "kind": "edge"}]
    with pytest.raises(KeyError, match="no table `nope`; there are arrays, attempts"):
        run.table("nope")
    assert branch["twins"].dims == ("point", "twins_1")
    assert list(run.points["wear"]) == list(run.points.groupby("name", sort=False).cumcount())
    assert branch["modal"].shape[0] == branch.sizes["point"]


def test_a_run_of_the_first_programs(copy: Path, tmp_path: Path) -> None:
    drop = "".join(
        f"ALTER TABLE branches DROP COLUMN {name};"
        for name in ("peak_standing", "penetration", "pressure_beyond", "amplitude_2h", "shift_2h", "omega_min_2h", "omega_max_2h",
            "change_2h", "change_omega_2h", "slowest_sliding")
    )
    one_mode = (
        "ALTER TABLE windows DROP COLUMN mode; DROP TABLE modes; CREATE TABLE one AS SELECT * FROM backbone;"
        "ALTER TABLE one DROP COLUMN mode; DROP TABLE backbone; ALTER TABLE one RENAME TO backbone;"
        "DROP TABLE curves; DROP TABLE curve_points; PRAGMA user_version = 1"
    )
    change(copy, drop + one_mode)
    run, files = isola_hbm.load(copy), exported(copy, tmp_path / "csv", "csv")
    texts = {"kind", "status", "peak_standing", "outcome", "reason", "source"}
    for name in ("summary", "windows", "folds", "events", "bifurcations"):
        assert_is_file(
            getattr(run, name), files / f"{name}.csv", texts | ({"branch"} if name == "windows" else set())
        )
    assert_is_file(run.backbones, files / "backbone.csv", texts)
    assert run.backbone(1)["modal"].shape[0] == len(run.backbones)
    assert run["0.005/isola 1"]["modal"].dtype == complex
    assert run.check() == []


def test_what_is_no_run(tmp_path: Path, copy: Path) -> None:
    with pytest.raises(isola_hbm.NoSuchRun, match="there is no such file; name the folder of a run"):
        isola_hbm.load(tmp_path / "nowhere")
    with pytest.raises(isola_hbm.NoSuchRun, match=r"study\.toml: a file; name the folder of a run"):
        (tmp_path / "study.toml").touch()
        isola_hbm.load(tmp_path / "study.toml")
    file = tmp_path / "run.sqlite"
    file.write_bytes(bytes([7]) * 5000)
    with pytest.raises(isola_hbm.NoSuchRun, match=r"not a run of Isola \(not an SQLite file\)"):
        isola_hbm.load(tmp_path)
    for size in (0, 50):
        file.write_bytes((copy / "run.sqlite").read_bytes()[:size])
        with pytest.raises(isola_hbm.NoSuchRun, match=rf"\(a file of {size} bytes: not begun, or cut short\)"):
            isola_hbm.load(tmp_path)
    file.unlink()
    change(tmp_path, "CREATE TABLE t (a); PRAGMA application_id = 5")
    with pytest.raises(isola_hbm.NoSuchRun, match="another program"):
        isola_hbm.load(file)
    change(copy, "PRAGMA user_version = 99")
    with pytest.raises(
        isola_hbm.OtherVersion, match="version 99 of the format, this package knows version 13"
    ):
        isola_hbm.load(copy)


def test_the_file_documents_its_columns(blade: Path) -> None:
    from isola_hbm.stored.store import Store

    with Store(blade).read() as reading:
        known = documented(reading, "backbone")
        assert set(reading.columns("backbone")) - {"mode", "i", "zeta"} <= known.keys()
    assert known["amplitude"].axes == ("monitor",)
    assert known["contact"].axes == ("element",)
    assert known["r_lin"].unit == "J a period"
    assert known["residual"].attributes == {"long_name": "Largest scaled residual", "units": "1"}


def test_studies_with_a_failure_of_the_main_branch(copy: Path) -> None:
    change(
        copy,
        "DELETE FROM points WHERE branch = (SELECT id FROM branches WHERE amplitude = '0.004');"
        "DELETE FROM branches WHERE amplitude = '0.004';"
        "UPDATE tasks SET state = 'dead', branch = NULL WHERE kind = 'main' AND level = 1;"
        "UPDATE attempts SET reason = 'ran out' WHERE task IN (SELECT id FROM tasks WHERE kind = 'main' AND level = 1)",
    )
    run = isola_hbm.load(copy)
    first = run.summary.loc["0.004/main"]
    assert (first["kind"], first["branch"], first["status"]) == ("main", 1, "given up: ran out")
    assert first["points"] is pd.NA
    assert "0.004/main" not in run
    with sqlite3.connect(copy / "run.sqlite") as db:
        assert db.execute("SELECT count(*) FROM branches WHERE level = 1").fetchone() == (0,)
    assert any("given up" in sentence for sentence in run.check())
    assert "No branch is known at A = 0.004." in run.check()
    assert MODELS.is_dir()
