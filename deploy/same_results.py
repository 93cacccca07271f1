"""Ends with 0 if a run has stored every result once, and its files are those of an undisturbed one.

python3 same_results.py RUN UNDISTURBED
"""

import pathlib
import sqlite3
import sys


def files(folder: pathlib.Path) -> dict[pathlib.Path, bytes]:
    """The files that say what was found."""
    return {file.relative_to(folder): file.read_bytes() for file in folder.rglob("*.csv")}


def tasks_of(folder: pathlib.Path) -> list[str]:
    """Tasks of all results."""
    return [task for (task,) in sqlite3.connect(folder / "run.sqlite").execute("SELECT task FROM results ORDER BY task")]


def main(run: pathlib.Path, undisturbed: pathlib.Path) -> None:
    """Compares them."""
    stored = [tasks_of(folder) for folder in (run, undisturbed)]
    if stored[0] != stored[1] or len(set(stored[0])) != len(stored[0]):
        sys.exit(f"{len(stored[0])} results, undisturbed {len(stored[1])}")
    database = sqlite3.connect(run / "run.sqlite")
    ends = dict(database.execute("SELECT coalesce(\"end\", 'open'), count(*) FROM attempts GROUP BY 1"))
    ours, theirs = files(run), files(undisturbed)
    different = sorted(str(name) for name in ours.keys() | theirs.keys() if ours.get(name) != theirs.get(name))
    if different:
        sys.exit(f"other than undisturbed: {different}")
    print(f"each of {len(stored[0])} results once; {len(ours)} files as undisturbed; ends of attempts: {ends}")


if __name__ == "__main__":
    main(*map(pathlib.Path, sys.argv[1:3]))
