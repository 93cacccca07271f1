"""The pages of a run in a real browser, headless Chromium: the report without a network, and the live page.

ISOLA_BIN names the program; chromium is taken from the PATH (Debian: apt-get install chromium).
"""

import csv
import io
import json
import os
import re
import shutil
import signal
import sqlite3
import subprocess
import time
from contextlib import contextmanager
from pathlib import Path
from xml.etree import ElementTree

import pytest
from PIL import Image
from playwright.sync_api import sync_playwright

REPOSITORY = Path(__file__).parents[2]
ISOLA = os.environ.get("ISOLA_BIN", str(REPOSITORY / "target/debug/isola"))
FIGURES = ["response", "balance", "map", "resonance", "modes", "motion"]
# Colours, with the shades between them, of a chart with nothing but a grid and one label are fewer.
EMPTY = 300
# Levels enough for the run to go on while a reader zooms.
MANY = "0.004:0.012:0.00008"
# Neither looks for what windows do not show nor verifies.
BRIEF = ["--search", "none", "--verify", "none"]
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


@pytest.mark.parametrize(
    ("width", "height", "scheme"), [(390, 900, "dark"), (1400, 900, "light"), (1400, 7000, "light"), (3840, 900, "light")]
)
def test_every_figure_is_drawn(run, browser, width, height, scheme):
    """Also where all of them are in sight at once."""
    with report(browser, run, viewport={"width": width, "height": height}, color_scheme=scheme) as page:
        for figure in FIGURES:
            charts = page.locator(f"#{figure} .chart").all()
            assert charts, figure
            assert all(colours(chart) > EMPTY for chart in charts), figure
        assert page.get_by_text("cannot be shown").count() == 0
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        assert page.locator("#verdict > div > p").count() == 3 and page.locator("#verdict details").count() == 1
        assert page.locator("#missing").is_hidden()
        assert "0.9481 mm" in page.locator("#verdict").inner_text()


def test_reasons_are_read_on_a_phone(run, browser):
    """Nothing of the table of windows lies off to the right: what became of a window stands below its numbers."""
    with report(browser, run, viewport={"width": 390, "height": 900}) as page:
        table = page.locator("#account .stacked").first
        assert table.evaluate("(box) => box.scrollWidth <= box.clientWidth")
        row = table.locator("tbody tr").first
        first, last = (row.locator("td").nth(k).bounding_box() for k in (0, 6))
        assert last["y"] >= first["y"] + first["height"] and last["width"] > 300
        # No number of a row is broken into two lines.
        heights = [row.locator("td").nth(k).bounding_box()["height"] for k in range(6)]
        assert max(heights) < 1.5 * min(heights), heights
    with report(browser, run, viewport={"width": 1400, "height": 900}) as page:
        row = page.locator("#account .stacked tbody tr").first
        assert row.locator("td").nth(0).bounding_box()["y"] == row.locator("td").nth(6).bounding_box()["y"]


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


def test_charts_in_other_units_and_as_files(run, browser):
    """Hz and turns a minute, a logarithmic axis, and what is shown as picture, vectors and numbers."""
    with report(browser, run, viewport={"width": 1400, "height": 900}) as page:
        axis = """(box) => {
            const { x_range, y_scale, below: [axis] } = [...Bokeh.index].find((view) => box.contains(view.el)).model;
            return [x_range.end, axis.axis_label.text, y_scale.type];
        }"""
        place = page.locator("#response")
        shown = lambda: page.evaluate(axis, place.locator(".chart").first.element_handle())
        omega, title, scale = shown()
        assert (title, scale) == ("frequency ω (rad/s)", "LinearScale")
        for unit, factor in [("Hz", 1 / 6.283185307179586), ("rpm", 60 / 6.283185307179586)]:
            page.get_by_label("Frequencies in").select_option(unit)
            assert shown() == [pytest.approx(omega * factor), f"frequency ({unit})", "LinearScale"]
        place.get_by_role("button", name="Log").click()
        assert shown()[2] == "LogScale"
        files = {}
        for name in ["PNG", "SVG", "CSV"]:
            with page.expect_download() as download:
                place.get_by_role("button", name=name).click()
            assert download.value.suggested_filename.endswith(f"-response.{name.lower()}")
            files[name] = Path(download.value.path()).read_bytes()
        assert len(Image.open(io.BytesIO(files["PNG"])).getcolors(1 << 20)) > EMPTY
        assert ElementTree.fromstring(files["SVG"]).tag.endswith("svg")
        head, *rows = csv.reader(io.StringIO(files["CSV"].decode()))
        assert head[:2] == ["curve", "frequency (rpm)"]
        isola = [float(row[1]) for row in rows if row[0] == "A = 20, isola 1"]
        summary = csv.DictReader((run / "summary.csv").read_text("utf-8").splitlines())
        (known,) = [row for row in summary if row["kind"] == "isola"]
        assert max(isola) == pytest.approx(float(known["omega_max"]) * 60 / 6.283185307179586)


