"""Curves that lie on each other: mirror images of the motions of a symmetric structure have the same amplitudes."""

from __future__ import annotations

import numpy as np

from .live.wire import Floats

#: Curves are drawn as one where no point of either is farther from the other, as a share of their width and height: less than lines are wide.
_SAME = 5e-3


def is_same(one: Floats, other: Floats) -> bool:
    """Whether two curves (rows of points) lie on each other."""
    low, high = one.min(axis=0), one.max(axis=0)
    size = high - low
    if not (size > 0.0).all():
        return False
    one, other = (one - low) / size, (other - low) / size
    # Most are told apart by their ends.
    ends = np.abs([other.min(axis=0), other.max(axis=0) - 1.0])
    return bool((ends <= _SAME).all()) and _reach(one, other) <= _SAME and _reach(other, one) <= _SAME


def _reach(points: Floats, curve: Floats) -> float:
    """The largest distance of points from a curve, straight from each of its points to the next."""
    steps = np.diff(curve, axis=0)
    offsets = points[:, None] - curve[:-1]
    squares = np.maximum((steps**2).sum(axis=-1), np.finfo(float).tiny)
    share = np.clip((offsets * steps).sum(axis=-1) / squares, 0.0, 1.0)
    return float(np.sqrt(((offsets - share[..., None] * steps) ** 2).sum(axis=-1).min(axis=1).max()))
