"""Nonlinear elements of models: laws and contact nodes, checked when they are made."""

from __future__ import annotations

import difflib
import math
import numbers
from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any

from .errors import BadModel

#: Parameters of laws by kind, all of them needed: whether one has to be above zero.
_PARAMETERS: dict[str, dict[str, bool]] = {
    "penalty_spring": {"stiffness": True, "gap": False},
    "tanh_friction": {"limit": True, "velocity": True},
    "jenkins": {"stiffness": True, "limit": True},
}

#: Laws whose one parameter is a list of terms.
_POLYNOMIALS = ("polynomial_spring", "polynomial_damper")

#: What a term of a polynomial has.
_TERM = ("power", "coefficient")

#: Largest power of a term.
_MOST = 15


#: Words in what people call laws, and the law that is meant, in the order in which the program searches a name for them.
_CALLED = (
    (("damp", "viscous"), "polynomial_damper"),
    (("jenkin", "iwan", "masing", "hyster", "slider"), "jenkins"),
    (("friction", "coulomb", "tanh", "slip"), "tanh_friction"),
    (("stop", "gap", "impact", "unilateral", "bilinear", "penalty", "contact"), "penalty_spring"),
    (("cubic", "quadratic", "quintic", "duffing", "poly", "spring", "stiffness"), "polynomial_spring"),
)


class Law(dict[str, Any]):
    """A nonlinear element, as under ``[[laws]]`` of a model file.

    >>> from isola_hbm import Law
    >>> Law("polynomial_spring", dof="x1", terms=[{"power": 3, "coefficient": 1.0}])["dof"]
    'x1'

    Args:
        kind: ``penalty_spring`` (`stiffness` N/m, `gap` m), ``polynomial_spring`` and ``polynomial_damper`` (`terms`:
            `power`, `coefficient` N/m^power, N/(m/s)^power), ``tanh_friction`` (`limit` N, `velocity` m/s), ``jenkins``
            (`stiffness` N/m, `limit` N).
        dof: Name of the dof that it acts on, against the ground; or
        between: names of two dofs, the law acting on the first minus the second; or
        coefficients: dofs with factors, the law acting on the sum.
        name: Name shown to people.
        parameters: Those of the law.

    Raises:
        BadModel: There is no such law, a parameter is missing, unknown or out of its range, or it does not say where it acts, more
            than once or by what are no names of dofs.
    """

    def __init__(
        self,
        kind: str,
        *,
        dof: str | None = None,
        between: Sequence[str] | None = None,
        coefficients: Mapping[str, float] | None = None,
        name: str | None = None,
        **parameters: Any,
    ) -> None:
        """Of a `kind` with its `parameters`, acting on one of `dof` (against the ground), `between` two dofs and `coefficients` (a
        sum): ``help(Law)`` says more."""
        _require_law(kind)
        where = {"name": name, "dof": dof, "between": between, "coefficients": coefficients}
        given = {key: value for key, value in where.items() if value is not None}
        if len(given.keys() - {"name"}) != 1:
            raise BadModel(f"law `{kind}`: say where it acts by one of dof, between and coefficients")
        _require_place(f"law `{kind}`", given)
        if kind in _POLYNOMIALS:
            _require_all(f"law `{kind}`", parameters, ("terms",))
            parameters["terms"] = _terms(kind, parameters["terms"])
        else:
            _require_all(f"law `{kind}`", parameters, _PARAMETERS[kind])
            for key, is_positive in _PARAMETERS[kind].items():
                _require_number(f"law `{kind}`: {key}", parameters[key], is_positive)
        super().__init__({**given, "law": {kind: parameters}})


class Contact(dict[str, Any]):
    """A contact node, as under ``[[contact.nodes]]`` of a model file.

    Args:
        normal: Dof that closes the gap; or dofs with factors, ``{"x1": 1, "x2": -1}`` between two bodies.
        tangential: One or two sliding directions, the first one along the rotation; needed with friction.
        radius: Radius of the node, m; needed with friction.
        name: Name shown to people.
        settings: What differs from the model's: `gap` (m), `epsilon` (N/m), `friction`, `sense`.
    """

    def __init__(
        self,
        normal: str | Mapping[str, float],
        *,
        tangential: Sequence[str | Mapping[str, float]] = (),
        radius: float | None = None,
        name: str | None = None,
        **settings: float,
    ) -> None:
        """At a `normal` dof, with friction along `tangential` ones at a `radius`: ``help(Contact)`` says more."""
        given = {
            "name": name,
            "normal": normal,
            "tangential": list(tangential) or None,
            "radius": radius,
            **settings,
        }
        super().__init__({key: value for key, value in given.items() if value is not None})


