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

/** @typedef {{name: string, factor: number}} Unit shown number = SI number × factor */

/** Picks the unit in which `largest` (SI) has one to three digits before the point. @returns {Unit} */
function unitFor(base, largest, prefixes = [["M", 1e-6], ["k", 1e-3], ["", 1], ["m", 1e3], ["µ", 1e6], ["n", 1e9]]) {
  const found = prefixes.find(([, factor]) => largest * factor >= 0.5) ?? (largest > 0 ? prefixes.at(-1) : ["", 1]);
  return { name: found[0] + base, factor: found[1] };
}

/** Lengths stay at m or below: nobody measures vibration in km. */
const lengthUnit = (largest) => unitFor("m", largest, [["", 1], ["m", 1e3], ["µ", 1e6], ["n", 1e9]]);

const formatIn = (unit, value, digits = 5) => `${formatNumber(value * unit.factor, digits)} ${unit.name}`;
const formatLength = (metres, digits = 4) => formatIn(lengthUnit(Math.abs(metres) || 1), metres, digits);
const formatShare = (share) => (Number.isNaN(share) ? NOT_KNOWN : `${formatNumber(100 * share, 3)} %`);
const formatHertz = (omega) => `${formatNumber(omega / (2 * Math.PI), 6)} Hz`;
const formatOmega = (omega) => `${formatNumber(omega, 6)} rad/s`;
const formatRange = ([low, high], format = formatNumber) => `${format(low)} to ${format(high)}`;

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

/** Whether numbers spread so far that a logarithmic axis reads better; `decades` apart. */
function spansDecades(extent, decades = 1.5) {
  return extent !== null && extent[0] > 0 && Math.log10(extent[1] / extent[0]) > decades;
}
