/* What panels are drawn with: one glyph for all lines, one for all areas, one for all markers, however many curves
 * there are. A glyph a curve would take seconds for a large run. */

/** Labels in files are so large, px; on the page they follow its text, and everything else follows them. */
const FILE_LABEL = 28 / 3;
const labelSize = () => 0.78 * rootFontSize();
const fileScale = () => labelSize() / FILE_LABEL;

const MARKERS = { cross: "x" };

/** Properties of a glyph that are columns of its source by the same name: `fieldsOf("x", "y")`. */
const fieldsOf = (...names) => Object.fromEntries(names.map((name) => [name, { field: name }]));

/** A glyph and its source. @param {string[]} fields @returns {object} the source */
function glyphOf(chart, kind, fields, options = {}) {
  const source = new Bokeh.ColumnDataSource({ data: Object.fromEntries(fields.map((field) => [field, []])) });
  chart.figure[kind]({ ...fieldsOf(...fields), ...options, source });
  return source;
}

/** Items as columns. */
const asColumns = (fields, items) => Object.fromEntries(
  fields.map((field) => [field, items.map((item) => item[field])]),
);

const AREA = ["xs", "ys", "fill_color"];
const LINE = ["xs", "ys", "line_color", "line_width", "line_dash"];
const MARKER = ["x", "y", "marker", "size", "line_color", "fill_color", "line_width"];

/**
 * @param {Chart} chart
 * @returns {(curves: Curve[]) => void} draws these in the place of those before
 */
function markLayers(chart) {
  const areas = glyphOf(chart, "patches", AREA, { line_color: null, fill_alpha: theme.palettes.tint });
  const lines = glyphOf(chart, "multi_line", LINE, { line_join: "round" });
  const markers = glyphOf(chart, "scatter", MARKER);
  let shown = [];
  return (curves) => {
    const next = [...curves, theme.name, fileScale()];
    if (next.length === shown.length && next.every((value, k) => value === shown[k])) return;
    shown = next;
    const filled = curves.filter(({ series }) => series.style.fill);
    areas.data = asColumns(AREA, filled.map((curve) => areaOf(curve, chart)));
    lines.data = asColumns(LINE, curves.filter(({ series }) => series.style.width > 0).map(lineOf));
    markers.data = asColumns(MARKER, curves.filter(({ series }) => series.style.marker).flatMap(markersOf));
  };
}

function areaOf({ series, drawn, x, y, y2, color }, chart) {
  const fill = { fill_color: colourOf(color) };
  if (series.kind !== "band") return { xs: drawn.x, ys: drawn.y, ...fill };
  // What has no place on a logarithmic axis lies far below it.
  const floor = chart.isLog("y") ? chart.figure.y_range.reset_start * 1e-3 : -Infinity;
  const ys = [...y, ...Array.from(y2).reverse()].map((value) => Math.max(value, floor));
  return { xs: [...x, ...Array.from(x).reverse()], ys, ...fill };
}

/** Width and dash for the size of the page's text. @param {Style} style */
const scaledLine = ({ width, dash = [] }, scale = fileScale()) => ({
  line_width: width * scale,
  line_dash: dash.map((length) => length * scale),
});

const lineOf = ({ series, drawn, color }) => ({
  xs: drawn.x,
  ys: drawn.y,
  line_color: colourOf(color),
  ...scaledLine(series.style),
});

function markersOf({ series: { style: { marker } }, x, y, color }) {
  const colour = colourOf(color);
  const look = {
    marker: MARKERS[marker.shape] ?? marker.shape,
    size: marker.size * fileScale(),
    line_color: colour,
    fill_color: marker.open ? theme.palette.paper : colour,
    line_width: fileScale(),
  };
  return Array.from(x, (value, k) => ({ x: value, y: y[k], ...look }));
}
