"""Sweeps the studies of this folder and draws the pictures that README.md shows.

    python models/pictures.py RUNS [MODEL ...]

Runs that are in the folder RUNS already are drawn as they are. Needs the program `isola` on the PATH (or what ISOLA_BIN
names) and Pillow.
"""

import os
import subprocess
import sys
from pathlib import Path

from PIL import Image

#: What is drawn of which model: levels that can be told apart, and the most that is to be seen.
PICTURES = {
    "cantilever_stop": ["response"],
    "chain_subharmonic": ["response", "--levels", "1.5,1.75,2.25"],
    "damper_two_isolas": ["response", "--levels", "0.013,0.0145,0.018,0.021"],
    "duffing": ["response", "--levels", "0.02,0.04,0.06,0.08,0.1"],
    "duffing_subharmonic": ["response"],
    "friction_mass": ["response", "--levels", "0.02,0.05,0.1"],
    "impact_subharmonic": ["response"],
    "nltva": ["response", "--levels", "0.11,0.15,0.2"],
    "nonlinear_damper": ["response", "--levels", "0.004,0.006,0.01,0.012"],
    "rotor67_thickness": ["response", "--levels", "20,60,140"],
    "stop_subharmonic": ["response"],
    "two_blades": ["response", "--levels", "0.015,0.034,0.05"],
    "two_dampers": ["response", "--levels", "0.03,0.068,0.1,0.11"],
    "two_masses_stop": ["response"],
}

models, runs = Path(__file__).parent, Path(sys.argv[1])
program = os.environ.get("ISOLA_BIN", "isola")
for name in sys.argv[2:] or PICTURES:
    run, picture = runs / name, models / name / "response.png"
    if not run.exists():
        subprocess.run([program, "sweep", models / name / "study.toml", "--out", run], check=True)
    figure, *options = PICTURES[name]
    size = ["--width", "130", "--height", "85"]
    subprocess.run([program, "plot", run, "--figure", figure, *options, *size, "-o", picture], check=True)
    # 300 pixels an inch, in all colours, are more than a page needs.
    image = Image.open(picture).convert("RGB")
    image = image.resize((900, image.height * 900 // image.width), Image.Resampling.LANCZOS)
    image.quantize(64, dither=Image.Dither.NONE).save(picture, optimize=True)
    print(picture.relative_to(models.parent), f"{picture.stat().st_size / 1000:.0f} kB")
