/* Modal contributions along the backbone. */

const MODE_DASHES = [[], [8, 4], [2, 3], [10, 3, 2, 3], [5, 3], [1, 3], [14, 4]];
const SMALLEST_SHARE = 1e-6;

/** The mode followed in ink, the others in colours; dashes differ throughout. */
function modeColour(k, palette) {
  return [
    palette.ink,
    palette.second,
    palette.first,
    palette.third,
    palette.fourth,
    palette.alarm,
    palette.soft,
  ][k % 7];
}

/** "mode 3 at 4ω (ω₃ = 1.003 · 4ω)" in resonance, else "mode 3, mostly at ω" */
function peakInWords({ mode, harmonic, ratio, resonant }) {
  const subscript = String(mode + 1).replace(/\d/g, (digit) => "₀₁₂₃₄₅₆₇₈₉"[digit]);
  const multiple = harmonic === 1 ? "ω" : `${harmonic}ω`;
  if (!resonant) return `mode ${mode + 1}, mostly at ${multiple}`;
  return `mode ${mode + 1} at ${multiple} (ω${subscript} = ${formatNumber(ratio, 4)} · ${multiple})`;
}

function modesFigure(place, run) {
  const { backbone } = run;
  if (!backbone || backbone.modes.length === 0) {
    place.append(emptyNote("The backbone is not there yet: the shares of the modes along it will be shown here."));
    return;
  }
  const unit = lengthUnit(extentOf(backbone.amplitude[0])?.[1] ?? 0);
  const shares = backbone.modes.map(
    ({ share }) => Float64Array.from(share, (number) => Math.max(number, SMALLEST_SHARE)),
  );
  const smallest = Math.max(
    Math.min(...shares.slice(1).map((share) => extentOf(share)?.[1] ?? 1), 0.01) / 300,
    SMALLEST_SHARE,
  );
  let axis = backboneAxis(backbone, "arc", unit);
  place.append(
    element("div.controls", {}, choice("Over", BACKBONE_AXES, "arc", (name) => over(name))),
    legend(backbone.modes.map(({ mode, frequency }, k) => ({
      text: `mode ${mode + 1}, ${formatOmega(frequency)}${k === 0 ? " (followed)" : ""}`,
      colour: (palette) => modeColour(k, palette),
      dash: MODE_DASHES[k % 7].join(" "),
      width: 2.2,
    }))),
  );
  const chart = new Chart(place, {
    label: "Share of each mode along the backbone",
    file: `${run.run.name} modes`,
    x: { label: axis.label, range: withMargin(extentOf(axis.column), 0.02) },
    y: { label: "share of the motion", range: [smallest, 2], type: "log" },
  });
  const curves = shares.map((y, k) => ({ x: axis.column, y, k }));
  const sources = shares.map((share, k) => {
    const source = chart.source({ x: axis.column, y: share });
    chart.glyph(
      "line",
      { ...columns("x", "y"), line_width: 2.2, line_dash: MODE_DASHES[k % 7], source },
      (palette) => ({ line_color: modeColour(k, palette) }),
    );
    return source;
  });
  const peaks = backbone.peaks.toSorted((a, b) => b.share - a.share);
  const modeOf = (peak) => backbone.modes.findIndex(({ mode }) => mode === peak.mode);
  const marks = chart.source({ x: [], y: [] });
  chart.glyph(
    "scatter",
    { ...columns("x", "y"), size: 7, line_width: 1.5, source: marks },
    (palette) => ({ line_color: palette.ink, fill_color: palette.paper }),
  );
  const relabel = keepLabels(
    chart,
    () => peaks.map((peak) => ({
      text: peakInWords(peak),
      x: axis.column[peak.index],
      y: peak.share,
      colour: modeColour(modeOf(peak), theme.palette),
      sides: ["above", "aboveEnd", "aboveStart", "below"],
    })),
    () => curves,
  );
  const markPeaks = () => (marks.data = {
    x: peaks.map(({ index }) => axis.column[index]),
    y: peaks.map(({ share }) => share),
  });
  markPeaks();
  const over = (name) => {
    axis = backboneAxis(backbone, name, unit);
    chart.figure.xaxes[0].axis_label = plainText(axis.label);
    chart.show({ x: withMargin(extentOf(axis.column), 0.02), home: true });
    sources.forEach((source, k) => (source.data = { x: axis.column, y: shares[k] }));
    for (const curve of curves) curve.x = axis.column;
    markPeaks();
    relabel();
  };
  inspectPoints(chart, () => curves, ({ k }, index) => {
    const { mode, frequency, share } = backbone.modes[k];
    return {
      title: `Mode ${mode + 1}, backbone point ${index}`,
      rows: [
        ["share", formatNumber(share[index], 3)],
        ["frequency", `${formatOmega(backbone.omega[index])} = ${formatHertz(backbone.omega[index])}`],
        [`ω of mode ${mode + 1} over ω`, formatNumber(frequency / backbone.omega[index], 4)],
        ["amplitude", formatLength(backbone.amplitude[0][index])],
      ],
    };
  });
}
