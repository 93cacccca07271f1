/* Looking at single points: the nearest one under the pointer or the arrow keys, with all its numbers. */

/** @typedef {{title: string, rows: [string, string][]}} Description */

const REACH = 30; // px from the pointer

/** A mark that stands on one point at most. @returns {(point: {curve: Curve, index: number}|null) => void} */
function pointMark(chart, look) {
  const source = new Bokeh.ColumnDataSource({ data: { x: [], y: [] } });
  const options = { ...fieldsOf("x", "y"), ...look, fill_color: null, line_width: 2, level: "overlay", source };
  const { glyph } = chart.figure.scatter(options);
  chart.paint(() => glyph.setv({ line_color: theme.palette.ink }));
  return (point) => {
    const [x, y] = point ? [[point.curve.x[point.index]], [point.curve.y[point.index]]] : [[], []];
    if (point || source.data.x?.length !== 0) source.data = { x, y };
  };
}

/**
 * @param {Curve[]} curves @param {{x: number, y: number}} at pixels of the chart's box
 * @returns {{curve: Curve, index: number}|null}
 */
function nearestPoint(projection, curves, at) {
  // Most points are told to be too far without projecting them.
  const [left, right] = [projection.xAt(at.x - REACH), projection.xAt(at.x + REACH)];
  const [low, high] = [projection.yAt(at.y + REACH), projection.yAt(at.y - REACH)];
  let best = null;
  let smallest = REACH * REACH;
  for (const curve of curves) {
    const { x, y } = curve;
    for (let i = 0; i < x.length; i++) {
      if (!(x[i] >= left && x[i] <= right && y[i] >= low && y[i] <= high)) continue;
      const distance = (projection.x(x[i]) - at.x) ** 2 + (projection.y(y[i]) - at.y) ** 2;
      if (distance >= smallest) continue;
      smallest = distance;
      best = { curve, index: i };
    }
  }
  return best;
}

/** The point looked at in any chart: marked in all that show it. */
const lookedAt = shared(null);

/** Curves whose points have the same frequencies, number by number of their column, are of the same points. */
const pointsOf = ({ series: { details } }) => details?.[0]?.values[0]?.column;

/**
 * Lets a chart's points be looked at.
 * @param {() => Curve[]} curves those shown
 * @param {(curve: Curve, index: number) => Description} describe
 * @param {(curve: Curve, index: number) => void} [pick] on click or Enter
 */
function inspectPoints(chart, curves, describe, pick = null) {
  const tip = element("div.tip", { role: "status", hidden: true });
  chart.box.append(tip);
  const mark = pointMark(chart, { marker: "circle", size: 11 });
  const echo = pointMark(chart, { marker: "square", size: 11 });
  let cursor = null;
  lookedAt.listen((point) => {
    const isElsewhere = point && point.chart !== chart;
    const curve = isElsewhere && curves().find((one) => pointsOf(one) === point.points && point.index < one.x.length);
    echo(curve ? { curve, index: point.index } : null);
  });

  const look = (point) => {
    if (point?.curve === cursor?.curve && point?.index === cursor?.index) return;
    cursor = point;
    tip.hidden = point === null;
    mark(point);
    const points = point && pointsOf(point.curve);
    lookedAt.set(points === null || points === undefined ? null : { chart, points, index: point.index });
    if (point) fillTip(chart, tip, point, describe(point.curve, point.index));
  };
  const take = () => cursor && pick?.(cursor.curve, cursor.index);

  let pointer = null;
  const follow = oncePerFrame(() => {
    const projection = chart.projection();
    look(pointer && projection ? nearestPoint(projection, curves(), pointer) : null);
  });
  chart.box.addEventListener("pointermove", (event) => {
    const { left, top } = chart.box.getBoundingClientRect();
    pointer = event.buttons === 0 ? { x: event.clientX - left, y: event.clientY - top } : null;
    follow();
  });
  chart.box.addEventListener("pointerleave", () => {
    pointer = null;
    follow();
  });
  listenForTaps(chart.box, (event) => {
    const { left, top } = chart.box.getBoundingClientRect();
    const projection = chart.projection();
    if (projection) look(nearestPoint(projection, curves(), { x: event.clientX - left, y: event.clientY - top }));
    take();
  });
  chart.box.addEventListener("blur", () => look(null));
  chart.box.addEventListener("keydown", (event) => {
    if (event.target !== chart.box || event.altKey || event.metaKey || event.ctrlKey) return;
    const next = pointByKey(event, curves(), cursor);
    if (next) look(next);
    else if (event.key === "Escape") look(null);
    else if (event.key === "Enter") take();
    else if (!zoomByKey(event.key, chart)) return;
    event.preventDefault();
  });
}

/** Calls back for presses that did not drag. */
function listenForTaps(box, tapped) {
  let down = null;
  box.addEventListener("pointerdown", (event) => (down = event), true);
  box.addEventListener("pointerup", (event) => {
    if (down && Math.hypot(event.clientX - down.clientX, event.clientY - down.clientY) < 5) tapped(event);
    down = null;
  }, true);
}

/** Left and right go along a curve, up and down to the next one. */
function pointByKey({ key, shiftKey }, curves, cursor) {
  const along = { ArrowRight: 1, ArrowLeft: -1 }[key];
  const across = { ArrowUp: 1, ArrowDown: -1 }[key];
  if (curves.length === 0 || (along === undefined && across === undefined)) return null;
  const at = curves.findIndex((curve) => curve === cursor?.curve);
  if (at < 0) return { curve: curves[0], index: highestOf(curves[0]) };
  if (along) {
    const index = cursor.index + along * (shiftKey ? 10 : 1);
    return { curve: cursor.curve, index: Math.min(Math.max(index, 0), cursor.curve.x.length - 1) };
  }
  const curve = curves[(at + across + curves.length) % curves.length];
  return { curve, index: highestOf(curve) };
}

const highestOf = ({ y }) => Math.max(indexOfLargest(y), 0);

function zoomByKey(key, chart) {
  if (key === "+" || key === "=") chart.zoom(0.7);
  else if (key === "-") chart.zoom(1 / 0.7);
  else if (key === "0") chart.reset();
  else return false;
  return true;
}

/** Fills the tip and puts it beside the point, where it hides nothing of the chart's other side. */
function fillTip(chart, tip, { curve, index }, { title, rows }) {
  tip.replaceChildren(
    element("strong", {}, title),
    element("dl", {}, ...rows.flatMap(([term, value]) => [element("dt", {}, term), element("dd", {}, value)])),
  );
  const { x, y, frame } = chart.projection();
  const [at, height] = [{ x: x(curve.x[index]), y: y(curve.y[index]) }, tip.offsetHeight];
  const room = { right: chart.box.clientWidth - at.x - 16, left: at.x - 16 };
  const toRight = room.right >= tip.offsetWidth || room.right >= room.left;
  const left = toRight ? at.x + 16 : at.x - 16 - tip.offsetWidth;
  tip.style.left = `${Math.min(Math.max(left, 0), chart.box.clientWidth - tip.offsetWidth)}px`;
  tip.style.top = `${Math.min(Math.max(at.y - height / 2, frame.top), Math.max(chart.box.clientHeight - height, 0))}px`;
}
