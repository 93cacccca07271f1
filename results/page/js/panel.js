/* A panel of a figure, drawn from its description. */

/**
 * @typedef {object} PanelDescription
 * @property {string} [title]
 * @property {string} about for screen readers
 * @property {"tall"|"medium"|"low"} size
 * @property {Axis[]} x one or, like all lists below that stand for one thing, one an option of the figure's choice
 * @property {Axis[]} y
 * @property {Series[]} [series] later ones on top
 * @property {{axis: "x"|"y", at?: number[], by_amplitude?: boolean, style: Style}[]} [spans] lines across
 * @property {LabelDescription[]} [labels]
 * @property {Placement[]} [placements] of labels
 * @property {{series: number, at: "best"|"middle", frames: Placement[][]}} [run_labels] names of the runs of each frame
 *
 * @typedef {object} LabelDescription
 * @property {string} text
 * @property {(number|null)[]} x null: at the right end
 * @property {(number|null)[]} y null: none
 * @property {Colour} color
 * @property {number} [level] with which it vanishes
 *
 * @typedef {object} Placement for a frame of this width, px
 * @property {number} [choice]
 * @property {number} width
 * @property {[number, string, number, number, number][]} spots label, anchor, offset right and down, leader or not
 */

class Panel {
  /**
   * @param {Element} box where it goes
   * @param {PanelDescription} description
   * @param {View} view shared by the panels of a figure
   * @param {{number: number, file: string, moved: function, picked: function}} context
   */
  constructor(box, description, view, { number, file, moved, picked }) {
    this.description = description;
    this.view = view;
    this.number = number;
    this.curves = [];
    this.made = new Curves();
    const { about, size, spans = [] } = description;
    this.box = box;
    this.chart = new Chart(box, { label: about, file, size, ...this.axes() });
    this.drawMarks = markLayers(this.chart);
    this.drawSelection = pointMark(this.chart, { marker: "circle_cross", size: 15 });
    this.spans = [];
    this.relabel = keepLabels(this.chart, (projection) => this.labels(projection));
    const named = () => this.curves.filter(({ series }) => series.name);
    const pick = ({ series }, index) => series.branch !== undefined && picked?.(series.branch, index);
    inspectPoints(this.chart, named, (curve, index) => this.describe(curve, index), pick);
    this.chart.numbers = () => this.numbers();
    frequencyUnit.listen(() => {
      this.fit(true);
      this.draw();
    });
    this.chart.paint(() => this.draw());
    if (spans.some((span) => span.by_amplitude)) dragLine(
      this.chart,
      () => view.frame.amplitude * this.factors().y,
      (place) => moved(place / this.factors().y),
    );
  }

  /** @returns {{x: Axis, y: Axis}} as chosen; a motion brings its own range and unit. */
  axes() {
    const { description: { x, y }, view } = this;
    const chosen = { ...ofOption(y, view.choice), ...view.motion?.panels[this.number] };
    return { x: inFrequencyUnit(ofOption(x, view.choice)), y: inFrequencyUnit(chosen) };
  }

  factors() {
    const { x, y } = this.axes();
    return { x: x.unit.factor, y: y.unit.factor };
  }

  /** Shows the axes chosen; `stay`: what the reader has zoomed into stays. */
  fit(stay = false) {
    this.chart.show(this.axes(), stay);
  }

  /** Takes over everything but the series. @param {PanelDescription} description */
  update(description) {
    this.description = { ...description, series: this.description.series };
    this.fit(true);
  }

  draw() {
    const { description: { series = [] }, view } = this;
    const axes = this.axes();
    const isShown = ({ level, switch: name }) =>
      (level === undefined || (view.shown?.has(level) ?? true)) && (name === undefined || view.switched.has(name));
    const shown = series.filter(isShown);
    const isDrawn = ({ hidden }) => !hidden || !ofOption(hidden, view.choice);
    this.curves = shown.filter(isDrawn).flatMap((one) => this.made.of(one, view, axes));
    this.drawMarks(this.curves);
    const { selected } = view;
    // What lies on another curve can be selected all the same.
    const chosen = selected && shown.find(({ name, branch }) => name && branch === selected.branch);
    this.drawSelection(chosen ? { curve: this.made.of(chosen, view, axes)[0], index: selected.index } : null);
    this.drawSpans(this.factors());
    this.relabel();
  }

  drawSpans(factors) {
    const { description: { spans = [] }, view, chart } = this;
    spans.forEach(({ axis, at, by_amplitude, style }, k) => {
      const place = by_amplitude ? view.frame?.amplitude : ofOption(at, view.choice);
      const line = { line_color: colourOf(style.color), ...scaledLine(style) };
      this.spans[k] ??= chart.span(axis, { level: by_amplitude ? "annotation" : "underlay" });
      this.spans[k].setv({ location: (place ?? 0) * factors[axis], visible: Number.isFinite(place), ...line });
    });
  }

