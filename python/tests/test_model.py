"""Models made in Python, and studies computed with them."""

from __future__ import annotations

import io
import json
import math
import os
import re
import signal
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
import scipy.sparse
from runs import MODELS, isola, program

import isola_hbm
from isola_hbm import BadModel, Contact, Law, Model
from isola_hbm import program as of_program
from isola_hbm import toml as of_toml
from isola_hbm.laws import _MOST, _PARAMETERS, _POLYNOMIALS, _TERM
from isola_hbm.showing import shown

CUBIC = Law("polynomial_spring", dof="x1", terms=[{"power": 3, "coefficient": 1}])


def random(n: int) -> np.ndarray:
    """A symmetric positive definite matrix of numbers with all their digits."""
    factor = np.random.default_rng(n).normal(size=(n, n))
    matrix: np.ndarray = factor @ factor.T + n * np.eye(n)
    return (matrix + matrix.T) / 2


@pytest.fixture(autouse=True)
def _program(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """The program is where the package looks for it."""
    if "needs_program" in request.keywords:
        monkeypatch.setenv("ISOLA_BIN", str(program().absolute()))


@pytest.mark.parametrize(
    "form", [np.array, scipy.sparse.csr_array, scipy.sparse.coo_matrix, lambda matrix: matrix.tolist()]
)
def test_matrices_are_kept_to_the_bit(form: object, tmp_path: Path) -> None:
    mass, stiffness = random(5), random(5) * 1e7
    stiffness[0, 4] = stiffness[4, 0] = 0.0
    assert callable(form)
    model = Model(form(mass), form(stiffness), C=form(1e-3 * mass), laws=[CUBIC], name="five")
    again = Model.load(model.save(tmp_path / "five"))
    for name in ("M", "K", "C"):
        assert getattr(again, name).tobytes() == getattr(model, name).tobytes(), name
    assert (again.name, again.dofs, again.size) == ("five", ["x1", "x2", "x3", "x4", "x5"], 5)
    assert repr(again) == "<Model five: 5 dofs, 0 contact nodes, 1 law>"


def test_everything_of_a_model_file_is_read_and_written(tmp_path: Path) -> None:
    for folder in sorted(path.parent for path in MODELS.glob("*/model.toml")):
        model = Model.load(folder)
        again = Model.load(model.save(tmp_path / folder.name))
        assert again.sections == model.sections
        assert (again.name, again.dofs, again.description) == (model.name, model.dofs, model.description)
        assert again.K.tobytes() == model.K.tobytes()


@pytest.mark.needs_program
def test_the_program_reads_the_same_structure(tmp_path: Path) -> None:
    model = Model.load(MODELS / "rotor67")
    runs = []
    for folder in (MODELS / "rotor67", model.save(tmp_path / "copy")):
        study = tmp_path / f"{len(runs)}.toml"
        where = of_toml.literal(os.path.relpath(folder, tmp_path))
        study.write_text(f"model = {where}\namplitudes = [1]\n")
        runs.append(isola("check", study).stdout.split("\n", 3)[3])
    assert runs[0] == runs[1]


def test_elements_are_written_as_the_file_wants_them(tmp_path: Path) -> None:
    model = Model(
        np.eye(3),
        np.eye(3),
        dofs=["tip.r", "tip.t", "a b"],
        monitors=["tip.t"],
        damping={"rayleigh": {"mass": 0.1, "stiffness": np.float64(1e-6)}},
        forcing={"shape": {"dofs": {"tip.r": 2.0}}, "harmonic": 2},
        contact={"gap": 1e-3, "friction": 0.15},
        contacts=[
            Contact("tip.r", tangential=["tip.t"], radius=0.25, name='the "tip"'),
            Contact({"tip.r": 1, "a b": -1}),
        ],
        laws=[
            Law("jenkins", between=["tip.r", "a b"], stiffness=1, limit=0.1),
            Law("penalty_spring", dof="a b", stiffness=1.0, gap=0.0),
        ],
    )
    text = (model.save(tmp_path / "m") / "model.toml").read_text()
    for line in (
        'monitors = ["tip.t"]',
        "rayleigh = { mass = 0.1, stiffness = 1e-06 }",
        'shape = { dofs = { "tip.r" = 2.0 } }',
        'name = "the \\"tip\\""',
        'normal = { "tip.r" = 1, "a b" = -1 }',
        'between = ["tip.r", "a b"]',
        "law = { jenkins = { stiffness = 1, limit = 0.1 } }",
    ):
        assert line in text.splitlines(), line
    forced = Model(np.eye(3), np.eye(3), forcing=np.array([0.0, 2.5, 0.0]), name="forced").save(
        tmp_path / "f"
    )
    assert "shape = { dofs = { x2 = 2.5 } }" in (forced / "model.toml").read_text().splitlines()
    with pytest.raises(FileExistsError, match="overwrite=True replaces it"):
        model.save(tmp_path / "m")
    assert model.save(tmp_path / "m", overwrite=True) == tmp_path / "m"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"M": [[1, 2, 3]]}, r"M: shape \(1, 3\); a square matrix \[n, n\] is needed"),
        ({"M": [1, 2]}, r"M: shape \(2,\)"),
        ({"M": [[]]}, r"M: shape \(1, 0\)"),
        ({"K": [[1]]}, r"K: shape \(1, 1\), but M has \(2, 2\)"),
        ({"C": np.eye(3)}, r"C: shape \(3, 3\), but M has"),
        ({"K": [[1, 0], [0, float("nan")]]}, r"K\[1, 1\] = nan: a finite number is needed"),
        ({"K": scipy.sparse.csr_array([[1, 0], [0, np.inf]])}, r"K\[1, 1\] = inf"),
        ({"K": [[2, 1], [1.001, 2]]}, r"K: not symmetric \(K\[0, 1\] = 1, K\[1, 0\] = 1.001\)"),
        ({"K": [[1j, 0], [0, 1]]}, "K: complex numbers"),
        ({"K": [["a", 0], [0, 1]]}, r"K\[0, 0\] = 'a': a finite number is needed"),
        ({"K": [[1, 0], [0, 1j, 2]]}, r"K\[1\] has 3 entries; rows of 2 are needed"),
        ({"M": [[1, 0], [0.1]]}, r"^M\[1\] has 1 entry; rows of 2 are needed, as many as there are rows$"),
        ({"M": [[1, 0], 3]}, r"M\[1\] = 3: a row of 2 numbers is needed"),
        ({"K": {"x1": 1}}, "K: no matrix of real numbers"),
        ({"K": "K.mtx"}, r"K = 'K.mtx': an array \[n, n\] is needed; Model.load reads the folder of a model, scipy.io.mmread"),
        ({"C": Path("C.mtx")}, r"C = 'C.mtx': an array"),
        (
            {"M": [[1, 0], [0, 0]]},
            r"M: not positive definite \(smallest eigenvalue 0\); are M and K exchanged",
        ),
        ({"dofs": ["a"]}, "dofs: 1 name; M has 2 rows: give each dof a name of its own"),
        ({"dofs": ["a", "a"]}, "dofs: 2 names, `a` more than once; M has 2 rows"),
        ({"monitors": ["y"]}, "monitors: no dof `y`; there are x1, x2"),
        ({"laws": [Law("jenkins", between=["x1", "z"], stiffness=1, limit=1)]}, r"laws\[0\]: no dof `z`"),
        ({"contacts": [Contact("x1", tangential=["t"])]}, r"contacts\[0\]: no dof `t`"),
        ({"forcing": [1.0]}, r"forcing: shape \(1,\); 2 finite numbers are needed"),
        ({"forcing": ["left", "right"]}, r"forcing\[0\] = 'left': a finite number is needed"),
        ({"forcing": [1.0, [2.0]]}, r"forcing\[1\] = \[2.0\]: a finite number is needed"),
        ({"forcing": [1.0, np.nan]}, r"^forcing\[1\] = nan: a finite number is needed$"),
        ({"forcing": [1.0, 1j]}, "forcing: complex numbers; real ones are needed"),
        ({"forcing": "x1"}, "forcing = 'x1': a list of 2 numbers is needed, a force for each dof"),
        ({"forcing": {1, 2}}, "forcing: no list of real numbers"),
        ({"forcing": {"shape": {"dofs": {"z": 1.0}}}}, "forcing: no dof `z`; there are x1, x2"),
        ({"forcing": {"x1": 1.0}}, 'forcing: no key `x1`; there are shape, harmonic; as {"shape": {"dofs": {"x1": 1}}}'),
        ({"forcing": {"shape": None}}, r"forcing: shape = None \(NoneType\)"),
        (
            {"dofs": ["main", "nes"], "forcing": {"shape": {"dofs": {"mian": 1.0}}}},
            "forcing: no dof `mian`; did you mean `main`[?] there are main, nes",
        ),
        ({"dofs": ["tip", "root"], "monitors": ["tipp"]}, "monitors: no dof `tipp`; did you mean `tip`[?] there are"),
        ({"forcing": [0.0, 0.0]}, "all forces are zero"),
        ({"C": np.eye(2), "damping": {"default_ratio": 1e-3}}, "two ways to give the damping"),
        ({"dofs": "ab"}, "dofs = 'ab': a list of names of dofs is needed"),
        ({"dofs": 2}, "dofs = 2: a list of names"),
        ({"monitors": "x1"}, "monitors = 'x1': a list of names"),
        ({"name": 67}, "name = 67: a text is needed"),
        ({"damping": 0.01}, "damping = 0.01: a dict of its keys is needed, as {\"default_ratio\": 0.01}"),
        ({"contact": 1}, "contact = 1: a dict of its keys"),
        ({"contact": {"gap": None}}, r"contact: gap = None \(NoneType\) has no form in TOML; numbers"),
        ({"laws": Law("jenkins", dof="x1", stiffness=1, limit=1)}, r"laws: a list is needed, as laws=\[Law\(…\)\]"),
        ({"laws": [{"between": "x1", "law": {}}]}, r"laws\[0\]: between = 'x1': two dofs are needed"),
        ({"laws": [{"between": ["x1"], "law": {}}]}, r"laws\[0\]: between = \['x1'\]: two dofs are needed"),
        ({"laws": [{"coefficients": ["x1"], "law": {}}]}, r"laws\[0\]: coefficients = \['x1'\]: dofs with factors"),
        ({"laws": [{"coefficients": {0: 1}, "law": {}}]}, r"laws\[0\]: 0 \(int\) is no name; a text is needed"),
        ({"contacts": [Contact({0: 1})]}, r"contacts\[0\]: 0 \(int\) is no name; a text is needed"),  # type: ignore[dict-item]
        ({"contacts": [{"normal": "x1", "tangential": 3}]}, r"contacts\[0\]: tangential = 3: a list of one or two"),
        ({"laws": ["jenkins"]}, r"laws\[0\] = 'jenkins': a Law is needed"),
        ({"forcing": {"shape": {"dofs": {0: 1}}}}, r"forcing: 0 \(int\) is no name; a text is needed"),
        ({"damping": {1: 0.1}}, r"damping: 1 \(int\) is no name; a text is needed"),
        ({"laws": [{"dof": "x1", "law": {"jenkins": {"limit": None}}}]}, r"laws\[0\]: law = None \(NoneType\)"),
        ({"contacts": Contact("x1")}, r"contacts: a list is needed, as contacts=\[Contact\(…\)\]"),
    ],
)
def test_bad_models_are_refused(changes: dict[str, object], message: str) -> None:
    with pytest.raises(BadModel, match=message) as caught:
        Model(**{"M": np.eye(2), "K": np.eye(2), **changes})  # type: ignore[arg-type]
    assert isinstance(caught.value, ValueError)
    assert caught.value.__cause__ is None and (caught.value.__suppress_context__ or not caught.value.__context__)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a =", "model.toml: Invalid value"),
        ("matrices = 3", "matrices = 3: a dict of its keys is needed"),
        ("contact = 3", "contact = 3: a dict of its keys"),
        ("[matrices]\nmass = 'mass.mtx'", "mass.mtx"),
        ("[matrices]\nmass = 'cut.mtx'", "cut.mtx: Truncated file"),
        ("[matrices]\nmass = 'rows.mtx'", r"M: shape \(2, 1\); a square matrix"),
        ("[matrices]\nmass = 'nan.mtx'", r"M\[0, 0\] = nan: a finite number"),
        ("harmonics = 3", "there is no `harmonics`; known here: contact, damping, description"),
    ],
)
def test_files_that_are_no_models(text: str, message: str, tmp_path: Path) -> None:
    head = "%%MatrixMarket matrix coordinate real"
    for name, matrix in {
        "K.mtx": f"{head} symmetric\n1 1 1\n1 1 1\n",
        "cut.mtx": f"{head} symmetric\n2 2 3\n1 1 1\n",
        "rows.mtx": f"{head} general\n2 1 1\n1 1 3\n",
        "nan.mtx": f"{head} symmetric\n1 1 1\n1 1 nan\n",
    }.items():
        (tmp_path / name).write_text(matrix)
    with pytest.raises(BadModel, match="model.toml: there is no such file; name the folder of a model"):
        Model.load(tmp_path)
    (tmp_path / "model.toml").write_text(text)
    with pytest.raises(BadModel, match=message):
        Model.load(tmp_path)


