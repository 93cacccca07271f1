/* Isola map: the threshold A* along the backbone, what is predicted at any A, and what was computed at each level. */

function mapFigure(place, run, { amplitude }) {
  const { backbone } = run;
  if (!backbone) {
    place.append(emptyNote("The backbone is not there yet: the map of thresholds will be drawn from it."));
    return;
  }
  const ranges = mapRanges(run);
  place.append(mapLegend(run));
  const chart = new Chart(place, {
    label: "Isola map: threshold of the forcing amplitude over frequency. Drag the line to move A.",
    file: `${run.run.name} isola map`,
    size: "tall",
    x: { label: "frequency ω, rad/s", range: ranges.x },
    y: { label: "forcing amplitude A, threshold A*", range: ranges.y, type: ranges.type },
  });
  drawComputed(chart, run);
  const line = chart.source({ x: backbone.omega, y: backbone.threshold });
  chart.glyph(
    "line",
    { ...columns("x", "y"), line_width: 2, source: line },
    (palette) => ({ line_color: palette.ink }),
  );
  const below = chart.source({ xs: [], ys: [], colour: [] });
  chart.glyph(
    "multi_line",
    { ...columns("xs", "ys"), line_color: { field: "colour" }, line_width: 4, line_cap: "round", source: below },
  );
  drawEvents(chart, backbone.events);
  const here = chart.span("width", amplitude.get(), [9, 3], (palette) => palette.third);
  here.level = "annotation";
  const curves = [{ x: backbone.omega, y: backbone.threshold }];
  const wishes = () => [amplitudeWish(chart, amplitude.get()), ...backbone.events.map(eventWish)];
  const relabel = keepLabels(chart, wishes, () => curves);
  inspectPoints(chart, () => curves, (_, index) => describeBackbonePoint(backbone, index, amplitude.get()));
  dragAmplitude(chart, amplitude);

  const words = element("div", { "aria-live": "polite" });
  place.append(element("div.controls", {}, ...amplitudeControls(run, amplitude)), words);
  const follow = (value) => {
    here.location = value;
    const runs = runsBelow(backbone.threshold, value);
    below.data = {
      xs: runs.map((window) => alongRun(backbone.omega, window)),
      ys: runs.map((window) => alongRun(backbone.threshold, window)),
      colour: runColours(runs, theme.palette),
    };
    words.replaceChildren(...predictionInWords(run, value));
    relabel();
  };
  follow(amplitude.get());
  amplitude.listen(follow);
  theme.listeners.push(() => follow(amplitude.get()));
}

/** @returns {LabelWish} */
const amplitudeWish = (chart, amplitude) => ({
  text: `A = ${formatNumber(amplitude, 4)}`,
  x: chart.figure.x_range.end,
  y: amplitude,
  colour: theme.palette.third,
  sides: ["aboveEnd"],
});

/** Births are named below the curve, merges above it. @returns {LabelWish} */
function eventWish({ kind, threshold, omega }) {
  const birth = kind === "birth";
  const sides = birth ? ["below", "belowStart", "belowEnd"] : ["above", "aboveEnd", "aboveStart"];
  const text = `${birth ? "born" : "merge"} at A* = ${formatNumber(threshold, 4)}`;
  return { text, x: omega, y: threshold, sides: [...sides, "right", "left"] };
}

/** Frequencies of the backbone and the isolas, amplitudes from below the first birth to a little above the levels. */
function mapRanges({ backbone, branches, levels }) {
  const isolas = branches.filter((branch) => branch.kind === "isola");
  const x = withMargin(extentOf(backbone.omega, ...isolas.map((branch) => branch.omega)), 0.06);
  const [low, high] = amplitudeRange({ backbone, levels });
  const events = backbone.events.map((event) => event.threshold).filter(
    (threshold) => threshold > low && threshold < high * 6,
  );
  const extent = extentOf([low, high], events);
  const type = spansDecades(extentOf(backbone.threshold)) ? "log" : "linear";
  return { x, type, y: type === "log" ? [extent[0] / 1.2, extent[1] * 1.3] : [0, extent[1] * 1.1] };
}

const MAP_KINDS = {
  main: { text: "main branch", colour: (palette) => palette.shade, width: 1 },
  isola: { text: "isola found", colour: (palette) => palette.second, width: 5 },
  not_found: {
    text: "window predicted, not found",
    colour: (palette) => palette.alarm,
    width: 2.5,
    dash: [6, 4],
    marker: "cross",
  },
  pending: {
    text: "window not computed yet",
    colour: (palette) => palette.shade,
    width: 2.5,
    dash: [2, 4],
    marker: "circle",
  },
};

