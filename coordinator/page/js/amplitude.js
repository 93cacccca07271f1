/* The forcing amplitude that figures 2 and 3 look at: chosen from the levels, typed, or dragged. */

const SLIDER_STEPS = 1000;

/** Amplitudes worth looking at: from below the first birth, yet not far below the levels, to above the largest one. */
function amplitudeRange({ levels, backbone }) {
  const [low, high] = extentOf(levels.map(({ value }) => value)) ?? [0.1, 10];
  const first = extentOf(backbone.threshold)?.[0] ?? low;
  return [Math.min(low, Math.max(first, low / 30)) / 1.3, high * 1.5];
}

/**
 * @param {{get: function, set: function, listen: function}} amplitude shared
 * @returns {Element[]} controls
 */
function amplitudeControls(run, amplitude) {
  const [low, high] = amplitudeRange(run);
  const toSlider = (value) => Math.round((SLIDER_STEPS * Math.log(value / low)) / Math.log(high / low));
  const fromSlider = (step) => Number((low * (high / low) ** (step / SLIDER_STEPS)).toPrecision(3));
  const levels = element("select", { change: () => levels.value && amplitude.set(Number(levels.value)) });
  levels.append(
    element("option", { value: "" }, "between levels"),
    ...run.levels.map(({ value, amplitude: typed }) => element("option", { value }, typed)),
  );
  const number = element(
    "input",
    {
      type: "number",
      step: "any",
      min: 0,
      change: () => Number(number.value) > 0 && amplitude.set(Number(number.value)),
    },
  );
  const slider = element(
    "input",
    {
      type: "range",
      class: "wide",
      min: 0,
      max: SLIDER_STEPS,
      "aria-label": "Forcing amplitude A",
      input: () => amplitude.set(fromSlider(Number(slider.value))),
    },
  );
  const follow = (value) => {
    levels.value = run.levels.some((level) => level.value === value) ? String(value) : "";
    number.value = value;
    slider.value = toSlider(value);
  };
  follow(amplitude.get());
  amplitude.listen(follow);
  return [labelled("Level", levels), labelled("or any A =", number), slider];
}
