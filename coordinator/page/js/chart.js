/* A chart: a Bokeh figure with the page's colours, ranges known beforehand, printing, and room for labels (labels.js)
 * and for looking at points (inspect.js). */

/** All charts of the page. @type {Chart[]} */
const charts = [];

/**
 * @typedef {object} Axis
 * @property {string} label with unit
 * @property {[number, number]} range
 * @property {"linear"|"log"} [type]
 */
class Chart {
  /**
   * @param {Element} place where it goes
   * @param {{label: string, file: string, x: Axis, y: Axis, size?: string}} options label: for screen readers
   */
  constructor(place, { label, file, x, y, size = "" }) {
    this.box = element(
      `div.chart${size && `.${size}`}`,
      { tabindex: 0, role: "group", "aria-roledescription": "chart", "aria-label": label },
    );
    this.painters = [];
    this.tools = bokehTools();
    this.figure = new Bokeh.Plotting.figure({
      sizing_mode: "stretch_both",
      x_axis_type: x.type ?? "linear",
      y_axis_type: y.type ?? "linear",
      x_range: homeRange(x.range),
      y_range: homeRange(y.range),
      tools: Object.values(this.tools),
      toolbar_location: null,
      lod_threshold: null,
    });
    this.figure.xaxes[0].axis_label = plainText(x.label);
    this.figure.yaxes[0].axis_label = plainText(y.label);
    if (x.type === "log") keepLogTicks(this.figure.xaxes[0], this.figure.x_range);
    if (y.type === "log") keepLogTicks(this.figure.yaxes[0], this.figure.y_range);
    this.paint((palette) => restyle(this.figure, palette));
    charts.push(this);
    /** The view, once it stands. */
    this.ready = Promise.resolve().then(
      () => Bokeh.Plotting.show(this.figure, this.box),
    ).then((view) => (this.view = view));
    place.append(toolButtons(this, file), this.box);
  }

  /** Runs `painter` with the palette, now and whenever the theme changes. */
  paint(painter) {
    this.painters.push(painter);
    painter(theme.palette);
  }

  repaint(palette) {
    for (const painter of this.painters) painter(palette);
  }

  /** A source of data with the given columns. */
  source(data) {
    return new Bokeh.ColumnDataSource({ data });
  }

  /** A glyph; `colours` says from the palette what its colours are. */
  glyph(kind, options, colours = null) {
    // Bokeh would take a list, e.g. of dashes, for a column of numbers.
    const plain = Object.entries(options).map(
      ([name, option]) => [name, Array.isArray(option) ? { value: option } : option],
    );
    const renderer = this.figure[kind](Object.fromEntries(plain));
    if (colours) this.paint((palette) => renderer.glyph.setv(colours(palette)));
    return renderer;
  }

  /** A line across the chart: `at` on the axis that it crosses. */
  span(dimension, at, dash, colour = (palette) => palette.soft) {
    const span = new Bokeh.Span({ dimension, location: at, line_dash: dash, line_width: 1.3, level: "underlay" });
    this.figure.add_layout(span);
    this.paint((palette) => span.setv({ line_color: colour(palette) }));
    return span;
  }

  /** Changes what is seen; `home`: also what "reset" goes back to. */
  show({ x, y, home = false }) {
    for (const [range, extent] of [[this.figure.x_range, x], [this.figure.y_range, y]]) {
      if (!extent) continue;
      const [start, end] = extent;
      range.setv(home ? { start, end, reset_start: start, reset_end: end } : { start, end });
    }
  }

  /** Changes what "reset" goes back to, and with it what is seen, unless the reader has zoomed or panned. */
  rehome({ x, y }) {
    for (const [range, [start, end]] of [[this.figure.x_range, x], [this.figure.y_range, y]]) {
      const isHome = range.start === range.reset_start && range.end === range.reset_end;
      range.setv({ reset_start: start, reset_end: end, ...(isHome ? { start, end } : {}) });
    }
  }