def test_the_page_begins_in_the_units_of_the_run(run, browser, tmp_path):
    """Those of its study; the reader's own choice holds afterwards."""
    shutil.copytree(run, tmp_path / "run")
    with sqlite3.connect(tmp_path / "run" / "run.sqlite") as database:
        database.execute("UPDATE meta SET value = ? || value WHERE key = 'study'", ("units = 'um,Hz'\n",))
    isola("report", tmp_path / "run")
    with report(browser, tmp_path / "run", viewport={"width": 1400, "height": 900}) as page:
        titles = """(box) => {
            const { below: [across], left: [up] } = [...Bokeh.index].find((view) => box.contains(view.el)).model;
            return [across.axis_label.text, up.axis_label.text];
        }"""
        chart = page.locator("#response .chart").first.element_handle()
        across, up = page.evaluate(titles, chart)
        assert across == "frequency (Hz)" and up.endswith("(µm)")
        page.get_by_label("Frequencies in").select_option("rad/s")
        assert page.evaluate(titles, chart) == ["frequency ω (rad/s)", up]


def test_texts_are_in_the_unit_chosen(run, browser):
    """What is written beside figures 2, 3, 5 and 6, and table 7, follows the axes."""
    places = ["#balance ul.words", "#map ul.words", "#modes .legend", "#motion p[aria-live]", "#account thead"]
    units = ["rad/s", "Hz", "rpm"]
    with report(browser, run, viewport={"width": 1400, "height": 900}) as page:
        text = lambda place: page.locator(place).first.text_content()
        before = {place: text(place) for place in places}
        for chosen in [*units[1:], units[0]]:
            page.get_by_label("Frequencies in").select_option(chosen)
            for place in places:
                assert [unit for unit in units if unit in text(place)] == [chosen], (place, text(place))
        assert {place: text(place) for place in places} == before
        omega = float(re.search(r": ([\d.]+) rad/s, one period", before["#motion p[aria-live]"])[1])
        page.get_by_label("Frequencies in").select_option("Hz")
        shown = float(re.search(r": ([\d.]+) Hz, one period", text("#motion p[aria-live]"))[1])
        assert shown == pytest.approx(omega / 6.283185307179586, rel=1e-5)
        # The first numbers of the table are those of the sentences.
        low = re.search(r"Window 1: ([\d.]+) to", text("#balance ul.words"))[1]
        assert page.locator("#account .stacked tbody tr td").nth(3).inner_text().startswith(low)


def test_a_point_looked_at_is_marked_in_other_figures(run, browser):
    """A point of the backbone: in figures 2, 3 and 5 at once."""
    with report(browser, run, viewport={"width": 1400, "height": 900}) as page:
        marks = """() => [...Bokeh.index].filter(({ model }) => model.renderers?.some(({ glyph, data_source }) =>
            glyph?.marker?.value === "square" && glyph.fill_color?.value === null && data_source.data.x.length === 1)).length"""
        assert page.evaluate(marks) == 0
        page.locator("[data-describes=balance] .chart").first.press("ArrowUp")
        page.wait_for_function(f"({marks})() >= 2")
        page.locator("[data-describes=balance] .chart").first.press("Escape")
        page.wait_for_function(f"({marks})() === 0")


@pytest.mark.parametrize("width", [390, 1400])
def test_runs_are_compared(run, browser, tmp_path, width):
    """Both runs are drawn over each other, and told apart in tables."""
    study = REPOSITORY / "models/rotor67/study.toml"
    other, page_file = tmp_path / "slippery", tmp_path / "compare.html"
    slippery = ["--set", "contact.friction=0.1", "--set", "name=slippery", "--search", "none", "--verify", "none"]
    isola("sweep", study, "--amplitudes", "20,40", "--out", other, *slippery)
    isola("report", run, other, "-o", page_file)
    with Page(browser, page_file.as_uri(), viewport={"width": width, "height": 900}) as page:
        page.wait_for_selector("html[data-drawn=all]", state="attached")
        assert "slippery" in page.locator("#run-name").inner_text()
        differing = ["contact.friction\t0.15\t0.1", 'search.effort\t"standard"\t"none"', 'verify.effort\t"standard"\t"none"']
        assert page.locator("#settings tbody tr").all_inner_texts() == differing
        assert page.locator("#numbers tbody tr").count() == 6
        for figure in ["response", "resonance"]:
            for chart in page.locator(f"#{figure} .chart").all():
                assert colours(chart) > EMPTY / 4, figure
        data = json.loads(page.locator("#data").text_content())
        _, lines = drawn(page, page.locator("#response"))
        assert {colour(data["palette"]["light"], {"category": k}) for k in (0, 1)} <= lines
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        page.get_by_label("Frequencies in").select_option("Hz")
        numbers = page.locator("#numbers tbody").inner_text()
        assert " Hz" in numbers and "rad/s" not in numbers


