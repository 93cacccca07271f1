/* One period of motion at the selected point: nodes over time, contact pressure, spectrum, and shape of the tip. */

const SHAPE_INSTANTS = 12;
const NODE_DASHES = [[], [7, 3], [2, 2]];

function motionFigure(place, run, { selection }) {
  const { motions } = run;
  if (!motions || motions.points.length === 0) {
    place.append(emptyNote("No motion is stored in this page yet: there is no branch to take one from."));
    return;
  }
  const scene = motionScene(run);
  const heading = element("p", { "aria-live": "polite" });
  const hint = element("p.hint");
  const panels = element("div.panels");
  const samples = scene.nodes.map(({ name, colour, dash }) => ({ text: name, colour, dash: dash.join(" ") }));
  place.append(heading, legend(samples), panels, hint);
  const parts = motionPanels(panels, scene);

  const show = (wanted) => {
    const stored = wanted && nearestMotion(motions, run.branches, wanted);
    heading.textContent = motionInWords(run, wanted, stored);
    const exact = stored?.index === wanted?.index;
    const intro = exact ? "Any other point is drawn by " : "The point selected is drawn by ";
    hint.replaceChildren(...(wanted ? [intro, element("code", {}, plotCommand(run, wanted))] : []));
    if (!stored) return;
    const oscillations = oscillationsOf(motions, decodeColumn(stored.coefficients));
    for (const part of parts) part.show(oscillations);
  };
  selection.listen(show);
  show(selection.get());
}

/** What the panels have in common: nodes with their colour and dash, in their order along the tip. */
function motionScene({ motions, run }) {
  const last = Math.max(motions.nodes.length - 1, 1);
  const nodes = motions.nodes.map((node, k) => ({
    ...node,
    dash: NODE_DASHES[k % NODE_DASHES.length],
    colour: (palette) => rampColour(palette.ramp, k / last),
  }));
  const hasContact = nodes.some(({ gap }) => gap !== null);
  return { nodes, hasContact, runName: run.name, harmonics: motions.harmonics };
}

/** The panels that the model has something for; the others say so. */
function motionPanels(panels, scene) {
  const missing = (title, why) => {
    panels.append(element("div", {}, element("h3", {}, title), emptyNote(why)));
    return [];
  };
  const contact = "This model has no contact: there is no pressure to show.";
  const shape = "One node only: it has no shape beyond its displacement.";
  return [
    displacementPanel(panels, scene),
    ...(scene.hasContact ? [pressurePanel(panels, scene)] : missing("Contact pressure", contact)),
    spectrumPanel(panels, scene),
    ...(scene.nodes.length > 1 ? [shapePanel(panels, scene)] : missing("Shape", shape)),
  ];
}

/** Which motion is shown, and whether it is the one that was asked for. */
function motionInWords(run, wanted, stored) {
  if (!wanted) return "Nothing is selected.";
  if (!stored) return `${pointName(run, wanted)}: its motion is not stored in this page.`;
  const { branch } = wanted;
  const { index } = stored;
  const period = (2 * Math.PI) / branch.omega[index];
  const facts = [
    `${pointName(run, { branch, index })}: ω = ${formatOmega(branch.omega[index])}`,
    `one period lasts ${formatIn(unitFor("s", period), period, 4)}`,
    `amplitude ${formatLength(branch.amplitude[0][index])}.`,
  ];
  const other = index === wanted.index ? "" : ` It is the stored point nearest to the one selected (${wanted.index}).`;
  return facts.join(", ") + other;
}

const pointName = ({ levels }, { branch, index }) =>
  `Point ${index} of ${branch.name}, A = ${levels[branch.level].amplitude}`;

/** How the program draws the motion at any point. */
const plotCommand = ({ levels }, { branch, index }) =>
  `isola plot RUN --figure motion --at "${levels[branch.level].amplitude}/${branch.name}/${index}"`;

/** A panel with one curve a node, over the period. */
function curvesPanel(panels, scene, { title, file, label, x, dimension }) {
  const panel = element("div", {}, element("h3", {}, title));
  panels.append(panel);
  const chart = new Chart(
    panel,
    {
      label: title,
      file: `${scene.runName} ${file}`,
      x,
      y: { label, range: dimension.range ?? [0, 1], type: dimension.type },
    },
  );
  const sources = scene.nodes.map(({ colour, dash }) => {
    const source = chart.source({ x: [], y: [] });
    chart.glyph(
      "line",
      { ...columns("x", "y"), line_width: 2, line_dash: dash, source },
      (palette) => ({ line_color: colour(palette) }),
    );
    return source;
  });
  let curves = [];
  inspectPoints(chart, () => curves, (curve, index) => dimension.describe(curve, index));
  return {
    chart,
    /** @param {{x: Numbers, y: Numbers}[]} next one a node */
    draw(next, yLabel, yRange) {
      curves = next.map((curve, k) => ({ ...curve, node: scene.nodes[k] }));
      sources.forEach((source, k) => (source.data = { x: next[k].x, y: next[k].y }));
      chart.figure.yaxes[0].axis_label = plainText(yLabel);
      chart.show({ y: yRange, home: true });
    },
  };
}

