"""Curves of periodic motions as xarray datasets: columns at once, harmonics when they are needed."""

from __future__ import annotations

import operator
from collections.abc import Hashable
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from xarray.backends import BackendArray
from xarray.core import indexing


class Motions(xr.Dataset):
    """p periodic motions of a structure: a branch of forced responses, or a backbone.

    A dataset with the axes `point`, `harmonic` (k = 0 … H), `dof` (nonlinear and monitored ones), `mode` (from 1),
    `monitor`, `element` (contacts) and `channel` (arguments of laws). Names and numbers are those of the store; `attrs` of a
    variable has its unit (`units`) and meaning (`long_name`), `attrs` of the dataset what is known of the whole curve.

    Harmonics X_k are complex, x(t) = Re Σ_k X_k exp(i k ω t): `displacement` (m), `modal` (kg^0.5 m) and `argument` (m;
    predicted pressure of contacts: N). They are read from the store when they are used for the first time.
    """

    __slots__ = ()

    def time(self, variable: str = "displacement", *, samples: int = 256) -> xr.DataArray:
        """A variable with harmonics over one period: Re Σ_k X_k exp(i k ω t) at t = 0, T/samples, …, T = 2π/ω.

        The axis `time` takes the place of `harmonic`; it counts in periods, from 0 to 1 (left out). Nothing is computed
        but what is used of the result: choose points and dofs first, or afterwards.

        >>> branch = run["0.006/isola 1"]
        >>> branch.time().sel(dof="x1").isel(point=branch.peak)  # one period at the peak

        Args:
            variable: `displacement` (m), `modal` (kg^0.5 m) or `argument` (m, N).
            samples: Instants a period, at least 1.

        Raises:
            ValueError: The variable has no harmonics, or there are no samples.
        """
        samples = operator.index(samples)
        if samples < 1:
            raise ValueError(f"samples = {samples}: at least one instant a period is needed")
        if variable not in self.data_vars or "harmonic" not in self[variable].dims:
            known = ", ".join(str(name) for name in self.data_vars if "harmonic" in self[name].dims)
            raise ValueError(f"`{variable}` has no harmonics; those that have: {known}")
        harmonics = self[variable].transpose(..., "harmonic")
        axes = (*harmonics.dims[:-1], "time")
        series = _Series(harmonics.variable, self["harmonic"].to_numpy(), samples)
        instants = xr.Variable(
            "time", np.arange(samples) / samples, {"long_name": "time", "units": "periods"}
        )
        coordinates = {
            name: values for name, values in harmonics.coords.items() if "harmonic" not in values.dims
        }
        # What is said of harmonics is not true of their sum.
        attributes = {name: value for name, value in harmonics.attrs.items() if name != "comment"}
        # Of a dataset, which does not read what it is made from.
        values = lazily(axes, series, attributes)
        return xr.Dataset({variable: values}, {**coordinates, "time": instants})[variable]

    def verified(self) -> Motions:
        """The points of which the Floquet multipliers are known: those whose frequency a marched orbit has. Everywhere else
        `multiplier` is NaN, and of branches that were not verified there are none.

        >>> run["0.006/isola 1"].verified()["multiplier"].plot(x="omega")
        """
        known = np.isfinite(self["multiplier"].to_numpy()) if "multiplier" in self else np.zeros(0, dtype=bool)
        return self.isel(point=np.flatnonzero(known))


def index_of(curve: Motions, point: int | str) -> int:
    """The index of a point of a branch: from 0 (from the end, if negative), or of ``"peak"`` or ``"start"``.

    Raises:
        IndexError: There is no such point.
        TypeError: It is neither a whole number nor a text.
    """
    if not hasattr(point, "__index__") and not isinstance(point, str):
        raise TypeError(f"point = {point!r}: an index from 0, 'peak' or 'start' is needed")
    count = curve.sizes["point"]
    index = curve.attrs.get(point) if isinstance(point, str) else operator.index(point)
    if index is None or not -count <= index < count:
        raise IndexError(f"point {point!r} of {count}: give an index from 0, 'peak' or 'start'")
    return int(index)


class _Series(BackendArray):
    """A sum of harmonics over a period, of what is asked for."""

    def __init__(self, harmonics: xr.Variable, orders: NDArray[np.integer[Any]], samples: int) -> None:
        self._harmonics = harmonics
        self._orders = orders
        self.shape = (*harmonics.shape[:-1], samples)
        self.dtype = np.dtype(np.float64)

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        return indexing.explicit_indexing_adapter(key, self.shape, indexing.IndexingSupport.BASIC, self._at)

    def _at(self, key: tuple[int | slice, ...]) -> NDArray[np.float64]:
        instants = np.arange(self.shape[-1])[key[-1]]
        waves = np.exp(2j * np.pi * np.multiply.outer(self._orders, instants) / self.shape[-1])
        return np.real(self._harmonics[(*key[:-1], slice(None))].to_numpy() @ waves)


class Later(BackendArray):
    """Harmonics of a curve that are read when they are needed; then they are kept as long as they are used."""

    def __init__(self, source: Source, name: str, shape: tuple[int, ...]) -> None:
        self._source = source
        self._name = name
        self.shape = shape
        self.dtype = np.dtype(np.complex128)

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        values = self._source.array(self._name)
        return indexing.explicit_indexing_adapter(
            key, self.shape, indexing.IndexingSupport.BASIC, values.__getitem__
        )


class Source:
    """Where harmonics of a curve come from, all of them together."""

    _arrays: dict[str, NDArray[np.complex128]] | None = None

    def array(self, name: str) -> NDArray[np.complex128]:
        """The array of this name, read-only."""
        if self._arrays is None:
            self._arrays = self.read()
        return self._arrays[name]

    def read(self) -> dict[str, NDArray[np.complex128]]:
        """All of them, by name."""
        raise NotImplementedError


def lazily(axes: tuple[Hashable, ...], array: BackendArray, attributes: dict[str, Any]) -> xr.Variable:
    """A variable that is read when it is needed."""
    return xr.Variable(axes, indexing.LazilyIndexedArray(array), attributes)
