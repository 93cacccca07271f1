"""Matrices and vectors of models: checked entry by entry, and written."""

from __future__ import annotations

import os
from collections.abc import Collection, Sequence
from typing import Any

import numpy as np

from .errors import BadModel
from .live.wire import Floats

#: Entries whose difference from those across the diagonal is below this share of the largest entry count as symmetric.
_SYMMETRIC = 1e-8


def symmetric(name: str, given: Any, size: int | None = None) -> Floats:
    """A symmetric matrix, dense."""
    if isinstance(given, (str, os.PathLike)):
        raise BadModel(
            f"{name} = {os.fspath(given)!r}: an array [n, n] is needed; Model.load reads the folder of a model, scipy.io.mmread a file"
        )
    dense = given.toarray() if hasattr(given, "toarray") else given
    numbers = _real(name, dense, 2)
    if numbers.ndim != 2 or numbers.shape[0] != numbers.shape[1] or not numbers.size:
        raise BadModel(f"{name}: shape {numbers.shape}; a square matrix [n, n] is needed")
    if size is not None and len(numbers) != size:
        raise BadModel(f"{name}: shape {numbers.shape}, but M has {(size, size)}")
    _require_finite(name, numbers)
    difference = np.abs(numbers - numbers.T)
    if difference.max() > _SYMMETRIC * np.abs(numbers).max():
        i, j = sorted(int(index) for index in np.unravel_index(difference.argmax(), numbers.shape))
        entries = f"{name}[{i}, {j}] = {numbers[i, j]:g}, {name}[{j}, {i}] = {numbers[j, i]:g}"
        raise BadModel(f"{name}: not symmetric ({entries}); (X + X.T) / 2 is, if the difference is rounding")
    return numbers


def forces(name: str, given: Any, size: int) -> Floats:
    """A force for each dof."""
    if isinstance(given, str):
        raise BadModel(f"{name} = {given!r}: a list of {size} numbers is needed, a force for each dof")
    numbers = _real(name, given, 1)
    if numbers.shape != (size,):
        needed = f"{size} finite numbers are needed, a force for each dof"
        raise BadModel(f"{name}: shape {numbers.shape}; {needed}")
    _require_finite(name, numbers)
    return numbers


def _real(name: str, given: Any, axes: int) -> Floats:
    """An array of real numbers."""
    try:
        is_complex = np.iscomplexobj(given)
        numbers = np.array(given, dtype=np.complex128 if is_complex else np.float64).real
    except (TypeError, ValueError):
        kind = "matrix" if axes == 2 else "list"
        raise BadModel(_fault(name, given, axes) or f"{name}: no {kind} of real numbers") from None
    if is_complex:
        raise BadModel(f"{name}: complex numbers; real ones are needed")
    return numbers


def _fault(name: str, given: Any, axes: int) -> str | None:
    """The first entry that keeps lists from being an array of so many axes."""
    if not isinstance(given, (Sequence, np.ndarray)):
        return None
    for i, entry in enumerate(given):
        if axes == 1:
            row, at = [entry], [f"{i}"]
        elif isinstance(entry, str) or not isinstance(entry, Collection):
            return f"{name}[{i}] = {entry!r}: a row of {len(given)} numbers is needed"
        elif len(entry) != len(given):
            has = "1 entry" if len(entry) == 1 else f"{len(entry)} entries"
            return f"{name}[{i}] has {has}; rows of {len(given)} are needed, as many as there are rows"
        else:
            row, at = list(entry), [f"{i}, {j}" for j in range(len(entry))]
        for number, where in zip(row, at):
            if not _is_real(number):
                return f"{name}[{where}] = {number!r}: a finite number is needed"
    return None


def _is_real(entry: Any) -> bool:
    try:
        float(entry)
    except (TypeError, ValueError):
        return False
    return True


def _require_finite(name: str, numbers: Floats) -> None:
    wrong = np.argwhere(~np.isfinite(numbers))
    if len(wrong):
        at = tuple(int(index) for index in wrong[0])
        raise BadModel(f"{name}[{', '.join(map(str, at))}] = {numbers[at]}: a finite number is needed")


def require_definite(mass: Floats) -> None:
    try:
        np.linalg.cholesky(mass)
    except np.linalg.LinAlgError:
        lowest = np.linalg.eigvalsh(mass)[0]
        raise BadModel(
            f"M: not positive definite (smallest eigenvalue {lowest:g}); are M and K exchanged?"
        ) from None


def matrix_market(matrix: Floats) -> str:
    """A matrix in Matrix Market format, every number in the shortest form that reads back the same."""
    is_symmetric = bool((matrix == matrix.T).all())
    rows, columns = np.nonzero(np.tril(matrix) if is_symmetric else matrix)
    kind = "symmetric" if is_symmetric else "general"
    entries = [f"{i + 1} {j + 1} {float(matrix[i, j])!r}" for i, j in zip(rows, columns)]
    n = len(matrix)
    return (
        "\n".join([f"%%MatrixMarket matrix coordinate real {kind}", f"{n} {n} {len(entries)}", *entries])
        + "\n"
    )
