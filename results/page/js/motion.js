/* One period of motion at the point selected, as far as it is stored; a slider, or playing, moves the shape. */

const PLAY_SECONDS = 4; // a period takes so long on the screen

/** @param {object} run @param {Element} place @param {object} context with the `selection`, shared */
function motionSection(place, run, context) {
  const { motions } = run;
  const heading = element("p", { "aria-live": "polite" });
  const hint = element("p.hint");
  place.append(heading);
  const figure = new Figure(place, run.figures.motion, context);
  place.append(hint);
  const isMoving = ({ signal }) => signal?.of === "shape";
  const moving = figure.panels.find(({ description }) => description.series.some(isMoving));
  if (moving) moving.box.append(timeControl((time) => figure.set({ time })));

  const say = (wanted) => {
    const stored = wanted && nearestMotion(motions, wanted);
    heading.textContent = motionInWords(run, wanted, stored);
    return stored;
  };
  const show = (wanted) => {
    const stored = say(wanted);
    const intro = stored?.index === wanted?.index ? "Any other point is drawn by " : "The point selected is drawn by ";
    hint.replaceChildren(...(wanted ? [intro, element("code", {}, plotCommand(run, wanted))] : []));
    if (!stored) return;
    figure.set({ motion: motionOf(motions, stored) });
    for (const panel of figure.panels) panel.fit();
  };
  context.selection.listen(show);
  frequencyUnit.listen(() => say(context.selection.get()));
  show(context.selection.get());
}

/** The stored point nearest to a point of a branch; undefined if none of this branch is stored. */
function nearestMotion({ points }, { branch, index }) {
  const distance = (point) => Math.abs(point.index - index);
  return points.filter((point) => point.branch === branch).sort((a, b) => distance(a) - distance(b))[0];
}

/** Harmonics of every node, c0, a1, b1, …: displacements, predicted pressures. */
function motionOf({ harmonics, nodes }, { coefficients, panels }) {
  const numbers = decodeColumn(coefficients);
  const length = 2 * harmonics + 1;
  const series = (k) => nodes.map((_, n) => numbers.subarray((2 * n + k) * length, (2 * n + k + 1) * length));
  const displacement = series(0);
  const touching = nodes.filter(({ gap }) => gap !== null).length;
  return {
    displacement,
    // Those whose shape is shown: contact nodes, which come first, or monitored dofs where there are none.
    along: displacement.slice(0, touching || nodes.length),
    pressure: series(1),
    gaps: nodes.map(({ gap }) => gap ?? NaN),
    largest: Math.max(...displacement.flatMap(harmonicSizes)),
    panels,
  };
}

/** Which motion is shown, and whether it is the one that was asked for. */
function motionInWords(run, wanted, stored) {
  if (!wanted) return "Nothing is selected.";
  const { level, name } = run.branches[wanted.branch];
  const point = `Point ${wanted.index} of ${name}, A = ${run.levels[level].amplitude}`;
  if (!stored) return `${point}: its motion is not stored in this page.`;
  if (stored.index === wanted.index) return toldText(stored.words);
  return `${toldText(stored.words)} It is the stored point nearest to the one selected (${wanted.index}).`;
}

/** How the program draws the motion at any point. */
function plotCommand({ levels, branches, orders }, { branch, index }) {
  const { level, name } = branches[branch];
  const further = orders.find(({ file, is_first }) => file === null && !is_first);
  const order = further ? ` --order ${further.order}` : "";
  return `isola plot RUN${order} --figure motion --at "${levels[level].amplitude}/${name}/${index}" -o motion.svg`;
}

/** Slider and play button. @param {(share: number) => void} moved share of the period */
function timeControl(moved) {
  let playing = null;
  const slider = element(
    "input",
    { type: "range", class: "wide", min: 0, max: 1, step: 0.005, value: 0, "aria-label": "Time within the period" },
  );
  const readout = element("output");
  const refresh = () => {
    readout.textContent = `${Number(slider.value).toFixed(2)} periods`;
    moved(Number(slider.value));
  };
  const step = (now) => {
    if (playing === null) return;
    slider.value = (playing.from + (now - playing.since) / 1000 / PLAY_SECONDS) % 1;
    refresh();
    requestAnimationFrame(step);
  };
  const play = button("Play", () => {
    playing = playing === null ? { from: Number(slider.value), since: performance.now() } : null;
    play.textContent = playing === null ? "Play" : "Pause";
    if (playing !== null) requestAnimationFrame(step);
  });
  slider.addEventListener("input", refresh);
  refresh();
  return element("div.controls", {}, play, slider, readout);
}
