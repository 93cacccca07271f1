/* Forced response: amplitude over frequency of all levels. Also the figure of a live page, which adds branches as they
 * come. */

/** Marks of folds and peaks, and labels of all isolas, help while there are few branches. */
const FEW_BRANCHES = 24;

/** Branches that come one by one are drawn together, once in so many ms: each time, all others are painted too. */
const GROWTH_PAUSE = 250;

/**
 * @param {Element} place
 * @param {object} run with `monitors`, `levels`, `branches`, `backbone` and `omega`, as the page's or a part of it
 * @param {{picked?: (branch: Branch, index: number) => void, runName?: string}} [options]
 */
const responseFigure = (place, run, options = {}) => new ResponseFigure(place, run, options);

class ResponseFigure {
  constructor(place, run, { picked = null, runName = "isola" }) {
    this.place = place;
    this.monitors = run.monitors;
    this.sweep = run.omega;
    /** @type {Map<string, {branch: Branch, curve?: object}>} by key of the branch, the curve in the units shown */
    this.branches = new Map(run.branches.map((branch) => [branch.key, { branch }]));
    this.visible = [];
    this.monitor = 0;
    this.unit = lengthUnit(0);
    this.withBackbone = false;
    this.selected = null;
    this.draw = oncePerFrame(() => this.drawNow());
    this.grow = oncePerFrame(() => {
      this.noteIsolas();
      this.rescale();
    }, GROWTH_PAUSE);

    this.picker = levelPicker(() => this.draw());
    const backboneLabel = "Backbone, bold where the largest level shown is predicted to respond";
    this.backboneCheck = checkbox(backboneLabel, false, (checked) => {
      this.withBackbone = checked;
      this.draw();
    });
    this.note = element("p.empty", { hidden: true });
    this.holder = element("div");
    const controls = element("div.controls", {}, this.monitorDropdown(), this.backboneCheck);
    place.append(this.picker.element, controls, this.note, this.holder);
    this.buildChart(runName, picked);
    this.setLevels(run.levels);
    this.setBackbone(run.backbone);
    theme.listeners.push(this.draw);
  }

  /** Takes a branch in; another with the same key is replaced. */
  add(branch) {
    this.branches.set(branch.key, { branch });
    this.grow();
  }

  setLevels(levels) {
    this.levels = levels;
    this.isolaCounts = levels.map(() => 0);
    this.picker.setLevels(levels);
    this.noteIsolas();
    this.draw();
  }

  setBackbone(backbone) {
    this.backbone = backbone;
    this.backboneCheck.hidden = backbone === null;
    this.grow();
  }

  /** Marks a point. */
  select(branch, index) {
    this.selected = { branch, index };
    this.draw();
  }

  monitorDropdown() {
    if (this.monitors.length < 2) return null;
    const options = this.monitors.map(({ name }, k) => [String(k), name]);
    return dropdown("Amplitude of", options, "0", (value) => {
      this.monitor = Number(value);
      this.chart.reset();
      this.rescale();
    });
  }

  buildChart(runName, picked) {
    this.chart = new Chart(this.holder, {
      label: "Forced response: amplitude over frequency. Arrow keys go from point to point, Enter selects one.",
      file: `${runName} response`,
      size: "tall",
      x: { label: "frequency ω, rad/s", range: this.sweep ?? [0, 1] },
      y: { label: "amplitude", range: [0, 1] },
    });
    this.layers = responseLayers(this.chart);
    const wishes = () => [...this.gapLabel(), ...this.branchLabels()];
    this.relabel = keepLabels(this.chart, wishes, () => this.visible);
    const describe = ({ branch }, index) => describePoint(branch, index, this.levels[branch.level], this.monitor);
    inspectPoints(this.chart, () => this.visible, describe, ({ branch }, index) => picked?.(branch, index));
  }

  /** Says "2 isolas" after every level of which the number has changed. */
  noteIsolas() {
    const counts = this.levels.map(() => 0);
    for (const { branch } of this.branches.values()) if (branch.kind === "isola") counts[branch.level]++;
    counts.forEach((count, k) => {
      if (count !== this.isolaCounts[k]) this.picker.setNote(k, count > 0 ? countOf(count, "isola") : "");
    });
    this.isolaCounts = counts;
  }

  /** The curve of a branch in the units shown. */
  curveOf(branch) {
    const { monitor, unit } = this;
    const entry = this.branches.get(branch.key);
    if (entry.curve?.monitor !== monitor || entry.curve.unit !== unit) {
      const y = scaled(branch.amplitude[monitor], unit.factor);
      entry.curve = { branch, monitor, unit, x: branch.omega, y, peak: branch.peaks[monitor] };
    }
    return entry.curve;
  }

  drawNow() {
    const shown = this.picker.shown();
    const isShown = (branch) => shown.has(branch.level);
    const { selected } = this;
    this.visible = [...this.branches.values()].filter(({ branch }) => isShown(branch)).map(
      ({ branch }) => this.curveOf(branch),
    );
    this.layers.draw(this.visible, levelColours(this.levels, theme.palette));
    this.place.dataset.branches = this.branches.size;
    this.layers.drawBackbone(this.withBackbone ? this.backboneParts() : []);
    this.layers.drawSelection(
      selected && isShown(selected.branch) ? { curve: this.curveOf(selected.branch), index: selected.index } : null,
    );
    this.holder.hidden = this.branches.size === 0 && this.backbone === null;
    this.picker.element.hidden = this.levels.length === 0;
    this.note.hidden = this.visible.length > 0;
    const nothing = this.branches.size === 0;
    this.note.textContent = nothing ? "No branch has been computed yet." : "No level is shown: choose some above.";
    this.relabel();
  }