def test_a_law_acts_in_one_place(tmp_path: Path) -> None:
    for where in ({}, {"dof": "x1", "between": ["x1", "x2"]}):
        with pytest.raises(
            BadModel, match="law `jenkins`: say where it acts by one of dof, between and coefficients"
        ):
            Law("jenkins", stiffness=1, limit=1, **where)  # type: ignore[arg-type]
    for places, message in (
        ({"dof": 1}, "dof: 1 (int) is no name of a dof; a text is needed"),
        ({"dof": ["x1"]}, "dof: ['x1'] (list) is no name of a dof"),
        ({"between": "x1"}, "between = 'x1': two dofs are needed, as ["),
        ({"between": ["x1"]}, "between = ['x1']: two dofs are needed"),
        ({"between": ["x1", 2]}, "between: 2 (int) is no name of a dof"),
        ({"between": ["x1", "x1"]}, "between = ['x1', 'x1']: two different dofs are needed"),
        ({"coefficients": ["x1"]}, "coefficients = ['x1']: dofs with factors are needed, as {"),
        ({"coefficients": {}}, "coefficients = {}: dofs with factors are needed"),
        ({"coefficients": {0: 1}}, "coefficients: 0 (int) is no name of a dof; a text is needed"),
        ({"coefficients": {"x1": "a"}}, "coefficients['x1'] = 'a': a finite number is needed"),
        ({"coefficients": {"x1": 1, "x2": 0}}, "coefficients['x2'] = 0: the law does not act there; leave the dof out"),
    ):
        with pytest.raises(BadModel, match=f"^{re.escape(f'law `jenkins`: {message}')}"):
            Law("jenkins", stiffness=1, limit=1, **places)  # type: ignore[arg-type]
    with pytest.raises(BadModel, match=re.escape("model.toml")):
        Model.load(tmp_path)


