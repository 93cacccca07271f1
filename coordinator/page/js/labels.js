/* Labels inside charts. They never overlap: those of least weight give way, and zooming places all anew. */

/**
 * @typedef {object} LabelWish
 * @property {string} text
 * @property {number} x where it points to, in data
 * @property {number} y
 * @property {string} [colour]
 * @property {string[]} [sides] where it may stand, best first: keys of LABEL_SIDES
 * @property {boolean} [important] may stand farther off with a line to its point, or on curves, rather than give way
 */

const measuringContext = document.createElement("canvas").getContext("2d");
const LABEL_DISTANCE = 8; // px
const FAR_DISTANCE = 34; // px
const CURVE_CELL = 5; // px
/** A label that would hide more of the curves than this share of itself gives way too. */
const MOST_HIDDEN = 0.35;

/** Anchor of the text and its shift from the point, and so the corner of its box, for every side. */
const LABEL_SIDES = {
  above: { anchor: "bottom_center", dx: 0, dy: -1, left: -0.5, top: -1 },
  below: { anchor: "top_center", dx: 0, dy: 1, left: -0.5, top: 0 },
  right: { anchor: "center_left", dx: 1, dy: 0, left: 0, top: -0.5 },
  left: { anchor: "center_right", dx: -1, dy: 0, left: -1, top: -0.5 },
  aboveStart: { anchor: "bottom_left", dx: 0.5, dy: -0.4, left: 0, top: -1 },
  aboveEnd: { anchor: "bottom_right", dx: -0.5, dy: -0.4, left: -1, top: -1 },
  belowStart: { anchor: "top_left", dx: 0.5, dy: 0.4, left: 0, top: 0 },
  belowEnd: { anchor: "top_right", dx: -0.5, dy: 0.4, left: -1, top: 0 },
};
const ANY_SIDE = ["above", "right", "aboveEnd", "left", "belowStart", "below", "belowEnd", "aboveStart"];

const boxesOverlap = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;

const isInside = (box, frame) =>
  box.left >= frame.left && box.right <= frame.right && box.top >= frame.top && box.bottom <= frame.bottom;

/**
 * Where curves run, as a grid of cells over the frame: labels should not stand on them.
 * @param {{x: Numbers, y: Numbers}[]} curves
 * @returns {(box: object) => number} how many occupied cells a box covers
 */
function curveGrid(curves, { x: toX, y: toY, frame }) {
  const width = Math.ceil((frame.right - frame.left) / CURVE_CELL) + 1;
  const height = Math.ceil((frame.bottom - frame.top) / CURVE_CELL) + 1;
  const occupied = new Uint8Array(width * height);
  const mark = (x, y) => {
    const [column, row] = [Math.floor((x - frame.left) / CURVE_CELL), Math.floor((y - frame.top) / CURVE_CELL)];
    if (column >= 0 && column < width && row >= 0 && row < height) occupied[row * width + column] = 1;
  };
  const total = curves.reduce((sum, { x }) => sum + x.length, 0);
  const stride = Math.ceil(total / 40_000);
  for (const { x, y } of curves) {
    let [lastX, lastY] = [NaN, NaN];
    for (let i = 0; i < x.length; i += stride) {
      const [px, py] = [toX(x[i]), toY(y[i])];
      const far = Math.max(Math.abs(px - lastX), Math.abs(py - lastY)) / CURVE_CELL;
      const steps = far < 1000 ? Math.ceil(far) : 0;
      for (let k = 1; k < steps; k++) mark(lastX + ((px - lastX) * k) / steps, lastY + ((py - lastY) * k) / steps);
      mark(px, py);
      [lastX, lastY] = [px, py];
    }
  }
  return ({ left, top, right, bottom }) => {
    let count = 0;
    for (let y = top; y < bottom; y += CURVE_CELL) {
      const row = Math.floor((y - frame.top) / CURVE_CELL) * width;
      for (let x = left; x < right; x += CURVE_CELL) {
        count += occupied[row + Math.floor((x - frame.left) / CURVE_CELL)] ?? 0;
      }
    }
    return count;
  };
}

/**
 * @param {LabelWish[]} wishes the weightiest first
 * @param {{x: function, y: function, frame: object}} projection
 * @param {(box: object) => number} covered how much of the curves a box would hide
 * @param {number} fontSize px
 * @returns {{wish: LabelWish, side: object, distance: number}[]} those with room
 */
function placeLabels(wishes, projection, covered, fontSize) {
  const { frame } = projection;
  const taken = [];
  const placed = [];
  measuringContext.font = `${fontSize}px ${chartFont()}`;
  for (const wish of wishes) {
    const [x, y] = [projection.x(wish.x), projection.y(wish.y)];
    // What stands on the edge may be rounded to either side of it.
    if (!(x > frame.left - 1 && x < frame.right + 1 && y > frame.top - 1 && y < frame.bottom + 1)) continue;
    const width = measuringContext.measureText(wish.text).width + 4;
    const best = bestPlace(wish, { x, y, width, height: fontSize * 1.25 }, frame, taken, covered);
    if (!best) continue;
    taken.push(best.box);
    placed.push({ wish, ...best });
  }
  return placed;
}