/** Bars of what was computed or is still to be. @returns {Record<string, {x0: number, x1: number, y: number}[]>} */
function computedBars({ branches, levels }) {
  const bars = { main: [], isola: [], not_found: [], pending: [] };
  for (const branch of branches) {
    const extent = extentOf(branch.omega);
    if (extent) bars[branch.kind].push({ x0: extent[0], x1: extent[1], y: levels[branch.level].value });
  }
  for (const { windows, value } of levels) {
    for (const { outcome, omega } of windows) if (outcome !== "found") bars[outcome].push({
      x0: omega[0],
      x1: omega[1],
      y: value,
    });
  }
  return bars;
}

function drawComputed(chart, run) {
  for (const [kind, bars] of Object.entries(computedBars(run))) {
    const { colour, dash = [], marker } = MAP_KINDS[kind];
    const width = Math.min(MAP_KINDS[kind].width, Math.max(100 / run.levels.length, 0.5));
    const source = chart.source({
      x0: bars.map(({ x0 }) => x0),
      x1: bars.map(({ x1 }) => x1),
      middle: bars.map(({ x0, x1 }) => (x0 + x1) / 2),
      y: bars.map(({ y }) => y),
    });
    chart.glyph(
      "segment",
      { ...columns("x0", "x1"), y0: { field: "y" }, y1: { field: "y" }, line_width: width, line_dash: dash, source },
      (palette) => ({ line_color: colour(palette) }),
    );
    if (marker) chart.glyph(
      "scatter",
      {
        x: { field: "middle" },
        y: { field: "y" },
        marker: marker === "cross" ? "x" : marker,
        size: 9,
        line_width: 2,
        source,
      },
      (palette) => ({ line_color: colour(palette), fill_color: palette.paper }),
    );
  }
}

function mapLegend(run) {
  const bars = computedBars(run);
  const computed = Object.entries(MAP_KINDS).filter(([kind]) => bars[kind].length > 0);
  return legend([
    { text: "threshold A* along the backbone, bold where A is larger", colour: (palette) => palette.ink },
    { text: "birth", colour: (palette) => palette.third, width: 0, marker: "triangle" },
    { text: "merge", colour: (palette) => palette.alarm, width: 0, marker: "inverted_triangle" },
    ...computed.map(
      ([, { text, colour, width, dash = [], marker }]) => ({ text, colour, width, dash: dash.join(" "), marker }),
    ),
  ]);
}

function drawEvents(chart, events) {
  const kinds = [
    ["birth", "triangle", (palette) => palette.third],
    ["merge", "inverted_triangle", (palette) => palette.alarm],
  ];
  for (const [kind, marker, colour] of kinds) {
    const here = events.filter((event) => event.kind === kind);
    const source = chart.source({ x: here.map(({ omega }) => omega), y: here.map(({ threshold }) => threshold) });
    chart.glyph(
      "scatter",
      { ...columns("x", "y"), marker, size: 12, line_width: 1, source },
      (palette) => ({ fill_color: colour(palette), line_color: palette.paper }),
    );
  }
}

/** The line at A follows a drag that begins on it. */
function dragAmplitude(chart, amplitude) {
  const GRIP = 7; // px
  let dragging = false;
  const position = (event) => event.clientY - chart.box.getBoundingClientRect().top;
  const isOnLine = (event) => {
    const projection = chart.projection();
    return projection !== null && Math.abs(projection.y(amplitude.get()) - position(event)) <= GRIP;
  };
  const valueAtPointer = (event) => {
    const { frame, yAt } = chart.projection();
    return Number(yAt(Math.min(Math.max(position(event), frame.top), frame.bottom)).toPrecision(3));
  };
  chart.box.addEventListener("pointerdown", (event) => {
    if (!isOnLine(event)) return;
    dragging = true;
    chart.box.setPointerCapture(event.pointerId);
    event.stopPropagation(); // Bokeh would zoom.
    event.preventDefault();
  }, true);
  chart.box.addEventListener("pointermove", (event) => {
    chart.box.style.cursor = dragging || isOnLine(event) ? "ns-resize" : "";
    if (!dragging) return;
    event.stopPropagation();
    amplitude.set(valueAtPointer(event));
  }, true);
  for (const end of ["pointerup", "pointercancel"]) chart.box.addEventListener(end, () => (dragging = false), true);
}
