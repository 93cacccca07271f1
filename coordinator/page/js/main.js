/* The page: what it says at the top, and its figures in their order. */

/** Figures by the place that waits for them. All take (place, run, context). */
const FIGURES = {
  response: (place, run, context) => {
    const figure = responseFigure(
      place,
      run,
      { picked: (branch, index) => context.selection.set({ branch, index }), runName: run.run.name },
    );
    context.selection.listen(({ branch, index }) => figure.select(branch, index));
    if (context.selection.get()) figure.select(context.selection.get().branch, context.selection.get().index);
  },
  balance: balanceFigure,
  map: mapFigure,
  ways: waysFigure,
  modes: modesFigure,
  motion: motionFigure,
  account: accountSection,
};

/** What is under the pointer when nothing was picked: the largest amplitude of all isolas, or of all branches. */
function defaultSelection(branches) {
  const isolas = branches.filter((branch) => branch.kind === "isola");
  let best = null;
  for (const branch of isolas.length > 0 ? isolas : branches) {
    const index = branch.peaks[0];
    const amplitude = branch.amplitude[0][index];
    if (index >= 0 && (!best || amplitude > best.amplitude)) best = { branch, index, amplitude };
  }
  return best;
}

/** The level to look at first: the one with most isolas, the lowest of those, so that wells are seen apart. */
function defaultAmplitude({ levels, branches }) {
  const counts = levels.map(
    (_, k) => branches.filter((branch) => branch.level === k && branch.kind === "isola").length,
  );
  return levels[counts.indexOf(Math.max(...counts))]?.value ?? 1;
}

function fillHeader({ run, verdict }) {
  const stages = {
    backbone: "the backbone is being computed",
    sweep: "the levels are being computed",
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
    ...verdict.map(({ title, text }) => element("div", {}, element("h2", {}, title), element("p", {}, text))),
  );
}

/** Draws figures one after another as the browser finds time, those in sight first: none delays what is read first. */
function drawFigures(run, context) {
  const waiting = new Map(
    [...document.querySelectorAll("[data-figure]")].map((place) => [place, FIGURES[place.dataset.figure]]),
  );
  const draw = (place) => {
    const figure = waiting.get(place);
    waiting.delete(place);
    try {
      figure?.(place, run, context);
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
  const run = decodeRun(JSON.parse(document.querySelector("#data").textContent));
  startTheme(document.querySelector("#theme"));
  startCharts();
  document.querySelector("#print").addEventListener("click", printPage);
  fillHeader(run);
  const context = { selection: shared(null), amplitude: shared(defaultAmplitude(run)) };
  // Figures far down wait until the first ones are on the screen.
  requestAnimationFrame(() =>
    setTimeout(() => {
      context.selection.set(defaultSelection(run.branches));
      drawFigures(run, context);
    }),
  );
}

startReport();
