/* Legends outside charts, where they hide nothing and wrap on narrow screens. */

/**
 * @typedef {object} Style how something is drawn; sizes as in files
 * @property {Colour} color
 * @property {number} [width] of the line; 0: none
 * @property {number[]} [dash]
 * @property {{shape: string, size: number, open?: boolean}} [marker]
 * @property {boolean} [fill] the inside, lightly
 */

const LEGEND_SHAPES = {
  circle: "M17 3a4 4 0 1 1-.01 0z",
  square: "M13 3h8v8h-8z",
  triangle: "M17 2l5 9h-10z",
  inverted_triangle: "M17 12l5-9h-10z",
  cross: "M13 3l8 8M21 3l-8 8",
};

function svgElement(tag, attributes) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
}

/** @param {Style} style */
function legendSample(style) {
  const { width = 0, marker, fill } = style;
  const svg = svgElement("svg", {
    viewBox: "0 0 34 14",
    "aria-hidden": "true",
    stroke: "currentColor",
    fill: "currentColor",
  });
  const { line_width, line_dash } = scaledLine(style, 1.3);
  const stroke = { "stroke-width": line_width, "stroke-dasharray": line_dash.join(" ") };
  if (fill) svg.append(
    svgElement("path", { d: "M3 2h28v10h-28z", "fill-opacity": theme.palettes.tint, ...stroke }),
  );
  else if (width > 0) svg.append(svgElement("line", { x1: 1, x2: 33, y1: 7, y2: 7, ...stroke }));
  if (marker) svg.append(
    svgElement(
      "path",
      { d: LEGEND_SHAPES[marker.shape], "stroke-width": 1.5, ...(marker.open && { fill: "var(--paper)" }) },
    ),
  );
  return svg;
}

/** @param {{text: string, style: Style, frequency?: number}[]} entries */
function legend(entries) {
  return element("div.legend", {}, ...entries.map(({ text, style, frequency }) => {
    const sample = legendSample(style);
    showInColour(sample, style.color);
    const behind = () => `${formatDigits(inChosenUnit(frequency), 4)} ${frequencyUnit.get()}`;
    const name = frequency === undefined ? text : followingUnits(() => element("span", {}, `${text} (${behind()})`));
    return element("span", {}, sample, name);
  }));
}
