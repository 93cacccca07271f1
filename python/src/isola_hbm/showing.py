"""How far the program is, shown: on a terminal, below a notebook's cell, in a file."""

from __future__ import annotations

import math
import shutil
import sys
import time
from collections.abc import Callable
from typing import TypeAlias

#: Whether to show how far it is: as of :func:`isola_hbm.sweep`.
Showing: TypeAlias = "bool | Callable[[str], None] | None"

#: Between two lines that say how far it is, where nobody asked for all of them and there is no terminal, s.
NOW_AND_THEN = 10.0
#: How a line begins that says how far it is.
_ROUTINE = "running: "


def shown(progress: Showing) -> Callable[[str], None]:
    """What shows a line."""
    if callable(progress):
        return progress
    if progress is False:
        return lambda line: None
    if _in_notebook():
        return _notebook_line()
    if not sys.stderr.isatty():
        return _plain if progress else _now_and_then()
    width = shutil.get_terminal_size().columns - 1

    def show(line: str) -> None:
        end = "\n" if line.endswith("\n") else ""
        print(f"\r{line.rstrip()[:width]:<{width}}", end=end, file=sys.stderr, flush=True)

    return show


def tell(text: Callable[[], str], progress: Showing) -> None:
    """Says what was found, to whoever was shown how far it is."""
    if progress is False or callable(progress):
        return
    print(text(), file=sys.stdout if _in_notebook() else sys.stderr, flush=True)


def _now_and_then() -> Callable[[str], None]:
    """What shows what happens, and now and then how far it is."""
    last = -math.inf

    def show(line: str) -> None:
        nonlocal last
        if line.startswith(_ROUTINE):
            if time.monotonic() - last < NOW_AND_THEN:
                return
            last = time.monotonic()
        _plain(line)

    return show


def _plain(line: str) -> None:
    print(line.rstrip(), file=sys.stderr, flush=True)


def _in_notebook() -> bool:
    ipython = sys.modules.get("IPython")
    return ipython is not None and hasattr(ipython.get_ipython(), "kernel")


def _notebook_line() -> Callable[[str], None]:
    """What shows a line below a notebook's cell, in place of the last one."""
    from IPython.display import DisplayHandle

    handle, is_shown = DisplayHandle(), False

    def show(line: str) -> None:
        nonlocal is_shown
        (handle.update if is_shown else handle.display)({"text/plain": line.rstrip()}, raw=True)
        is_shown = True

    return show
