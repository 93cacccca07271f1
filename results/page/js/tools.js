/* Buttons above a chart: what a drag does, closer, farther, back, logarithmic, pictures, numbers. In place of Bokeh's own toolbar, which keys
 * and screen readers do not reach. */

/** Touch screens scroll the page with a finger on a chart, unless a tool is turned on. */
const COARSE_POINTER = matchMedia("(pointer: coarse)").matches;

/** Tools of a Bokeh figure. The wheel needs Ctrl, so that alone it scrolls the page. */
function bokehTools() {
  return {
    box: new Bokeh.BoxZoomTool(),
    pan: new Bokeh.PanTool(),
    wheel: new Bokeh.WheelZoomTool({ modifiers: { ctrl: true } }),
  };
}

/** Hands out a file. @param {string} name @param {Blob} blob */
function handOut(name, blob) {
  const link = element("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}

/** @param {Chart} chart @param {string} file name of its files */
function toolButtons(chart, file) {
  const modes = [["box", "Box zoom"], ["pan", "Pan"]];
  const toggles = modes.map(([name, text]) => button(text, () => use(chart.tools[name].active ? null : name)));
  const use = (chosen) => {
    modes.forEach(([name], k) => {
      chart.tools[name].active = name === chosen;
      toggles[k].setAttribute("aria-pressed", name === chosen);
    });
  };
  const log = button("Log", () => {
    chart.setLog(!chart.isLog("y"));
    log.setAttribute("aria-pressed", chart.isLog("y"));
  }, { "aria-pressed": "false", title: "Logarithmic axis upwards" });
  log.hidden = !chart.canBeLog;
  chart.ready.then(() => {
    chart.tools.wheel.active = !COARSE_POINTER;
    use(COARSE_POINTER ? null : "box");
  });
  return element(
    "div.tools",
    { role: "toolbar", "aria-label": "Chart tools" },
    ...toggles,
    button("+", () => chart.zoom(0.7), { "aria-label": "Closer" }),
    button("−", () => chart.zoom(1 / 0.7), { "aria-label": "Farther" }),
    button("Reset", () => chart.reset()),
    log,
    button("PNG", () => chart.save(file), { title: "Save as a picture (PNG)" }),
    button("SVG", () => chart.saveVectors(file), { title: "Save as a picture of vectors (SVG)" }),
    button("CSV", () => chart.saveNumbers(file), { title: "Save the numbers of what is shown (CSV)" }),
  );
}

/** File names without what some systems do not take. */
const fileName = (text) => text.replace(/[^\p{L}\p{N}._-]+/gu, "-").replace(/^-+|-+$/g, "").slice(0, 80);
