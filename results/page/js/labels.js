/* Labels inside charts, where the figure has placed them. Of those that would overlap in the room there is, the ones
 * named later give way. */

/**
 * @typedef {object} PlacedLabel
 * @property {string} text
 * @property {number} x what it names, in the units shown
 * @property {number} y
 * @property {string} anchor of the text, e.g. "bottom_center"
 * @property {number} dx from the point to the anchor, px to the right
 * @property {number} dy px down
 * @property {boolean} leader whether a line leads to the point
 * @property {Colour} color
 * @property {PlacedLabel[]} [elsewhere] where it may stand as well, if it would lie on others here
 */

const LABEL = ["x", "y", "text", "anchor", "x_offset", "y_offset", "text_color"];
const LEADER = ["x", "y", "length", "angle", "line_color"];
const measuringContext = document.createElement("canvas").getContext("2d");

const boxesOverlap = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;

/** What a label covers, px. @param {PlacedLabel} label */
function labelBox({ text, x, y, anchor, dx, dy }, projection) {
  const width = measuringContext.measureText(text).width + 2;
  const height = labelSize() * 1.2;
  const left = projection.x(x) + dx - width * (anchor.includes("left") ? 0 : anchor.includes("right") ? 1 : 0.5);
  const top = projection.y(y) + dy - height * (anchor.includes("top") ? 0 : anchor.includes("bottom") ? 1 : 0.5);
  return { left, top, right: left + width, bottom: top + height };
}

/** How far a part has to move to lie within others: not at all, if it does. */
const inwards = (low, high, from, to) => Math.max(from - low, 0) - Math.max(high - to, 0);

/** Those in view that overlap none before them, moved inside where they stick out. @param {PlacedLabel[]} labels */
function labelsWithRoom(labels, projection) {
  measuringContext.font = `${labelSize()}px ${chartFont()}`;
  const { left, right, top, bottom } = projection.frame;
  const isInView = ({ x, y }) => {
    const [across, down] = [projection.x(x), projection.y(y)];
    // What stands on the edge may be rounded to either side of it.
    return across > left - 1 && across < right + 1 && down > top - 1 && down < bottom + 1;
  };
  const inside = (label) => {
    const box = labelBox(label, projection);
    const dx = label.dx + inwards(box.left, box.right, left, right);
    return { ...label, dx, dy: label.dy + inwards(box.top, box.bottom, top, bottom) };
  };
  const fixed = labels.filter((label) => !label.elsewhere && isInView(label)).map((label) => labelBox(inside(label), projection));
  const isFree = (label) => !fixed.some((other) => boxesOverlap(labelBox(label, projection), other));
  const free = ({ elsewhere = [], ...label }) => [label, ...elsewhere].map(inside).find(isFree) ?? inside(label);
  const taken = [];
  return labels.filter(isInView).map((label) => (label.elsewhere ? free(label) : inside(label))).filter((label) => {
    const box = labelBox(label, projection);
    const hasRoom = !taken.some((other) => boxesOverlap(box, other));
    if (hasRoom) taken.push(box);
    return hasRoom;
  });
}

/**
 * Keeps labels on a chart.
 * @param {(projection: object) => PlacedLabel[]} wanted asked for after each change of ranges, room and theme
 * @returns {() => void} to be called when other labels are wanted
 */
function keepLabels(chart, wanted) {
  const onScreen = { field: "length", units: "screen" };
  const leaders = glyphOf(chart, "ray", LEADER, { length: onScreen, level: "overlay" });
  const texts = new Bokeh.ColumnDataSource({ data: asColumns(LABEL, []) });
  const drawn = chart.figure.text({
    ...fieldsOf(...LABEL),
    padding: 1,
    background_fill_alpha: 0.7,
    border_line_color: null,
    level: "overlay",
    source: texts,
  });
  drawn.nonselection_glyph = null;
  let shown = "";
  let room = "";
  const roomOf = ({ frame }) => Object.values(frame).join();
  // Before the chart is painted with what has changed: painting a large run twice takes twice as long.
  const place = oncePerEvent(() => {
    const projection = chart.projection();
    if (!projection) return;
    room = roomOf(projection);
    const labels = labelsWithRoom(wanted(projection), projection);
    const state = JSON.stringify([labels, theme.name]);
    if (state === shown) return;
    shown = state;
    texts.data = asColumns(LABEL, labels.map(textOf));
    leaders.data = asColumns(LEADER, labels.filter(({ leader }) => leader).map(leaderOf));
  });
  chart.paint(() => {
    const { paper } = theme.palette;
    const size = `${labelSize()}px`;
    drawn.glyph.setv({ background_fill_color: paper, text_font_size: size, text_font: chartFont() });
    place();
  });
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

const textOf = ({ dx, dy, color, ...label }) => ({
  ...label,
  x_offset: dx,
  y_offset: dy,
  text_color: colourOf(color),
});

const leaderOf = ({ x, y, dx, dy, color }) => ({
  x,
  y,
  length: Math.hypot(dx, dy),
  angle: Math.atan2(-dy, dx),
  line_color: colourOf(color),
});
