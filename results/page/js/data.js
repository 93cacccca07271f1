/* What the page is given: figures as data, and columns of numbers that they refer to. All SI: rad/s, m, N, J, s. */

/**
 * @typedef {Float32Array|Float64Array} Numbers one number a point; NaN where there is none
 * @typedef {{f8: string}|{f4: string}} Column base64 of little-endian numbers of 64 or 32 bits
 * @typedef {(index: number) => Numbers} Columns
 *
 * @typedef {object} Ref numbers that something is drawn with
 * @property {number} column
 * @property {number[]} [at] only these places of the column
 * @property {boolean} [by_amplitude] times the forcing amplitude looked at
 *
 * @typedef {object} Frame what depends on the forcing amplitude looked at
 * @property {number} amplitude
 * @property {string} name
 * @property {number} [level] index of the level that it is, if it is one
 * @property {Run[]} [runs]
 * @property {string} words what is predicted
 * @property {(string|object)[][]} [sentences] one a run
 *
 * @typedef {object} Run a part of the backbone on which forced responses are predicted
 * @property {number} first place on the backbone where it begins; between points, a fraction
 * @property {number} last
 * @property {number} best point of smallest threshold
 * @property {string} name
 * @property {Colour} color
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
 * Columns that are decoded when first asked for: a large run has millions of numbers, and most are only shown of the
 * one point under the pointer.
 * @param {Column[]} list @param {number} first number of the first one
 * @returns {Columns}
 */
function lazyColumns(list, first = 0) {
  const decoded = [];
  return (index) => (decoded[index] ??= decodeColumn(list[index - first]));
}

/** Index of the largest number, -1 if there is none. */
function indexOfLargest(numbers) {
  let best = -1;
  for (let i = 0; i < numbers.length; i++) {
    if (best < 0 ? !Number.isNaN(numbers[i]) : numbers[i] > numbers[best]) best = i;
  }
  return best;
}

/** Column times a factor, in double precision: what a chart in mm needs of a column in m. */
const scaled = (column, factor) => (factor === 1 ? column : Float64Array.from(column, (number) => number * factor));

/** The item of a list that has one for all options of a figure, or one for each. */
const ofOption = (list, option) => list[Math.min(option, list.length - 1)];

/** A value that several figures share, e.g. the forcing amplitude looked at. */
function shared(value) {
  const listeners = [];
  return {
    get: () => value,
    set(next) {
      value = next;
      for (const listener of listeners) listener(next);
    },
    listen: (listener) => listeners.push(listener),
  };
}
