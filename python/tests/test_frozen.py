"""The bytes that the Rust tests freeze, read by this client."""

from __future__ import annotations

import re

import msgpack
import numpy as np
import pytest
from fake import FROZEN, frozen, sample

from isola_hbm import (
    Backbone,
    Certificate,
    Corrupt,
    Done,
    LevelWindows,
    Manifest,
    OtherVersion,
    Result,
    Status,
)
from isola_hbm.live import words
from isola_hbm.live.types import Model
from isola_hbm.live.wire import VERSION, array, decode, encoding, harmonics, sha256, variant


def model() -> Model:
    return Model.read(sample("model"))


def test_every_sample_is_messagepack_with_a_view_that_names_its_encoding():
    files = sorted(FROZEN.glob("*.snap.msgpack"))
    assert len(files) > 25
    for file in files:
        name = file.name.removesuffix(".snap.msgpack")
        view = (FROZEN / f"{name}.view.snap").read_text()
        found = next(line for line in view.splitlines() if line.startswith("application/msgpack;"))
        message = found.removeprefix("application/msgpack;").removesuffix(f".v{VERSION}")
        assert name.startswith(message)
        assert found == encoding(message)
        decode(file.read_bytes(), found, message)


def test_manifest():
    manifest = Manifest.read(sample("manifest"))
    assert (manifest.protocol, manifest.run, manifest.name) == (VERSION, "damper-1", "nonlinear damper")
    assert manifest.reach is not None
    assert manifest.reach.frequency == (0.75, 1.5)
    assert [(a.text, a.value) for a in manifest.amplitudes] == [("1e-3", 0.001), ("2.5", 2.5)]
    assert manifest.monitors == ("tip",)
    assert manifest.stage == "sweep"
    assert manifest.settings["harmonics"] == {"count": 10, "samples": 512, "quadrature": "arcs"}
    assert manifest.model_sha256 == sha256(frozen("model"))
    assert Manifest.read({**sample("manifest"), "reach": None}).reach is None
    assert manifest.modes is not None
    assert manifest.modes.followed == (0, 1)
    assert manifest.modes.left_out == (
        (2, "8 modes are followed already"),
        (3, "its backbone does not start: singular"),
    )
    early = {key: value for key, value in sample("manifest").items() if key != "modes"}
    assert Manifest.read({**early, "reach": None}).modes is None


def test_model():
    two = model()
    assert two.dofs == ("root", "tip")
    np.testing.assert_array_equal(two.mass, [[1.0, 1.25], [1.5, 1.75]])
    np.testing.assert_array_equal(two.shapes, [[-1.0, -0.75], [-0.5, -0.25]])
    assert two.damping.shape == (2,)
    assert [element.law for element in two.elements] == [
        "contact",
        "contact",
        "penalty_spring",
        "polynomial_spring",
        "polynomial_damper",
        "tanh_friction",
        "jenkins",
    ]
    node = two.elements[0]
    assert node.channels[2] == ((0, 0.5), (1, 0.5))
    assert node.parameters["friction"] == {"coefficient": 0.15, "radius": 0.25, "sense": -1.0}
    assert (two.index("tip"), two.index(0), two.index(-1)) == (1, 0, 1)
    with pytest.raises(KeyError, match="there are root, tip"):
        two.index("nose")
    with pytest.raises(IndexError):
        two.index(2)


def test_backbone():
    backbone = Backbone.read(sample("backbone"), model())
    assert len(backbone) == 3
    assert backbone.outcome == "open: linear range to amplitude bound"
    np.testing.assert_array_equal(backbone.threshold, [0.5, 0.25, np.inf])
    np.testing.assert_array_equal(backbone.r_nl, [-2.0, -1.75, -1.5])
    assert backbone.contributions.shape == (3, 2)
    assert backbone.modal.shape == (3, 2, 2)


def test_windows():
    levels = [LevelWindows.read(level) for level in sample("windows")["levels"]]
    assert [len(level.windows) for level in levels] == [0, 1]
    window = levels[1].windows[0]
    assert (window.first, window.best, window.last, window.threshold) == (40, 70, 300, 1.75)
    assert window.mode == 1
    assert window.omega == (0.875, 1.125)


def test_status():
    status = Status.read(sample("status"))
    assert (status.stage, status.is_over, status.sequence, status.eta) == ("sweep", False, 4, 30.0)
    assert (status.tasks.done, status.tasks.skipped, status.tasks.running) == (4, 2, 1)
    assert (status.tasks.waiting, status.tasks.dead, status.tasks.branches) == (5, 3, 6)
    assert status.active[0].amplitude == "2.5"
    assert status.active[0].progress is not None
    assert status.active[0].progress.points == 300
    assert status.workers[0].tasks == ("2.5-3",)
    assert status.workers[0].progress is None