def colour(palette, name):
    """The colour of a role, a forcing level or a category, as #rrggbb."""
    if isinstance(name, str):
        return palette[name]
    pale = {"pale_level": "level", "pale_category": "category"}
    if faded := [key for key in name if key in pale]:
        full = colour(palette, {pale[faded[0]]: name[faded[0]]})
        channels = [[int(text[i : i + 2], 16) for i in (1, 3, 5)] for text in (palette["paper"], full)]
        mixed = (int(paper + palette["pale"] * (own - paper) + 0.5) for paper, own in zip(*channels))
        return "#" + "".join(f"{part:02x}" for part in mixed)
    if "category" in name:
        return palette["categories"][name["category"] % len(palette["categories"])]
    ramp = [[int(text[i : i + 2], 16) for i in (1, 3, 5)] for text in palette["ramp"]]
    below = min(int(name["level"] * (len(ramp) - 1)), len(ramp) - 2)
    share = name["level"] * (len(ramp) - 1) - below
    mixed = (int(low + share * (high - low) + 0.5) for low, high in zip(ramp[below], ramp[below + 1]))
    return "#" + "".join(f"{part:02x}" for part in mixed)


def drawn(page, place):
    """Labels with their colours, and colours of the lines, of the first chart in a place."""
    labels, lines = page.evaluate(
        """(box) => {
            const { renderers } = [...Bokeh.index].find((view) => box.contains(view.el)).model;
            const data = (kind) => renderers.find(({ glyph }) => glyph?.type === kind).data_source.data;
            const [{ text, text_color }, { line_color }] = [data("Text"), data("MultiLine")];
            return [text.map((label, k) => [label, text_color[k]]), line_color];
        }""",
        place.locator(".chart").first.element_handle(),
    )
    return dict(labels), set(lines)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_labels_and_colours_are_those_of_the_description(run, browser, scheme):
    with report(browser, run, viewport={"width": 1400, "height": 900}, color_scheme=scheme) as page:
        data = json.loads(page.locator("#data").text_content())
        palette = {**data["palette"][scheme], "pale": data["palette"]["pale"]}
        [panel] = data["figures"]["response"]["panels"]
        labels, lines = drawn(page, page.locator("#response"))
        described = {label["text"]: colour(palette, label["color"]) for label in panel["labels"]}
        assert len(labels) > 2 and labels.items() <= described.items()
        series = [one for one in panel["series"] if "switch" not in one and one["style"]["width"] > 0]
        assert lines == {colour(palette, one["style"]["color"]) for one in series}


@pytest.mark.parametrize("figure", ["response", "balance", "backbone", "map", "resonance", "modes"])
def test_page_and_file_name_the_same(run, browser, tmp_path, figure):
    """Labels and legend of the page are those of the figure as a file, at the forcing level shown first."""
    file = tmp_path / "figure.svg"
    # As wide as the page, with smaller texts: whatever has room on the page has room there.
    isola("plot", run, "--figure", figure, "--width", 330, "--height", 180, "-o", file)
    texts = [text.attrib["aria-label"] for text in ElementTree.parse(file).iter() if "aria-label" in text.attrib]
    with report(browser, run, viewport={"width": 1400, "height": 900}) as page:
        data = json.loads(page.locator("#data").text_content())
        description, frame = data["figures"][figure], data["frames"][data["first_frame"]]
        place = page.locator(f"[data-describes={figure}]")
        legend = place.locator(".legend > span").all_inner_texts()
        for shown, entry in zip(legend, description["legend"], strict=True):
            assert shown == entry["text"] or ("frequency" in entry and shown.startswith(f"{entry['text']} ("))
        # No amplitude is chosen in a file.
        chosen = {"amplitude chosen: drag the line", "windows there, a colour each"} if figure == "map" else set()
        assert set(legend) - set(texts) == chosen
        panel = description["panels"][0]
        known = {label["text"] for label in panel["labels"]} | {one["name"] for one in frame["runs"]}
        labels, _ = drawn(page, place)
        assert labels and labels.keys() & known <= set(texts)
        assert labels.keys() - known <= {frame["name"]}


@pytest.mark.parametrize("width", [390, 1280])
def test_answers_come_before_what_is_lost(run, browser, tmp_path, width):
    folder = tmp_path / "run"
    shutil.copytree(run, folder)
    with sqlite3.connect(folder / "run.sqlite") as db:
        db.execute("UPDATE meta SET value = 'cancelled' WHERE key = 'stage'")
    db.close()
    isola("report", folder)
    with report(browser, folder, viewport={"width": width, "height": 900}) as page:
        answers = [card.locator("p").all_inner_texts() for card in page.locator("#verdict > div").all()]
        assert all(not answer[0].startswith("Not all is known") for answer in answers), answers
        assert [answer[1] for answer in answers] == ["Not all is known. The run was cancelled.", *2 * ["Not all is known (cancelled)."]]
        assert page.locator("#verdict p.lost").first.is_visible()


def test_names_are_text(run, browser, tmp_path):
    """A study cannot put markup into its report."""
    study = tmp_path / "study.toml"
    study.write_text(
        f'name = "<img src=x onerror=alert(1)></script>"\nmodel = "{REPOSITORY / "models/nonlinear_damper"}"\n'
        'amplitudes = "0.004"\n[harmonics]\ncount = 3\n[backbone]\nmax_amplitude = 1\n'
    )
    isola("sweep", study, *BRIEF, "--out", tmp_path / "run")
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
