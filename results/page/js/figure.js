/* A figure, drawn from its description: controls for what the reader can choose, legend, panels. */

/**
 * @typedef {object} FigureDescription
 * @property {string} name
 * @property {string} [choice] label of the control that chooses between the axes of the panels
 * @property {boolean} [linked_x] whether panels are zoomed together along x
 * @property {number} [columns] panels in a row
 * @property {{text: string, style: Style}[]} [legend]
 * @property {PanelDescription[]} panels
 */

/** Up to so many options are all in sight. */
const FEW_OPTIONS = 3;

/** Series that come one by one are drawn together, once in so many ms: each time, all others are painted too. */
const GROWTH_PAUSE = 250;

class Figure {
  /**
   * @param {Element} place @param {FigureDescription} description
   * @param {object} context
   * @param {Columns} context.columns what series refer to
   * @param {string} context.file begins the names of saved pictures
   * @param {(branch: number, index: number) => void} [context.picked] told of a point that was clicked
   * @param {(amplitude: number) => void} [context.moved] told of the amplitude that a line was dragged to
   */
  constructor(place, description, { columns, file, picked, moved }) {
    /** @type {View} */
    this.view = { choice: 0, shown: null, switched: new Set(), frame: null, motion: null, time: 0, selected: null };
    this.draw = oncePerFrame(() => this.drawNow());
    this.grow = oncePerFrame(() => this.growNow(), GROWTH_PAUSE);
    this.next = null;
    this.thinner = [];
    this.controls = element("div.controls");
    this.switches = new Set();
    this.legend = legend(description.legend ?? []);
    const boxes = description.panels.map(({ title }) => element("div", {}, title ? element("h3", {}, title) : null));
    const panels = element(description.columns > 1 ? "div.panels" : "div", {}, ...boxes);
    place.append(this.controls, panels);
    place.dataset.describes = description.name;
    if (boxes.length === 1) boxes[0].append(this.legend);
    else panels.before(this.legend);
    this.panels = description.panels.map((panel, number) => {
      panel.series = (panel.series ?? []).map((series) => ({ ...series, columns }));
      const name = boxes.length > 1 ? `${description.name} ${panel.title ?? panel.y[0].title}` : description.name;
      return new Panel(boxes[number], panel, this.view, { number, file: `${file} ${name}`, picked, moved });
    });
    if (description.linked_x) linkAlongX(this.panels.map(({ chart }) => chart));
    this.addChoice(description);
    this.addSwitches();
  }

  addChoice({ choice: label, panels: [{ x, y }] }) {
    const options = (x.length > 1 ? x : y).map(({ name }, k) => [String(k), name]);
    if (options.length < 2) return;
    const control = options.length > FEW_OPTIONS ? dropdown : choice;
    this.controls.append(control(label, options, "0", (value) => {
      this.view.choice = Number(value);
      for (const one of this.panels) one.fit();
      this.draw();
    }));
  }

  addSwitches() {
    for (const { switch: name } of this.panels.flatMap(({ description }) => description.series)) {
      if (name === undefined || this.switches.has(name)) continue;
      this.switches.add(name);
      this.controls.append(checkbox(name, false, (on) => {
        if (on) this.view.switched.add(name);
        else this.view.switched.delete(name);
        this.draw();
      }));
    }
  }

  /** What the reader has chosen elsewhere. @param {Partial<View>} change */
  set(change) {
    Object.assign(this.view, change);
    this.draw();
  }

  drawNow() {
    for (const panel of this.panels) panel.draw();
  }

  /** Takes more series in, of the first panel. @param {Series[]} series @param {Columns} columns what they refer to */
  add(series, columns) {
    this.panels[0].description.series.push(...series.map((one) => ({ ...one, columns })));
    this.addSwitches();
    this.grow();
  }

  /** Takes away what is drawn of a branch. */
  remove(branch) {
    const { description } = this.panels[0];
    description.series = description.series.filter((series) => series.branch !== branch);
  }

  /** Calls what is drawn of a branch by another name. @param {string[]} name one, or one an option */
  rename(branch, name) {
    for (const series of this.panels[0].description.series) {
      if (series.branch === branch && series.name) series.name = name;
    }
  }

  /**
   * Takes over axes, lines across, labels and legend; series and what the reader has zoomed into stay.
   * @param {FigureDescription & {thinner?: number[]}} description by how much lines of each branch are thinner than they came
   */
  update({ panels, legend: entries = [], thinner = [] }) {
    this.thinner = thinner;
    const next = legend(entries);
    this.legend.replaceWith(next);
    this.legend = next;
    this.next = panels;
    this.grow();
  }

  growNow() {
    this.next?.forEach((description, k) => this.panels[k].update(description));
    this.next = null;
    this.makeThinner();
    this.drawNow();
  }

  /** Gives the lines of narrow branches the width that the axes have room for. */
  makeThinner() {
    const { description } = this.panels[0];
    description.series = description.series.map((series) => {
      const { branch, kind, style, full = style.width } = series;
      const width = full - (this.thinner[branch] ?? 0);
      // Others of a branch are its marks.
      return kind !== "closed" || width === style.width ? series : { ...series, full, style: { ...style, width } };
    });
  }
}
