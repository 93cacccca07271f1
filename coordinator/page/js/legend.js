/* Legends outside charts, where they hide nothing and wrap on narrow screens. */

/**
 * @typedef {object} LegendEntry
 * @property {string} text
 * @property {(palette: Palette) => string} colour
 * @property {string} [dash] as of SVG
 * @property {number} [width] of the line, px; 0: none
 * @property {"circle"|"square"|"triangle"|"inverted_triangle"|"cross"|"patch"} [marker]
 */

const LEGEND_SHAPES = {
  circle: "M17 3a4 4 0 1 1-.01 0z",
  square: "M13 3h8v8h-8z",
  triangle: "M17 2l5 9h-10z",
  inverted_triangle: "M17 12l5-9h-10z",
  cross: "M13 3l8 8M21 3l-8 8",
  patch: "M3 1h28v12h-28z",
};

function svgElement(tag, attributes) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
}

/** @param {LegendEntry} entry */
function legendSample({ dash = "", width = 2.5, marker }) {
  const svg = svgElement(
    "svg",
    {
      width: 34,
      height: 14,
      viewBox: "0 0 34 14",
      "aria-hidden": "true",
      stroke: "currentColor",
      fill: "currentColor",
    },
  );
  if (width > 0) svg.append(
    svgElement("line", { x1: 1, x2: 33, y1: 7, y2: 7, "stroke-width": width, "stroke-dasharray": dash }),
  );
  if (marker) svg.append(
    svgElement(
      "path",
      {
        d: LEGEND_SHAPES[marker],
        "stroke-width": 2,
        "fill-opacity": marker === "patch" ? 0.3 : 1,
        "stroke-opacity": marker === "patch" ? 0 : 1,
      },
    ),
  );
  return svg;
}

/** @param {LegendEntry[]} entries */
function legend(entries) {
  const samples = entries.map(legendSample);
  const colour = (palette) => samples.forEach((sample, k) => (sample.style.color = entries[k].colour(palette)));
  colour(theme.palette);
  theme.listeners.push(colour);
  return element("div.legend", {}, ...entries.map(({ text }, k) => element("span", {}, samples[k], text)));
}
