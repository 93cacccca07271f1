#!/usr/bin/env python3
"""Sweeps the same studies with two programs and compares the CSV files that they write.

    tests/golden/compare.py OLD NEW                    byte for byte
    tests/golden/compare.py OLD NEW --relative 1e-9    numbers to this relative difference

For changes that must not change what is found. OLD and NEW are `isola` programs, or folders that an earlier call kept
with --keep. Takes half a minute in release builds. Files are only comparable on one machine: vector instructions differ
between processors.
"""

import argparse
import csv
import math
import subprocess
import sys
import tempfile
from pathlib import Path

MODELS = Path(__file__).parents[2] / "models"
STUDIES = {
    "rotor67": (MODELS / "rotor67/study.toml", []),
    "rotor67-frictionless": (MODELS / "rotor67/frictionless.toml", []),
    "rotor67-paper": (MODELS / "rotor67/paper.toml", []),
    "duffing": (MODELS / "duffing/study.toml", []),
    "nonlinear-damper": (MODELS / "nonlinear_damper/study.toml", []),
    "impact-subharmonic": (None, ["--amplitudes", "0.1,0.2"]),
}


def sweep(program: Path, folder: Path) -> Path:
    """Runs every study; the folder with a run for each."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, (study, options) in STUDIES.items():
        if study is None:
            study = folder / f"{name}.toml"
            study.write_text(f'model = "{MODELS / name.replace("-", "_")}"\namplitudes = "1"\n')
        command = [program, "sweep", study, *options, "--out", folder / name]
        done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"{' '.join(map(str, command))} ends with {done.returncode}:\n{done.stderr}")
    return folder


def same_field(old: str, new: str, relative: float) -> bool:
    if old == new:
        return True
    try:
        return math.isclose(float(old), float(new), rel_tol=relative, abs_tol=0.0)
    except ValueError:
        return False


def difference(old: Path, new: Path, relative: float) -> str | None:
    """Where two files differ first."""
    if old.read_bytes() == new.read_bytes():
        return None
    if relative == 0:
        return "other bytes"
    tables = [list(csv.reader(file.open(newline=""))) for file in (old, new)]
    if len(tables[0]) != len(tables[1]):
        return f"{len(tables[0])} and {len(tables[1])} rows"
    for number, (left, right) in enumerate(zip(*tables), 1):
        if len(left) != len(right):
            return f"row {number}: {len(left)} and {len(right)} columns"
        for column, before, after in zip(tables[0][0], left, right):
            if not same_field(before, after, relative):
                return f"row {number}, {column}: {before} and {after}"
    return None


def files(folder: Path) -> set[Path]:
    return {file.relative_to(folder) for file in folder.rglob("*.csv")}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old", type=Path)
    parser.add_argument("new", type=Path)
    parser.add_argument("--relative", type=float, default=0.0)
    parser.add_argument("--keep", type=Path, help="keep the runs of NEW in this folder")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        kept = options.keep or Path(folder) / "new"
        old = options.old if options.old.is_dir() else sweep(options.old.resolve(), Path(folder) / "old")
        new = options.new if options.new.is_dir() else sweep(options.new.resolve(), kept)
        wrong = [f"{file}: in one of them only" for file in sorted(files(old) ^ files(new))]
        common = sorted(files(old) & files(new))
        for file in common:
            if found := difference(old / file, new / file, options.relative):
                wrong.append(f"{file}: {found}")
    print("\n".join([*wrong, f"{len(common)} files compared, {len(wrong)} differ"]))
    sys.exit(bool(wrong) or not common)


if __name__ == "__main__":
    main()
