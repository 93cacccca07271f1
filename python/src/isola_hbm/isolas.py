"""Which windows led to isolas: which level and which mode's backbone figures are about."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

if TYPE_CHECKING:
    from .stored.run import StoredRun


def mode_of_isola(run: StoredRun, amplitude: float | None = None) -> int | None:
    """Mode of the backbone that figures are about, as in figures of the program: that of the first window that led to an isola of its
    frequencies, at this amplitude or, if none did there, at the lowest level; None if none did anywhere."""
    found = windows_of_isolas(run)
    here = found[found["amplitude"] == amplitude]
    return next(iter(pd.concat([here, found])["mode"].astype(int)), None)


def windows_of_isolas(run: StoredRun) -> pd.DataFrame:
    """Windows that led to isolas of their frequencies, level by level."""
    windows, isolas = run.windows, run.summary.query("kind == 'isola'")

    def has_isola(window: pd.Series) -> bool:
        names = str(window["branch"]).split("; ") if window["outcome"] == "found" else []
        numbers = [name.removeprefix("isola ") for name in names if name.startswith("isola ")]
        is_named = isolas["branch"].astype(str).isin(numbers) & (isolas["amplitude"] == window["amplitude"])
        rows = isolas[is_named]
        lies = (rows["omega_min"] <= window["omega_max"]) & (rows["omega_max"] >= window["omega_min"])
        # What cannot be read is not judged.
        return bool(lies.any()) or len(rows) < len(numbers)

    is_led = np.array([has_isola(window) for _, window in windows.iterrows()], dtype=bool)
    return windows[is_led].sort_values("amplitude", kind="stable")