def guess(given: Any, known: Iterable[str]) -> str:
    """What may have been meant."""
    nearest = difflib.get_close_matches(str(given), list(known), 1)
    return f"did you mean `{nearest[0]}`? " if nearest else ""


def _require_known(what: str, given: Any, known: Collection[str]) -> None:
    if given not in known:
        raise BadModel(f"there is no {what} `{given}`; {guess(given, known)}known: {', '.join(sorted(known))}")


def _require_law(kind: Any) -> None:
    """Refuses laws that there are not, with all that there are: the one first that is probably meant."""
    known = sorted((*_PARAMETERS, *_POLYNOMIALS))
    if kind in known:
        return
    name = str(kind).lower()
    meant = next((law for words, law in _CALLED if any(word in name for word in words)), None)
    nearest = [meant] if meant else difflib.get_close_matches(name, known, 1)
    hint = f"did you mean `{nearest[0]}`? " if nearest else ""
    ordered = [*nearest, *(law for law in known if law not in nearest)]
    raise BadModel(f"there is no law `{kind}`; {hint}known: {', '.join(ordered)}")


def _require_all(what: str, given: Mapping[str, Any], needed: Collection[str]) -> None:
    """Refuses parameters that are unknown, and missing ones."""
    for key in given:
        _require_known(f"parameter of {what}", key, needed)
    if missing := [key for key in needed if key not in given]:
        raise BadModel(f"{what}: {' and '.join(missing)} missing; it needs {' and '.join(needed)}")


def _require_number(what: str, given: Any, is_positive: bool = False) -> None:
    if not isinstance(given, numbers.Real) or isinstance(given, bool) or not math.isfinite(given):
        raise BadModel(f"{what} = {given!r}: a finite number is needed")
    if is_positive and given <= 0:
        raise BadModel(f"{what} = {given!r}: a number above zero is needed")


def _require_place(what: str, given: Mapping[str, Any]) -> None:
    """Refuses places that are none: whether there are such dofs is known to a model alone."""
    if "dof" in given:
        _require_name(f"{what}: dof", given["dof"])
    if "between" in given:
        names = given["between"]
        is_list = not isinstance(names, (str, Mapping)) and isinstance(names, Iterable)
        if not is_list or len(list(names)) != 2:
            raise BadModel(f'{what}: between = {names!r}: two dofs are needed, as ["x1", "x2"]')
        for name in names:
            _require_name(f"{what}: between", name)
        if names[0] == names[1]:
            raise BadModel(f"{what}: between = {names!r}: two different dofs are needed")
    if "coefficients" in given:
        factors = given["coefficients"]
        if not isinstance(factors, Mapping) or not factors:
            raise BadModel(f'{what}: coefficients = {factors!r}: dofs with factors are needed, as {{"x1": 1, "x2": -1}}')
        for name, factor in factors.items():
            _require_name(f"{what}: coefficients", name)
            _require_number(f"{what}: coefficients[{name!r}]", factor)
            if factor == 0:
                raise BadModel(f"{what}: coefficients[{name!r}] = 0: the law does not act there; leave the dof out")


def _require_name(what: str, given: Any) -> None:
    if not isinstance(given, str):
        raise BadModel(f"{what}: {given!r} ({type(given).__name__}) is no name of a dof; a text is needed")


def _terms(kind: str, given: Any) -> list[dict[str, Any]]:
    """Terms of a polynomial."""
    example = '[{"power": 3, "coefficient": 1.0}]'
    if isinstance(given, (str, Mapping)) or not isinstance(given, Iterable):
        raise BadModel(f"law `{kind}`: terms = {given!r}: a list is needed, as {example}")
    terms = list(given)
    if not terms:
        raise BadModel(f"law `{kind}`: terms is empty; at least one is needed, as {example}")
    for i, term in enumerate(terms):
        what = f"law `{kind}`: terms[{i}]"
        if not isinstance(term, Mapping):
            raise BadModel(f"{what} = {term!r}: a power with its coefficient is needed, as {example[1:-1]}")
        for key in term:
            _require_known(f"key of a term of law `{kind}`", key, _TERM)
        _require_all(what, term, _TERM)
        power = term["power"]
        if not isinstance(power, numbers.Integral) or isinstance(power, bool) or not 1 <= int(power) <= _MOST:
            raise BadModel(f"{what}.power = {power!r}: a whole number from 1 to {_MOST} is needed")
        _require_number(f"{what}.coefficient", term["coefficient"])
    return [dict(term) for term in terms]
