/* Numbers and units as people read them. */

const NOT_KNOWN = "–";

/** A number with `digits` significant digits; powers of ten only where plain digits would be unreadable. */
function formatNumber(value, digits = 5) {
  if (value === null || value === undefined || Number.isNaN(value)) return NOT_KNOWN;
  if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
  if (value === 0) return "0";
  const size = Math.abs(value);
  const text = size < 1e-3 || size >= 1e7 ? value.toExponential(digits - 1).replace(/\.?0+e/, "e") : String(
    Number(value.toPrecision(digits)),
  );
  return text.replace("-", "−").replace("e+", "e");
}

/** As the program writes it: with `digits` significant digits, and those before the point as they are. */
function formatDigits(value, digits) {
  return Math.abs(value) < 10 ** digits ? formatNumber(value, digits) : value.toFixed(0).replace("-", "−");
}

const PREFIXES = [["M", 1e-6], ["k", 1e-3], ["", 1], ["m", 1e3], ["µ", 1e6], ["n", 1e9]];

/** The unit in which `size` has one to three digits before the point, from the prefix `from` downwards. */
function unitFor(base, size, from = "M") {
  const fitting = PREFIXES.slice(PREFIXES.findIndex(([prefix]) => prefix === from));
  const found = fitting.find(([, factor]) => size * factor >= 0.5) ?? (size > 0 ? fitting.at(-1) : ["", 1]);
  return { name: found[0] + base, factor: found[1] };
}

/** The unit of all lengths, if the run has one. */
const chosenLength = { unit: null };

/** Lengths stay at m or below: nobody measures vibration in km. */
const lengthUnit = (size) => chosenLength.unit ?? unitFor("m", size, "");

const formatIn = ({ name, factor }, value, digits) => `${formatNumber(value * factor, digits)} ${name}`;

/** How quantities are written, by name. */
const FORMATS = {
  length: (value, digits) => formatIn(lengthUnit(Math.abs(value)), value, digits),
  energy: (value, digits) => formatIn(unitFor("J", Math.abs(value)), value, digits),
  frequency: (value, digits) => frequencyInWords(value, digits),
  share: (value, digits) => `${formatNumber(100 * value, digits)} %`,
  rate: (value, digits) => `${formatNumber(value, digits)} 1/s`,
  number: formatNumber,
  count: (value) => formatNumber(value, 9),
};

/** In the unit chosen, and in another one. @param {number} value rad/s */
function frequencyInWords(value, digits) {
  const chosen = frequencyUnit.get();
  const written = (name) => formatIn(FREQUENCY_UNITS[name], value, digits);
  return `${written(chosen)} = ${written(chosen === "Hz" ? "rad/s" : "Hz")}`;
}

/** @param {string} format key of FORMATS @param {number|undefined} value SI @param {string} [unit] that FORMATS lack */
function formatQuantity(format, value, digits = 5, unit = "") {
  if (value === null || value === undefined || Number.isNaN(value)) return NOT_KNOWN;
  const text = (FORMATS[format] ?? formatNumber)(value, digits);
  return unit ? `${text} ${unit}` : text;
}

const formatRange = ([low, high]) => `${formatNumber(low)} to ${formatNumber(high)}`;

/** 12:03 on 21 November 2026, where the reader is. */
function formatTime(rfc3339) {
  const time = new Date(rfc3339);
  return Number.isNaN(time.getTime()) ? String(rfc3339) : time.toLocaleString(
    "en-GB",
    { dateStyle: "long", timeStyle: "short" },
  );
}

function formatSeconds(seconds) {
  if (seconds === null || seconds === undefined) return NOT_KNOWN;
  if (seconds < 120) return `${formatNumber(seconds, 3)} s`;
  return seconds < 7200 ? `${formatNumber(seconds / 60, 3)} min` : `${formatNumber(seconds / 3600, 3)} h`;
}

/** "1 isola", "2 isolas" */
const countOf = (count, one, many = `${one}s`) => `${count} ${count === 1 ? one : many}`;