def test_announcement_and_result():
    done, payload = Done.read(sample("done")), frozen("result")
    assert (done.sequence, done.task, done.branch, done.outcome) == (4, "2.5-3", "isola 1", "isola 1")
    assert (done.size, done.sha256) == (len(payload), sha256(payload))
    result = Result.read(msgpack.unpackb(payload), model())
    assert (result.task, result.attempt, result.worker, result.seconds) == ("2.5-3", 2, "host-77", 1.5)
    branch = result.branch
    assert branch is not None
    assert (branch.amplitude, branch.amplitude_text) == (2.5, "2.5")
    assert (branch.kind, branch.number, branch.name, branch.closed) == ("isola", 1, "isola 1", False)
    assert branch.outcome == (
        "open: frequency bound to stalled at the smallest step: "
        "no convergence in 10 iterations (scaled residual 1.5e-3)"
    )
    assert [(point.kind, point.index) for point in branch.special] == [("start", 0), ("peak", 1), ("fold", 1)]
    np.testing.assert_array_equal(branch.omega, [1.0, 1.25])
    np.testing.assert_array_equal(branch.amplitudes, [[3.0], [3.25]])
    assert (branch.contact.shape, branch.arguments.shape) == ((2, 2), (2, 9, 2))
    # The numbers count up by a quarter: (re, im) are neighbours, then harmonics, then modes, then points.
    np.testing.assert_array_equal(branch.modal[0], [[-1 - 0.75j, -0.5 - 0.25j], [0.25j, 0.5 + 0.75j]])
    assert branch.arguments[1, 8, 1] == 10 + 0.25 * 70 + 1j * (10 + 0.25 * 71)
    assert branch.peak == 1
    assert "isola 1 at A = 2.5, 2 points" in repr(branch)
    assert branch.peak_standing == "at_least"
    assert branch.certificate == Certificate(
        penetration=0.125, pressure_beyond=None, amplitude_2h=0.375, shift_2h=1e-3, omega_min_2h=0.5, omega_max_2h=0.625,
        change_2h=0.0625, change_omega_2h=1.125,
        contact_omega=(0.5, 0.75), slowest_sliding=0.875,
    )


def test_a_branch_of_the_first_programs():
    message = msgpack.unpackb(frozen("result"))
    for later in ("kind", "peak_standing", "certificate"):
        del message["branch"][later]
    branch = Result.read(message, model()).branch
    assert branch is not None
    assert (branch.kind, branch.peak_standing) == ("isola", None)
    assert branch.certificate == Certificate(*10 * [None])


def test_nothing_found():
    done = Done.read(sample("done_nothing"))
    payload = frozen("result_nothing")
    assert done.branch is None
    assert (done.size, done.sha256) == (len(payload), sha256(payload))
    result = Result.read(msgpack.unpackb(payload), model())
    assert result.branch is None
    assert result.work == "main"
    assert result.outcome == (
        "nothing converged: no convergence in 10 iterations (scaled residual 1.5e-3)"
    )


def test_words_are_those_of_the_program():
    lines = [
        line for line in (FROZEN / "words.snap").read_text().splitlines() if "outcome" in line.split(" ")[0]
    ]
    assert len(lines) > 25
    for line in lines:
        kind, hexadecimal, text = line.split(" ", 2)
        value = msgpack.unpackb(bytes.fromhex(hexadecimal))
        assert {"outcome": words.outcome, "seed_outcome": words.seed_outcome}[kind](value) == text


def test_words_of_tomorrow():
    assert words.outcome("spiral") == "spiral"
    assert words.stop({"stalled": "boredom"}) == "stalled at the smallest step: boredom"
    assert words.seed_outcome("lost") == "lost"


def test_displacements():
    branch = Result.read(sample("result"), model()).branch
    assert branch is not None
    shapes = branch.model.shapes
    every = branch.displacement()
    np.testing.assert_allclose(every, np.einsum("dm,pmk->pdk", shapes, branch.modal), rtol=1e-14)
    np.testing.assert_array_equal(branch.displacement("tip"), every[:, 1])
    np.testing.assert_array_equal(branch.displacement(["tip", 0]), every[:, ::-1])
    x = branch.over_period("tip", samples=8)
    assert x.shape == (2, 8)
    for j in range(8):
        rotation = np.exp(1j * np.arange(2) * 2 * np.pi * j / 8)
        np.testing.assert_allclose(x[:, j], (every[:, 1] * rotation).sum(axis=1).real, atol=1e-14)
    np.testing.assert_array_equal(branch.over_period("tip", 8, points=1), x[1])
    np.testing.assert_array_equal(branch.over_period("tip", 8, points=[1, 0]), x[::-1])


def test_a_field_of_tomorrow_is_ignored():
    result = {**sample("result"), "tomorrow": {"a": 1}}
    result["branch"]["points"]["tomorrow"] = [1, 2]
    assert Result.read(result, model()).branch is not None
    assert Done.read({**sample("done"), "tomorrow": 1}).sequence == 4


