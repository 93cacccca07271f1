/* Which levels are shown: a check for each, all or none, and a range between two sliders. */

/** From so many levels on, a range of them can be chosen. */
const MANY_LEVELS = 8;

/**
 * @param {{amplitude: string}[]} levels by forcing amplitude
 * @param {Colour[]} colours one a level
 * @param {(shown: Set<number>) => void} changed told of the indices of the levels shown; at first, all are
 * @returns {{element: Element, setNote: (index: number, note: string) => void}}
 */
function levelPicker(levels, colours, changed) {
  let shown = new Set(levels.keys());
  const last = Math.max(levels.length - 1, 0);
  const end = (value, label) => element("input", { type: "range", min: 0, max: last, value, "aria-label": label });
  const [from, to] = [end(0, "Smallest level shown"), end(last, "Largest level shown")];
  const range = element("div.level-range", {}, element("span", {}, "from"), from, element("span", {}, "to"), to);
  range.hidden = levels.length < MANY_LEVELS;
  const summary = element("output");
  const checks = levels.map((level, index) => levelCheck(level, colours[index], index));
  const list = element("div.levels", { role: "group", "aria-label": "Levels shown" }, ...checks);

  const refresh = () => {
    for (const input of list.querySelectorAll("input")) input.checked = shown.has(Number(input.value));
    const values = [...shown].sort((a, b) => a - b);
    const amplitude = (index) => levels[index].amplitude;
    const ends = values.length > 0 ? `, A from ${amplitude(values[0])} to ${amplitude(values.at(-1))}` : "";
    summary.textContent = `${shown.size} of ${countOf(levels.length, "level")} shown${ends}`;
  };
  const show = (next) => {
    shown = next;
    refresh();
    changed(shown);
  };
  const showRange = () => {
    const [low, high] = [Number(from.value), Number(to.value)].sort((a, b) => a - b);
    show(new Set(levels.map((_, k) => k).filter((k) => k >= low && k <= high)));
  };
  from.addEventListener("input", showRange);
  to.addEventListener("input", showRange);
  list.addEventListener("change", ({ target }) => {
    const next = new Set(shown);
    if (target.checked) next.add(Number(target.value));
    else next.delete(Number(target.value));
    show(next);
  });
  const all = button("All", () => show(new Set(levels.keys())));
  const none = button("None", () => show(new Set()));

  refresh();
  const controls = element("div.controls", {}, all, none, range, summary);
  return {
    element: element("div.level-picker", { hidden: levels.length === 0 }, controls, list),
    /** @param {string} note said after a level, e.g. "1 isola" */
    setNote(index, note) {
      checks[index].title = note;
      checks[index].querySelector("small").textContent = note;
    },
  };
}

function levelCheck(level, colour, index) {
  const swatch = element("span.swatch", { "aria-hidden": "true" });
  showInColour(swatch, colour);
  return element(
    "label.level",
    {},
    element("input", { type: "checkbox", value: index, checked: true }),
    swatch,
    element("span", {}, `A = ${level.amplitude}`),
    element("small"),
  );
}

/**
 * Says "2 isolas, 1 cut" after every level that has some, of several runs each with its name.
 * @param {{level: number, kind: string, run?: string}[]} branches
 */
function noteIsolas(picker, branches) {
  const levels = new Map();
  for (const { level, kind, run = "" } of branches) {
    if (kind === "main") continue;
    const runs = levels.get(level) ?? new Map();
    const counts = runs.get(run) ?? new Map();
    levels.set(level, runs.set(run, counts.set(kind, (counts.get(kind) ?? 0) + 1)));
  }
  const inWords = ([kind, count]) => (kind === "isola" ? countOf(count, kind) : `${count} ${kind}`);
  const ofRun = ([run, counts]) => (run ? `${run}: ` : "") + [...counts].map(inWords).join(", ");
  for (const [level, runs] of levels) picker.setNote(level, [...runs].map(ofRun).join("; "));
}
