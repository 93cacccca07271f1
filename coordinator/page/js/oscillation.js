/* Periodic motions from their harmonics: x(τ) = c0 + Σ a_k cos kτ + b_k sin kτ with τ = ωt. */

/** Instants of a period that curves are drawn with. */
const INSTANTS = 240;

/**
 * @typedef {object} Oscillation of one node
 * @property {Numbers} displacement c0, a1, b1, a2, b2, …; towards the casing, m
 * @property {Numbers} pressure the predicted one, of which the positive part is the contact pressure, N
 */

/** @param {{harmonics: number, nodes: object[]}} motions @param {Numbers} coefficients @returns {Oscillation[]} */
function oscillationsOf({ harmonics, nodes }, coefficients) {
  const length = 2 * harmonics + 1;
  return nodes.map((_, n) => ({
    displacement: coefficients.subarray(2 * n * length, (2 * n + 1) * length),
    pressure: coefficients.subarray((2 * n + 1) * length, (2 * n + 2) * length),
  }));
}

/** @param {Numbers} series @param {number} phase τ */
function seriesAt(series, phase) {
  let sum = series[0];
  for (let k = 1; 2 * k < series.length; k++) {
    sum += series[2 * k - 1] * Math.cos(k * phase) + series[2 * k] * Math.sin(k * phase);
  }
  return sum;
}

/** Shares of the period at which curves are drawn, both ends included. */
const PERIOD = Float64Array.from({ length: INSTANTS + 1 }, (_, i) => i / INSTANTS);

/** @returns {Float64Array} the series at the instants of PERIOD, times a factor */
const overPeriod = (series, factor) => PERIOD.map((share) => factor * seriesAt(series, 2 * Math.PI * share));

/** Size of each harmonic, from 0. */
function harmonicSizes(series) {
  const sizes = [Math.abs(series[0])];
  for (let k = 1; 2 * k < series.length; k++) sizes.push(Math.hypot(series[2 * k - 1], series[2 * k]));
  return sizes;
}

/** The stored point nearest to a point of a branch; null if none of this branch is stored. */
function nearestMotion({ points }, branches, { branch, index }) {
  const at = branches.indexOf(branch);
  const stored = points.filter((point) => point.branch === at);
  if (stored.length === 0) return null;
  return stored.reduce((best, point) => (Math.abs(point.index - index) < Math.abs(best.index - index) ? point : best));
}
