"""Units of figures and texts of the report."""

import csv
import io
import re
import shutil
import sqlite3
from pathlib import Path
from xml.etree import ElementTree

import pytest
from pages import isola, report
from PIL import Image

# Colours, with the shades between them, of a chart with nothing but a grid and one label are fewer.
EMPTY = 300


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


@pytest.mark.parametrize("asked", [[], ["--units", "um,Hz"]])
def test_the_page_begins_in_the_units_of_the_run(run, browser, tmp_path, asked):
    """Those of its study, or those that are asked for; the reader's own choice holds afterwards."""
    shutil.copytree(run, tmp_path / "run")
    units = "m,rad/s" if asked else "um,Hz"
    with sqlite3.connect(tmp_path / "run" / "run.sqlite") as database:
        database.execute("UPDATE meta SET value = ? || value WHERE key = 'study'", (f"units = '{units}'\n",))
    isola("report", tmp_path / "run", *asked)
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


def test_the_table_of_branches_stays_sorted(run, browser):
    """In another unit its rows are those of before, in their order."""
    with report(browser, run) as page:
        table = page.locator("table", has_text="press a head to sort")
        names = lambda: [row.locator("td").nth(1).inner_text() for row in table.locator("tbody tr").all()]
        first = names()
        assert len(first) > 1
        for name in ["points", "branch", "points", "points"]:
            table.get_by_role("button", name=re.compile(f"^{name}")).click()
        ordered = names()
        assert ordered != first and sorted(ordered) == sorted(first)
        page.get_by_label("Frequencies in").select_option("Hz")
        assert names() == ordered
        head = table.locator("th[aria-sort=descending]")
        assert head.inner_text().startswith("points")
