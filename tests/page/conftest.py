"""The run whose pages are looked at, and the browser."""

import pytest
from pages import CHROMIUM, REPOSITORY, isola
from playwright.sync_api import sync_playwright


@pytest.fixture(scope="session")
def run(tmp_path_factory):
    """Rotor 67 with an isola at the first of two levels."""
    folder = tmp_path_factory.mktemp("page") / "run"
    isola("sweep", REPOSITORY / "models/rotor67/study.toml", "--amplitudes", "20,40", "--out", folder)
    isola("report", folder)
    return folder


@pytest.fixture(scope="session")
def browser():
    assert CHROMIUM, "chromium is not installed"
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield browser
        browser.close()
