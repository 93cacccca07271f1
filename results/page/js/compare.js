/* The page of several runs: what differs, their curves over each other, numbers. */

function fillTables({ names, settings, numbers, sentences }) {
  const places = Object.fromEntries([...document.querySelectorAll("[data-table]")].map((place) => [place.dataset.table, place]));
  const scrolling = (caption, heads, rows) =>
    element("div.scroll", { tabindex: 0, role: "region", "aria-label": caption }, table(caption, heads, rows));
  places.settings.append(
    settings.length === 0
      ? emptyNote("The studies are the same but for their names.")
      : scrolling("Settings that differ", ["key", ...names], settings.map(({ key, values }) => [key, ...values])),
  );
  const rows = () => numbers.map(({ amplitude, what, values }) => [amplitude, what, ...values.map(toldText)]);
  places.numbers.append(followingUnits(() => scrolling("What was found", ["A", "what", ...names], rows())));
  const list = () => element("ul", {}, ...sentences.map((told) => element("li", {}, toldText(told))));
  document.querySelector("#sentences").append(followingUnits(list));
}

function drawCompared(data) {
  const context = { columns: lazyColumns(data.columns), file: "compared" };
  for (const place of document.querySelectorAll("[data-figure]")) {
    const name = place.dataset.figure;
    const why = data.nothing[name];
    if (why !== undefined) place.append(emptyNote(`Nothing to show: ${why}.`));
    else if (name === "response") new ResponseSection(place, data.figures.response, { ...data, frames: [] }, context);
    else new Figure(place, data.figures[name], context).draw();
  }
  document.documentElement.dataset.drawn = "all";
}

function startCompared() {
  const data = JSON.parse(document.querySelector("#data").textContent);
  theme.palettes = data.palette;
  startTheme(document.querySelector("#theme"));
  startCharts();
  document.querySelector("#print").addEventListener("click", printPage);
  frequencyUnit.set(data.frequency_unit);
  chosenLength.unit = data.length_unit;
  document.querySelector("nav").append(frequencyControl());
  const facts = data.runs.map((run, k) => `${k + 1}: ${data.names[k]}, model ${run.model}, started ${formatTime(run.created)}`);
  document.querySelector("#run-facts").textContent = facts.join(" · ");
  const missing = data.runs.flatMap((run, k) => run.missing.map((sentence) => `${data.names[k]}: ${sentence}`));
  document.querySelector("#missing").hidden = missing.length === 0;
  document.querySelector("#missing ul").replaceChildren(...missing.map((sentence) => element("li", {}, sentence)));
  document.querySelector("#answer").replaceChildren(...data.answer.map((sentence) => element("p", {}, sentence)));
  fillTables(data);
  requestAnimationFrame(() => setTimeout(() => drawCompared(data)));
}

startCompared();
