/* The forcing amplitude that figures look at: chosen from the levels, typed, or dragged, as far as there are frames. */

/** The frame whose amplitude is nearest, by ratio. @param {Frame[]} frames */
function nearestFrame(frames, amplitude) {
  const distance = (frame) => Math.abs(Math.log(frame.amplitude / amplitude));
  return frames.reduce((best, frame) => (distance(frame) < distance(best) ? frame : best));
}

/**
 * @param {Frame[]} frames by amplitude
 * @param {{amplitude: string}[]} levels
 * @param {{get: () => Frame, set: (frame: Frame) => void, listen: function}} looked the frame looked at, shared
 * @returns {Element} controls
 */
function amplitudeControls(frames, levels, looked) {
  const ofLevels = frames.filter(({ level }) => Number.isInteger(level));
  const select = element(
    "select",
    { change: () => select.value && looked.set(frames[Number(select.value)]) },
    element("option", { value: "" }, "between levels"),
    ...ofLevels.map((frame) => element("option", { value: frames.indexOf(frame) }, levels[frame.level].amplitude)),
  );
  const take = () => Number(number.value) > 0 && looked.set(nearestFrame(frames, Number(number.value)));
  const number = element("input", { type: "number", step: "any", min: 0, change: take });
  const slider = element("input", {
    type: "range",
    class: "wide",
    min: 0,
    max: frames.length - 1,
    "aria-label": "Forcing amplitude A",
    input: () => looked.set(frames[Number(slider.value)]),
  });
  const follow = (frame) => {
    const index = frames.indexOf(frame);
    select.value = Number.isInteger(frame.level) ? String(index) : "";
    number.value = Number(frame.amplitude.toPrecision(4));
    slider.value = index;
    slider.setAttribute("aria-valuetext", frame.name);
  };
  follow(looked.get());
  looked.listen(follow);
  return element("div.controls", {}, labelled("Level", select), labelled("or any A =", number), slider);
}

/** What the balance predicts at the amplitude looked at: a sentence, and one a window. */
function predictionInWords(looked) {
  const words = element("div", { "aria-live": "polite" });
  const say = (frame) => words.replaceChildren(
    element("p", {}, frame.words),
    element("ul.words", {}, ...(frame.sentences ?? []).map((sentence) => element("li", {}, toldText(sentence)))),
  );
  say(looked.get());
  looked.listen(say);
  frequencyUnit.listen(() => say(looked.get()));
  return words;
}

const GRIP = 7; // px

/**
 * The line at the amplitude looked at follows a drag that begins on it.
 * @param {Chart} chart
 * @param {() => number} place where it is, in the units shown
 * @param {(place: number) => void} moved
 */
function dragLine(chart, place, moved) {
  let dragging = false;
  const position = (event) => event.clientY - chart.box.getBoundingClientRect().top;
  const isOnLine = (event) => {
    const projection = chart.projection();
    return projection !== null && Math.abs(projection.y(place()) - position(event)) <= GRIP;
  };
  chart.box.addEventListener("pointerdown", (event) => {
    if (!isOnLine(event)) return;
    dragging = true;
    chart.box.setPointerCapture(event.pointerId);
    event.stopPropagation(); // Bokeh would zoom.
    event.preventDefault();
  }, true);
  chart.box.addEventListener("pointermove", (event) => {
    chart.box.style.cursor = dragging || isOnLine(event) ? "ns-resize" : "";
    if (!dragging) return;
    event.stopPropagation();
    const { frame, yAt } = chart.projection();
    moved(yAt(Math.min(Math.max(position(event), frame.top), frame.bottom)));
  }, true);
  for (const end of ["pointerup", "pointercancel"]) chart.box.addEventListener(end, () => (dragging = false), true);
}
