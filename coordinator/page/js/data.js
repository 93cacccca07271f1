/* What the page is given, and its columns of numbers. All SI: rad/s, m, N, J, s. */

/**
 * @typedef {Float32Array|Float64Array} Numbers one number a point; NaN where there is none
 * @typedef {{f8: string}|{f4: string}} Column base64 of little-endian numbers of 64 or 32 bits
 *
 * @typedef {object} Branch forced responses of one level that one continuation connects
 * @property {string} key unique on this page
 * @property {number} level index into the levels
 * @property {"main"|"isola"} kind
 * @property {string} name "main", "isola 1", …
 * @property {boolean} closed
 * @property {number} size number of points
 * @property {Numbers} omega rad/s
 * @property {Numbers[]} amplitude largest |x| over the period, m; one column a monitor
 * @property {Numbers[]} rms m; one column a monitor
 * @property {Numbers} contact share of the period in contact
 * @property {Numbers} residual
 * @property {Numbers} highHarmonics
 * @property {Numbers} iterations
 * @property {{kind: string, index: number}[]} special start, peak, folds
 * @property {number[]} peaks index of the largest amplitude, -1 if there is none; one a monitor
 * @property {[number, number]|null} frequencies lowest and highest
 */

/** @param {string} text base64 @returns {ArrayBuffer} */
function bytesOfBase64(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text).buffer;
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < bytes.length; i++) bytes[i] = binary.charCodeAt(i);
  return bytes.buffer;
}

/** @param {Column|undefined} column @returns {Numbers} */
function decodeColumn(column) {
  if (column?.f8 !== undefined) return new Float64Array(bytesOfBase64(column.f8));
  if (column?.f4 !== undefined) return new Float32Array(bytesOfBase64(column.f4));
  return new Float64Array(0);
}

/**
 * Defines properties that are decoded when first asked for: a large run has millions of numbers, and most are only
 * shown of the one point under the pointer.
 */
function defineLazy(target, decoders) {
  for (const [name, decode] of Object.entries(decoders)) {
    Object.defineProperty(target, name, {
      configurable: true,
      enumerable: true,
      get() {
        const value = decode();
        Object.defineProperty(target, name, { value, enumerable: true });
        return value;
      },
    });
  }
  return target;
}

/** As a list of columns of which each is decoded when first asked for. */
function lazyColumns(columns = []) {
  const decoders = Object.fromEntries(columns.map((column, k) => [k, () => decodeColumn(column)]));
  return defineLazy(new Array(columns.length), decoders);
}

/** @returns {Branch} */
function decodeBranch(raw) {
  const { level, kind, number, name, closed, status, task, worker, seconds, rejections, size } = raw;
  const branch = {
    key: `${level}/${kind}/${number}`,
    level,
    kind,
    number,
    name,
    closed,
    status,
    task,
    worker,
    seconds,
    rejections,
    size,
  };
  branch.special = raw.special ?? [];
  return defineLazy(branch, {
    omega: () => decodeColumn(raw.omega),
    amplitude: () => lazyColumns(raw.amplitude),
    rms: () => lazyColumns(raw.rms),
    contact: () => decodeColumn(raw.contact),
    residual: () => decodeColumn(raw.residual),
    highHarmonics: () => decodeColumn(raw.high_harmonics),
    iterations: () => decodeColumn(raw.iterations),
    peaks: () => lazyPeaks(branch, raw),
    frequencies: () => extentOf(branch.omega),
  });
}

/** The peak of the first monitor is given, of numbers with all their digits; the others are searched when asked for. */
function lazyPeaks(branch, { amplitude = [], peak, size }) {
  const isGiven = Number.isInteger(peak) && peak < size;
  const find = (monitor) => (monitor === 0 && isGiven ? peak : indexOfLargest(branch.amplitude[monitor]));
  return defineLazy([], Object.fromEntries(amplitude.map((_, monitor) => [monitor, () => find(monitor)])));
}

/** The backbone with its columns decoded; `needed` is what the forcing has to supply a period. */
function decodeBackbone(raw) {
  if (!raw) return null;
  const { mode, status, events, peaks } = raw;
  const backbone = { mode, status, events, peaks };
  defineLazy(backbone, {
    omega: () => decodeColumn(raw.omega),
    decay: () => decodeColumn(raw.decay),
    amplitude: () => lazyColumns(raw.amplitude),
    contact: () => decodeColumn(raw.contact),
    linear: () => decodeColumn(raw.r_lin),
    nonlinear: () => decodeColumn(raw.r_nl),
    needed: () => (raw.needed ? decodeColumn(raw.needed) : lossesOf(backbone)),
    work: () => decodeColumn(raw.work),
    threshold: () => decodeColumn(raw.threshold),
    certificate: () => decodeColumn(raw.certificate),
    arc: () => decodeColumn(raw.arc),
    modes: () => raw.modes.map((m) => ({ mode: m.mode, frequency: m.frequency, share: decodeColumn(m.share) })),
  });
  return backbone;
}

/** |R_lin + R_nl|: what the balance asks for where it is not told. */
const lossesOf = ({ linear, nonlinear }) => Float64Array.from(linear, (work, i) => Math.abs(work + nonlinear[i]));

/** @param {object} raw the JSON of the page, or the part of it that a live page is given */
function decodeRun(raw) {
  return {
    ...raw,
    branches: (raw.branches ?? []).map(decodeBranch),
    backbone: decodeBackbone(raw.backbone),
  };
}

/** Index of the largest number, -1 if there is none. */
function indexOfLargest(numbers) {
  let best = -1;
  for (let i = 0; i < numbers.length; i++) {
    if (best < 0 ? !Number.isNaN(numbers[i]) : numbers[i] > numbers[best]) best = i;
  }
  return best;
}

/** Smallest and largest finite number of several columns; null if there is none. @returns {[number, number]|null} */
function extentOf(...columns) {
  let low = Infinity;
  let high = -Infinity;
  for (const column of columns) {
    for (const number of column) {
      if (!Number.isFinite(number)) continue;
      if (number < low) low = number;
      if (number > high) high = number;
    }
  }
  return low <= high ? [low, high] : null;
}

/** Column times a factor, in double precision: what a chart in mm needs of a column in m. */
function scaled(column, factor) {
  return Float64Array.from(column, (number) => number * factor);
}

/** A value that several figures share, e.g. the forcing amplitude looked at. */
function shared(value) {
  const listeners = [];
  return {
    get: () => value,
    set(next, from = null) {
      value = next;
      for (const listener of listeners) listener(next, from);
    },
    listen: (listener) => listeners.push(listener),
  };
}
