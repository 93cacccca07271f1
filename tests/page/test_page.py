"""The pages of a run in a real browser, headless Chromium: the report without a network, and the live page.

ISOLA_BIN names the program; chromium is taken from the PATH (Debian: apt-get install chromium).
"""

import io
import os
import shutil
import signal
import sqlite3
import subprocess
import time
from contextlib import contextmanager
from pathlib import Path

import pytest
from PIL import Image
from playwright.sync_api import sync_playwright

REPOSITORY = Path(__file__).parents[2]
ISOLA = os.environ.get("ISOLA_BIN", str(REPOSITORY / "target/debug/isola"))
FIGURES = ["response", "balance", "map", "ways", "modes", "motion"]
# Colours, with the shades between them, of a chart with nothing but a grid and one label are fewer.
EMPTY = 300
# Levels enough for the run to go on while a reader zooms.
MANY = "0.004:0.012:0.00004"
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")


def isola(*arguments, **more):
    return subprocess.run([ISOLA, *map(str, arguments)], check=True, capture_output=True, text=True, **more)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """Rotor 67 with an isola at the first of two levels."""
    folder = tmp_path_factory.mktemp("page") / "run"
    isola("sweep", REPOSITORY / "models/rotor67/study.toml", "--amplitudes", "20,40", "--out", folder)
    isola("report", folder)
    return folder


@pytest.fixture(scope="module")
def browser():
    assert CHROMIUM, "chromium is not installed"
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield browser
        browser.close()


class Page:
    """A page with everything that it complains about and asks the network for."""

    def __init__(self, browser, url, allowed=("file:", "data:", "blob:"), **context):
        self.allowed = allowed
        self.page = browser.new_page(**context)
        self.complaints, self.requests = [], []
        self.page.on("console", lambda message: self.complaints.append(message.text) if message.type in ("error", "warning") else None)
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.goto(url)

    def __enter__(self):
        return self.page

    def __exit__(self, *_):
        self.page.close()
        assert self.complaints == []
        fetched = [url for url in self.requests if not url.startswith(self.allowed)]
        assert fetched == []


@contextmanager
def report(browser, run, **context):
    """The report of a run with all its figures drawn."""
    with Page(browser, (run / "report.html").as_uri(), **context) as page:
        page.wait_for_selector("html[data-drawn=all]", state="attached")
        yield page


def colours(chart):
    """How many colours there are inside the axes of a chart."""
    picture = Image.open(io.BytesIO(chart.screenshot())).convert("RGB")
    width, height = picture.size
    inside = picture.crop((width // 4, height // 20, width - width // 20, height * 3 // 4))
    return len(inside.getcolors(width * height))


@pytest.mark.parametrize(("width", "scheme"), [(390, "dark"), (1400, "light"), (3840, "light")])
def test_every_figure_is_drawn(run, browser, width, scheme):
    with report(browser, run, viewport={"width": width, "height": 900}, color_scheme=scheme) as page:
        for figure in FIGURES:
            charts = page.locator(f"#{figure} .chart").all()
            assert charts, figure
            assert all(colours(chart) > EMPTY for chart in charts), figure
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        assert page.locator("#verdict p").count() == 3
        assert page.locator("#missing").is_hidden()
        assert "0.9481 mm" in page.locator("#verdict").inner_text()


def test_levels_are_switched_and_points_are_chosen(run, browser):
    with report(browser, run, viewport={"width": 1400, "height": 900}) as page:
        motion = page.locator("#motion").inner_text()
        assert "isola 1" in motion
        page.get_by_role("button", name="None", exact=True).click()
        page.get_by_role("button", name="All", exact=True).click()
        # From branch to branch with the arrow keys, to the first main branch.
        chart = page.locator("#response .chart")
        for _ in range(3):
            chart.press("ArrowUp")
            if "main" in page.locator("#response .tip").inner_text():
                break
        chart.press("Enter")
        page.locator("#motion", has_text="of main").wait_for()


def test_names_are_text(run, browser, tmp_path):
    """A study cannot put markup into its report."""
    study = tmp_path / "study.toml"
    study.write_text(
        f'name = "<img src=x onerror=alert(1)></script>"\nmodel = "{REPOSITORY / "models/nonlinear_damper"}"\n'
        'amplitudes = "0.004"\n[harmonics]\ncount = 3\n[backbone]\nmax_amplitude = 1\n'
    )
    isola("sweep", study, "--out", tmp_path / "run")
    isola("report", tmp_path / "run")
    with report(browser, tmp_path / "run") as page:
        assert page.locator("#run-name").inner_text().startswith("<img src=x")
        assert page.locator("img[src=x]").count() == 0


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
    unit = {"m": 1, "mm": 1e-3}[label.split(", ")[-1]]
    return [*ends[:2], ends[2] * unit, ends[3] * unit]


def test_a_run_is_followed_to_its_end(browser, tmp_path):
    """A reader who has zoomed keeps the view, and a level that is hidden stays so, whatever comes."""
    run = tmp_path / "run"
    study = REPOSITORY / "models/nonlinear_damper/study.toml"
    with started("sweep", study, "--amplitudes", MANY, "--stay", "--workers", 2, "--out", run):
        wait_for(run / "address")
        with started("watch", run, "--page") as watch:
            url = watch.stdout.readline().split()[0]
            with Page(browser, url, allowed=(url, "data:", "blob:"), viewport={"width": 1400, "height": 900}) as page:
                page.locator("[data-figure][data-branches]:not([data-branches='0'])").wait_for()
                page.locator(".level input").first.uncheck()
                page.get_by_role("button", name="Closer").click()
                zoomed = view(page)
                assert "finished" not in page.locator("#status").inner_text(), "the run is too short for this test"
                page.locator("#status", has_text="finished").wait_for()
                page.locator(f"[data-figure][data-branches='{branches_stored(run)}']").wait_for()
                assert not page.locator(".level input").first.is_checked()
                assert page.locator(".level input:checked").count() == page.locator(".level").count() - 1
                assert view(page) == pytest.approx(zoomed)