def test_a_law_is_one_that_there_is() -> None:
    for kind, parameters, message in (
        ("cubic", {}, "there is no law `cubic`; did you mean `polynomial_spring`? known: polynomial_spring, jenkins, penalty_spring, "),
        ("penalty", {"gap": 1}, "there is no law `penalty`; did you mean `penalty_spring`? known: penalty_spring, jenkins, "),
        ("viscous damper", {}, "there is no law `viscous damper`; did you mean `polynomial_damper`? known: polynomial_damper, "),
        ("jenkns", {}, "there is no law `jenkns`; did you mean `jenkins`? known: jenkins, "),
        ("magnet", {}, "there is no law `magnet`; known: jenkins, penalty_spring, polynomial_damper, polynomial_spring, tanh_friction"),
        (
            "polynomial_spring",
            {"terms": [{"power": 3, "coeficient": 1}]},
            "there is no key of a term of law `polynomial_spring` `coeficient`; did you mean `coefficient`? known: ",
        ),
        ("jenkins", {"limt": 1}, "there is no parameter of law `jenkins` `limt`; did you mean `limit`? known: limit, "),
        ("penalty_spring", {"stiffness": 1}, "law `penalty_spring`: gap missing; it needs stiffness and gap"),
        ("penalty_spring", {"stiffness": 0, "gap": 1}, "law `penalty_spring`: stiffness = 0: a number above zero is needed"),
        ("penalty_spring", {"stiffness": 1, "gap": math.nan}, "law `penalty_spring`: gap = nan: a finite number is needed"),
        ("jenkins", {"stiffness": "1", "limit": 1}, "law `jenkins`: stiffness = '1': a finite number is needed"),
        ("polynomial_spring", {"terms": []}, "law `polynomial_spring`: terms is empty; at least one is needed, as [{"),
        ("polynomial_spring", {"terms": {"power": 3}}, "law `polynomial_spring`: terms = {'power': 3}: a list is needed, as ["),
        ("polynomial_damper", {"terms": [3]}, "law `polynomial_damper`: terms[0] = 3: a power with its coefficient is needed"),
        ("polynomial_spring", {"terms": [{"power": 3}]}, "law `polynomial_spring`: terms[0]: coefficient missing; it needs power"),
        (
            "polynomial_spring",
            {"terms": [{"power": 2.5, "coefficient": 1}]},
            "law `polynomial_spring`: terms[0].power = 2.5: a whole number from 1 to 15 is needed",
        ),
        (
            "polynomial_spring",
            {"terms": [{"power": 3, "coefficient": math.inf}]},
            "law `polynomial_spring`: terms[0].coefficient = inf: a finite number is needed",
        ),
    ):
        with pytest.raises(BadModel, match=f"^{re.escape(message)}"):
            Law(kind, dof="x1", **parameters)


