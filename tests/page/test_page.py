"""The report in a real browser: headless Chromium, no network.

ISOLA_BIN names the program; chromium is taken from the PATH (Debian: apt-get install chromium).
"""

import os
import shutil
import subprocess
from pathlib import Path

import pytest
from playwright.sync_api import sync_playwright

REPOSITORY = Path(__file__).parents[2]
ISOLA = os.environ.get("ISOLA_BIN", str(REPOSITORY / "target/debug/isola"))
FIGURES = ["response", "balance", "map", "ways", "modes", "motion"]
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

    def __init__(self, browser, file, **context):
        self.page = browser.new_page(**context)
        self.complaints, self.requests = [], []
        self.page.on("console", lambda message: self.complaints.append(message.text) if message.type in ("error", "warning") else None)
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.goto(file.as_uri())
        self.page.wait_for_selector("html[data-drawn=all]", state="attached")

    def __enter__(self):
        return self.page

    def __exit__(self, *_):
        self.page.close()
        assert self.complaints == []
        fetched = [url for url in self.requests if not url.startswith(("file:", "data:", "blob:"))]
        assert fetched == []


@pytest.mark.parametrize(("width", "scheme"), [(390, "dark"), (1400, "light"), (3840, "light")])
def test_every_figure_is_drawn(run, browser, width, scheme):
    with Page(browser, run / "report.html", viewport={"width": width, "height": 900}, color_scheme=scheme) as page:
        for figure in FIGURES:
            assert page.locator(f"#{figure} canvas").count() > 0, figure
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        assert page.locator("#verdict p").count() == 3
        assert page.locator("#missing").is_hidden()
        assert "0.9481 mm" in page.locator("#verdict").inner_text()


def test_levels_are_switched_and_points_are_chosen(run, browser):
    with Page(browser, run / "report.html", viewport={"width": 1400, "height": 900}) as page:
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
    with Page(browser, tmp_path / "run/report.html") as page:
        assert page.locator("#run-name").inner_text().startswith("<img src=x")
        assert page.locator("img[src=x]").count() == 0
