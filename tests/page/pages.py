"""Pages of a run in a browser, headless Chromium, and the program that makes them.

ISOLA_BIN names the program; chromium is taken from the PATH (Debian: apt-get install chromium).
"""

import io
import os
import shutil
import subprocess
from contextlib import contextmanager
from pathlib import Path

from PIL import Image

REPOSITORY = Path(__file__).parents[2]
ISOLA = os.environ.get("ISOLA_BIN", str(REPOSITORY / "target/debug/isola"))
# Neither looks for what windows do not show nor verifies.
BRIEF = ["--search", "none", "--verify", "none"]
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")


def isola(*arguments, **more):
    return subprocess.run([ISOLA, *map(str, arguments)], check=True, capture_output=True, text=True, **more)


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
