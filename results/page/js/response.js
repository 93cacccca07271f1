/* Forced response of all levels. Also the figure of a live page, which adds branches as they come. */

class ResponseSection {
  /**
   * @param {Element} place
   * @param {FigureDescription} description
   * @param {object} run with `levels`, `level_colors`, `frames` and `branches`
   * @param {object} context as of a figure
   */
  constructor(place, description, { levels, level_colors, frames, branches }, context) {
    this.place = place;
    this.branches = [...branches];
    this.frames = frames;
    this.shown = new Set(levels.keys());
    this.picker = levelPicker(levels, level_colors, (shown) => {
      this.shown = shown;
      this.look();
    });
    this.note = emptyNote("");
    this.holder = element("div");
    place.append(this.picker.element, this.note, this.holder);
    this.figure = new Figure(this.holder, description, context);
    noteIsolas(this.picker, this.branches);
    this.look();
  }

  /** Shows the levels chosen, and what is predicted for the largest of them. */
  look() {
    const largest = Math.max(...this.shown);
    const frame = this.frames.find(({ level }) => level === largest) ?? null;
    this.figure.set({ shown: this.shown, frame });
    this.tell();
  }

  /** Says how much there is. */
  tell() {
    this.place.dataset.branches = this.branches.length;
    this.note.hidden = this.branches.length > 0 && this.shown.size > 0;
    this.note.textContent =
      this.branches.length === 0 ? "No branch has been computed yet." : "No level is shown: choose some above.";
  }

  /** Marks a point. */
  select(branch, index) {
    this.figure.set({ selected: { branch, index } });
  }

  /**
   * Takes a branch in; another of the same level, kind and number is replaced.
   * @param {[number, string[]][]} renamed what branches that it lies on are called from now on
   */
  add(branch, series, columns, renamed) {
    const isSame = ({ level, kind, number }) =>
      level === branch.level && kind === branch.kind && number === branch.number;
    const known = this.branches.findIndex(isSame);
    const place = known < 0 ? this.branches.length : known;
    this.branches[place] = branch;
    if (known >= 0) this.figure.remove(known);
    this.figure.add(series.map((one) => ({ ...one, branch: place })), columns);
    for (const [other, name] of renamed) this.figure.rename(other, name);
    noteIsolas(this.picker, this.branches);
    this.tell();
  }

  /** Takes the backbone in. */
  setBackbone(series, columns, frames) {
    this.frames = frames;
    this.figure.add(series, columns);
    this.look();
  }
}
