#!/usr/bin/env python3
"""Checks the structure of the workspace: no circles between files, SQL in one folder, crates that know what they may.

    python3 tests/structure/check_structure.py [FOLDER]

Prints what is wrong and ends with 1 if anything is. It reads source text only, and needs nothing but Python 3.11.

Circles. In every folder of modules, the crate's `src` first of all, the nodes are the modules declared there, each with
everything below it: `store.rs`, or `store/mod.rs` and all of `store/`. Module a depends on module b if code in a names
something that is defined in b: in a `use`, or in a path such as `crate::b::Thing`, `super::b::thing` or `b::Thing`.
Names are followed through re-exports, renamings and globs to the file that defines them, so that
`pub use store::Reader` in `lib.rs` makes nobody depend on `lib.rs`. Modules of a folder that depend on each other in
turn are a circle.

A file and the modules that it declares are no circle: `engine/mod.rs` may use `engine/job.rs`, which may use what
`engine/mod.rs` defines. In the folder above both are the one node `engine`, so a circle through others is found there.
Of a package with several programs each has a tree of its own.

Tests are free: code under `#[cfg(test)]`, modules called `tests`, and packages in `TESTS` may name anything.
`rust_modules.py` says what is seen of the source.

Crates. `MUST_NOT_NAME` says what a crate must not name, in its code or as a dependency. SQL stands in `SQL_FOLDER`
alone: rusqlite, and texts that begin like a statement.

Patches. A package in `[patch.crates-io]` is what Cargo.lock says is built: of another version it would be passed over.
"""

from __future__ import annotations

import re
import sys
import tomllib
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from rust_modules import Module, StructureError, Use, read_crate, resolve, roots

#: Circles that are known: the folder, and its modules in the circle. One that is not there any more is reported, too.
EXCEPTIONS: dict[str, list[set[str]]] = {}
#: What the crate of a folder must not name: crates, or modules of crates.
MUST_NOT_NAME = {
    "solver/linalg": ["zenoh", "tokio", "solver", "protocol", "worker", "results", "coordinator"],
    "solver": ["faer", "rustfft", "zenoh", "tokio", "protocol", "worker", "results", "coordinator"],
    "protocol": ["worker", "results", "coordinator"],
    "worker": ["results", "coordinator"],
    "results": ["zenoh", "worker", "coordinator"],
    "bench/recall": ["solver", "protocol", "worker", "results", "coordinator"],
}
#: Packages that are nothing but tests.
TESTS = {"tests"}
#: Places shown of each dependence.
SHOWN = 3
#: Where SQL stands.
SQL_FOLDER = "results/src/store"
SQL_CRATE = "rusqlite"
STATEMENT = re.compile(
    r"\s*(SELECT\s.*\sFROM|INSERT\s+(OR\s+\w+\s+)?INTO|UPDATE\s.*\sSET|DELETE\s+FROM|CREATE\s+(TABLE|INDEX|VIEW)|PRAGMA)\s",
    re.DOTALL,
)

# Circles


class Dependence(NamedTuple):
    """A place where one file names what another one defines."""

    file: Path
    use: Use
    source: Module
    target: Module


def dependences(crate: Module) -> Iterator[Dependence]:
    """All of them between different files of a crate, imports before other paths."""
    for module in crate.all():
        # A single name that is imported is told of where it is imported.
        paths = [use for use in module.uses if len(use.path) > 1 or use.path[0] not in module.imports]
        for use in [*module.imported(), *paths]:
            for found in resolve(module, use.path):
                source, target = module.of_file(), found.module.of_file()
                if source is not target:
                    yield Dependence(module.file, use, source, target)


def circles(edges: dict[str, set[str]]) -> list[list[str]]:
    """Strongly connected components of more than one node, by Tarjan's algorithm."""
    index: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    found: list[list[str]] = []

    def visit(node: str) -> None:
        index[node] = low[node] = len(index)
        stack.append(node)
        for other in sorted(edges.get(node, ())):
            if other not in index:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in stack:
                low[node] = min(low[node], index[other])
        if low[node] == index[node]:
            place = stack.index(node)
            component = sorted(stack[place:])
            del stack[place:]
            if len(component) > 1:
                found.append(component)

    for node in sorted(edges):
        if node not in index:
            visit(node)
    return sorted(found)


@dataclass
class Circle:
    """Modules of one folder that depend on each other in turn."""

    folder: str
    modules: list[str]
    #: A place for every dependence within.
    places: dict[tuple[str, str], list[str]]

    def __str__(self) -> str:
        lines = [f"{self.folder}: {', '.join(self.modules)} are a circle"]
        for (source, target), places in sorted(self.places.items()):
            more = f", and {len(places) - SHOWN} more" if len(places) > SHOWN else ""
            lines.append(f"    {source} -> {target}: {', '.join(places[:SHOWN])}{more}")
        return "\n".join(lines)


