/* Which levels are shown: a check for each, all or none, and a range between two sliders. */

/**
 * @param {(shown: Set<number>) => void} changed told of the indices of the levels shown
 * @returns {object} its `element`, the indices `shown()`, and how it is told of levels and of what to note on them
 */
function levelPicker(changed) {
  let shown = new Set();
  let levels = [];
  const summary = element("output");
  const list = element("div.levels", { role: "group", "aria-label": "Levels shown" });
  const from = element("input", { type: "range", min: 0, "aria-label": "Smallest level shown" });
  const to = element("input", { type: "range", min: 0, "aria-label": "Largest level shown" });
  const range = element("div.level-range", {}, element("span", {}, "from"), from, element("span", {}, "to"), to);

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

  theme.listeners.push(colourSwatches);
  return {
    element: element("div.level-picker", {}, element("div.controls", {}, all, none, range, summary), list),
    shown: () => shown,
    /** Of levels that there were already, those shown stay so; new ones are shown. */
    setLevels(next) {
      shown = new Set([...next.keys()].filter((k) => k >= levels.length || shown.has(k)));
      if (next.length !== levels.length) {
        for (const slider of [from, to]) slider.max = Math.max(next.length - 1, 0);
        [from.value, to.value] = [0, next.length - 1];
      }
      levels = next;
      list.replaceChildren(...levels.map(levelCheck));
      range.hidden = levels.length < 8;
      colourSwatches(theme.palette);
      refresh();
    },
    /** @param {string} note said after a level, e.g. "1 isola" */
    setNote(index, note) {
      const level = list.children[index];
      level.title = note;
      level.querySelector("small").textContent = note;
    },
  };

  function colourSwatches(palette) {
    if (levels.length === 0) return;
    const colours = levelColours(levels, palette);
    list.querySelectorAll(".swatch").forEach((swatch, k) => swatch.style.setProperty("--colour", colours[k]));
  }
}

function levelCheck(level, index) {
  return element(
    "label.level",
    {},
    element("input", { type: "checkbox", value: index, checked: true }),
    element("span.swatch", { "aria-hidden": "true" }),
    element("span", {}, `A = ${level.amplitude}`),
    element("small"),
  );
}
