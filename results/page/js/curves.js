/* From the series of a figure to curves: numbers in the units shown, for what the reader has chosen. */

/**
 * @typedef {object} Series
 * @property {"line"|"closed"|"band"} kind closed: back to its first point; band: filled between y and y2
 * @property {string[]} [name] title of what is said of its points, one or one an option; without, nothing is
 * @property {boolean[]} [hidden] options for which it is not drawn, for it would lie on another one
 * @property {Ref[]} [x] one, or one an option; likewise y and y2
 * @property {Signal} [signal] in place of x and y: from the motion shown
 * @property {Style} style
 * @property {number} [level] with which it vanishes
 * @property {number} [branch] of which its points are
 * @property {boolean} [along_runs] drawn once a run of the frame, cut to it, in its colour
 * @property {string} [switch] what the reader has to switch on to see it
 * @property {{after: number[], x: Ref[], y: Ref[]}} [smooth] more to draw between the points, each after a point
 * @property {Columns} columns what its refs refer to
 *
 * @typedef {object} View what the reader has chosen
 * @property {number} choice which of the options of axes, numbers and places
 * @property {Set<number>|null} shown levels; null: all
 * @property {Set<string>} switched on
 * @property {Frame|null} frame
 * @property {object|null} motion
 * @property {number} time share of the period
 *
 * @typedef {object} Curve
 * @property {Series} series
 * @property {Numbers} x its points
 * @property {Numbers} y
 * @property {Numbers} [y2]
 * @property {Colour} color
 * @property {{x: Numbers, y: Numbers}} drawn with what makes it smooth
 */

/** @param {Ref[]|undefined} refs @param {View} view @returns {Numbers|undefined} */
function numbersOf(refs, columns, { choice, frame }) {
  if (!refs?.length) return undefined;
  const { column, at, by_amplitude } = ofOption(refs, choice);
  const numbers = columns(column);
  const chosen = at ? Float64Array.from(at, (index) => numbers[index]) : numbers;
  return by_amplitude ? scaled(chosen, frame?.amplitude ?? NaN) : chosen;
}

/** Keeps what it made of a series until something that it depends on changes. */
class Curves {
  constructor() {
    this.made = new WeakMap();
  }

  /**
   * @param {Series} series @param {View} view @param {{x: Axis, y: Axis}} axes
   * @returns {Curve[]} one; along runs, one a run
   */
  of(series, view, axes) {
    const frame = isByAmplitude(series) ? view.frame : null;
    const moving = series.signal ? [view.motion, view.time] : [];
    const depends = [view.choice, axes.x.unit.factor, axes.y.unit.factor, frame, ...moving];
    const known = this.made.get(series);
    if (known?.depends.every((value, k) => value === depends[k])) return known.curves;
    const whole = wholeCurve(series, view, axes);
    const curves = series.along_runs ? (frame?.runs ?? []).map((run) => curveAlong(whole, run, axes)) : [whole];
    this.made.set(series, { depends, curves });
    return curves;
  }
}

const isByAmplitude = ({ along_runs, y = [], y2 = [] }) =>
  along_runs || [...y, ...y2].some(({ by_amplitude }) => by_amplitude);

/** @returns {Curve} */
function wholeCurve(series, view, axes) {
  const { signal, columns, style: { color } } = series;
  if (signal) {
    const { x, y } = signalCurve(series, view);
    const shown = { x: scaled(x, axes.x.unit.factor), y: scaled(y, axes.y.unit.factor) };
    return { series, color, ...shown, drawn: shown };
  }
  const numbers = (refs, axis) => {
    const found = numbersOf(refs, columns, view);
    return found && scaled(found, axes[axis].unit.factor);
  };
  const curve = { series, color, x: numbers(series.x, "x"), y: numbers(series.y, "y"), y2: numbers(series.y2, "y") };
  return { ...curve, drawn: smoothed(curve, series.smooth, numbers) };
}

/** The points of a curve and, between them, those that make it smooth. */
function smoothed({ x, y, series }, smooth, numbers) {
  const isClosed = series.kind === "closed" && x.length > 0;
  if (!smooth && !isClosed) return { x, y };
  const after = smooth?.after ?? [];
  const merged = (points, between = []) => {
    const list = new Float64Array(points.length + after.length + (isClosed ? 1 : 0));
    let [next, at] = [0, 0];
    for (let i = 0; i < points.length; i++) {
      list[at++] = points[i];
      while (next < after.length && after[next] <= i) list[at++] = between[next++];
    }
    if (isClosed) list[at] = points[0];
    return list;
  };
  return { x: merged(x, numbers(smooth?.x, "x")), y: merged(y, numbers(smooth?.y, "y")) };
}

/** A column at a place between its points, as the line between them is drawn on the axis. @param {Axis} axis */
function valueAt(column, place, { scale }) {
  const i = Math.min(Math.floor(place), column.length - 1);
  if (i === place || i + 1 >= column.length) return column[i];
  const [value, next, share] = [column[i], column[i + 1], place - i];
  return scale === "log" ? value * (next / value) ** share : value + (next - value) * share;
}

/** A curve cut to a run, both ends included. @param {Curve} whole @param {Run} run @returns {Curve} */
function curveAlong(whole, { first, last, color }, axes) {
  const cut = (column, axis) => {
    if (!column) return undefined;
    const values = [valueAt(column, first, axis)];
    for (let i = Math.floor(first) + 1; i < last; i++) values.push(column[i]);
    if (last > first) values.push(valueAt(column, last, axis));
    return values;
  };
  const part = { x: cut(whole.x, axes.x), y: cut(whole.y, axes.y), y2: cut(whole.y2, axes.y) };
  return { series: whole.series, color, ...part, drawn: part };
}
