/* A chart: a Bokeh figure with the page's colours, ranges known beforehand, printing, and room for marks (marks.js),
 * labels (labels.js) and for looking at points (inspect.js). */

/** All charts of the page. @type {Chart[]} */
const charts = [];

/**
 * @typedef {object} Axis as figures describe it, in SI
 * @property {string} name what a choice between axes calls it
 * @property {string} title
 * @property {{name: string, factor: number}} unit shown number = SI number × factor
 * @property {[number, number]} range that files show
 * @property {[number, number]} [whole] what the page shows at first and after "reset", if that is more
 * @property {"linear"|"log"} scale
 * @property {[number, string][]} [ticks] named ones
 */
class Chart {
  /**
   * @param {Element} place where it goes
   * @param {{label: string, file: string, x: Axis, y: Axis, size: string}} options label: for screen readers
   */
  constructor(place, { label, file, x, y, size }) {
    this.box = element(
      `div.chart.${size}`,
      { tabindex: 0, role: "group", "aria-roledescription": "chart", "aria-label": label },
    );
    // In its place from the beginning, so that titles are broken before they are painted: what sticks out is not wiped away.
    place.append(this.box);
    this.painters = [];
    this.tools = bokehTools();
    this.figure = new Bokeh.Plotting.figure({
      sizing_mode: "stretch_both",
      x_axis_type: x.scale,
      y_axis_type: y.scale,
      x_range: new Bokeh.Range1d(),
      y_range: new Bokeh.Range1d(),
      tools: Object.values(this.tools),
      toolbar_location: null,
      lod_threshold: null,
    });
    this.factors = { x: x.unit.factor, y: y.unit.factor };
    /** Whether the reader may choose a logarithmic axis upwards. */
    this.canBeLog = y.scale !== "log" && !y.ticks;
    /** @type {() => string} numbers of what is shown, as CSV; whoever draws knows them */
    this.numbers = () => "";
    this.show({ x, y });
    for (const [name, axis] of Object.entries({ x, y })) {
      const drawn = this.figure[`${name}axes`][0];
      if (axis.scale === "log") keepLogTicks(drawn, this.gridAlong(name), this.figure[`${name}_range`]);
      if (axis.ticks) nameTicks(drawn, axis.ticks);
    }
    this.paint(() => {
      restyle(this.figure);
      this.title();
    });
    // A phone that is turned has other room for titles.
    new ResizeObserver(() => this.title()).observe(this.box);
    charts.push(this);
    /** The view, once it stands. */
    this.ready = Promise.resolve().then(
      () => Bokeh.Plotting.show(this.figure, this.box),
    ).then((view) => (this.view = view));
    this.box.before(toolButtons(this, file));
  }

  /** Runs `painter` now, and whenever the theme or the size of texts changes. */
  paint(painter) {
    this.painters.push(painter);
    painter();
  }

  repaint() {
    for (const painter of this.painters) painter();
  }

  /** A line across the chart, on the axis that it crosses. */
  span(axis, options) {
    const span = new Bokeh.Span({ dimension: axis === "x" ? "height" : "width", ...options });
    this.figure.add_layout(span);
    return span;
  }

  /**
   * Axes for others in the place of those there were: titles, units and ranges.
   * @param {{x: Axis, y: Axis}} axes @param {boolean} stay what the reader has zoomed into stays in view
   */
  show(axes, stay = false) {
    this.axes = axes;
    this.title();
    for (const [name, axis] of Object.entries(axes)) {
      const { factor } = axis.unit;
      const range = this.figure[`${name}_range`];
      const ends = (axis.whole ?? axis.range).map((end) => end * factor);
      const [start, end] = this.isLog(name) && ends[0] <= 0 ? [ends[1] * LOWEST, ends[1]] : ends;
      const isHome = range.start === range.reset_start && range.end === range.reset_end;
      const ratio = factor / this.factors[name];
      const kept = { start: range.start * ratio, end: range.end * ratio };
      range.setv({ reset_start: start, reset_end: end, ...(stay && !isHome ? kept : { start, end }) });
      this.factors[name] = factor;
    }
  }