  /** @returns {PlacedLabel[]} the weightiest first */
  labels(projection) {
    const { description: { labels = [], placements = [] }, view } = this;
    const factors = this.factors();
    const at = ({ x: places, y, text, color }) => {
      const x = ofOption(places, view.choice);
      const { end } = this.chart.figure.x_range;
      return { x: x === null ? end : x * factors.x, y: (ofOption(y, view.choice) ?? NaN) * factors.y, text, color };
    };
    const isShown = ({ level }) => level === undefined || (view.shown?.has(level) ?? true);
    const named = this.spotsOf(placements, projection).filter(([label]) => isShown(labels[label])).map(
      (spot) => placed(at(labels[spot[0]]), spot),
    );
    return [...this.amplitudeLabel(factors), ...this.runLabels(projection), ...named];
  }

  /** The spots made for the option chosen and the width nearest to what there is. */
  spotsOf(placements, { frame }) {
    const width = frame.right - frame.left;
    const fitting = placements.filter(({ choice = 0 }) => choice === this.view.choice);
    if (fitting.length === 0) return [];
    const distance = (placement) => Math.abs(placement.width - width);
    return fitting.reduce((best, next) => (distance(next) < distance(best) ? next : best)).spots;
  }

  runLabels(projection) {
    const { description: { run_labels, series }, view: { frame } } = this;
    if (!run_labels || !frame) return [];
    const axes = this.axes();
    const [whole] = this.made.of(series[run_labels.series], this.view, axes);
    return this.spotsOf(run_labels.frames[frame.index] ?? [], projection).map((spot) => {
      const { first, last, best, name, color } = frame.runs[spot[0]];
      const place = run_labels.at === "best" ? best : (first + last) / 2;
      const [x, y] = [valueAt(whole.x, place, axes.x), valueAt(whole.y, place, axes.y)];
      return placed({ x, y, text: name, color }, spot);
    });
  }

  /** The amplitude looked at, at the right end of its line, or where it covers no other label. */
  amplitudeLabel(factors) {
    const { view: { frame }, description: { spans = [] } } = this;
    const line = spans.find((span) => span.by_amplitude);
    if (!line || !frame) return [];
    const { start, end } = this.chart.figure.x_range;
    const ways = [[end, "bottom_right", -4, -3], [end, "top_right", -4, 3], [start, "bottom_left", 4, -3], [start, "top_left", 4, 3]];
    const label = { y: frame.amplitude * factors.y, text: frame.name, color: line.style.color };
    const [first, ...elsewhere] = ways.map(([x, ...spot]) => placed({ ...label, x }, [0, ...spot, 0]));
    return [{ ...first, elsewhere }];
  }

  /** What is shown, in the units shown: a row a point. */
  numbers() {
    const { x, y } = this.axes();
    const quoted = (text) => `"${String(text).replaceAll('"', '""')}"`;
    const rows = this.curves.flatMap(({ series: { name }, x: across, y: up }, k) =>
      Array.from(across, (value, i) => `${quoted(name ? this.called(name) : `curve ${k + 1}`)},${value},${up[i]}`),
    );
    return [["curve", axisLabel(x), axisLabel(y)].map(quoted).join(","), ...rows, ""].join("\n");
  }

  /** The name of a series where the reader looks. @param {string[]} name one, or one an option */
  called(name) {
    return ofOption(name, this.view.choice);
  }

  /** All that is known of a point: what its series says or, without, the numbers on the axes. @returns {Description} */
  describe({ series, x, y }, index) {
    const { details, marks = [], columns } = series;
    const title = this.called(series.name);
    if (!details) {
      const axes = this.axes();
      const row = ({ title: quantity, unit }, value) => [quantity, `${formatNumber(value, 4)} ${unit.name}`];
      return { title, rows: [row(axes.x, x[index]), row(axes.y, y[index])] };
    }
    const rows = details.map(({ label, format, digits, unit, values }) => [
      label,
      formatQuantity(format, numbersOf(values, columns, this.view)?.[index], digits, unit),
    ]);
    const special = marks.filter(([at]) => at === index).map(([, text]) => text);
    const place = `${index} of ${x.length}${special.length > 0 ? ` (${special.join(", ")})` : ""}`;
    return { title, rows: [...rows, ["point", place]] };
  }
}

/** @returns {PlacedLabel} */
const placed = (label, [, anchor, dx, dy, leader]) => ({ ...label, anchor, dx, dy, leader: Boolean(leader) });
