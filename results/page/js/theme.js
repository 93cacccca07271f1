/* Light and dark. The colours of figures come with them; the rest of the page takes its colours from style.css. */

/**
 * @typedef {"ink"|"soft"|"faint"|"shade"|"alert"|"paper"|{level: number}|{category: number}|{pale_level: number}|{pale_category: number}} Colour
 *
 * @typedef {object} Palette
 * @property {string} paper
 * @property {string} ink text and curves that a figure is about
 * @property {string} soft axes
 * @property {string} faint grids
 * @property {string[]} ramp from the smallest to the largest forcing amplitude
 * @property {string[]} categories colours told apart
 */

const THEMES = ["light", "dark"];
const THEME_KEY = "isola-theme";

/** The theme in use, and who is to be told when it changes. */
const theme = {
  listeners: [],
  name: "light",
  /** @type {{tint: number, pale: number, light: Palette, dark: Palette}} as the figures brought them */
  palettes: { tint: 0, pale: 1 },
  get palette() {
    return this.palettes[this.name];
  },
  use(name) {
    this.name = name;
    document.documentElement.dataset.theme = name;
    for (const listener of this.listeners) listener();
  },
};

/** @param {Colour} colour @returns {string} "#rrggbb" */
function colourOf(colour, palette = theme.palette) {
  if (typeof colour === "string") return palette[colour];
  if (colour.level !== undefined) return rampColour(palette.ramp, colour.level);
  const { pale_level: level, pale_category: category } = colour;
  if (level !== undefined || category !== undefined) {
    return mixed(palette.paper, colourOf(level !== undefined ? { level } : { category }, palette), theme.palettes.pale);
  }
  return palette.categories[colour.category % palette.categories.length];
}

/** Gives an element a colour for each theme, of which style.css takes one. @param {Colour} colour */
function showInColour(shown, colour) {
  for (const name of THEMES) shown.style.setProperty(`--${name}`, colourOf(colour, theme.palettes[name]));
}

const parseHex = (colour) => [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));

/** @param {string[]} ramp "#rrggbb" @param {number} at from 0 to 1 */
function rampColour(ramp, at) {
  const place = Math.min(Math.max(at, 0), 1) * (ramp.length - 1);
  const below = Math.min(Math.floor(place), ramp.length - 2);
  return mixed(ramp[below], ramp[below + 1], place - below);
}

/** @param {string} from "#rrggbb" @param {string} to @param {number} share of the second */
function mixed(from, to, share) {
  const [low, high] = [parseHex(from), parseHex(to)];
  const channels = low.map((channel, k) => Math.round(channel + (high[k] - channel) * share));
  return `#${channels.map((channel) => channel.toString(16).padStart(2, "0")).join("")}`;
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
  const preferred = () => (THEMES.includes(chosen) ? chosen : system.matches ? "dark" : "light");
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