/** The place of a label that hides least of the curves, near ones first. */
function bestPlace(wish, size, frame, taken, covered) {
  const most = wish.important ? Infinity : (MOST_HIDDEN * size.width * size.height) / CURVE_CELL ** 2;
  let best = null;
  for (const distance of wish.important ? [LABEL_DISTANCE, FAR_DISTANCE, 2 * FAR_DISTANCE] : [LABEL_DISTANCE]) {
    for (const name of wish.sides ?? ANY_SIDE) {
      const side = LABEL_SIDES[name];
      const box = labelBox(size, side, distance);
      if (!isInside(box, frame) || taken.some((other) => boxesOverlap(box, other))) continue;
      const hidden = covered(box);
      if (hidden <= most && (!best || hidden < best.hidden)) best = { side, box, hidden, distance };
      if (hidden === 0) return best;
    }
  }
  return best;
}

function labelBox({ x, y, width, height }, side, distance) {
  const left = x + side.dx * distance + side.left * width;
  const top = y + side.dy * distance + side.top * height;
  return { left, top, right: left + width, bottom: top + height };
}

/**
 * Keeps labels on a chart. `wishes` is asked for after each change of the ranges, the room and the theme.
 * @param {() => LabelWish[]} wishes
 * @param {() => {x: Numbers, y: Numbers}[]} [curves] that labels should keep off
 * @returns {() => void} to be called when the wishes have changed
 */
function keepLabels(chart, wishes, curves = () => []) {
  const source = chart.source({
    x: [],
    y: [],
    text: [],
    anchor: [],
    dx: [],
    dy: [],
    colour: [],
    length: [],
    angle: [],
  });
  const text = { ...columns("x", "y", "text", "anchor"), x_offset: { field: "dx" }, y_offset: { field: "dy" } };
  const renderer = chart.glyph("text", {
    ...text,
    text_color: { field: "colour" },
    padding: 1,
    background_fill_alpha: 0.7,
    border_line_color: null,
    source,
    level: "overlay",
  }, (palette) => ({
    background_fill_color: palette.paper,
    text_font_size: `${labelSize()}px`,
    text_font: chartFont(),
  }));
  renderer.nonselection_glyph = null;
  const leader = { ...columns("x", "y", "angle"), length: { field: "length", units: "screen" } };
  chart.glyph("ray", { ...leader, line_color: { field: "colour" }, line_width: 1, source, level: "overlay" });
  let shown = "";
  let room = "";
  const roomOf = ({ frame }) => Object.values(frame).join();
  // Before the chart is painted with what has changed: painting a large run twice takes twice as long.
  const place = oncePerEvent(() => {
    const projection = chart.projection();
    if (!projection) return;
    room = roomOf(projection);
    const placed = placeLabels(wishes(), projection, curveGrid(curves(), projection), labelSize());
    const column = (pick) => placed.map(pick);
    const data = {
      x: column(({ wish }) => wish.x),
      y: column(({ wish }) => wish.y),
      text: column(({ wish }) => wish.text),
      anchor: column(({ side }) => side.anchor),
      dx: column(({ side, distance }) => side.dx * distance),
      dy: column(({ side, distance }) => side.dy * distance),
      // Bokeh takes 0 for endless.
      length: column(
        ({ side, distance }) => (distance > LABEL_DISTANCE ? Math.hypot(side.dx, side.dy) * distance : 0.1),
      ),
      angle: column(({ side }) => Math.atan2(-side.dy, side.dx)),
      colour: column(({ wish }) => wish.colour ?? theme.palette.ink),
    };
    const state = JSON.stringify(data);
    if (state === shown) return;
    shown = state;
    source.data = data;
  });
  chart.paint(place);
  for (const range of [chart.figure.x_range, chart.figure.y_range]) range.change.connect(place);
  chart.ready.then((view) => {
    // The room for them is known once a chart is laid out, and changes with the window.
    view.repainted.connect(() => {
      const projection = chart.projection();
      if (projection && roomOf(projection) !== room) place();
    });
    place();
  });
  return place;
}

const labelSize = () => 0.78 * rootFontSize();

/**
 * The order in which evenly spread items should be named when there is room for few: last, first, middle, quarters, …
 * @param {number} count @returns {number[]} all indices below `count`
 */
function spreadOrder(count) {
  const order = new Set(count > 0 ? [count - 1, 0] : []);
  for (let step = count / 2; step >= 0.5; step /= 2) {
    for (let at = step; at < count; at += step) order.add(Math.floor(at));
  }
  for (let i = 0; i < count; i++) order.add(i);
  return [...order];
}
