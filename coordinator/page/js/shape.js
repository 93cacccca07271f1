/* Shape of the blade's tip at instants of the period; a slider, or playing, moves one of them. */

const PLAY_SECONDS = 4; // a period takes so long on the screen

function shapePanel(panels, scene) {
  const { nodes } = scene;
  const panel = element("div", {}, element("h3", {}, "Shape at instants of the period"));
  panels.append(panel);
  const chart = new Chart(panel, {
    label: "Shape of the tip at instants of the period",
    file: `${scene.runName} shape`,
    x: { label: "node", range: [-0.3, nodes.length - 0.7] },
    y: { label: "displacement", range: [0, 1] },
  });
  nameTicks(chart.figure.xaxes[0], nodes);
  const x = nodes.map((_, k) => k);
  const still = chart.source({ xs: [], ys: [] });
  const moving = chart.source({ x, y: x.map(() => NaN) });
  const casing = chart.source({ x0: [], x1: [], y: [] });
  const at = columns("x", "y");
  chart.glyph(
    "multi_line",
    { ...columns("xs", "ys"), line_width: 1.2, source: still },
    (palette) => ({ line_color: palette.shade }),
  );
  chart.glyph(
    "segment",
    { ...columns("x0", "x1"), y0: { field: "y" }, y1: { field: "y" }, line_width: 3, source: casing },
    (palette) => ({ line_color: palette.soft }),
  );
  chart.glyph(
    "line",
    { ...at, line_width: 3, source: moving, level: "overlay" },
    (palette) => ({ line_color: palette.second }),
  );
  chart.glyph(
    "scatter",
    { ...at, size: 8, source: moving, level: "overlay" },
    (palette) => ({ fill_color: palette.second, line_color: palette.paper }),
  );

  let oscillations = [];
  let unit = lengthUnit(1);
  const relabel = keepLabels(
    chart,
    () => nodes.slice(0, 1).map(({ gap }) => ({
      text: "casing",
      x: -0.3,
      y: (gap ?? NaN) * unit.factor,
      colour: theme.palette.soft,
      sides: ["aboveStart"],
    })),
  );
  const shapeAt = (share) => oscillations.map(
    ({ displacement }) => unit.factor * seriesAt(displacement, 2 * Math.PI * share),
  );
  const time = timeControl((share) => (moving.data = { x, y: shapeAt(share) }));
  panel.append(time.element);
  return {
    show(next) {
      oscillations = next;
      const extent = extentOf(
        ...next.map(({ displacement }) => overPeriod(displacement, 1)),
        nodes.map(({ gap }) => gap ?? NaN),
      );
      unit = lengthUnit(Math.max(...extent.map(Math.abs)));
      chart.figure.yaxes[0].axis_label = plainText(`displacement, ${unit.name}`);
      chart.show({ y: withMargin(extent.map((end) => end * unit.factor), 0.1), home: true });
      const instants = Array.from({ length: SHAPE_INSTANTS }, (_, k) => k / SHAPE_INSTANTS);
      still.data = { xs: instants.map(() => x), ys: instants.map(shapeAt) };
      const touching = nodes.map((node, k) => ({ ...node, k })).filter(({ gap }) => gap !== null);
      casing.data = {
        x0: touching.map(({ k }) => k - 0.5),
        x1: touching.map(({ k }) => k + 0.5),
        y: touching.map(({ gap }) => gap * unit.factor),
      };
      time.refresh();
      relabel();
    },
  };
}

/** Names of the nodes under the axis, not more than fit. */
function nameTicks(axis, nodes) {
  const step = Math.ceil(nodes.length / 10);
  const ticks = nodes.map((_, k) => k).filter((k) => k % step === 0);
  axis.ticker = new Bokeh.FixedTicker({ ticks, minor_ticks: [] });
  axis.major_label_overrides = new Map(ticks.map((k) => [k, plainText(nodes[k].name)]));
}

/** Slider and play button. @param {(share: number) => void} moved share of the period */
function timeControl(moved) {
  let playing = null;
  const slider = element(
    "input",
    { type: "range", class: "wide", min: 0, max: 1, step: 0.005, value: 0, "aria-label": "Time within the period" },
  );
  const readout = element("output");
  const refresh = () => {
    readout.textContent = `${Number(slider.value).toFixed(2)} periods`;
    moved(Number(slider.value));
  };
  const step = (now) => {
    if (playing === null) return;
    slider.value = (playing.from + (now - playing.since) / 1000 / PLAY_SECONDS) % 1;
    refresh();
    requestAnimationFrame(step);
  };
  const play = button("Play", () => {
    playing = playing === null ? { from: Number(slider.value), since: performance.now() } : null;
    play.textContent = playing === null ? "Play" : "Pause";
    if (playing !== null) requestAnimationFrame(step);
  });
  slider.addEventListener("input", refresh);
  return { element: element("div.controls", {}, play, slider, readout), refresh };
}
