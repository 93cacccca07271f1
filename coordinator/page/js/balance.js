/* Energy balance along the backbone at one forcing amplitude, and where on the backbone its windows lie. */

function balanceFigure(place, run, { amplitude }) {
  if (!run.backbone) {
    place.append(emptyNote("The backbone is not there yet: its energies will be shown here."));
    return;
  }
  const words = element("div", { "aria-live": "polite" });
  const controls = element("div.controls", {}, ...amplitudeControls(run, amplitude));
  const panels = element("div.panels");
  place.append(controls, panels, words);
  const energies = energyPanel(panels, run);
  const windows = windowPanel(panels, run);
  controls.append(choice("Over", BACKBONE_AXES, "arc", (name) => energies.over(name)));
  const follow = (value) => {
    energies.at(value);
    windows.at(value);
    words.replaceChildren(...predictionInWords(run, value));
  };
  follow(amplitude.get());
  amplitude.listen(follow);
  theme.listeners.push(() => follow(amplitude.get()));
}

/** What is dissipated against what is supplied, over a place on the backbone. */
function energyPanel(panels, run) {
  const { backbone } = run;
  const lengths = lengthUnit(extentOf(backbone.amplitude[0])?.[1] ?? 0);
  const energies = unitFor("J", extentOf(backbone.needed)?.[1] ?? 0);
  const needed = scaled(backbone.needed, energies.factor);
  const positive = extentOf(needed.filter((energy) => energy > 0));
  const type = spansDecades(positive) ? "log" : "linear";
  const range =
    type === "log"
      ? withMargin([Math.max(positive[0], positive[1] * 1e-6), positive[1]], 0.06, "log")
      : [0, (positive?.[1] ?? 1) * 1.08];
  let axis = backboneAxis(backbone, "arc", lengths);
  const curve = { x: axis.column, y: needed };
  let forcing = 0;

  const panel = element("div");
  panels.append(panel);
  panel.append(
    element("h3", {}, "Energy per period"),
    legend([
      { text: "to be supplied, A*·W", colour: (palette) => palette.ink },
      { text: "supplied, A·W", colour: (palette) => palette.first, dash: "7 4" },
      { text: "supply is larger: window", colour: (palette) => palette.second, width: 0, marker: "patch" },
    ]),
  );
  const chart = new Chart(panel, {
    label: "Energy balance along the backbone",
    file: `${run.run.name} energy balance`,
    x: { label: axis.label, range: withMargin(extentOf(axis.column), 0.02) },
    y: { label: `energy per period, ${energies.name}`, range, type },
  });
  const wells = chart.source({ xs: [], ys: [], colour: [] });
  const lines = chart.source({ x: [], needed: [], supplied: [] });
  chart.glyph(
    "patches",
    { ...columns("xs", "ys"), fill_color: { field: "colour" }, fill_alpha: 0.3, line_color: null, source: wells },
  );
  chart.glyph(
    "line",
    { x: { field: "x" }, y: { field: "needed" }, line_width: 2, source: lines },
    (palette) => ({ line_color: palette.ink }),
  );
  chart.glyph(
    "line",
    { x: { field: "x" }, y: { field: "supplied" }, line_width: 2, line_dash: [7, 4], source: lines },
    (palette) => ({ line_color: palette.first }),
  );
  let runs = [];
  const relabel = keepLabels(chart, () =>
    runs.map((window, k) => ({
      text: window.fromStart ? `${k + 1}: ${mainInWords(run, forcing, window)}` : `${k + 1}`,
      x: valueAt(axis.column, window.best),
      y: energies.factor * forcing * Math.abs(valueAt(backbone.work, window.best)),
      colour: runColours(runs, theme.palette)[k],
    })),
    () => [curve],
  );

  const draw = () => {
    const supplied = Float64Array.from(backbone.work, (work) => energies.factor * forcing * Math.abs(work));
    runs = runsBelow(backbone.threshold, forcing);
    lines.data = { x: axis.column, needed, supplied };
    wells.data = {
      xs: runs.map((window) => [...alongRun(axis.column, window), ...alongRun(axis.column, window).reverse()]),
      ys: runs.map(
        (window) => [
          ...alongRun(needed, window),
          ...alongRun(supplied, window).reverse(),
        ].map((y) => (type === "log" ? Math.max(y, range[0] * 1e-3) : y)),
      ),
      colour: runColours(runs, theme.palette),
    };
    relabel();
  };
  inspectPoints(chart, () => [curve], (_, index) => describeBackbonePoint(backbone, index, forcing));
  return {
    at(value) {
      forcing = value;
      draw();
    },
    over(name) {
      axis = backboneAxis(backbone, name, lengths);
      curve.x = axis.column;
      chart.figure.xaxes[0].axis_label = plainText(axis.label);
      chart.show({ x: withMargin(extentOf(axis.column), 0.02), home: true });
      draw();
    },
  };
}