  /** The whole backbone, and its parts inside the windows of the largest level shown. */
  backboneParts() {
    const { omega, threshold, amplitude } = this.backbone;
    const y = scaled(amplitude[this.monitor], this.unit.factor);
    const largest = Math.max(...[...this.picker.shown()].map((k) => this.levels[k].value), 0);
    const inside = runsBelow(threshold, largest).map(
      (part) => ({ x: alongRun(omega, part), y: alongRun(y, part), width: 4 }),
    );
    return [{ x: omega, y, width: 1.2 }, ...inside];
  }

  /** Units, ranges and gap line for the monitored dof chosen and the branches there are. What was zoomed into stays. */
  rescale() {
    const { monitor } = this;
    const branches = [...this.branches.values()].map(({ branch }) => branch);
    // Each branch is searched once only: on a live page this is done whenever one has come.
    const peaks = branches.map(({ amplitude, peaks }) => amplitude[monitor][peaks[monitor]] ?? NaN);
    const [, found] = extentOf(peaks) ?? extentOf(this.backbone?.amplitude[monitor] ?? []) ?? [0, 1];
    const largest = found || 1; // The dof may be at rest.
    const unit = lengthUnit(largest);
    if (unit.factor !== this.unit.factor) {
      this.chart.scaleY(unit.factor / this.unit.factor);
      this.unit = unit;
    }
    const { name, gap } = this.monitors[this.monitor];
    const [axis] = this.chart.figure.yaxes;
    const label = `largest |${name}| over the period, ${unit.name}`;
    if (axis.axis_label.text !== label) axis.axis_label = plainText(label); // A new one is laid out anew.
    this.layers.gap.setv({ location: (gap ?? 0) * unit.factor, visible: gap !== null });
    const frequencies = extentOf(...branches.map((branch) => branch.frequencies ?? []));
    const x = this.sweep ?? withMargin(frequencies ?? extentOf(this.backbone?.omega ?? []));
    this.chart.rehome({ x, y: [0, largest * unit.factor * 1.08] });
    this.draw();
  }

  gapLabel() {
    const { gap } = this.monitors[this.monitor];
    if (gap === null) return [];
    const narrow = this.chart.box.clientWidth < 600;
    const text = narrow ? "clearance" : `clearance ${formatIn(this.unit, gap, 3)}: beyond it, the casing is touched`;
    return [
      {
        text,
        x: this.chart.figure.x_range.end,
        y: gap * this.unit.factor,
        colour: theme.palette.soft,
        sides: ["aboveEnd"],
      },
    ];
  }

  /** A label at the highest point in view of every branch, isolas and the ends of the range of levels first. */
  branchLabels() {
    const { x_range, y_range } = this.chart.figure;
    const isolas = this.visible.filter(({ branch }) => branch.kind === "isola");
    const mains = this.visible.filter(({ branch }) => branch.kind === "main");
    const ordered = [isolas, mains].flatMap((group) => spreadOrder(group.length).map((k) => group[k]));
    const colours = levelColours(this.levels, theme.palette);
    const most = Math.max(12, this.chart.box.clientWidth / 50);
    return ordered.slice(0, most).flatMap((curve) => {
      const index = highestIn(curve, x_range, y_range);
      if (index < 0) return [];
      const { level, kind, name } = curve.branch;
      const forcing = `A = ${this.levels[level].amplitude}`;
      const text = kind === "main" ? forcing : `${name}, ${forcing}`;
      const important = kind === "isola" && isolas.length <= FEW_BRANCHES;
      return [{ text, x: curve.x[index], y: curve.y[index], colour: colours[level], important }];
    });
  }
}

/** The highest point of a curve inside the ranges; -1 if there is none. */
function highestIn({ x, y, peak }, xRange, yRange) {
  const inside = (i) => x[i] >= xRange.start && x[i] <= xRange.end && y[i] >= yRange.start && y[i] <= yRange.end;
  if (peak >= 0 && inside(peak)) return peak;
  let best = -1;
  for (let i = 0; i < x.length; i++) if ((best < 0 || y[i] > y[best]) && inside(i)) best = i;
  return best;
}

/** All that is known of a point. @returns {Description} */
function describePoint(branch, index, level, monitor) {
  const special = branch.special.filter((mark) => mark.index === index).map(({ kind }) => kind);
  return {
    title: `A = ${level.amplitude}, ${branch.name}`,
    rows: [
      ["frequency", `${formatOmega(branch.omega[index])} = ${formatHertz(branch.omega[index])}`],
      ["amplitude", formatLength(branch.amplitude[monitor][index], 5)],
      ["rms", formatLength(branch.rms[monitor]?.[index] ?? NaN, 5)],
      ["in contact", formatShare(branch.contact[index] ?? NaN)],
      ["residual", formatNumber(branch.residual[index], 2)],
      ["highest harmonics", formatNumber(branch.highHarmonics[index], 2)],
      ["Newton iterations", formatNumber(branch.iterations[index])],
      ["point", `${index} of ${branch.size}${special.length > 0 ? ` (${special.join(", ")})` : ""}`],
    ],
  };
}