  /** Numbers along y are `factor` times what they were: the same is seen in another unit. */
  scaleY(factor) {
    const { start, end, reset_start, reset_end } = this.figure.y_range;
    this.figure.y_range.setv({
      start: start * factor,
      end: end * factor,
      reset_start: reset_start * factor,
      reset_end: reset_end * factor,
    });
  }

  /** Zooms about the middle; factor < 1: closer. */
  zoom(factor) {
    for (const [range, log] of [[this.figure.x_range, this.isLog("x")], [this.figure.y_range, this.isLog("y")]]) {
      const [from, to] = log ? [Math.log(range.start), Math.log(range.end)] : [range.start, range.end];
      const half = ((to - from) * factor) / 2;
      const ends = [(from + to) / 2 - half, (from + to) / 2 + half];
      const [start, end] = log ? ends.map(Math.exp) : ends;
      range.setv({ start, end });
    }
  }

  /** Back to the ranges that it began with. */
  reset() {
    for (const range of [this.figure.x_range, this.figure.y_range]) range.setv({
      start: range.reset_start,
      end: range.reset_end,
    });
  }

  /** Hands out a picture as a file. */
  save(file) {
    if (!this.view) return;
    const link = element(
      "a",
      { href: this.view.export("png", true).canvas.toDataURL(), download: `${fileName(file)}.png` },
    );
    link.click();
  }

  isLog(axis) {
    return this.figure[`${axis}_scale`].type === "LogScale";
  }

  /**
   * From data to pixels of the chart's box (`x`, `y`) and back (`xAt`, `yAt`), and the frame in pixels. Null before the
   * chart stands.
   */
  projection() {
    if (!this.view || this.view.frame.bbox.width <= 0) return null;
    const { left, right, top, bottom } = this.view.frame.bbox;
    const { x_range, y_range } = this.figure;
    const [x, xAt] = axisProjection(x_range, left, right, this.isLog("x"));
    const [y, yAt] = axisProjection(y_range, bottom, top, this.isLog("y"));
    return { x, y, xAt, yAt, frame: { left, right, top, bottom } };
  }

  /**
   * Puts a picture in the place of the canvas, which does not follow the width of paper. No time is given for painting
   * anew: dark pictures are turned into light ones by style.css, for which their paper has to be black.
   */
  preparePrint() {
    if (!this.view) return;
    const dark = theme.name === "dark";
    const paper = (colour) => this.figure.setv({ background_fill_color: colour, border_fill_color: colour });
    if (dark) paper("#000000");
    const picture = this.view.export("png", true).canvas.toDataURL();
    if (dark) paper(theme.palette.paper);
    this.box.after(element("img.print-only", { src: picture, alt: this.box.getAttribute("aria-label") }));
  }
}

function homeRange([start, end]) {
  return new Bokeh.Range1d({ start, end, reset_start: start, reset_end: end });
}

/** Properties of a glyph that are columns of its source by the same name: `columns("x", "y")`. */
const columns = (...names) => Object.fromEntries(names.map((name) => [name, { field: name }]));

/** Text that Bokeh takes as it is: it would look for formulas in plain strings. */
const plainText = (text) => new Bokeh.PlainText({ text });

/** Ticks at 1, 2, 5 while a logarithmic axis shows few decades; Bokeh would show one or two powers of ten. */
function keepLogTicks(axis, range) {
  const powers = axis.formatter;
  const plain = new Bokeh.BasicTickFormatter();
  const follow = () => {
    const [low, high] = [Math.log10(range.start), Math.log10(range.end)];
    const mantissas = high - low < 1 ? [1, 1.5, 2, 3, 4, 5, 6, 8] : high - low < 3.2 ? [1, 2, 5] : [1];
    const step = Math.max(1, Math.ceil((high - low) / 8));
    const ticks = [];
    for (let power = Math.floor(low); power <= high; power++) {
      if (power % step === 0) ticks.push(...mantissas.map((mantissa) => mantissa * 10 ** power));
    }
    axis.setv({
      ticker: new Bokeh.FixedTicker({ ticks, minor_ticks: [] }),
      formatter: mantissas.length > 1 ? plain : powers,
    });
  };
  follow();
  range.change.connect(follow);
}

