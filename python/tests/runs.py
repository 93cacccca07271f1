"""Runs that the program computes for tests."""

from __future__ import annotations

import os
import sqlite3
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MODELS = ROOT / "models"


def program() -> Path:
    """What ISOLA_BIN names, or the release build."""
    named = os.environ.get("ISOLA_BIN")
    path = Path(named) if named else ROOT / "target" / "release" / "isola"
    if not named and not path.exists():
        pytest.skip(f"{path.relative_to(ROOT)} was not built, and ISOLA_BIN is not set")
    return path


def isola(*arguments: object, code: int = 0) -> subprocess.CompletedProcess[str]:
    """Runs the program, which ends with this code."""
    command = [str(program()), *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == code, done.stderr
    return done


def change(folder: Path, script: str) -> None:
    """Changes the store of a run."""
    with sqlite3.connect(folder / "run.sqlite") as db:
        db.executescript(script)
    db.close()
