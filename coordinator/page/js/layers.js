/* What the forced response is drawn with: main branches thin, isolas bold and, as the closed curves they are, lightly
 * filled, so that they differ without colour too. */

/** @param {Chart} chart */
function responseLayers(chart) {
  const lines = () => chart.source({ xs: [], ys: [], colour: [], width: [] });
  const [mains, loops, opens, backbone] = [lines(), lines(), lines(), lines()];
  const marks = chart.source({ x: [], y: [], marker: [], colour: [] });
  const selection = chart.source({ x: [], y: [] });
  const path = (source) => ({ ...columns("xs", "ys"), line_color: { field: "colour" }, line_join: "round", source });
  const at = columns("x", "y");

  const gap = chart.span("width", 0, [2, 3]);
  chart.glyph(
    "multi_line",
    { ...path(backbone), line_width: { field: "width" }, line_dash: [7, 4] },
    (palette) => ({ line_color: palette.soft }),
  );
  chart.glyph("multi_line", { ...path(mains), line_width: 1.4 });
  const bold = [
    chart.glyph("multi_line", { ...path(opens), line_width: 3 }),
    chart.glyph("patches", { ...path(loops), fill_color: { field: "colour" }, fill_alpha: 0.14, line_width: 3 }),
  ];
  chart.glyph(
    "scatter",
    { ...at, source: marks, marker: { field: "marker" }, size: 7, line_color: { field: "colour" }, line_width: 1.5 },
    (palette) => ({ fill_color: palette.paper }),
  );
  chart.glyph(
    "scatter",
    { ...at, source: selection, marker: "circle_cross", size: 15, fill_color: null, line_width: 2, level: "overlay" },
    (palette) => ({ line_color: palette.ink }),
  );

  const columnsOf = (curves, colours) => ({
    xs: curves.map((curve) => curve.x),
    ys: curves.map((curve) => curve.y),
    colour: curves.map(({ branch }) => colours[branch.level]),
    width: curves.map(() => 1),
  });

  const isMain = ({ branch }) => branch.kind === "main";
  const isLoop = ({ branch }) => branch.kind !== "main" && branch.closed;
  return {
    gap,
    /** @param {Curve[]} curves with their branch @param {string[]} colours of the levels */
    draw(curves, colours) {
      // Those of small levels lie inside the others: they come last. Of hundreds, thin lines show more, and
      // fills upon fills would only cost time.
      curves = curves.toSorted((a, b) => b.branch.level - a.branch.level);
      const isolaCount = curves.filter((curve) => !isMain(curve)).length;
      bold[0].glyph.line_width = bold[1].glyph.line_width = isolaCount > 40 ? 1.8 : 3;
      bold[1].glyph.fill_alpha = isolaCount > 40 ? 0 : Math.min(0.14, 1.4 / Math.max(isolaCount, 1));
      mains.data = columnsOf(curves.filter(isMain), colours);
      loops.data = columnsOf(curves.filter(isLoop), colours);
      opens.data = columnsOf(curves.filter((curve) => !isMain(curve) && !isLoop(curve)), colours);
      marks.data = marksOf(curves.length <= FEW_BRANCHES ? curves : [], colours);
    },
    drawBackbone(parts) {
      backbone.data = {
        xs: parts.map(({ x }) => x),
        ys: parts.map(({ y }) => y),
        colour: parts.map(() => ""),
        width: parts.map(({ width }) => width),
      };
    },
    drawSelection(point) {
      selection.data = point ? { x: [point.curve.x[point.index]], y: [point.curve.y[point.index]] } : { x: [], y: [] };
    },
  };
}

/** Peaks as triangles, folds as circles. */
function marksOf(curves, colours) {
  const symbols = { peak: "triangle", fold: "circle" };
  const found = curves.flatMap(
    (curve) => curve.branch.special.filter(({ kind }) => kind in symbols).map(
      ({ kind, index }) => ({ curve, kind, index }),
    ),
  );
  return {
    x: found.map(({ curve, index }) => curve.x[index]),
    y: found.map(({ curve, index }) => curve.y[index]),
    marker: found.map(({ kind }) => symbols[kind]),
    colour: found.map(({ curve }) => colours[curve.branch.level]),
  };
}