def circles_of(crate: Module, top: Path) -> list[Circle]:
    """The circles of a crate."""
    folders: dict[tuple[str, ...], dict[tuple[str, str], list[str]]] = defaultdict(lambda: defaultdict(list))
    for file, use, source, target in dependences(crate):
        shorter = min(len(source.path), len(target.path))
        common = next((i for i in range(shorter) if source.path[i] != target.path[i]), shorter)
        if common == shorter:
            continue
        place = f"{file.relative_to(top)}:{use.line} {use}"
        places = folders[source.path[:common]][source.path[common], target.path[common]]
        if place not in places:
            places.append(place)
    found = []
    for path, edges in sorted(folders.items()):
        followers: dict[str, set[str]] = defaultdict(set)
        for source_name, target_name in edges:
            followers[source_name].add(target_name)
        folder = (crate.folder.relative_to(top) / Path(*path)).as_posix()
        for modules in circles(followers):
            within = {edge: where for edge, where in edges.items() if set(edge) <= set(modules)}
            found.append(Circle(folder, modules, within))
    return found


# The workspace


def members(top: Path) -> list[Path]:
    """The packages of the workspace."""
    manifest = tomllib.loads((top / "Cargo.toml").read_text("utf-8"))
    return [top / member for member in manifest["workspace"]["members"]]


def dependencies(package: Path) -> set[str]:
    """The crates that a package depends on, but for its tests."""
    manifest = tomllib.loads((package / "Cargo.toml").read_text("utf-8"))
    tables = [manifest, *manifest.get("target", {}).values()]
    named = [entry for table in tables for entry in table.get("dependencies", {}).items()]
    return {entry.get("package", name) if isinstance(entry, dict) else name for name, entry in named}


def is_named(path: tuple[str, ...], other: str) -> bool:
    """Whether a path begins with a crate, or a module of a crate."""
    parts = tuple(other.split("::"))
    path = path[1:] if path[:1] == ("",) else path
    return path[: len(parts)] == parts


def outside(module: Module) -> Iterator[Use]:
    """What a module names of other crates."""
    # A single name in code may be a variable.
    for use in [*module.imported(), *(use for use in module.uses if len(use.path) > 1)]:
        if not resolve(module, use.path):
            yield use


def check_crate(package: Path, top: Path) -> Iterator[str]:
    """What is wrong in the crates of a package, but for circles."""
    name = package.relative_to(top).as_posix()
    manifest = package / "Cargo.toml"
    depends = dependencies(package)
    unknown = MUST_NOT_NAME.get(name, [])
    for other in sorted(depends & set(unknown)):
        yield f"{manifest.relative_to(top)}: {name} must not depend on {other}"
    if SQL_CRATE in depends and name not in TESTS and not SQL_FOLDER.startswith(f"{name}/"):
        yield f"{manifest.relative_to(top)}: {SQL_CRATE} is for {SQL_FOLDER} alone"
    for root in roots(package):
        for module in read_crate(root).all():
            file = module.file.relative_to(top).as_posix()
            may_have_sql = name in TESTS or file.startswith((f"{SQL_FOLDER}/", f"{SQL_FOLDER}.rs"))
            for use in outside(module):
                for other in unknown:
                    if is_named(use.path, other):
                        yield f"{file}:{use.line}: {name} must not name {other} ({use})"
                if is_named(use.path, SQL_CRATE) and not may_have_sql:
                    yield f"{file}:{use.line}: SQL is for {SQL_FOLDER} alone ({use})"
            for text, line in module.texts:
                if STATEMENT.match(text) and not may_have_sql:
                    words = " ".join(text.split())[:40]
                    yield f'{file}:{line}: SQL is for {SQL_FOLDER} alone ("{words} …")'


def check_patches(top: Path) -> Iterator[str]:
    """What of the patched packages is not built."""
    patched = tomllib.loads((top / "Cargo.toml").read_text("utf-8")).get("patch", {}).get("crates-io", {})
    if not patched:
        return
    locked = tomllib.loads((top / "Cargo.lock").read_text("utf-8"))["package"]
    for name, entry in patched.items():
        sources = [package.get("source") for package in locked if package["name"] == name]
        if sources != [None]:
            yield f"Cargo.toml: {name} is not built from {entry['path']}: another version is asked for (see Cargo.lock)"


def check(top: Path, exceptions: dict[str, list[set[str]]] | None = None) -> list[str]:
    """Everything that is wrong in a workspace."""
    exceptions = EXCEPTIONS if exceptions is None else exceptions
    wrong, known = [], []
    for package in members(top):
        for root in roots(package):
            for circle in circles_of(read_crate(root), top):
                if set(circle.modules) in exceptions.get(circle.folder, []):
                    known.append((circle.folder, set(circle.modules)))
                else:
                    wrong.append(str(circle))
        wrong += check_crate(package, top)
    wrong += check_patches(top)
    for folder, sets in exceptions.items():
        for modules in sets:
            if (folder, modules) not in known:
                names = ", ".join(sorted(modules))
                wrong.append(f"{folder}: {names} are no circle any more: take them out of EXCEPTIONS")
    return wrong


def main(arguments: list[str]) -> int:
    """Checks the workspace of this file, or another one."""
    top = Path(arguments[0]) if arguments else Path(__file__).parents[2]
    try:
        wrong = check(top.resolve())
    except StructureError as error:
        wrong = [str(error)]
    for sentence in wrong:
        print(sentence)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
