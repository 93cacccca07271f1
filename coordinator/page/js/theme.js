/* Colours of the charts, light and dark. The rest of the page takes its colours from style.css. */

/**
 * @typedef {object} Palette
 * @property {string} ink text and axes
 * @property {string[]} ramp from the smallest to the largest forcing amplitude: lightness falls (light) or rises (dark)
 *   steadily along it, so that it survives colour blindness and a grey printer
 * @property {string} first, second, third, fourth, alarm after Okabe and Ito, told apart by lightness too
 */
const PALETTES = {
  light: {
    paper: "#ffffff", ink: "#1a2027", soft: "#5b6672", faint: "#dfe4e9", shade: "#8b96a1",
    ramp: ["#e08a2e", "#d9604f", "#bc3a72", "#8c1f8a", "#561a8f", "#1c0f63"],
    first: "#0072b2", second: "#d55e00", third: "#00805f", fourth: "#8a4f7d", alarm: "#b3261e",
  },
  dark: {
    paper: "#14181d", ink: "#e8ecf0", soft: "#a3aeb9", faint: "#2b323a", shade: "#76828e",
    ramp: ["#7a5cd6", "#a457cf", "#d05fae", "#f0788a", "#fba25f", "#f7e06a"],
    first: "#56b4e9", second: "#f0913a", third: "#2fc39b", fourth: "#d9a0cc", alarm: "#ff8a80",
  },
};

const THEME_KEY = "isola-theme";

/** The theme in use, and who is to be told when it changes. */
const theme = {
  listeners: [],
  name: "light",
  get palette() {
    return PALETTES[this.name];
  },
  use(name) {
    this.name = name;
    document.documentElement.dataset.theme = name;
    for (const listener of this.listeners) listener(this.palette);
  },
};

const parseHex = (colour) => [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));

/** @param {string[]} ramp "#rrggbb" @param {number} at from 0 to 1 */
function rampColour(ramp, at) {
  const place = Math.min(Math.max(Number.isFinite(at) ? at : 0.5, 0), 1) * (ramp.length - 1);
  const below = Math.min(Math.floor(place), ramp.length - 2);
  const [low, high] = [parseHex(ramp[below]), parseHex(ramp[below + 1])];
  const mixed = low.map((channel, k) => Math.round(channel + (high[k] - channel) * (place - below)));
  return `#${mixed.map((channel) => channel.toString(16).padStart(2, "0")).join("")}`;
}

/**
 * Colour of each level: by value, or by its logarithm where values spread over decades.
 * @param {{value: number}[]} levels by value
 */
function levelColours(levels, palette) {
  const values = levels.map((level) => level.value);
  const measure = spansDecades(extentOf(values)) ? Math.log : (value) => value;
  const [low, high] = [measure(values[0]), measure(values.at(-1))];
  return values.map((value) => rampColour(palette.ramp, high > low ? (measure(value) - low) / (high - low) : 1));
}

/** What the reader chose last, else what the system says; the button in the header changes it. */
function startTheme(toggle) {
  const system = matchMedia("(prefers-color-scheme: dark)");
  let chosen = null;
  try {
    chosen = localStorage.getItem(THEME_KEY);
  } catch {
    // Pages opened from a mail may not keep anything.
  }
  const use = (name) => {
    theme.use(name);
    toggle.textContent = name === "dark" ? "Light" : "Dark";
    toggle.setAttribute("aria-label", `Use ${name === "dark" ? "light" : "dark"} colours`);
  };
  const preferred = () => (chosen in PALETTES ? chosen : system.matches ? "dark" : "light");
  use(preferred());
  system.addEventListener("change", () => use(preferred()));
  toggle.addEventListener("click", () => {
    chosen = theme.name === "dark" ? "light" : "dark";
    use(chosen);
    try {
      localStorage.setItem(THEME_KEY, chosen);
    } catch {
      // As above.
    }
  });
}
