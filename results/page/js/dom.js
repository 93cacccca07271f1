/* Elements. Text enters as text only: names come from users. */

/**
 * @param {string} tag "div", or with classes "div.chart.tall"
 * @param {object} [attributes] attributes; functions become listeners of the event named
 * @param {...(Node|string|null)} children
 */
function element(tag, attributes = {}, ...children) {
  const [name, ...classes] = tag.split(".");
  const made = document.createElement(name);
  if (classes.length > 0) made.className = classes.join(" ");
  for (const [key, value] of Object.entries(attributes)) {
    if (typeof value === "function") made.addEventListener(key, value);
    else if (value === true) made.setAttribute(key, "");
    else if (value !== false && value !== null && value !== undefined) made.setAttribute(key, value);
  }
  made.append(...children.filter((child) => child !== null && child !== undefined));
  return made;
}

let controlCount = 0;

/** A labelled control: the label and whatever `control` is, tied together for screen readers. */
function labelled(text, control) {
  control.id ||= `control-${++controlCount}`;
  return element("span.field", {}, element("label", { for: control.id }, text), control);
}

/** @param {[string, string][]} options value and text @param {(value: string) => void} chosen */
function dropdown(label, options, value, chosen) {
  const select = element(
    "select",
    { change: () => chosen(select.value) },
    ...options.map(([v, text]) => element("option", { value: v, selected: v === value }, text)),
  );
  return labelled(label, select);
}

/** Two or three ways of seeing the same thing. @param {[string, string][]} options value and text */
function choice(label, options, value, chosen) {
  const name = `choice-${++controlCount}`;
  return element(
    "fieldset.choice",
    {},
    element("legend", {}, label),
    ...options.map(
      ([v, text]) => element(
        "label",
        {},
        element("input", { type: "radio", name, value: v, checked: v === value, change: () => chosen(v) }),
        element("span", {}, text),
      ),
    ),
  );
}

function checkbox(label, checked, changed) {
  const input = element("input", { type: "checkbox", checked, change: () => changed(input.checked) });
  return element("label.check", {}, input, element("span", {}, label));
}

function button(label, pressed, attributes = {}) {
  return element("button", { type: "button", click: pressed, ...attributes }, label);
}

/** Says in words what is not there. */
const emptyNote = (text) => element("p.empty", {}, text);

/** At most one call of `work` a frame, and in `pause` ms, however often it is asked for. */
function oncePerFrame(work, pause = 0) {
  let waiting = false;
  let last = -Infinity;
  const workInFrame = () =>
    requestAnimationFrame((now) => {
      waiting = false;
      last = now;
      work();
    });
  return () => {
    if (waiting) return;
    waiting = true;
    const left = last + pause - performance.now();
    if (left > 0) setTimeout(workInFrame, left);
    else workInFrame();
  };
}

/** At most one call of `work` for all that one event changes, and before the browser paints any of it. */
function oncePerEvent(work) {
  let waiting = false;
  return () => {
    if (waiting) return;
    waiting = true;
    queueMicrotask(() => {
      waiting = false;
      work();
    });
  };
}

/** A number that is known from below: "≥ 1.25", sorted as the number. */
class AtLeast {
  /** @param {number} value */
  constructor(value) {
    this.value = value;
  }

  valueOf() {
    return this.value;
  }

  toString() {
    return `≥ ${formatNumber(this.value, 6)}`;
  }
}

const isNumber = (content) => typeof content === "number" || content instanceof AtLeast;

/** Cells with more characters may break their lines. */
const LONG_CELL = 48;

/**
 * @param {string[]} heads
 * @param {(string|number|AtLeast|Node)[][]} rows numbers are aligned right
 */
function table(caption, heads, rows) {
  const numeric = heads.map(
    (_, k) => rows.length > 0 && rows.every((row) => isNumber(row[k]) || row[k] === NOT_KNOWN),
  );
  const kindOf = (content, k) => (numeric[k] ? "number" : String(content).length > LONG_CELL ? "long" : null);
  const shown = (content) => {
    if (content instanceof AtLeast) return String(content);
    return typeof content === "number" ? formatNumber(content, 6) : content;
  };
  const cell = (content, k) => element("td", { class: kindOf(content, k) }, shown(content));
  return element(
    "table",
    {},
    element("caption", {}, caption),
    element(
      "thead",
      {},
      element(
        "tr",
        {},
        ...heads.map((head, k) => element("th", { scope: "col", class: numeric[k] ? "number" : null }, head)),
      ),
    ),
    element("tbody", {}, ...rows.map((row) => element("tr", {}, ...row.map(cell)))),
  );
}