@pytest.mark.needs_program
def test_laws_are_those_of_the_program() -> None:
    said = subprocess.run([of_program.find(), "schema", "model"], check=True, capture_output=True, text=True).stdout
    laws = json.loads(said)["properties"]["laws"]["items"]["properties"]["law"]["properties"]
    assert set(laws) == {*_PARAMETERS, *_POLYNOMIALS}
    for kind, parameters in _PARAMETERS.items():
        known = {key: key_of.get("exclusiveMinimum") == 0 for key, key_of in laws[kind]["properties"].items()}
        assert known == parameters and set(laws[kind]["required"]) == set(parameters)
    for kind in _POLYNOMIALS:
        terms = laws[kind]["properties"]["terms"]
        term = terms["items"]["properties"]
        assert terms["minItems"] == 1 and set(term) == set(_TERM)
        assert (term["power"]["minimum"], term["power"]["maximum"]) == (1, _MOST)


@pytest.mark.needs_program
def test_a_sweep_is_the_one_of_the_command_line(tmp_path: Path) -> None:
    said: list[str] = []
    model = Model.load(MODELS / "nonlinear_damper")
    run = isola_hbm.sweep(
        model,
        [0.004, 0.005],
        out=tmp_path / "mine",
        workers=1,
        progress=said.append,
        harmonics={"count": 5},
        **{"frequency.min": 0.9, "frequency.max": 1.1, "backbone.max_amplitude": 3},
        search="none",
    )
    study = MODELS / "nonlinear_damper" / "study.toml"
    isola(
        "sweep",
        study,
        "--out",
        tmp_path / "theirs",
        "--amplitudes",
        "0.004,0.005",
        "--workers",
        1,
        "--search",
        "none",
    )
    theirs = isola_hbm.load(tmp_path / "theirs")
    assert list(run) == list(theirs) == ["0.004/main", "0.005/main", "0.005/isola 1"]
    for name in run:
        assert run[name]["modal"].values.tobytes() == theirs[name]["modal"].values.tobytes()
    assert "2 levels, 1 backbone" in "".join(said)
    assert said[-1].startswith("finished: 3 branches in ")
    # What the terminal says at the end.
    told = run.status()
    assert "isolas and others" in told and "Looked for: windows of mode 1 alone;" in " ".join(told.split()), told
    counts = run.counts
    assert (counts.branches, counts.running, counts.waiting, counts.dead) == (3, 0, 0, 0)
    text = (tmp_path / "mine" / "model" / "model.toml").read_text()
    with pytest.raises(isola_hbm.FolderInUse, match="holds a run already, .* give another `out`, or remove"):
        isola_hbm.sweep(Model([[2]], [[3]]), [1], out=tmp_path / "mine")
    assert (tmp_path / "mine" / "model" / "model.toml").read_text() == text
    # The study stays beside the run, which goes on with it.
    assert isola("resume", tmp_path / "mine", "--workers", 1).returncode == 0


@pytest.mark.needs_program
def test_studies_and_models_by_their_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    Model([[1]], [[1]], laws=[CUBIC], name="mine").save(tmp_path / "models" / "mine")
    monkeypatch.chdir(tmp_path)
    settings = {"workers": 1, "search": "none", "harmonics": {"count": 3}, "progress": False}
    run = isola_hbm.sweep("models/mine", "0.01, 0.02", backbone={"max_amplitude": 0.5}, **settings)
    assert list(run) == ["0.01/main", "0.02/main"]
    assert run.folder.parent == Path("runs")
    assert run.folder.name.startswith("mine-2")
    run = isola_hbm.sweep(MODELS / "duffing", 0.01, backbone={"max_amplitude": 0.5}, **settings)
    assert list(run) == ["0.01/main"]
    assert run.folder.name.startswith("duffing-")
    with pytest.raises(BadModel, match="models/mine: no study; give amplitudes"):
        isola_hbm.sweep("models/mine", progress=False)


