"""Models made in Python: matrices from NumPy or SciPy, with contacts and laws; written as a folder that the program reads."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

from . import study, toml
from .asked import checked
from .counted import count
from .errors import BadModel, FolderInUse
from .laws import guess
from .live.wire import Floats
from .matrices import forces, matrix_market, require_definite, symmetric

#: What stands in a model file.
_KEYS = {"name", "description", "dofs", "monitors", "matrices", "damping", "forcing", "contact", "laws"}

#: What sections may hold.
_EXAMPLES = {
    "damping": '{"default_ratio": 0.01}',
    "contact": '{"gap": 1e-3}',
    "forcing": '{"shape": {"dofs": {"x1": 1}}}',
}


class Model:
    """A structure: M ẍ + C ẋ + K x + f(x, ẋ) = A s cos(ωt), SI units.

    >>> from isola_hbm import Law, Model
    >>> duffing = Model(M=[[1]], K=[[1]], laws=[Law("polynomial_spring", dof="x1", terms=[{"power": 3, "coefficient": 1}])])
    >>> duffing.size
    1

    Args:
        M: Mass matrix [n, n], kg; NumPy or SciPy sparse, symmetric and positive definite.
        K: Stiffness matrix [n, n], N/m, symmetric.
        C: Damping matrix [n, n], N·s/m, symmetric; or
        damping: modal or Rayleigh damping, as the section `damping` of a model file: ``{"default_ratio": 1e-3}`` (without
            both 0.01 for every mode), ``{"rayleigh": {"mass": 0.1, "stiffness": 1e-6}}``.
        laws: Nonlinear elements, :class:`Law`.
        contacts: Contact nodes, :class:`Contact`.
        contact: What all of them share: `gap` (m), `epsilon` (N/m), `friction`, `sense`.
        forcing: Forces on the dofs [n], N per unit of A; or as the section `forcing` of a model file:
            ``{"shape": {"mode": 1}}`` (the default), ``{"shape": {"dofs": {"x1": 1.0}}, "harmonic": 2}``.
        dofs: n names; by default x1 … xn.
        monitors: Dofs whose amplitude is reported; by default the first one.
        name: Shown to people.
        description: For whoever reads the file.

    Raises:
        BadModel: Matrices that are not square, of different sizes, not finite, not symmetric or, the mass, not positive
            definite; names that do not fit.
    """

    @checked
    def __init__(
        self,
        M: Any,
        K: Any,
        *,
        C: Any = None,
        damping: Mapping[str, Any] | None = None,
        laws: Iterable[Mapping[str, Any]] = (),
        contacts: Iterable[Mapping[str, Any]] = (),
        contact: Mapping[str, float] | None = None,
        forcing: Mapping[str, Any] | Sequence[float] | Floats | None = None,
        dofs: Sequence[str] | None = None,
        monitors: Sequence[str] | None = None,
        name: str = "model",
        description: str = "",
    ) -> None:
        """Of matrices `M`, `K` and `C` (or `damping`), with `laws` and `contacts`, forced as `forcing` says: ``help(Model)`` says more."""
        #: Mass [n, n], kg.
        self.M = symmetric("M", M)
        n = len(self.M)
        #: Stiffness [n, n], N/m.
        self.K = symmetric("K", K, n)
        #: Damping [n, n], N·s/m; None if it is given in another way.
        self.C = None if C is None else symmetric("C", C, n)
        require_definite(self.M)
        if self.C is not None and damping is not None:
            raise BadModel("C and damping are two ways to give the damping; give one of them")
        #: Names of the dofs.
        self.dofs = [f"x{i}" for i in range(1, n + 1)] if dofs is None else _names("dofs", dofs)
        if len(self.dofs) != n or len(set(self.dofs)) != n:
            again = next((name for k, name in enumerate(self.dofs) if name in self.dofs[:k]), None)
            twice = "" if again is None else f", `{again}` more than once"
            given, rows = count(len(self.dofs), "name"), count(n, "row")
            raise BadModel(f"dofs: {given}{twice}; M has {rows}: give each dof a name of its own")
        #: Name shown to people.
        self.name = _text("name", name)
        #: For whoever reads the file.
        self.description = _text("description", description)
        #: Sections of the model file, as given.
        self.sections: dict[str, Any] = {
            "damping": _section("damping", {} if damping is None else damping),
            "forcing": {} if forcing is None else self._forcing(forcing),
            "contact": {
                **_section("contact", {} if contact is None else contact),
                "nodes": _elements("contacts", contacts, "Contact"),
            },
            "laws": _elements("laws", laws, "Law"),
            "monitors": None
            if monitors is None
            else [self._known("monitors", dof) for dof in _names("monitors", monitors)],
        }
        for i, law in enumerate(self.sections["laws"]):
            for dof in _dofs_of_law(f"laws[{i}]", law):
                self._known(f"laws[{i}]", dof)
        for i, node in enumerate(self.sections["contact"]["nodes"]):
            sliding = node.get("tangential", [])
            if isinstance(sliding, (str, Mapping)) or not isinstance(sliding, Iterable):
                raise BadModel(
                    f"contacts[{i}]: tangential = {sliding!r}: a list of one or two directions is needed"
                )
            # That a normal is missing is the program's to say.
            for direction in filter(None, [node.get("normal"), *sliding]):
                for dof in direction if isinstance(direction, Mapping) else [direction]:
                    self._known(f"contacts[{i}]", dof)

    @classmethod
    def load(cls, folder: str | os.PathLike[str]) -> Model:
        """Reads the folder of a model: ``model.toml`` and its matrices. Needs SciPy for files in Matrix Market format.

        Raises:
            BadModel: There is no model, or one that makes no sense.
        """
        path = Path(folder)
        try:
            content = tomllib.loads((path / "model.toml").read_text(encoding="utf-8"))
        except FileNotFoundError:
            raise BadModel(
                f"{path / 'model.toml'}: there is no such file; name the folder of a model"
            ) from None
        except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
            raise BadModel(f"{path / 'model.toml'}: {error}") from None
        # What is not known here would be lost when the model is saved.
        if unknown := sorted(content.keys() - _KEYS):
            raise BadModel(
                f"{path / 'model.toml'}: there is no `{unknown[0]}`; known here: {', '.join(sorted(_KEYS))}"
            )
        matrices, contact = (_section(key, content.get(key, {})) for key in ("matrices", "contact"))
        files = {"mass": "M.mtx", "stiffness": "K.mtx", **matrices}
        mass, stiffness, damping = (_read(path, files.get(key)) for key in ("mass", "stiffness", "damping"))
        nodes = contact.pop("nodes", [])
        others = {key: content[key] for key in _KEYS - {"name", "matrices", "contact"} if key in content}
        name = content.get("name", path.absolute().name)
        return cls(mass, stiffness, C=damping, contact=contact, contacts=nodes, name=name, **others)

    @property
    def size(self) -> int:
        """Number of dofs n."""
        return len(self.M)

    def __repr__(self) -> str:
        nodes, laws = len(self.sections["contact"]["nodes"]), len(self.sections["laws"])
        return f"<Model {self.name}: {count(self.size, 'dof')}, {count(nodes, 'contact node')}, {count(laws, 'law')}>"

    def save(self, folder: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
        """Writes the model as a folder: ``model.toml`` and its matrices in Matrix Market format, bit for bit. Returns it.

        Raises:
            FolderInUse: There is a model in this folder, and `overwrite` is not set.
        """
        path = Path(folder)
        file = path / "model.toml"
        if file.exists() and not overwrite:
            raise FolderInUse(f"{file}: there is a model in this folder; overwrite=True replaces it")
        path.mkdir(parents=True, exist_ok=True)
        matrices = {"mass": ("M.mtx", self.M), "stiffness": ("K.mtx", self.K), "damping": ("C.mtx", self.C)}
        given = {key: (name, matrix) for key, (name, matrix) in matrices.items() if matrix is not None}
        for name, matrix in given.values():
            (path / name).write_text(matrix_market(matrix), encoding="ascii")
        file.write_text(self._toml({key: name for key, (name, _) in given.items()}), encoding="utf-8")
        return path

    def check(self, amplitudes: study.Amplitudes | None = None, **settings: Any) -> str:
        """What the program says of the model, as ``isola check``: size, modes, forcing, contact, monitored dofs, and the
        amplitudes, if they are given. Computes no response.

        >>> from isola_hbm import Model
        >>> print(Model(M=[[1]], K=[[1]]).check())

        Args:
            amplitudes: Forcing amplitudes A, as of :func:`sweep`.
            settings: Keys of a study, as those of :func:`sweep`.

        Raises:
            BadStudy: Amplitudes or settings are not what can be given to the program at all.
            NoProgram: The program is not there.
            ProgramFailed: It refuses the model: with its own message.
        """
        with tempfile.TemporaryDirectory() as scratch:
            self.save(Path(scratch) / study.MODEL)
            return study.check(Path(scratch), amplitudes, settings)

    def _toml(self, matrices: dict[str, str]) -> str:
        """The text of ``model.toml``."""
        sections = dict(self.sections)
        nodes = sections["contact"].get("nodes")
        head: dict[str, Any] = {"name": self.name, "description": self.description or None}
        head |= {"dofs": self.dofs, "monitors": sections["monitors"]}
        lines = [f"{key} = {toml.literal(value)}" for key, value in head.items() if value is not None]
        contact = {key: value for key, value in sections["contact"].items() if key != "nodes"}
        named = {
            "matrices": matrices,
            "damping": sections["damping"],
            "forcing": sections["forcing"],
            "contact": contact,
        }
        for section, entries in named.items():
            if entries:
                lines += ["", f"[{section}]", *_entries(entries)]
        for section, elements in {"contact.nodes": nodes, "laws": sections["laws"]}.items():
            for element in elements:
                lines += ["", f"[[{section}]]", *_entries(element)]
        return "\n".join(lines) + "\n"

    def _forcing(self, given: Mapping[str, Any] | Sequence[float] | Floats) -> dict[str, Any]:
        """The section of the forcing."""
        if isinstance(given, Mapping):
            section = _section("forcing", given)
            for key in section:
                if key not in ("shape", "harmonic"):
                    example = f'{{"shape": {{"dofs": {{"{key}": 1}}}}}}' if key in self.dofs else _EXAMPLES["forcing"]
                    raise BadModel(f"forcing: no key `{key}`; there are shape, harmonic; as {example}")
            shape = section.get("shape")
            driven = shape.get("dofs") if isinstance(shape, Mapping) else None
            for dof in driven if isinstance(driven, Mapping) else ():
                self._known("forcing", dof)
            return section
        on_dofs = forces("forcing", given, self.size)
        if not on_dofs.any():
            raise BadModel("forcing: all forces are zero; at least one dof must be driven")
        return {
            "shape": {"dofs": {dof: force for dof, force in zip(self.dofs, on_dofs.tolist()) if force != 0.0}}
        }

    def _known(self, where: str, dof: Any) -> str:
        if dof not in self.dofs:
            meant = guess(dof, self.dofs)
            known = ", ".join(self.dofs[:12]) + (", …" if self.size > 12 else "")
            raise BadModel(f"{where}: no dof `{dof}`; {meant}there are {known}")
        return str(dof)


def _names(what: str, given: Any) -> list[str]:
    """A list of names: a text would be one of letters."""
    if isinstance(given, str) or not isinstance(given, Iterable):
        raise BadModel(f"{what} = {given!r}: a list of names of dofs is needed")
    return [str(name) for name in given]


def _text(what: str, given: Any) -> str:
    if not isinstance(given, str):
        raise BadModel(f"{what} = {given!r}: a text is needed")
    return given


def _section(what: str, given: Any) -> dict[str, Any]:
    """A section of the model file."""
    if not isinstance(given, Mapping):
        example = _EXAMPLES.get(what)
        raise BadModel(f"{what} = {given!r}: a dict of its keys is needed{f', as {example}' if example else ''}")
    _require_toml(what, given)
    return dict(given)


def _elements(what: str, given: Any, kind: str) -> list[dict[str, Any]]:
    """A list of elements: a single one would be a list of its keys."""
    if isinstance(given, (str, Mapping)) or not isinstance(given, Iterable):
        raise BadModel(f"{what}: a list is needed, as {what}=[{kind}(…)]")
    elements = list(given)
    for i, element in enumerate(elements):
        if not isinstance(element, Mapping):
            raise BadModel(f"{what}[{i}] = {element!r}: a {kind} is needed")
        _require_toml(f"{what}[{i}]", element)
    return [dict(element) for element in elements]


def _require_toml(what: str, given: Mapping[str, Any]) -> None:
    """Raises unless it can be written to a model file."""
    for key, value in given.items():
        try:
            toml.key(key)
            toml.literal(value)
        except toml.NoName as error:
            raise BadModel(f"{what}: {error}") from None
        except TypeError as error:
            raise BadModel(
                f"{what}: {key} = {error}; numbers, texts, lists and dicts can be written"
            ) from None


def _read(folder: Path, matrix: Any) -> Any:
    """A matrix as a model file gives it: rows, or the name of a file."""
    if not isinstance(matrix, str):
        return matrix
    try:
        from scipy.io import mmread
    except ImportError as error:
        raise ImportError("matrices in files need SciPy: pip install 'isola-hbm[model]'") from error
    try:
        return mmread(folder / matrix, spmatrix=False)
    except (OSError, ValueError) as error:
        raise BadModel(f"{folder / matrix}: {error}") from None


def _dofs_of_law(where: str, law: Mapping[str, Any]) -> list[Any]:
    one = [law["dof"]] if "dof" in law else []
    between, coefficients = law.get("between", ()), law.get("coefficients", {})
    is_list = isinstance(between, Iterable) and not isinstance(between, str)
    ends = list(between) if is_list else []
    if not is_list or ("between" in law and len(ends) != 2):
        raise BadModel(f"{where}: between = {between!r}: two dofs are needed")
    if not isinstance(coefficients, Mapping):
        raise BadModel(f"{where}: coefficients = {coefficients!r}: dofs with factors are needed")
    return [*one, *ends, *coefficients]


def _entries(section: Mapping[str, Any]) -> list[str]:
    return [f"{toml.key(key)} = {toml.literal(value)}" for key, value in section.items()]
