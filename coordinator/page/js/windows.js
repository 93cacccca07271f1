/* Windows: runs of the backbone along which a forcing amplitude A lies above the threshold A*, i.e. A·W is more than
 * has to be supplied. There, forced responses are predicted. */

/**
 * @typedef {object} Run
 * @property {number} first place on the backbone where it begins; between points, a fraction
 * @property {number} last
 * @property {number} best point of smallest threshold
 * @property {number} threshold that threshold: the run is born at this amplitude
 * @property {boolean} fromStart whether it begins where the backbone does, in the linear range
 */

/** @param {Numbers} threshold A* along the backbone @returns {Run[]} */
function runsBelow(threshold, amplitude) {
  const runs = [];
  let run = null;
  for (let i = 0; i < threshold.length; i++) {
    if (threshold[i] < amplitude) {
      if (!run) runs.push(
        (run = { first: i === 0 ? 0 : crossing(threshold, i - 1, amplitude), last: i, best: i, fromStart: i === 0 }),
      );
      if (threshold[i] < threshold[run.best]) run.best = i;
      run.last = i;
    } else if (run) {
      run.last = crossing(threshold, i - 1, amplitude);
      run = null;
    }
  }
  return runs.map((found) => ({ ...found, threshold: threshold[found.best] }));
}

/** Where between points `i` and `i + 1` the threshold passes the amplitude, its logarithm taken as straight. */
function crossing(threshold, i, amplitude) {
  const [a, b] = [Math.log(threshold[i]), Math.log(threshold[i + 1])];
  const share = (Math.log(amplitude) - a) / (b - a);
  return i + (Number.isFinite(share) ? Math.min(Math.max(share, 0), 1) : 0.5);
}

/** A column at a place between its points. */
function valueAt(column, place) {
  const i = Math.min(Math.floor(place), column.length - 1);
  if (i === place || i + 1 >= column.length) return column[i];
  return column[i] + (column[i + 1] - column[i]) * (place - i);
}

/** A column along a run, both ends included. @returns {number[]} */
function alongRun(column, { first, last }) {
  const values = [valueAt(column, first)];
  for (let i = Math.floor(first) + 1; i < last; i++) values.push(column[i]);
  if (last > first) values.push(valueAt(column, last));
  return values;
}

/** What the backbone can be drawn over. */
const BACKBONE_AXES = [
  ["arc", "arc length"],
  ["omega", "frequency"],
  ["amplitude", "amplitude"],
];

/** Column and label of one of these axes. @param {Unit} unit of lengths */
function backboneAxis(backbone, name, unit) {
  if (name === "omega") return { column: backbone.omega, label: "frequency ω, rad/s" };
  if (name === "amplitude") return {
    column: scaled(backbone.amplitude[0], unit.factor),
    label: `amplitude, ${unit.name}`,
  };
  return { column: backbone.arc, label: "arc length along the backbone (scaled)" };
}

/** Lowest and highest frequency along a run. */
const frequencyRange = (backbone, run) => extentOf(alongRun(backbone.omega, run));

/** What a level computed of a run: the window that holds the run's best point. */
const windowOfRun = (level, run) => level?.windows.find(
  (window) => window.first <= run.best && run.best <= window.last,
) ?? null;

/** Colours of runs: that from the start, if there is one, and the separate ones in turn. @param {Run[]} runs */
function runColours(runs, palette) {
  const inTurn = [palette.second, palette.third, palette.fourth];
  let separate = 0;
  return runs.map(({ fromStart }) => (fromStart ? palette.first : inTurn[separate++ % 3]));
}

/** Names the run from the start after the main branch: for certain only if that was computed there. */
function mainInWords({ levels }, amplitude, run) {
  const window = windowOfRun(levels.find(({ value }) => value === amplitude), run);
  const isComputed = window?.outcome === "found" && window.branches.split("; ").includes("main");
  return isComputed ? "main branch" : "main branch, as a rule";
}

/**
 * What is predicted at a forcing amplitude and, if it is a level of the run, what was found there.
 * @returns {string[]} a sentence a window
 */
function windowsInWords(run, amplitude) {
  const { backbone, levels } = run;
  const level = levels.find(({ value }) => value === amplitude);
  return runsBelow(backbone.threshold, amplitude).map((window, k) => {
    const range = formatRange(frequencyRange(backbone, window));
    const where = `Window ${k + 1}: ${range} rad/s, born at A* = ${formatNumber(window.threshold, 4)}`;
    const which = window.fromStart
      ? `begins where the backbone does: ${mainInWords(run, amplitude, window)}`
      : "separate: an isola, unless the main branch reaches it";
    return `${where}; ${which}.${outcomeInWords(level, windowOfRun(level, window))}`;
  });
}

function outcomeInWords(level, window) {
  if (!level) return "";
  if (!window) return " Not among the windows of this level.";
  if (window.outcome === "found") return ` Computed: ${window.branches}.`;
  if (window.outcome === "pending") return " Not computed yet.";
  return ` Computed, not found: ${window.reason}.`;
}

/** What the balance predicts at a forcing amplitude: a sentence, and a list of windows. @returns {Element[]} */
function predictionInWords(run, amplitude) {
  const sentences = windowsInWords(run, amplitude);
  const isLevel = run.levels.some(({ value }) => value === amplitude);
  const where = `At A = ${formatNumber(amplitude, 4)}${isLevel ? "" : " (not a level of this run)"}`;
  const many = sentences.length > 0;
  const what = many ? `${countOf(sentences.length, "window")}:` : "no forced response on this backbone.";
  return [
    element("p", {}, `${where} the balance predicts ${what}`),
    element("ul.words", {}, ...sentences.map((sentence) => element("li", {}, sentence))),
  ];
}
