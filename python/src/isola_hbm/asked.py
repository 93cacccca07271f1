"""What is asked of figures: arguments that are wrong, told with what would be right."""

from __future__ import annotations

import difflib
import functools
import inspect
from bisect import bisect_left
from collections.abc import Callable, Iterable, Sequence
from decimal import Decimal, InvalidOperation
from typing import TYPE_CHECKING, Any, ParamSpec, TypeAlias, TypeVar

import numpy as np

from .counted import is_same

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Forcing levels: a list of numbers, or a text as after ``isola plot --levels``: ``"20,60"`` or ``"20:60:20"``.
Levels: TypeAlias = "Iterable[str | float] | str | float"
#: Lowest and highest value of an axis.
Limits: TypeAlias = tuple[float, float]

#: So many levels are all named.
_ALL_NAMED = 12
#: A range has no more levels.
_MOST = 100_000

_Arguments = ParamSpec("_Arguments")
_Result = TypeVar("_Result")


def checked(method: Callable[_Arguments, _Result]) -> Callable[_Arguments, _Result]:
    """A method that says which arguments it has where it is given others."""
    signature = inspect.signature(method)
    known = [name for name in signature.parameters if name != "self"]
    # A class is called, not what it is made by.
    called = method.__qualname__.split(".")[-2] if method.__name__ == "__init__" else method.__name__

    @functools.wraps(method)
    def call(*args: _Arguments.args, **kwargs: _Arguments.kwargs) -> _Result:
        try:
            signature.bind(*args, **kwargs)
        except TypeError as error:
            unknown = [name for name in kwargs if name not in known]
            near = difflib.get_close_matches(unknown[0], known, 1) if unknown else []
            meant = f"; did you mean `{near[0]}`?" if near else ";"
            what = f"no argument `{unknown[0]}`{meant}" if unknown else f"{error};"
            raise TypeError(f"{called}: {what} there are {', '.join(known)}") from None
        return method(*args, **kwargs)

    return call


def is_axes(ax: object) -> Axes | None:
    """The axes to draw on that were given, if any were.

    Raises:
        TypeError: They are none.
    """
    if ax is None or (hasattr(ax, "add_artist") and hasattr(ax, "get_xlim")):
        return ax  # type: ignore[return-value]
    raise TypeError(f"ax = {_short(ax)}: axes of matplotlib are needed, one, as of plt.subplots()[1]")


def is_flag(name: str, value: object) -> bool:
    """Whether something is wanted.

    Raises:
        TypeError: That is not said.
    """
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    raise TypeError(f"{name} = {_short(value)}: True or False is needed")


def limits_of(name: str, limits: object, is_positive: bool = False) -> Limits | None:
    """The limits of an axis that were asked for.

    Raises:
        ValueError: They are no range, or one of an axis that is logarithmic and not above zero.
    """
    if limits is None:
        return None
    ends: Any = () if isinstance(limits, str) else limits
    try:
        low, high = (float(end) for end in ends)
    except (TypeError, ValueError):
        low = high = np.nan
    if not (np.isfinite([low, high]).all() and low < high and (low > 0.0 or not is_positive)):
        above = ", both above zero" if is_positive else ""
        raise ValueError(
            f"{name} = {_short(limits)}: the lowest and the highest one shown{above}, in the unit of the axis, "
            "as in (2400.0, 2500.0)"
        )
    return low, high


def levels_of(levels: Levels, there: Sequence[float]) -> set[float]:
    """The forcing levels that were asked for, which are among those of which there are branches, ascending.

    Raises:
        ValueError: They are no numbers, or there is no branch at one of them: with those there are.
    """
    given = [levels] if isinstance(levels, str) or not isinstance(levels, Iterable) else list(levels)
    try:
        asked = [_level(value, there) for one in given for value in _values(one)]
    except (TypeError, ValueError, InvalidOperation):
        what = given[0] if len(given) == 1 else given
        raise ValueError(
            f"levels = {_short(what)}: give numbers, as [20, 60], or a text, as '20,60' or '20:60:20'; "
            f"there are branches at A = {instead([], there)}"
        ) from None
    if unknown := sorted(set(asked) - set(there)):
        at = ", ".join(f"{value:.15g}" for value in unknown)
        raise ValueError(f"levels: no branch at A = {at}; there are branches at A = {instead(unknown, there)}")
    return set(asked)


def _level(value: float, there: Sequence[float]) -> float:
    """The level that this is, else itself."""
    return next((level for level in there if is_same(value, level)), value)


def _values(one: object) -> list[float]:
    """The numbers of an entry: one, several between commas, or start:stop:step with both ends."""
    if isinstance(one, str):
        return [value for part in one.split(",") for value in _range(part.strip())]
    if one is None or isinstance(one, (bool, np.bool_)):
        raise TypeError
    return [float(one)]  # type: ignore[arg-type]


def _range(text: str) -> list[float]:
    if ":" not in text:
        return [float(text)]
    start, stop, step = (Decimal(part.strip()) for part in text.split(":"))
    count = (stop - start) / step if step and all(end.is_finite() for end in (start, stop, step)) else Decimal(-1)
    # As the program: both ends are levels.
    if not 0 <= count <= _MOST or count != int(count):
        raise ValueError(text)
    return [float(start + k * step) for k in range(int(count) + 1)]


def instead(others: Sequence[float], there: Sequence[float]) -> str:
    """Which levels there are instead of others, as the program says it: all of them or, of many, those beside the others."""
    if len(there) <= _ALL_NAMED:
        return ", ".join(f"{value:.15g}" for value in there)
    places = {place for other in others for above in [bisect_left(there, other)] for place in (above - 1, above)}
    near = [f"{there[place]:.15g}" for place in sorted(places) if 0 <= place < len(there)]
    count = f"{len(there)} levels from {there[0]:.15g} to {there[-1]:.15g}"
    return f"{', '.join(near)} nearby ({count})" if near else count


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}…"
