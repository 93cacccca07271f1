"""The report of a run in a real browser, without a network."""

import json
import shutil
import sqlite3
from xml.etree import ElementTree

import pytest
from pages import BRIEF, REPOSITORY, Page, colours, isola, report

FIGURES = ["response", "balance", "map", "resonance", "modes", "motion"]
# Colours, with the shades between them, of a chart with nothing but a grid and one label are fewer.
EMPTY = 300


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
        assert page.locator("#verdict > div > p:not(.lost)").count() == 3 and page.locator("#verdict details").count() == 1
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
        # Nothing reaches into the next column.
        widths = table.evaluate("(box) => [...box.querySelectorAll('th, td')].map((cell) => [cell.scrollWidth, cell.clientWidth])")
        assert all(text <= cell for text, cell in widths), widths
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
        # Three a level, and the highest isola's where there is one.
        assert page.locator("#numbers tbody tr").count() == 7
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
def test_what_is_lost_comes_before_answers(run, browser, tmp_path, width):
    folder = tmp_path / "run"
    shutil.copytree(run, folder)
    with sqlite3.connect(folder / "run.sqlite") as db:
        db.execute("UPDATE meta SET value = 'cancelled' WHERE key = 'stage'")
    db.close()
    isola("report", folder)
    with report(browser, folder, viewport={"width": width, "height": 900}) as page:
        answers = [card.locator("p").all_inner_texts() for card in page.locator("#verdict > div").all()]
        expected = ["Not all is known. The run was cancelled.", *2 * ["Not all is known (cancelled)."]]
        assert all(answer[0].startswith(start) for answer, start in zip(answers, expected, strict=True)), answers
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


def patched(run, tmp_path, *changes):
    """The folder of a copy of the report, in which these texts are others."""
    page = (run / "report.html").read_text(encoding="utf-8")
    for old, new in changes:
        assert old in page
        page = page.replace(old, new)
    (tmp_path / "report.html").write_text(page, encoding="utf-8")
    return tmp_path


@pytest.mark.parametrize("turned", [False, True])
def test_titles_of_axes_have_room_on_a_phone(run, browser, tmp_path, turned):
    """Also long ones, and where a phone was turned after they were broken into lines."""
    long = "frequency ω of the response, 1/2 of the force's"
    folder = patched(run, tmp_path, ('"title":"frequency ω"', f'"title":"{long}"'))
    across, upright = ({"width": 800, "height": 390}, {"width": 390, "height": 800})
    with report(browser, folder, viewport=across if turned else upright) as page:
        if turned:
            page.set_viewport_size(upright)
            page.wait_for_timeout(500)
        measured = page.evaluate(
            """() => [...Bokeh.index].filter(({ frame }) => frame).flatMap(({ model, el, frame }) => {
                const context = document.createElement("canvas").getContext("2d");
                const of = ({ axis_label: { text }, axis_label_text_font_size: size, axis_label_text_font: font }, length) => {
                    context.font = `${size} ${font}`;
                    return [text, Math.max(...text.split("\\n").map((line) => context.measureText(line).width)), length];
                };
                const { left, right, top, bottom } = frame.bbox;
                const room = (from, to, whole) => 2 * Math.min((from + to) / 2, whole - (from + to) / 2);
                return [of(model.below[0], room(left, right, el.clientWidth)), of(model.left[0], room(top, bottom, el.clientHeight))];
            })"""
        )
        assert len(measured) >= 10
        assert all(width <= room for _, width, room in measured), measured
        broken = [text for text, *_ in measured if text.replace("\n", " ").startswith(long)]
        assert len(broken) >= 3 and all("\n" in text for text in broken), measured
        # What has room stays in one line.
        assert "time (periods)" in " ".join(text for text, *_ in measured if "\n" not in text)


def test_the_amplitude_looked_at_covers_no_other_label(run, browser, tmp_path):
    folder = patched(run, tmp_path, ("function keepLabels(", "window.labelsWithRoom = labelsWithRoom;\nfunction keepLabels("))
    with report(browser, folder, viewport={"width": 390, "height": 800}) as page:
        shown = page.evaluate(
            """() => {
                const frame = { left: 0, right: 300, top: 0, bottom: 200 };
                const projection = { x: (x) => x, y: (y) => y, frame };
                const label = (text, x, anchor, dx, dy) => ({ text, x, y: 100, anchor, dx, dy });
                const elsewhere = [label("A = 300", 300, "top_right", -4, 3)];
                const chosen = { ...label("A = 300", 300, "bottom_right", -4, -3), elsewhere };
                const others = [label("dies at 301", 250, "bottom_center", 0, -3)];
                return [[chosen, ...others], [chosen]].map((labels) =>
                    labelsWithRoom(labels, projection).map(({ text, anchor }) => [text, anchor]));
            }"""
        )
        assert shown == [
            [["A = 300", "top_right"], ["dies at 301", "bottom_center"]],
            [["A = 300", "bottom_right"]],
        ]
