#!/usr/bin/env python3
"""What the program is made of: a software bill of materials, CycloneDX 1.5, on standard output.

    python3 deploy/sbom.py TARGET > isola.cdx.json

Every package that is linked into `isola` for the target triple, with version, licence and the checksum of its source as
Cargo.lock has it, and what is bundled with it. It needs cargo, nothing else.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
PROGRAM = "coordinator"
#: Published packages with changes of ours.
THIRD_PARTY = ROOT / "third_party"


def bundled() -> list[dict[str, Any]]:
    """What is not a package of Cargo: scripts of the page and the font of figures."""
    api = (ROOT / "results/page/vendor/bokeh.min.js").read_text("utf-8")
    version = api.partition('version="')[2].partition('"')[0] or api.partition('version:"')[2].partition('"')[0]
    bokeh: dict[str, Any] = {"type": "library", "name": "bokehjs", "licenses": [{"license": {"id": "BSD-3-Clause"}}]}
    if version:
        bokeh |= {"version": version, "purl": f"pkg:npm/%40bokeh/bokehjs@{version}"}
    font = {"type": "data", "name": "Noto Sans", "licenses": [{"license": {"id": "OFL-1.1"}}]}
    return [bokeh, font]


def linked(metadata: dict[str, Any]) -> list[dict[str, Any]]:
    """Packages that normal dependencies lead to from the program."""
    nodes = {node["id"]: node for node in metadata["resolve"]["nodes"]}
    packages = {package["id"]: package for package in metadata["packages"]}
    (start,) = (package["id"] for package in metadata["packages"] if package["name"] == PROGRAM)
    found, waiting = {start}, [start]
    while waiting:
        for dependency in nodes[waiting.pop()]["deps"]:
            normal = any(kind["kind"] is None for kind in dependency["dep_kinds"])
            if normal and dependency["pkg"] not in found:
                found.add(dependency["pkg"])
                waiting.append(dependency["pkg"])
    return sorted((packages[id] for id in found), key=lambda package: (package["name"], package["version"]))


def main() -> int:
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    command = ["cargo", "metadata", "--locked", "--format-version", "1", "--filter-platform", sys.argv[1]]
    metadata = json.loads(subprocess.run(command, cwd=ROOT, check=True, capture_output=True).stdout)
    lock = tomllib.loads((ROOT / "Cargo.lock").read_text("utf-8"))
    checksums = {(package["name"], package["version"]): package.get("checksum") for package in lock["package"]}
    components = []
    for package in linked(metadata):
        name, version = package["name"], package["version"]
        component: dict[str, Any] = {"type": "library", "name": name, "version": version}
        purl = f"pkg:cargo/{name}@{version}"
        if package["source"]:
            component |= {"purl": purl, "bom-ref": purl}
        elif Path(package["manifest_path"]).is_relative_to(THIRD_PARTY):
            ancestor = {key: component[key] for key in ("type", "name", "version")} | {"purl": purl}
            component["pedigree"] = {"ancestors": [ancestor], "notes": "With the change that its README tells."}
        if package["license"]:
            # As packages write it: "MIT/Apache-2.0" is older than the expressions.
            component["licenses"] = [{"expression": package["license"].replace("/", " OR ")}]
        if checksum := checksums.get((name, version)):
            component["hashes"] = [{"alg": "SHA-256", "content": checksum}]
        components.append(component)
    (program,) = (component for component in components if component["name"] == PROGRAM)
    bill = {
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": {
            "component": {"type": "application", "name": "isola", "version": program["version"]},
            "properties": [{"name": "target", "value": sys.argv[1]}],
        },
        "components": [*(component for component in components if component is not program), *bundled()],
    }
    json.dump(bill, sys.stdout, indent=1)
    print()
    return 0


if __name__ == "__main__":
    sys.exit(main())
