/* Periodic motions from their harmonics: x(τ) = c0 + Σ a_k cos kτ + b_k sin kτ with τ = ωt. */

/**
 * @typedef {object} Signal of the motion shown
 * @property {"displacement"|"pressure"|"spectrum"|"shape"|"shapes"|"gap"} of
 * @property {number} [node]
 * @property {number} [instants] of the period, for shapes
 */

/** Harmonics below this share of the largest are left out. */
const SMALLEST_HARMONIC = 1e-6;

/** Shares of the period at which curves are drawn, both ends included. */
const PERIOD = Float64Array.from({ length: 241 }, (_, i) => i / 240);

/** @param {Numbers} series c0, a1, b1, a2, … @param {number} share of the period */
function seriesAt(series, share) {
  const phase = 2 * Math.PI * share;
  let sum = series[0];
  for (let k = 1; 2 * k < series.length; k++) {
    sum += series[2 * k - 1] * Math.cos(k * phase) + series[2 * k] * Math.sin(k * phase);
  }
  return sum;
}

/** Size of each harmonic, from 0. */
function harmonicSizes(series) {
  const sizes = [Math.abs(series[0])];
  for (let k = 1; 2 * k < series.length; k++) sizes.push(Math.hypot(series[2 * k - 1], series[2 * k]));
  return sizes;
}

/** @param {Series} series @param {View} view @returns {{x: Numbers, y: Numbers}} SI */
function signalCurve({ signal: { of, node, instants } }, { motion, time }) {
  if (!motion) return { x: [], y: [] };
  const { displacement, pressure, gaps, along } = motion;
  const places = along.map((_, k) => k + 1);
  const shape = (share) => along.map((series) => seriesAt(series, share));
  switch (of) {
    case "displacement":
      return { x: PERIOD, y: PERIOD.map((share) => seriesAt(displacement[node], share)) };
    case "pressure":
      return { x: PERIOD, y: PERIOD.map((share) => Math.max(seriesAt(pressure[node], share), 0)) };
    case "spectrum": {
      const floor = SMALLEST_HARMONIC * motion.largest;
      const sizes = harmonicSizes(displacement[node]);
      return { x: sizes.map((_, k) => k), y: sizes.map((size) => (size >= floor ? size : NaN)) };
    }
    case "gap":
      return { x: places, y: gaps.slice(0, along.length) };
    case "shape":
      return { x: places, y: shape(time) };
    case "shapes": {
      // One after another, with a gap between them.
      const shapes = Array.from({ length: instants }, (_, k) => [...shape(k / instants), NaN]);
      return { x: shapes.flatMap(() => [...places, NaN]), y: shapes.flat() };
    }
    default:
      return { x: [], y: [] };
  }
}
