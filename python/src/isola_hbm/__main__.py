"""Lists runs and follows one: ``python -m isola_hbm tcp/127.0.0.1:7447``."""

from __future__ import annotations

import argparse
import sys

from . import NAMESPACE, Branch, IsolaError, connect


def line(branch: Branch) -> str:
    """A branch in a line."""
    low, high, top = branch.omega.min(), branch.omega.max(), branch.peak
    return (
        f"A = {branch.amplitude_text}  {branch.name}: {branch.outcome}, {len(branch)} points, "
        f"{low:.6g} to {high:.6g} rad/s, at most {branch.amplitudes[top, 0]:.4e} m at {branch.omega[top]:.6g} rad/s"
    )


def main(arguments: list[str] | None = None) -> int:
    """Exit code: 0 after the end of the run, 1 with a message, 130 if interrupted."""
    parser = argparse.ArgumentParser(
        prog="python -m isola_hbm", description="Lists runs and follows one of them."
    )
    parser.add_argument("address", help="endpoint like tcp/127.0.0.1:7447, or a run directory")
    parser.add_argument("--run", help="name of the run, if there are several")
    parser.add_argument("--list", action="store_true", help="list runs and end")
    parser.add_argument(
        "--namespace", default=NAMESPACE, help="first chunk of the keys (default: %(default)s)"
    )
    parser.add_argument(
        "--timeout", type=float, default=30.0, help="patience without news, s (default: %(default)s)"
    )
    options = parser.parse_args(arguments)
    try:
        with connect(options.address, namespace=options.namespace) as bus:
            for run in bus.runs():
                levels = ", ".join(amplitude.text for amplitude in run.amplitudes)
                print(f"{run.run}  {run.name}  {run.stage}  A = {levels}", flush=True)
            if options.list:
                return 0
            chosen = bus.run(options.run)
            for branch in chosen.follow(options.timeout):
                print(line(branch), flush=True)
            status = chosen.status()
            print(f"{status.stage}: {status.tasks.branches} branches, {status.tasks.dead} tasks given up")
    except IsolaError as error:
        print(f"isola: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main())