@pytest.mark.needs_program
@pytest.mark.parametrize(
    ("arguments", "settings", "message"),
    [
        (
            ("nowhere", [1]),
            {},
            "nowhere: no such file; give a study file, or a folder that holds a study.toml",
        ),
        ((MODELS / "duffing", [-1]), {}, "amplitudes = -1: a forcing amplitude is a finite number above zero"),
        ((MODELS / "duffing", [0.1]), {"contact": {"gapp": 1}}, "there is no key `gapp`; did you mean `gap`?"),
        ((MODELS / "duffing", [0.1]), {"harmonics.count": 0}, "harmonics.count = 0: use 1 to 400"),
        ((MODELS / "duffing", [0.1]), {"harmonic": 5}, "harmonic = 5: there is no key `harmonic`; did you"),
        ((MODELS / "duffing", [0.1]), {"search": "hard"}, "hard"),
        ((MODELS / "duffing", [0.1]), {"frequency": (1, 2)}, "frequency = [1, 2]: this is a section: give a dict of its keys, as frequency={…}"),
    ],
)
def test_the_program_says_what_is_wrong(
    arguments: tuple[object, object], settings: dict[str, object], message: str, tmp_path: Path
) -> None:
    with pytest.raises(isola_hbm.ProgramFailed, match=re.escape(message)) as caught:
        isola_hbm.sweep(*arguments, out=tmp_path / "run", progress=False, **settings)  # type: ignore[arg-type]
    assert caught.value.code in (1, 2)
    assert not str(caught.value).startswith(("error", "--"))
    assert isinstance(caught.value, isola_hbm.BadStudy)
    # Nothing is left of what was refused.
    assert not (tmp_path / "run").exists()


@pytest.mark.needs_program
@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"laws": [{"dof": "x1", "law": {"cubic": {}}}]}, "the model given: `laws[0].law`: there is no law `cubic`; did you mean `polynomial_spring`?"),
        (
            {"laws": [CUBIC, {"dof": "x1", "law": {"polynomial_spring": {"terms": [{"power": 3, "coeff": 1}]}}}]},
            "the model given: `laws[1].law.polynomial_spring.terms[0].coeff`: there is no key `coeff`; did you mean",
        ),
        ({"damping": {"ratio": 0.01}}, "the model given: `damping.ratio`: there is no key `ratio`; did you mean `ratios`?"),
        ({"K": [[0]], "laws": [CUBIC]}, "the model given: `backbone.modes` (set by default) = auto: all modes are rigid-body modes"),
        ({"K": [[-1]]}, "the model given: `K` has a negative eigenvalue: "),
        ({"contacts": [Contact("x1", gapp=1)]}, "the model given: `contacts[0].gapp`: there is no key `gapp`; did you mean `gap`?"),
        (
            {"laws": [{"dof": "x1", "law": {"polynomial_spring": {"terms": []}}}]},
            'the model given: `laws[0].law.polynomial_spring.terms` = []: expected at least one term, like {"power": 3, "coefficient": 1}',
        ),
        (
            {"laws": [{"dof": "x1", "law": {"polynomial_spring": {"terms": {"power": 3, "coefficient": 1}}}}]},
            "the model given: `laws[0].law.polynomial_spring.terms`: a single dict, where a list of them is expected",
        ),
        (
            {"laws": [{"dof": "x1", "law": {"polynomial_spring": {"terms": [3]}}}]},
            "the model given: `laws[0].law.polynomial_spring.terms[0]`: found `3`, expected a dict of its keys",
        ),
    ],
)
def test_the_program_speaks_of_the_model_given(
    changes: dict[str, object], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    model = Model(**{"M": [[1]], "K": [[1]], **changes})  # type: ignore[arg-type]
    monkeypatch.chdir(tmp_path)
    for out in ("run", tmp_path / "absolute", None):
        with pytest.raises(isola_hbm.ProgramFailed) as caught:
            isola_hbm.sweep(model, [0.1], out=out, progress=False)
        assert isinstance(caught.value, isola_hbm.BadModel)
        assert str(caught.value).startswith(message)
        assert not re.search(r"\.(toml|mtx)|\[\[|\w = \d+[,}]", str(caught.value))
    with pytest.raises(isola_hbm.ProgramFailed) as checked:
        model.check()
    assert str(checked.value) == str(caught.value)


@pytest.mark.needs_program
def test_what_a_backbone_shows_to_make_no_sense(tmp_path: Path) -> None:
    told = r"^frequency.min = 9 rad/s \(1.432394 Hz\): the backbones end at "
    with pytest.raises(isola_hbm.StudyRefused, match=told):
        isola_hbm.sweep(MODELS / "duffing", [0.01], out=tmp_path / "run", progress=False, frequency={"min": 9})


@pytest.mark.parametrize(
    ("said", "code", "kind"),
    [
        ("error: {out}: no space left on device", 1, isola_hbm.ProgramFailed),
        ("error: thread panicked", 101, isola_hbm.ProgramFailed),
        ("error: --amplitudes: `amplitudes` = -1: no", 2, isola_hbm.StudyRefused),
        ("error: --set contact.gap=-1: `contact.gap` = -1: no", 2, isola_hbm.StudyRefused),
        ("error: {out}/model/model.toml: first entry of laws: `laws[0].law`: no", 1, isola_hbm.ModelRefused),
        ("error: {out}/model/K.mtx, line 3: no", 1, isola_hbm.ModelRefused),
    ],
)
def test_failures_are_no_refusals(
    said: str, code: int, kind: type[isola_hbm.ProgramFailed], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    isola_stub = tmp_path / "isola"
    isola_stub.write_text(f"#!/bin/sh\necho '{said.format(out=tmp_path / 'run')}' >&2\nexit {code}\n")
    isola_stub.chmod(0o755)
    monkeypatch.setenv("ISOLA_BIN", str(isola_stub))
    with pytest.raises(isola_hbm.ProgramFailed) as caught:
        isola_hbm.sweep(Model([[1]], [[1]]), [0.1], out=tmp_path / "run", progress=False)
    assert (type(caught.value), caught.value.code) == (kind, code)
    assert isinstance(caught.value, ValueError) == (kind is not isola_hbm.ProgramFailed)


@pytest.mark.needs_program
def test_a_model_is_checked_without_a_sweep(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    model = Model([[1]], [[4]], laws=[CUBIC], name="mine")
    said = model.check()
    assert said.startswith("size        1 dof, no rigid contact, 1 other law")
    assert "2 rad/s" in said and "monitored   x1" in said
    assert "harmonics   3," in model.check(harmonics={"count": 3})
    assert "\namplitudes  " not in said and "\namplitudes  2: 0.1 … 0.2\n" in model.check([0.1, 0.2])
    assert model.check(amplitudes=[0.1, 0.2]) == model.check("0.1:0.2:0.1")
    with pytest.raises(isola_hbm.BadStudy, match="search: None"):
        model.check(search=None)
    with pytest.raises(isola_hbm.BadStudy, match="model: a study is that of the model given"):
        model.check(model="other")
    with pytest.raises(isola_hbm.ProgramFailed, match="^harmonics.cuont = 3: "):
        model.check(**{"harmonics.cuont": 3})
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("typed", ["amplitude", "amplitudess", "worker", "outs"])
def test_a_keyword_that_is_mistyped(typed: str, tmp_path: Path) -> None:
    model = Model([[1]], [[4]], laws=[CUBIC])
    meant = {"amplitude": "amplitudes", "amplitudess": "amplitudes", "worker": "workers", "outs": "out"}[typed]
    for given in (model, tmp_path):
        with pytest.raises(isola_hbm.BadStudy, match=f"^{typed}: .*did you mean `{meant}`"):
            isola_hbm.sweep(given, out=tmp_path / "run", **{typed: 1})
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("given", [np.eye(2), None, 3, [[1.0]]])
def test_what_is_no_model(given: object, tmp_path: Path) -> None:
    message = r"model: \w+ given; a Model is needed, as Model\(M, K\) of matrices, or the path of a model or a study"
    with pytest.raises(BadModel, match=message):
        isola_hbm.sweep(given, [0.1], out=tmp_path / "run")  # type: ignore[arg-type]


@pytest.mark.needs_program
@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"amplitudes": [None]}, "amplitudes = [None]: give a list of numbers, as [20, 60], or a text"),
        ({"amplitudes": np.ones((1, 2))}, "amplitudes = array([[1., 1.]]): give a list"),
        ({"amplitudes": object}, "give a list of numbers"),
        ({"workers": -1}, "workers = -1: a number of processes is needed"),
        ({"workers": "two"}, "workers = 'two'"),
        ({"search": None}, "search: None (NoneType) has no form in TOML; leave a key out"),
        ({"harmonics": {1: 2}}, "settings: 1 (int) is no name; a text is needed"),
        ({"amplitudes": []}, "amplitudes: the list is empty; give one forcing amplitude at least, as [20]"),
        ({"amplitudes": {0.1: 1}}, "amplitudes = {0.1: 1}: give a list of numbers"),
        ({"harmonics": {"count": None}}, "harmonics: None (NoneType)"),
    ],
)
def test_what_cannot_be_told_to_the_program(changes: dict[str, object], message: str, tmp_path: Path) -> None:
    arguments = {"amplitudes": [0.1], "out": tmp_path / "run", **changes}
    with pytest.raises(isola_hbm.BadStudy, match=re.escape(message)) as caught:
        isola_hbm.sweep(MODELS / "duffing", progress=False, **arguments)  # type: ignore[arg-type]
    assert isinstance(caught.value, ValueError)
    assert not (tmp_path / "run").exists()


