#!/usr/bin/env bash
# What a newcomer does: in a new virtual environment, without Rust, installs the wheel, makes a model from a template, sweeps,
# loads and plots. Ends with 1 if anything fails, or takes more than LIMIT seconds of processors in all, if that is given: for a
# wheel that is released, on a machine that is known.
#
#   [LIMIT=60] tests/wheel/first_steps.sh WHEEL [TEMPLATE]
set -euo pipefail

wheel=$(realpath "$1")
template=${2:-absorber}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python=$(command -v python3)
cd "$work"
began=$(date +%s%N)
step() { printf '%3d s  %s\n' "$((($(date +%s%N) - began) / 1000000000))" "$1"; }

"$python" -m venv venv
# Nothing of this machine but its system: no cargo, and no program of somebody else.
export PATH="$work/venv/bin:/usr/bin:/bin" MPLBACKEND=Agg
unset ISOLA_BIN PYTHONPATH
! command -v cargo > /dev/null || { echo "there is a Rust toolchain in $PATH" >&2 && exit 1; }
pip install --quiet --disable-pip-version-check "${wheel}[plot]"
[ "$(command -v isola)" = "$work/venv/bin/isola" ] || { echo "the wheel brought no program" >&2 && exit 1; }
step "installed: $(isola --version), $(($(stat --format %s "$wheel") / 1000000)) MB"

isola new first --template "$template" > /dev/null
isola check first > /dev/null
isola sweep first --out runs/first > sweep.txt 2> progress.txt || { cat sweep.txt progress.txt && exit 1; }
step "swept: $(wc -l < runs/first/summary.csv) lines in summary.csv"

# Out of reach of the PATH, as a notebook server is.
PATH=/usr/bin:/bin "$work/venv/bin/python" - << 'END'
import isola_hbm

run = isola_hbm.load("runs/first")
isolas = run.summary[run.summary["kind"] == "isola"]
assert len(isolas) > 0, "no isola was found"
name = f"{isolas.iloc[0]['amplitude']:g}/isola 1"
assert run[name]["amplitude"].max() > 0 and run.check() == []
run.plot.response().figure.savefig("response.png")
again = isola_hbm.sweep("first", amplitudes=[isolas.iloc[0]["amplitude"]], out="runs/again", search="none")
assert len(again.summary) > 0
END
[ "$(stat --format %s response.png)" -gt 10000 ]
step "loaded, plotted, swept once more from Python"

# What the processors took, which does not depend on what else the machine does: on a free one it is less than that by the clock.
times > times.txt
seconds=$(awk 'NR == 2 { gsub(/[ms]/, " "); print int(60 * $1 + $2 + 60 * $3 + $4) }' times.txt)
step "$seconds s of processors in all"
[ "$seconds" -lt "${LIMIT:-$((seconds + 1))}" ] || { echo "longer than $LIMIT s" >&2 && exit 1; }
