/* The unit that frequencies are shown in, on the axes of all figures of the page. */

/** Units that frequencies are shown in on axes; turns a minute are those of a rotor that is forced once a turn. */
const FREQUENCY_UNITS = {
  "rad/s": { name: "rad/s", factor: 1 },
  Hz: { name: "Hz", factor: 1 / (2 * Math.PI) },
  rpm: { name: "rpm", factor: 30 / Math.PI },
};

/** The unit of frequencies that all figures of the page share, by its name: at first that of the run. */
const frequencyUnit = shared("rad/s");

/** An axis in that unit, if it is one of frequencies. @param {Axis} axis @returns {Axis} */
function inFrequencyUnit(axis) {
  const unit = FREQUENCY_UNITS[frequencyUnit.get()];
  return axis.unit.name === "rad/s" && unit.name !== "rad/s"
    ? { ...axis, unit: { ...unit, factor: unit.factor * axis.unit.factor }, title: axis.title.replace(" ω", "") }
    : axis;
}

/** The control that chooses it. */
const frequencyControl = () =>
  dropdown("Frequencies in", Object.keys(FREQUENCY_UNITS).map((name) => [name, name]), frequencyUnit.get(), (name) =>
    frequencyUnit.set(name),
  );