@pytest.mark.needs_program
def test_a_file_in_the_place_of_the_folder(tmp_path: Path) -> None:
    (tmp_path / "run").touch()
    for out in (tmp_path / "run", tmp_path / "run" / "first"):
        with pytest.raises(isola_hbm.FolderInUse, match="run: a file, where the folder of the run is to be"):
            isola_hbm.sweep(Model([[1]], [[1]]), [1], out=out, progress=False)


@pytest.mark.needs_program
def test_a_folder_of_somebody_else(tmp_path: Path) -> None:
    """Nothing of it is written over; what an earlier attempt wrote is."""
    model, settings = Model([[1]], [[1]], laws=[CUBIC]), {"search": "none", "harmonics": {"count": 3}}
    for name, said in (("thesis.tex", "holds thesis.tex, and no run"), ("study.toml", "a study already")):
        out = tmp_path / name
        out.mkdir()
        (out / name).write_text("mine")
        with pytest.raises(isola_hbm.FolderInUse, match=said):
            isola_hbm.sweep(model, [0.01], out=out, workers=1, progress=False, **settings)
        assert [entry.name for entry in out.iterdir()] == [name] and (out / name).read_text() == "mine"
    attempt = tmp_path / "attempt"
    attempt.mkdir()
    with pytest.raises(isola_hbm.StudyRefused):
        isola_hbm.sweep(model, [0.01], out=attempt, workers=1, progress=False, frequency={"min": 2, "max": 1})
    assert (attempt / "study.toml").exists()
    assert len(isola_hbm.sweep(model, [0.01], out=attempt, workers=1, progress=False, **settings)) == 1


@pytest.mark.needs_program
def test_doubts_are_a_warning(tmp_path: Path) -> None:
    model = Model.load(MODELS / "duffing")
    settings = {"search": "none", "branch": {"max_points": 10}, "harmonics": {"count": 3}}
    # Whoever asked is who is warned.
    with pytest.warns(isola_hbm.Incomplete, match="main branch") as seen:
        run = isola_hbm.sweep(model, [0.05], out=tmp_path / "run", workers=1, progress=False, **settings)
    assert len(run) >= 1 and {warning.filename for warning in seen} == {__file__}
    assert "Not known to its end: the main branch at A = 0.05" in " ".join(run.status().split())
    with pytest.warns(isola_hbm.Incomplete, match="main branch") as seen:
        run = isola_hbm.extend(run, [0.06], workers=1, progress=False)
    assert "0.06/main" in run and {warning.filename for warning in seen} == {__file__}