def test_another_version_or_name_is_refused_in_words():
    for found in (f"application/msgpack;done.v{VERSION + 1}", encoding("status"), "zenoh/bytes"):
        with pytest.raises(OtherVersion, match="another version of Isola, or is not Isola"):
            decode(frozen("done"), found, "done")
    for cut in (0, 1, 10):
        with pytest.raises(Corrupt, match="malformed `done` message"):
            decode(frozen("done")[:cut], encoding("done"), "done")
    with pytest.raises(Corrupt, match="malformed"):
        decode(frozen("done") + b"\0", encoding("done"), "done")


@pytest.mark.parametrize(
    "damaged",
    [
        {"dtype": "<f4", "shape": [1], "data": bytes(4)},
        {"dtype": "<f8", "shape": [2], "data": bytes(8)},
        {"dtype": "<f8", "shape": [1], "data": bytes(7)},
        {"dtype": "<f8", "shape": "x", "data": bytes(8)},
        {"dtype": "<f8", "data": bytes(8)},
        None,
    ],
)
def test_damaged_arrays(damaged):
    with pytest.raises(Corrupt):
        array(damaged)


def test_arrays_are_complex_by_their_last_axis():
    message = {"dtype": "<f8", "shape": [2, 2], "data": np.array([1.0, 2, 3, 4]).tobytes()}
    np.testing.assert_array_equal(harmonics(message), [1 + 2j, 3 + 4j])
    empty = {"dtype": "<f8", "shape": [0, 3, 2, 2], "data": b""}
    assert harmonics(empty).shape == (0, 3, 2)
    for shape in ([4], [1, 4], []):
        with pytest.raises(Corrupt):
            harmonics({**message, "shape": shape})


def test_columns_by_name_also_those_of_later_programs():
    sent = sample("result")
    points = sent["branch"]["points"]
    count = points["residual"]["shape"][0]
    points["of tomorrow"] = {"dtype": "<f8", "shape": [count], "data": np.arange(count, dtype="<f8").tobytes()}
    points["of another kind"] = {"dtype": "<f8", "shape": [count + 1], "data": bytes(8 * (count + 1))}
    points["no array"] = {"a": [1, None]}
    branch = Result.read(sent, model()).branch
    np.testing.assert_array_equal(branch.columns["of tomorrow"], np.arange(count))
    assert set(branch.columns) == {*sample("result")["branch"]["points"], "of tomorrow"} - {"motions"}
    np.testing.assert_array_equal(branch.columns["amplitude"], branch.amplitudes)

    backbone = Backbone.read(sample("backbone"), model())
    np.testing.assert_array_equal(backbone.columns["threshold"], backbone.threshold)
    np.testing.assert_array_equal(backbone.columns["rms"], backbone.rms)


def test_arrays_that_do_not_fit_the_model():
    result = sample("result")
    points = result["branch"]["points"]
    points["rms"] = {"dtype": "<f8", "shape": [1, 1], "data": bytes(8)}
    with pytest.raises(Corrupt, match="do not fit a model of 2 modes"):
        Result.read(result, model())


def test_variants():
    assert variant("main") == ("main", None)
    assert variant({"isola": 0}) == ("isola", 0)
    for wrong in (None, 1, {}, {"a": 1, "b": 2}):
        with pytest.raises(Corrupt):
            variant(wrong)


def test_every_field_and_variant_is_documented():
    text = (FROZEN.parents[1] / "MESSAGES.md").read_text()

    def check(value, where):
        if isinstance(value, dict):
            for key, content in value.items():
                assert re.search(f'[`"]{key}[`"]', text), f"{key} of {where} is not in MESSAGES.md"
                if key != "settings":
                    check(content, where)
        elif isinstance(value, list):
            for content in value:
                check(content, where)

    for file in FROZEN.glob("*.snap.msgpack"):
        check(msgpack.unpackb(file.read_bytes()), file.name)


def test_result_with_a_fold_curve():
    result = Result.read(sample("result_curve"), model())
    assert result.branch is None and result.outcome == "curve 1"
    curve = result.curve
    assert curve is not None and len(curve) == 3 and not curve.closed
    assert curve.outcome == "open: forcing bound to point budget used up"
    assert [(event.kind, event.index) for event in curve.events] == [("birth", 1)]
    assert curve.quantity == "frequency"
    assert Result.read(sample("result"), model()).curve is None


def test_result_with_responses_of_an_open_branch():
    result = Result.read(sample("result_carried"), model())
    curve = result.curve
    assert result.outcome == "curve 2" and result.work == {"carry": {"branch": {"open": 0}, "end": "last"}}
    assert curve is not None and curve.quantity is None and len(curve) == 2 and not curve.events


def test_result_with_a_branch_that_crosses_another_one():
    result = Result.read(sample("result_switched"), model())
    branch = result.branch
    assert result.work == {"switch": {"branch": "main", "point": 1}} and branch is not None
    assert branch.kind == "branched"
    assert [point.kind for point in branch.special] == ["peak", "start", "branch_point"]


def test_result_of_a_landing():
    result = Result.read(sample("result_landings"), model())
    assert (result.branch, result.curve, result.outcome) == (None, None, "2 forced responses")
