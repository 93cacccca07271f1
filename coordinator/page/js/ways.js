/* Resonance over the forcing amplitude as three ways of computing see it. */

const WAYS = [
  {
    name: "balance",
    text: "energy balance alone",
    colour: (palette) => palette.third,
    dash: [7, 4],
    marker: null,
    width: 2.5,
  },
  {
    name: "isolas",
    text: "with isolas",
    colour: (palette) => palette.second,
    dash: [],
    marker: "square",
    width: 2.5,
    size: 8,
  },
  {
    name: "continuation",
    text: "continuation alone",
    colour: (palette) => palette.first,
    dash: [2, 3],
    marker: "circle",
    width: 2,
    size: 7,
  },
];

function waysFigure(place, run) {
  const curves = WAYS.map((way) => ({ ...way, ...wayColumns(run.ways[way.name]) })).filter(({ x }) => x.length > 0);
  if (curves.length === 0) {
    place.append(emptyNote("No level has been computed yet and there is no backbone: nothing to compare."));
    return;
  }
  const forcing = extentOf(...curves.map(({ x }) => x));
  const type = spansDecades(forcing, 2) ? "log" : "linear";
  const lengths = lengthUnit(extentOf(...curves.map(({ amplitude }) => amplitude))?.[1] ?? 0);
  const monitor = run.monitors[0]?.name ?? "the first monitored dof";
  place.append(
    legend(
      curves.map(({ text, colour, dash, width, marker }) => ({ text, colour, dash: dash.join(" "), width, marker })),
    ),
  );
  const x = { label: "forcing amplitude A", range: withMargin(forcing, 0.02, type), type };
  const upper = wayPanel(place, run, curves, { quantity: "omega", factor: 1, label: "frequency ω, rad/s", x });
  const lower = wayPanel(
    place,
    run,
    curves,
    { quantity: "amplitude", factor: lengths.factor, label: `amplitude of ${monitor}, ${lengths.name}`, x },
  );
  linkAlongX(upper, lower);
}

/** A way's columns, nulls as NaN, so that curves break there. */
function wayColumns(way) {
  const numbers = (column) => Float64Array.from(column ?? [], (number) => number ?? NaN);
  return { x: numbers(way?.value), omega: numbers(way?.omega), amplitude: numbers(way?.amplitude) };
}

function wayPanel(place, run, ways, { quantity, factor, label, x }) {
  const curves = ways.map((way) => ({ ...way, y: scaled(way[quantity], factor) }));
  const chart = new Chart(place, {
    label: `Resonance over forcing: ${label}`,
    file: `${run.run.name} resonance ${quantity}`,
    size: "low",
    x,
    y: { label, range: withMargin(extentOf(...curves.map(({ y }) => y)), 0.08) },
  });
  const events = run.backbone?.events ?? [];
  for (const { kind, threshold } of events) {
    chart.span("height", threshold, kind === "birth" ? [1, 4] : [6, 4], (palette) => palette.shade);
  }
  for (const { x, y, colour, dash, width, marker, size } of curves) {
    const source = chart.source({ x, y });
    const at = { ...columns("x", "y"), source };
    chart.glyph("line", { ...at, line_width: width, line_dash: dash }, (palette) => ({ line_color: colour(palette) }));
    if (marker && x.length <= 60) chart.glyph(
      "scatter",
      { ...at, marker, size },
      (palette) => ({ fill_color: colour(palette), line_color: palette.paper }),
    );
  }
  // The same border for both panels, so that their axes stand below each other.
  chart.paint(() => chart.figure.setv({ min_border_left: Math.round(4.6 * rootFontSize()) }));
  keepLabels(
    chart,
    () => events.map((event) => eventLabel(event, chart.figure.y_range)),
    () => curves,
  );
  inspectPoints(chart, () => curves, (way, index) => ({
    title: way.text,
    rows: [
      ["A", formatNumber(way.x[index], 4)],
      ["frequency", `${formatOmega(way.omega[index])} = ${formatHertz(way.omega[index])}`],
      ["largest amplitude", formatLength(way.amplitude[index])],
    ],
  }));
  return chart;
}

/** Births are named at the foot, merges at the head of their lines. */
function eventLabel({ kind, threshold }, range) {
  const birth = kind === "birth";
  return {
    text: `${birth ? "▲ born" : "▼ merge"} ${formatNumber(threshold, 3)}`,
    x: threshold,
    y: birth ? range.start : range.end,
    sides: birth ? ["aboveStart", "aboveEnd"] : ["belowStart", "belowEnd"],
    colour: theme.palette.soft,
  };
}