/** The backbone with the windows of this amplitude in colour. */
function windowPanel(panels, run) {
  const { backbone } = run;
  const unit = lengthUnit(extentOf(backbone.amplitude[0])?.[1] ?? 0);
  const y = scaled(backbone.amplitude[0], unit.factor);
  const panel = element("div");
  panels.append(panel);
  panel.append(
    element("h3", {}, "Where that is on the backbone"),
    legend([
      { text: "backbone", colour: (palette) => palette.soft, width: 1.3 },
      { text: "window from its start", colour: (palette) => palette.first, width: 5 },
      { text: "separate windows", colour: (palette) => palette.second, width: 5 },
    ]),
  );
  const chart = new Chart(panel, {
    label: "Backbone with the windows of the chosen forcing amplitude",
    file: `${run.run.name} windows`,
    x: { label: "frequency ω, rad/s", range: withMargin(extentOf(backbone.omega)) },
    y: { label: `amplitude of ${run.monitors[0].name}, ${unit.name}`, range: [0, (extentOf(y)?.[1] || 1) * 1.08] },
  });
  const whole = chart.source({ x: backbone.omega, y });
  const parts = chart.source({ xs: [], ys: [], colour: [] });
  chart.glyph(
    "line",
    { ...columns("x", "y"), line_width: 1.3, source: whole },
    (palette) => ({ line_color: palette.soft }),
  );
  chart.glyph(
    "multi_line",
    { ...columns("xs", "ys"), line_color: { field: "colour" }, line_width: 5, line_cap: "round", source: parts },
  );
  const curves = [{ x: backbone.omega, y }];
  let runs = [];
  let forcing = 0;
  const nameOf = (window) =>
    window.fromStart ? mainInWords(run, forcing, window) : `from A* = ${formatNumber(window.threshold, 3)}`;
  const relabel = keepLabels(chart, () =>
    runs.map((window, k) => ({
      text: `${k + 1}: ${nameOf(window)}`,
      x: valueAt(backbone.omega, (window.first + window.last) / 2),
      y: valueAt(y, (window.first + window.last) / 2),
      colour: runColours(runs, theme.palette)[k],
    })),
    () => curves,
  );
  inspectPoints(chart, () => curves, (_, index) => describeBackbonePoint(backbone, index, forcing));
  return {
    at(value) {
      forcing = value;
      runs = runsBelow(backbone.threshold, forcing);
      parts.data = {
        xs: runs.map((window) => alongRun(backbone.omega, window)),
        ys: runs.map((window) => alongRun(y, window)),
        colour: runColours(runs, theme.palette),
      };
      relabel();
    },
  };
}

/** All that is known of a point of the backbone, at a forcing amplitude. @returns {Description} */
function describeBackbonePoint(backbone, index, forcing) {
  const energy = (value) => formatIn(unitFor("J", Math.abs(value)), value, 4);
  return {
    title: `Backbone, point ${index}`,
    rows: [
      ["frequency", `${formatOmega(backbone.omega[index])} = ${formatHertz(backbone.omega[index])}`],
      ["amplitude", formatLength(backbone.amplitude[0][index])],
      ["threshold A*", formatNumber(backbone.threshold[index], 4)],
      ["R_lin", energy(backbone.linear[index])],
      ["R_nl", energy(backbone.nonlinear[index])],
      ["to be supplied", energy(backbone.needed[index])],
      [`A·W at A = ${formatNumber(forcing, 4)}`, energy(forcing * backbone.work[index])],
      ["decay rate", `${formatNumber(backbone.decay[index], 4)} 1/s`],
      ["in contact", formatShare(backbone.contact[index] ?? NaN)],
      ["energy certificate", formatNumber(backbone.certificate[index], 2)],
    ],
  };
}