  /** Titles of the axes, in as many lines as the box has room for. */
  title() {
    const { clientWidth, clientHeight } = this.box;
    const size = AXIS_TEXT * rootFontSize();
    measuringContext.font = `${size}px ${chartFont()}`;
    const widest = (lines) => Math.max(...lines.map((line) => measuringContext.measureText(line).width));
    // Before the box stands there is nothing to fit into.
    const room = (length, taken) => (length > 0 ? length - taken : Infinity);
    const across = inLines(axisLabel(this.axes.x), room(clientWidth, BESIDE_TICKS * rootFontSize()), widest);
    const below = UNDER_TICKS * rootFontSize() + 1.2 * size * across.length;
    const up = inLines(axisLabel(this.axes.y), room(clientHeight, below), widest);
    for (const [name, lines] of Object.entries({ x: across, y: up })) {
      const [drawn] = this.figure[`${name}axes`];
      const text = lines.join("\n");
      if (drawn.axis_label?.text !== text) drawn.axis_label = plainText(text); // A new one is laid out anew.
    }
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

  /** The same of vectors. */
  async saveVectors(file) {
    if (this.view) handOut(`${fileName(file)}.svg`, await this.view.export("svg", false).to_blob());
  }

  /** The numbers of what is shown. */
  saveNumbers(file) {
    handOut(`${fileName(file)}.csv`, new Blob([this.numbers()], { type: "text/csv" }));
  }

  /** Makes the axis upwards logarithmic, or even again. */
  setLog(on) {
    const [axis] = this.figure.yaxes;
    const { y_range } = this.figure;
    this.even ??= { ticker: axis.ticker, formatter: axis.formatter, start: y_range.reset_start };
    this.figure.y_scale = on ? new Bokeh.LogScale() : new Bokeh.LinearScale();
    const start = on && this.even.start <= 0 ? y_range.reset_end * LOWEST : this.even.start;
    y_range.setv({ start, end: y_range.reset_end, reset_start: start });
    if (on) {
      axis.formatter = new Bokeh.LogTickFormatter();
      this.forgetTicks = keepLogTicks(axis, this.gridAlong("y"), y_range);
    } else {
      this.forgetTicks?.();
      axis.setv({ ticker: this.even.ticker, formatter: this.even.formatter });
      this.gridAlong("y").ticker = this.even.ticker;
    }
    this.repaint();
  }

  gridAlong(axis) {
    return this.figure.grids.find(({ dimension }) => dimension === (axis === "x" ? 0 : 1));
  }

  isLog(axis) {
    return this.figure[`${axis}_scale`].type === "LogScale";
  }

  /**
   * From shown numbers to pixels of the chart's box (`x`, `y`) and back (`xAt`, `yAt`), and the frame in pixels. Null
   * before the chart stands.
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

/** Where a logarithmic axis begins that would begin at zero, as a share of its end. */
const LOWEST = 1e-4;

/** Size of texts along axes, and what ticks with their numbers take beside and below the frame, as shares of the size of the page's text. */
const AXIS_TEXT = 0.82;
const BESIDE_TICKS = 4.6;
const UNDER_TICKS = 2.4;
/** A title has so many lines at most. */
const LINES = 3;

/**
 * A title in as few lines as fit into this room, px, all about as long.
 * @param {(lines: string[]) => number} widest of lines, px
 */
function inLines(title, room, widest) {
  const words = title.split(" ");
  for (let count = 1; ; count++) {
    const lines = evenly(words, count, widest);
    if (count === LINES || count === words.length || widest(lines) <= room) return lines;
  }
}

/** Words in so many lines, the widest of which is as narrow as can be. @returns {string[]} */
function evenly(words, count, widest) {
  if (count === 1) return [words.join(" ")];
  const ways = words.slice(count - 1).map((_, k) => [
    words.slice(0, k + 1).join(" "),
    ...evenly(words.slice(k + 1), count - 1, widest),
  ]);
  return ways.reduce((best, next) => (widest(next) < widest(best) ? next : best));
}

/** Text that Bokeh takes as it is: it would look for formulas in plain strings. */
const plainText = (text) => new Bokeh.PlainText({ text });

/** @param {Axis} axis */
const axisLabel = ({ title, unit }) => (unit.name === "" ? title : `${title} (${unit.name})`);

/** Ticks at 1, 2, 5 while a logarithmic axis shows few decades; Bokeh would show one or two powers of ten. What it returns ends it. */
function keepLogTicks(axis, grid, range) {
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
    const ticker = new Bokeh.FixedTicker({ ticks, minor_ticks: [] });
    grid.setv({ ticker });
    axis.setv({ ticker, formatter: mantissas.length > 1 ? plain : powers });
  };
  follow();
  range.change.connect(follow);
  return () => range.change.disconnect(follow);
}

/** Names in the place of numbers, not more than fit. @param {[number, string][]} ticks */
function nameTicks(axis, ticks) {
  const step = Math.ceil(ticks.length / 10);
  const named = ticks.filter((_, k) => k % step === 0);
  if (Bokeh.NoOverlap) axis.major_label_policy = new Bokeh.NoOverlap();
  axis.ticker = new Bokeh.FixedTicker({ ticks: named.map(([place]) => place), minor_ticks: [] });
  axis.major_label_overrides = new Map(named.map(([place, name]) => [place, plainText(name)]));
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

function restyle(figure) {
  const { paper, ink, soft, faint } = theme.palette;
  const text = { text_color: ink, text_font_size: `${AXIS_TEXT * rootFontSize()}px`, text_font: chartFont() };
  const under = (part) => Object.fromEntries(Object.entries(text).map(([name, value]) => [`${part}_${name}`, value]));
  figure.setv({
    background_fill_color: paper,
    border_fill_color: paper,
    outline_line_color: null,
    min_border_right: 16,
  });
  for (const axis of figure.axes) {
    axis.setv({
      axis_line_color: soft,
      major_tick_line_color: soft,
      minor_tick_line_color: null,
      ...under("major_label"),
      ...under("axis_label"),
      axis_label_text_font_style: "normal",
    });
  }
  for (const grid of figure.grids) grid.setv({ grid_line_color: faint });
}

/** Charts below each other that are zoomed together along x. @param {Chart[]} linked */
function linkAlongX(linked) {
  for (const leader of linked) {
    // The same border for all, so that their axes stand below each other.
    leader.paint(() => leader.figure.setv({ min_border_left: Math.round(4.6 * rootFontSize()) }));
    const { x_range } = leader.figure;
    x_range.change.connect(() => {
      const { start, end } = x_range;
      for (const { figure } of linked) {
        if (figure.x_range.start !== start || figure.x_range.end !== end) figure.x_range.setv({ start, end });
      }
    });
  }
}

/** All charts follow the theme; before printing, each is made a picture. */
function startCharts() {
  Bokeh.set_log_level("warn");
  const repaint = () => charts.forEach((chart) => chart.repaint());
  theme.listeners.push(repaint);
  let size = rootFontSize();
  window.addEventListener("resize", () => {
    if (rootFontSize() === size) return;
    size = rootFontSize();
    repaint();
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