/** From data to pixels and back along one axis. @returns {[(value: number) => number, (pixel: number) => number]} */
function axisProjection({ start, end }, from, to, log) {
  const perUnit = (to - from) / (log ? Math.log(end / start) : end - start);
  if (log) return [
    (value) => from + Math.log(value / start) * perUnit,
    (pixel) => start * Math.exp((pixel - from) / perUnit),
  ];
  return [(value) => from + (value - start) * perUnit, (pixel) => start + (pixel - from) / perUnit];
}

/** The size of the page's text: charts grow with it on large screens. */
const rootFontSize = () => parseFloat(getComputedStyle(document.documentElement).fontSize);

const chartFont = () => getComputedStyle(document.body).fontFamily;

function restyle(figure, palette) {
  const size = `${0.82 * rootFontSize()}px`;
  figure.setv({
    background_fill_color: palette.paper,
    border_fill_color: palette.paper,
    outline_line_color: null,
    min_border_right: 16,
  });
  for (const axis of figure.axes) {
    axis.setv({
      axis_line_color: palette.soft, major_tick_line_color: palette.soft, minor_tick_line_color: null,
      major_label_text_color: palette.ink, major_label_text_font_size: size, major_label_text_font: chartFont(),
      axis_label_text_color: palette.ink,
      axis_label_text_font_size: size,
      axis_label_text_font: chartFont(),
      axis_label_text_font_style: "normal",
    });
  }
  for (const grid of figure.grids) grid.setv({ grid_line_color: palette.faint });
  for (const legend of figure.legends ?? []) legend.setv({ label_text_color: palette.ink });
}

/** Charts that are zoomed together along x. */
function linkAlongX(first, second) {
  const follow = (leader, follower) =>
    leader.change.connect(() => {
      const { start, end } = leader;
      if (follower.start !== start || follower.end !== end) follower.setv({ start, end });
    });
  follow(first.figure.x_range, second.figure.x_range);
  follow(second.figure.x_range, first.figure.x_range);
}

/** A range with a margin on both sides. @param {[number, number]|null} extent */
function withMargin(extent, share = 0.04, type = "linear") {
  if (!extent) return type === "log" ? [0.1, 10] : [0, 1];
  let [low, high] = extent;
  if (type === "log") {
    const factor = Math.max((high / low) ** share, 1.05);
    return [low / factor, high * factor];
  }
  if (low === high) [low, high] = low === 0 ? [-1, 1] : [low - Math.abs(low) * 0.1, high + Math.abs(high) * 0.1];
  const margin = (high - low) * share;
  return [low - margin, high + margin];
}

/** All charts follow the theme; before printing, each is made a picture. */
function startCharts() {
  Bokeh.set_log_level("warn");
  theme.listeners.push((palette) => charts.forEach((chart) => chart.repaint(palette)));
  let size = rootFontSize();
  window.addEventListener("resize", () => {
    if (rootFontSize() === size) return;
    size = rootFontSize();
    charts.forEach((chart) => chart.repaint(theme.palette));
  });
  window.addEventListener("beforeprint", () => charts.forEach((chart) => chart.preparePrint()));
  window.addEventListener(
    "afterprint",
    () => document.querySelectorAll("img.print-only").forEach((picture) => picture.remove()),
  );
}

/** Prints in light colours and, unlike the browser's own command, with charts laid out anew for the width of paper. */
async function printPage() {
  const before = theme.name;
  document.documentElement.classList.add("paper");
  theme.use("light");
  await new Promise((resolve) => setTimeout(resolve, 600)); // for charts to follow
  window.print();
  document.documentElement.classList.remove("paper");
  theme.use(before);
}
