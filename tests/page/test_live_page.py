"""The live page of a run in a real browser."""

import signal
import sqlite3
import subprocess
import time
from contextlib import contextmanager

import pytest
from pages import BRIEF, ISOLA, REPOSITORY, Page

# Levels enough for the run to go on while a reader zooms.
MANY = "0.004:0.012:0.00008"


@contextmanager
def started(*arguments):
    """The program in the background, ended as by Ctrl-C."""
    command = [ISOLA, *map(str, arguments)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    try:
        yield process
    finally:
        process.send_signal(signal.SIGINT)
        try:
            process.communicate(timeout=20)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()


def wait_for(file, seconds=30):
    end = time.monotonic() + seconds
    while not file.exists():
        assert time.monotonic() < end, f"{file} does not appear"
        time.sleep(0.05)


def branches_stored(run):
    with sqlite3.connect(f"file:{run / 'run.sqlite'}?mode=ro", uri=True) as database:
        return database.execute("SELECT count(*) FROM branches").fetchone()[0]


def view(page):
    """What the chart of a live page shows: rad/s, rad/s, m, m."""
    *ends, label = page.evaluate(
        """() => {
            const { x_range: x, y_range: y, left: [axis] } = [...Bokeh.index][0].model;
            return [x.start, x.end, y.start, y.end, axis.axis_label.text];
        }"""
    )
    unit = {"(m)": 1, "(mm)": 1e-3}[label.split()[-1]]
    return [*ends[:2], ends[2] * unit, ends[3] * unit]


def test_what_is_unstable_is_dashed_while_it_is_followed(browser, tmp_path):
    run = tmp_path / "run"
    study = REPOSITORY / "models/nonlinear_damper/study.toml"
    with started("sweep", study, "--amplitudes", "0.007", "--search", "none", "--stay", "--workers", 1, "--out", run):
        wait_for(run / "address")
        with started("watch", run, "--page") as watch:
            url = watch.stdout.readline().split()[0]
            with Page(browser, url, allowed=(url, "data:", "blob:")) as page:
                page.locator(".legend span", has_text="unstable (solid: stable, or not known)").wait_for(timeout=300_000)
                dashed = """() => [...Bokeh.index][0].model.renderers.flatMap(
                    ({ data_source }) => [...(data_source?.data.line_dash ?? [])]).some((dash) => dash.length > 0)"""
                page.wait_for_function(dashed)
                # The verified branch has taken the place of the one that came before.
                page.locator(f"[data-figure][data-branches='{branches_stored(run)}']").wait_for()


def test_a_run_is_followed_to_its_end(browser, tmp_path):
    """A reader who has zoomed keeps the view, and a level that is hidden stays so, whatever comes."""
    run = tmp_path / "run"
    study = REPOSITORY / "models/nonlinear_damper/study.toml"
    with started("sweep", study, "--amplitudes", MANY, *BRIEF, "--stay", "--workers", 2, "--out", run):
        wait_for(run / "address")
        with started("watch", run, "--page") as watch:
            url = watch.stdout.readline().split()[0]
            with Page(browser, url, allowed=(url, "data:", "blob:"), viewport={"width": 1400, "height": 900}) as page:
                page.locator("[data-figure][data-branches]:not([data-branches='0'])").wait_for()
                page.locator(".level input").first.uncheck()
                page.get_by_role("button", name="Closer").click()
                zoomed = view(page)
                assert "finished" not in page.locator("#status").inner_text(), "the run is too short for this test"
                page.locator("#status", has_text="finished").wait_for(timeout=300_000)
                page.locator(f"[data-figure][data-branches='{branches_stored(run)}']").wait_for()
                assert not page.locator(".level input").first.is_checked()
                assert page.locator(".level input:checked").count() == page.locator(".level").count() - 1
                assert view(page) == pytest.approx(zoomed)
