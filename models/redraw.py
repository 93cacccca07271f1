"""Draws the forced responses of a run as exported by `isola export RUN --format npz`.

    python models/redraw.py FOLDER response.png

Needs NumPy and Matplotlib.
"""

import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plot
import numpy

folder, picture = Path(sys.argv[1]), sys.argv[2]
run = numpy.load(folder / "run.npz")
figure, axes = plot.subplots(figsize=(9, 6))

levels = list(run["levels.amplitude"])
for name, level, kind in zip(run["branches.file"], run["branches.amplitude"], run["branches.kind"]):
    file = folder / "branches" / f"{name}.npz"
    if not file.exists():  # run["run.missing"] says why
        continue
    branch = numpy.load(file)
    points = numpy.arange(len(branch["omega"]))
    if branch["closed"]:
        points = numpy.append(points, 0)
    color = plot.cm.viridis(levels.index(level) / max(len(levels) - 1, 1))
    style = dict(color=color, linestyle="--" if kind != "main" else "-", label=f"A = {level}, {kind}")
    axes.plot(branch["omega"][points], 1e3 * branch["amplitude"][points, 0], **style)
if "backbone.omega" in run:
    axes.plot(run["backbone.omega"], 1e3 * run["backbone.amplitude"][:, 0], "k:", label="backbone")

axes.set(title=str(run["run.name"]), xlabel="ω, rad/s", ylabel=f"|{run['model.monitors'][0]}|, mm")
axes.legend(fontsize="small")
figure.savefig(picture, dpi=120)
