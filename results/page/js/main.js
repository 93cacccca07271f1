/* The page: what it says at the top, and its figures in their order. */

/** What fills the places of the page. All take (place, run, context). */
const SECTIONS = {
  response(place, run, context) {
    const { selection } = context;
    const picked = (branch, index) => selection.set({ branch, index });
    const section = new ResponseSection(place, run.figures.response, run, { ...context, picked });
    const select = (chosen) => chosen && section.select(chosen.branch, chosen.index);
    selection.listen(select);
    select(selection.get());
  },
  balance(place, run, context) {
    const controls = amplitudeControls(run.frames, run.levels, context.looked);
    const panels = element("div.panels");
    place.append(controls, panels, predictionInWords(context.looked));
    for (const name of ["balance", "backbone"]) {
      const part = element("div");
      panels.append(part);
      controls.append(...plainFigure(part, run.figures[name], context).controls.children);
    }
  },
  map(place, run, context) {
    plainFigure(place, run.figures.map, context);
    const controls = amplitudeControls(run.frames, run.levels, context.looked);
    place.append(controls, predictionInWords(context.looked));
  },
  resonance: (place, run, context) => plainFigure(place, run.figures.resonance, context),
  modes: (place, run, context) => plainFigure(place, run.figures.modes, context),
  motion: motionSection,
  account: accountSection,
};

/** A figure that depends on nothing but the forcing amplitude looked at. */
function plainFigure(place, description, { looked, ...context }) {
  const figure = new Figure(place, description, context);
  const look = (frame) => figure.set({ frame });
  look(looked.get());
  looked.listen(look);
  return figure;
}

/** What is selected when nothing was picked: the largest amplitude of isolas, of others beside the main branches, or of all. */
function defaultSelection(branches) {
  const kinds = [({ kind }) => kind === "isola", ({ kind }) => kind !== "main", () => true];
  const chosen = kinds.map((is) => branches.filter(is)).find(({ length }) => length > 0) ?? [];
  const [highest] = chosen.toSorted(
    (a, b) => b.amplitude_at_peak - a.amplitude_at_peak,
  );
  return highest ? { branch: branches.indexOf(highest), index: highest.peak } : null;
}

/** Which motions this page tells of, where a run looks for several orders, and the pages of the others. */
function fillOrders(orders) {
  const lasting = (order) => `${order} ${order === 1 ? "period" : "periods"} of the force`;
  const place = document.querySelector("#orders");
  place.hidden = orders.length === 0;
  place.append("Motions that last ");
  orders.forEach(({ order, file }, index) => {
    const words = index === 0 ? lasting(order) : String(order);
    place.append(index === 0 ? "" : " · ");
    place.append(file === null ? element("strong", {}, `${words} (this page)`) : element("a", { href: file }, words));
  });
}

function fillHeader({ run, orders, verdict }) {
  fillOrders(orders);
  const stages = {
    backbone: "its backbone is not computed yet",
    sweep: "not all of its levels are computed",
    finished: "finished",
    cancelled: "cancelled",
  };
  const facts = [
    `Model ${run.model}`,
    stages[run.stage] ?? run.stage,
    `started ${formatTime(run.created)}`,
    `page made ${formatTime(run.made)}`,
  ];
  document.querySelector("#run-name").textContent = run.name;
  document.querySelector("#run-facts").textContent = facts.join(" · ");
  document.querySelector("#run-description").textContent = run.description ?? "";
  document.querySelector("#missing").hidden = run.missing.length === 0;
  document.querySelector("#missing ul").replaceChildren(...run.missing.map((sentence) => element("li", {}, sentence)));
  document.querySelector("#verdict").replaceChildren(
    ...verdict.map(({ title, lead, text, lost, details: more, reach }) => element("div", {},
      element("h2", {}, title),
      ...(lead ? [element("p.lost", {}, lead)] : []),
      element("p", {}, text),
      ...(lost ? [element("p.lost", {}, lost)] : []),
      ...(more.length > 0 ? [element("ul", {}, ...more.map((sentence) => element("li", {}, sentence)))] : []),
      ...(reach ? [details("What was looked for", element("p", {}, reach))] : []),
    )),
  );
}

/** Draws figures one after another as the browser finds time, those in sight first: none delays what is read first. */
function drawFigures(run, context) {
  const waiting = new Map(
    [...document.querySelectorAll("[data-figure]")].map((place) => [place, SECTIONS[place.dataset.figure]]),
  );
  const draw = (place) => {
    // One that comes into sight may have been drawn meanwhile.
    if (!waiting.has(place)) return;
    const section = waiting.get(place);
    const why = run.nothing[place.dataset.figure];
    waiting.delete(place);
    try {
      if (why === undefined) section(place, run, context);
      else place.append(emptyNote(`Nothing to show: ${why}.`));
    } catch (error) {
      // What is damaged in one figure must not take the others away.
      place.append(emptyNote(`This part cannot be shown: ${error.message}`));
      console.error(error);
    }
  };
  const seen = new IntersectionObserver(
    (entries) => entries.filter((entry) => entry.isIntersecting).forEach(({ target }) => draw(target)),
  );
  for (const place of waiting.keys()) seen.observe(place);
  const later = window.requestIdleCallback ?? ((work) => setTimeout(work, 60));
  const drawNext = () => {
    const [place] = waiting.keys();
    if (!place) {
      seen.disconnect();
      document.documentElement.dataset.drawn = "all";
      return;
    }
    draw(place);
    later(drawNext, { timeout: 500 });
  };
  later(drawNext, { timeout: 500 });
  window.addEventListener("beforeprint", () => [...waiting.keys()].forEach(draw));
}

function startReport() {
  const run = JSON.parse(document.querySelector("#data").textContent);
  theme.palettes = run.palette;
  startTheme(document.querySelector("#theme"));
  startCharts();
  document.querySelector("#print").addEventListener("click", printPage);
  frequencyUnit.set(run.frequency_unit);
  chosenLength.unit = run.length_unit;
  document.querySelector("nav").append(frequencyControl());
  fillHeader(run);
  run.frames.forEach((frame, index) => (frame.index = index));
  const looked = shared(run.frames[run.first_frame ?? 0] ?? null);
  const context = {
    columns: lazyColumns(run.columns),
    file: run.run.name,
    selection: shared(defaultSelection(run.branches)),
    looked,
    moved: (amplitude) => looked.set(nearestFrame(run.frames, amplitude)),
  };
  // Figures far down wait until the first ones are on the screen.
  requestAnimationFrame(() => setTimeout(() => drawFigures(run, context)));
}

startReport();
