"""What branches do where they touch, which the program tells in a file of the run."""

from __future__ import annotations

import csv
import warnings
from pathlib import Path

import pandas as pd

from ..errors import LeftOut


def told(events: pd.DataFrame, file: Path) -> pd.DataFrame:
    """Events with what branches do where they merge or part, as far as this ``events.csv`` says it: that follows from fold curves and
    all that is known of levels, and is found out by the program alone. Warns where branches do and no file says what."""
    try:
        with file.open(encoding="utf-8", newline="") as lines:
            table = csv.DictReader(lines)
            is_told = "outcome" in (table.fieldnames or [])
            rows = [row for row in table if row.get("outcome")]
            known = {(row["kind"], float(row["forcing"]), float(row["omega"])): row["outcome"] for row in rows}
    except (OSError, ValueError, KeyError, csv.Error):
        is_told, known = False, {}
    if not is_told and ((events["source"] == "computed") & (events["kind"] == "merge")).any():
        why = "is of an earlier program" if file.is_file() else "is not there"
        warnings.warn(
            f"What branches do where they merge or part (outcome) is not known: {file.name} {why}; "
            f"`isola export {file.parent}` writes it.",
            LeftOut,
            stacklevel=3,
        )
    keys = zip(events["kind"], events["forcing"], events["omega"])
    return events.assign(outcome=pd.Series([known.get(key, "") for key in keys], events.index, dtype=str))