const periodAxis = { label: "time, periods", range: [0, 1] };

function displacementPanel(panels, scene) {
  const gaps = [...new Set(scene.nodes.map(({ gap }) => gap).filter((gap) => gap !== null))];
  let unit = lengthUnit(1);
  const title = scene.hasContact ? "Displacement towards the casing" : "Displacement";
  const describe = ({ node, x, y }, index) => ({
    title: node.name,
    rows: [
      ["time", `${formatNumber(x[index], 3)} periods`],
      ["displacement", `${formatNumber(y[index], 4)} ${unit.name}`],
    ],
  });
  const panel = curvesPanel(
    panels,
    scene,
    { title, file: "displacement", label: "displacement", x: periodAxis, dimension: { describe } },
  );
  const spans = gaps.map(() => panel.chart.span("width", 0, [2, 3]));
  const relabel = keepLabels(
    panel.chart,
    () => gaps.slice(0, 1).map(
      (gap) => ({ text: "casing", x: 1, y: gap * unit.factor, colour: theme.palette.soft, sides: ["aboveEnd"] }),
    ),
  );
  return {
    show(oscillations) {
      const extent = extentOf(...oscillations.map(({ displacement }) => overPeriod(displacement, 1)), gaps);
      unit = lengthUnit(Math.max(...extent.map(Math.abs)));
      const curves = oscillations.map(({ displacement }) => ({ x: PERIOD, y: overPeriod(displacement, unit.factor) }));
      panel.draw(curves, `displacement, ${unit.name}`, withMargin(extent.map((end) => end * unit.factor), 0.1));
      spans.forEach((span, k) => (span.location = gaps[k] * unit.factor));
      relabel();
    },
  };
}

function pressurePanel(panels, scene) {
  let unit = unitFor("N", 1);
  const describe = ({ node, x, y }, index) => ({
    title: node.name,
    rows: [
      ["time", `${formatNumber(x[index], 3)} periods`],
      ["contact force", `${formatNumber(y[index], 4)} ${unit.name}`],
    ],
  });
  const panel = curvesPanel(
    panels,
    scene,
    { title: "Contact pressure", file: "pressure", label: "contact force", x: periodAxis, dimension: { describe } },
  );
  return {
    show(oscillations) {
      const contact = oscillations.map(
        ({ pressure }) => overPeriod(pressure, 1).map((predicted) => Math.max(predicted, 0)),
      );
      const largest = extentOf(...contact)[1];
      unit = unitFor("N", largest || 1);
      panel.draw(
        contact.map((y) => ({ x: PERIOD, y: scaled(y, unit.factor) })),
        `normal force on a node, ${unit.name}`,
        [0, largest > 0 ? largest * unit.factor * 1.1 : 1],
      );
    },
  };
}

function spectrumPanel(panels, scene) {
  let unit = lengthUnit(1);
  const describe = ({ node, x, y }, index) => ({
    title: node.name,
    rows: [["harmonic", String(x[index])], ["size", `${formatNumber(y[index], 3)} ${unit.name}`]],
  });
  const x = { label: "harmonic", range: [-0.4, scene.harmonics + 0.4] };
  const panel = curvesPanel(
    panels,
    scene,
    { title: "Spectrum", file: "spectrum", label: "size", x, dimension: { describe, range: [1e-3, 1], type: "log" } },
  );
  const dots = panel.chart.source({ x: [], y: [], colour: [] });
  panel.chart.glyph(
    "scatter",
    { ...columns("x", "y"), fill_color: { field: "colour" }, line_color: null, size: 6, source: dots },
  );
  let sizes = [];
  const paint = () => {
    const coloured = sizes.flatMap(
      (y, k) => y.map((size, h) => ({ h, size, colour: scene.nodes[k].colour(theme.palette) })),
    );
    dots.data = {
      x: coloured.map(({ h }) => h),
      y: coloured.map(({ size }) => size),
      colour: coloured.map(({ colour }) => colour),
    };
  };
  panel.chart.paint(paint);
  return {
    show(oscillations) {
      const raw = oscillations.map(({ displacement }) => harmonicSizes(displacement));
      const largest = extentOf(...raw)[1] || 1;
      unit = lengthUnit(largest);
      const floor = largest * unit.factor * 1e-6;
      sizes = raw.map((row) => row.map((size) => Math.max(size * unit.factor, floor)));
      const range = withMargin(extentOf(...sizes), 0.06, "log");
      panel.draw(sizes.map((y) => ({ x: y.map((_, h) => h), y })), `|c_k| of the displacement, ${unit.name}`, range);
      paint();
    },
  };
}
