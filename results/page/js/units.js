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

/** A frequency in that unit. @param {number} omega rad/s */
const inChosenUnit = (omega) => omega * FREQUENCY_UNITS[frequencyUnit.get()].factor;

/**
 * A text of the page in that unit.
 * @param {string|(string|{omega: number, digits: number, signed: boolean}|{unit: null})[]} told with frequencies as numbers
 */
function toldText(told) {
  if (typeof told === "string") return told;
  const partText = (part) => {
    if (typeof part === "string") return part;
    if (part.omega === undefined) return frequencyUnit.get();
    const text = formatDigits(inChosenUnit(part.omega), part.digits);
    return part.signed && part.omega > 0 ? `+${text}` : text;
  };
  return told.map(partText).join("");
}

/** An element that is made anew where another unit is chosen. @param {() => Element} make */
function followingUnits(make) {
  let shown = make();
  frequencyUnit.listen(() => {
    const next = make();
    shown.replaceWith(next);
    shown = next;
  });
  return shown;
}

/** The control that chooses it. */
const frequencyControl = () =>
  dropdown("Frequencies in", Object.keys(FREQUENCY_UNITS).map((name) => [name, name]), frequencyUnit.get(), (name) =>
    frequencyUnit.set(name),
  );