def test_without_the_program(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("ISOLA_BIN", str(tmp_path / "isola"))
    with pytest.raises(isola_hbm.NoProgram, match="ISOLA_BIN names `.*`, which is no program; install the"):
        isola_hbm.sweep(Model([[1]], [[1]]), [1], out=tmp_path / "run")
    monkeypatch.delenv("ISOLA_BIN")
    monkeypatch.setenv("PATH", str(tmp_path))
    scripts = tmp_path / "bin"
    monkeypatch.setattr("sysconfig.get_path", lambda name: str(scripts))
    with pytest.raises(isola_hbm.NoProgram, match="the program `isola` is not on the PATH"):
        isola_hbm.sweep(Model([[1]], [[1]]), [1], out=tmp_path / "run")
    assert not (tmp_path / "run").exists()
    # The program of the wheel is found without the path.
    scripts.mkdir()
    (scripts / "isola").touch(mode=0o755)
    assert of_program.find() == str(scripts / "isola")


@pytest.mark.needs_program
@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_an_interrupt_ends_the_sweep_and_keeps_the_run(tmp_path: Path) -> None:
    told = []

    def interrupt(line: str) -> None:
        told.append(line)
        if line.startswith("running: "):
            raise KeyboardInterrupt

    threads, handler = threading.active_count(), signal.getsignal(signal.SIGINT)
    with pytest.raises(KeyboardInterrupt) as raised:
        isola_hbm.sweep(
            MODELS / "nonlinear_damper",
            "0.004:0.012:0.0001",
            out=tmp_path / "run",
            workers=1,
            progress=interrupt,
        )
    assert told[-1].startswith("interrupted: isola_hbm.resume(")
    assert sys.version_info < (3, 11) or raised.value.__notes__ == [told[-1].strip()]
    run = isola_hbm.load(tmp_path / "run")
    assert run.stage == "sweep"
    assert any("still to be done" in sentence for sentence in run.check())
    assert threading.active_count() == threads
    assert signal.getsignal(signal.SIGINT) is handler


@pytest.mark.needs_program
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_what_vibrates_by_itself_is_called_that_first(tmp_path: Path) -> None:
    damper = Law("polynomial_damper", dof="x1", terms=[{"power": 3, "coefficient": 0.1}])
    model = Model([[1]], [[1]], C=[[-0.1]], laws=[damper])
    settings = {"search": "none", "verify": "none", "harmonics": {"count": 3}, "workers": 1}
    run = isola_hbm.sweep(model, [0.1], out=tmp_path / "run", progress=False, **settings)  # type: ignore[arg-type]
    first = run.status().splitlines()[1]
    assert first.startswith("Mode 1 has negative linear damping: the structure can vibrate by itself, from"), first


@pytest.mark.needs_program
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_a_run_has_the_damping_that_it_was_computed_with(tmp_path: Path) -> None:
    mass, stiffness = np.diag([1.0, 2.0]), np.array([[3.0, -1.0], [-1.0, 2.0]])
    own = 0.02 * stiffness + np.diag([0.01, 0.0])
    model = Model(mass, stiffness, C=own, laws=[CUBIC])
    settings = {"search": "none", "verify": "none", "harmonics": {"count": 3}, "workers": 1, "progress": False}
    run = isola_hbm.sweep(model, [0.01], out=tmp_path / "own", **settings)  # type: ignore[arg-type]
    np.testing.assert_allclose(run.model.C, own, atol=1e-12)
    ratio = {"damping.default_ratio": 0.01}
    run = isola_hbm.sweep(model, [0.01], out=tmp_path / "ratio", **settings, **ratio)  # type: ignore[arg-type]
    # The study gives another one: 2 D ω for each mode.
    damped = run.shapes.values.T @ run.model.C @ run.shapes.values
    np.testing.assert_allclose(damped, np.diag(0.02 * run.model.frequencies), atol=1e-12)


@pytest.mark.needs_program
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_a_run_is_carried_on(tmp_path: Path) -> None:
    def interrupt(line: str) -> None:
        if line.startswith("running: "):
            raise KeyboardInterrupt

    model, folder = Model([[1]], [[1]], laws=[CUBIC], name="mine"), tmp_path / "run"
    settings = {"search": "none", "verify": "none", "harmonics": {"count": 3}, "workers": 1}
    with pytest.raises(KeyboardInterrupt):
        isola_hbm.sweep(model, [0.01, 0.02], out=folder, progress=interrupt, **settings)  # type: ignore[arg-type]
    assert isola_hbm.load(folder).stage == "sweep"
    run = isola_hbm.resume(folder, workers=1, progress=False)
    assert run.stage == "finished" and set(run) == {"0.01/main", "0.02/main"}
    before = run["0.02/main"].load()

    # Those that it has are passed over; what was computed stays as it is.
    longer = isola_hbm.extend(run, [0.02, 0.015], workers=1, progress=False)
    assert set(longer) == {"0.01/main", "0.015/main", "0.02/main"} and longer.folder == run.folder
    assert "0.015" in longer.study and longer.stage == "finished"
    assert np.array_equal(longer["0.02/main"]["omega"], before["omega"])
    assert set(isola_hbm.resume(longer, progress=False)) == set(longer)

    # A study that has changed since is not gone on with unless it is asked for.
    (folder / "study.toml").write_text((folder / "study.toml").read_text() + "[branch]\nmax_points = 500\n")
    with pytest.raises(isola_hbm.StudyRefused, match="give as_started=True"):
        isola_hbm.extend(run, [0.012], workers=1, progress=False)
    assert "0.012/main" in isola_hbm.extend(run, [0.012], workers=1, as_started=True, progress=False)

    with pytest.raises(isola_hbm.StudyRefused, match=r"^amplitudes = 0\.02: the run has all of these levels"):
        isola_hbm.extend(run, 0.02)
    with pytest.raises(isola_hbm.BadStudy, match="workers = -1: a number of processes"):
        isola_hbm.resume(run, workers=-1)
    with pytest.raises(isola_hbm.NoSuchRun, match="nowhere"):
        isola_hbm.resume(tmp_path / "nowhere")
    with pytest.raises(isola_hbm.FolderInUse, match=r"isola_hbm\.resume\('.*run'\) goes on"):
        isola_hbm.sweep(model, [0.01], out=folder)


@pytest.mark.needs_program
def test_the_page_of_a_run(damper: Path, tmp_path: Path) -> None:
    page = isola_hbm.load(damper).explore()
    html = page.save(tmp_path / "page.html").read_text()
    assert html == page.html
    assert html.lower().startswith("<!doctype html>")
    frame = page._repr_html_()
    assert frame.startswith('<iframe srcdoc="')
    assert frame.count('"') == 4


def test_levels_are_named_without_what_rounding_adds() -> None:
    from isola_hbm.asked import levels_of
    from isola_hbm.study import typed

    assert typed([0.1 + 0.2, 1e-4 * 1.25, 20, "5:10:5", 1 / 3]) == "0.3,0.000125,20,5:10:5,0.333333333333333"
    # What was given finds the level again.
    assert levels_of([0.1 + 0.2], [0.3, 0.4]) == {0.3}


def test_other_keywords_are_refused_with_those_there_are() -> None:
    with pytest.raises(TypeError, match=r"^Model: no argument `law`; did you mean `laws`\? there are M, K, C, damping, laws,"):
        Model(M=[[1]], K=[[1]], law=[])  # type: ignore[call-arg]
    with pytest.raises(TypeError, match=r"^Model: no argument `foo`; there are M, K, C, damping, laws, contacts, "):
        Model(M=[[1]], K=[[1]], foo=1)  # type: ignore[call-arg]
    with pytest.raises(TypeError, match=r"^Model: missing a required argument: 'K'; there are M, K, "):
        Model(M=[[1]])  # type: ignore[call-arg]


def test_values_in_toml() -> None:
    assert of_toml.literal({"a": [1, 2.5, True], "b c": "x"}) == '{ a = [1, 2.5, true], "b c" = "x" }'
    assert of_toml.literal(np.arange(3)) == "[0, 1, 2]"
    assert of_toml.literal(np.float64(0.1)) == "0.1"
    assert dict(of_toml.dotted({"a": {"b": {"c": 1}}, "d.e": "f"})) == {"a.b.c": "1", "d.e": '"f"'}
    with pytest.raises(TypeError, match=r"None \(NoneType\) has no form in TOML"):
        of_toml.literal(None)


@pytest.mark.needs_program
def test_what_is_doubtful_is_warned_of(tmp_path: Path) -> None:
    settings = {"search": "none", "harmonics": {"count": 1}, "workers": 1, "progress": False}
    with pytest.warns(isola_hbm.Doubtful, match="^the damping is not given: 1 % of critical in every mode"):
        isola_hbm.sweep(Model([[1]], [[1]], laws=[CUBIC]), [0.01], out=tmp_path / "run", **settings)  # type: ignore[arg-type]


def test_progress_is_one_line_of_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    monkeypatch.setenv("COLUMNS", "30")
    monkeypatch.setattr(sys, "stderr", terminal := Terminal())
    show = shown(True)
    show("sweep: no level has tasks right now, 300 tasks done")
    show("finished\n")
    assert terminal.getvalue() == "\rsweep: no level has tasks rig\rfinished" + 21 * " " + "\n"
    monkeypatch.setattr(sys, "stderr", file := io.StringIO())
    shown(False)("running")
    assert file.getvalue() == ""
    # Nobody asked, and there is no terminal: now and then, and the last one.
    show = shown(None)
    for line in ("run f1 in runs/x", "computing", "running: 1", "running: 2", "note: a level has no task", "finished\n"):
        show(line)
    assert file.getvalue() == "run f1 in runs/x\ncomputing\nrunning: 1\nnote: a level has no task\nfinished\n"
    file.seek(file.truncate(0))
    # Asked for, a file has what the program says, line by line.
    shown(True)("sweep: no level has tasks right now, 300 tasks done")
    shown(True)("finished\n")
    assert file.getvalue() == "sweep: no level has tasks right now, 300 tasks done\nfinished\n"


@pytest.mark.needs_program
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_a_sweep_says_what_it_found_where_there_is_no_terminal(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model = Model([[1]], [[1]], laws=[CUBIC], name="mine")
    settings = {"search": "none", "verify": "none", "harmonics": {"count": 3}, "workers": 1}
    for progress in (None, False):
        run = isola_hbm.sweep(model, [0.01], out=tmp_path / f"run {progress}", progress=progress, **settings)  # type: ignore[arg-type]
        out, said = capsys.readouterr()
        assert out == ""
        if progress is False:
            assert said == ""
            continue
        assert said.startswith("run ") or "\nrun " in said
        assert "finished: 1 branch in " in said
        # What the terminal has at the end, and how to see it again.
        assert said.endswith(f"{run.status()}\n") and "main peak" in said
    assert repr(run).startswith("<StoredRun mine, finished: 1 level, 1 branch (0 isolas), in ")
