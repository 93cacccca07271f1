/* Account: every window, every branch, every worker; settings, study. */

function accountSection(place, run) {
  const { account } = run;
  const sorted = [];
  place.append(
    followingUnits(() => windowTable(run)),
    followingUnits(() => branchTable(run, sorted)),
    workerTable(account),
    taskDetails(run),
    details("Settings", tableOf("Settings of the computation", ["setting", "value"], account.settings)),
    details("Words of this page", tableOf("Words of this page", ["word", "what it means"], run.words)),
    details("Versions and sizes", tableOf("Versions and sizes", ["what", "value"], factsOf(run))),
    details("Study as it was run", element("pre", {}, account.study)),
  );
}

/** How seeds are landed, as the store calls it, in words. */
const WAYS = { fixed_frequency: "full forcing", stepped_forcing: "steps in the forcing" };

const details = (summary, ...children) => element("details", {}, element("summary", {}, summary), ...children);

/** A table that scrolls inside its frame; in words if it has no rows. */
function tableOf(caption, heads, rows, none = "Nothing yet.") {
  if (rows.length === 0) return element("div", {}, element("h3", {}, caption), emptyNote(none));
  return element("div.scroll", { tabindex: 0, role: "region", "aria-label": caption }, table(caption, heads, rows));
}

function windowTable({ levels }) {
  const rows = levels.flatMap((level) => {
    const remarks = [
      level.main_failure && `main branch failed: ${level.main_failure}`,
      level.pending > 0 && `${countOf(level.pending, "task")} to come`,
      level.dead > 0 && `${countOf(level.dead, "task")} given up`,
    ].filter(Boolean);
    const failed = level.main_failure || level.dead > 0;
    const word = element(failed ? "span.bad" : "span", {}, failed ? "incomplete" : "goes on");
    const remark = remarks.length > 0 ? [[level.value, NOT_KNOWN, NOT_KNOWN, NOT_KNOWN, NOT_KNOWN, word, remarks.join("; ")]] : [];
    return [...remark, ...level.windows.map((window) => windowRow(level, window))];
  });
  const holder = tableOf(
    "Windows of every level",
    ["A", "window", "mode", `frequencies, ${frequencyUnit.get()}`, "threshold A*", "outcome", "branches, or why not"],
    rows,
    "No window is predicted, or the backbone is not there yet.",
  );
  holder.classList.add("stacked");
  return holder;
}

/** What became of a window comes with the branches that it led to, or with the reason why there are none. */
function windowRow(level, { number, mode, omega, threshold, outcome }) {
  const [[name, text]] = Object.entries(outcome);
  const word = element(["not_found", "elsewhere", "passed"].includes(name) ? "span.bad" : "span", {}, name.replaceAll("_", " "));
  return [level.value, number, mode, formatRange(omega.map(inChosenUnit)), rounded(threshold, 5), word, (text.told ?? text) || NOT_KNOWN];
}

const rounded = (value, digits) => Number((value ?? NaN).toPrecision(digits));

/** "isola 2" before "isola 10" */
const byName = new Intl.Collator("en", { numeric: true });

/** Sorted by the columns whose heads were pressed, the last one first, which `sorted` keeps where the table is drawn anew. */
function branchTable({ branches, levels }, sorted) {
  const largest = branches.map((branch) => branch.amplitude_at_peak ?? NaN);
  const unit = lengthUnit(Math.max(...largest.filter(Number.isFinite), 0));
  const size = `largest amplitude, ${unit.name}`;
  const heads = ["A", "branch", "found by", "points", size, `at, ${frequencyUnit.get()}`, "by time marching", "how it ends", "time, s", "worker"];
  const told = (branch) => levels[branch.level].branches.find(({ kind, number }) => kind === branch.kind && number === branch.number);
  const rows = branches.map((branch, k) => [
    levels[branch.level].value,
    branch.name,
    told(branch)?.found_by ?? NOT_KNOWN,
    branch.size,
    branch.peak_standing === "at_least" ? new AtLeast(rounded(largest[k] * unit.factor, 5)) : rounded(largest[k] * unit.factor, 5),
    rounded(inChosenUnit(branch.omega_at_peak ?? NaN), 6),
    told(branch)?.by_marching ?? NOT_KNOWN,
    branch.status,
    rounded(branch.seconds, 3),
    branch.worker ?? NOT_KNOWN,
  ]);
  const by = (rows, { column, down }) => {
    const order = (a, b) =>
      isNumber(a[column]) ? a[column] - b[column] : byName.compare(a[column], b[column]);
    return rows.toSorted((a, b) => (down ? -order(a, b) : order(a, b)));
  };
  const ordered = () => sorted.reduce(by, rows);
  const holder = tableOf("Branches (press a head to sort)", heads, ordered(), "No branch has been computed yet.");
  const sort = (column) => {
    const last = sorted.at(-1);
    const before = sorted.findIndex((earlier) => earlier.column === column);
    if (before >= 0) sorted.splice(before, 1);
    sorted.push({ column, down: last?.column === column && !last.down });
    holder.replaceChildren(table("Branches (press a head to sort)", heads, ordered()));
    armHeads();
    holder.querySelectorAll("th button")[column].focus();
  };
  const armHeads = () =>
    holder.querySelectorAll("th").forEach((head, k) => {
      const { column, down } = sorted.at(-1) ?? { column: -1 };
      const arrow = k === column ? (down ? " ↓" : " ↑") : "";
      head.setAttribute("aria-sort", arrow === "" ? "none" : down ? "descending" : "ascending");
      head.replaceChildren(button(heads[k] + arrow, () => sort(k)));
    });
  armHeads();
  return holder;
}

function workerTable({ workers }) {
  const rows = workers.map(({ name, branches, tasks, seconds, programs }) => [
    name,
    tasks,
    branches,
    formatSeconds(seconds),
    programs.join(", "),
  ]);
  return tableOf(
    "Workers",
    ["worker", "tasks", "branches", "computing time", "program"],
    rows,
    "No worker has handed in anything yet.",
  );
}

function taskDetails({ account, levels }) {
  const rows = account.tasks.map((task) => [
    task.task,
    levels[task.level]?.value ?? NaN,
    task.kind,
    task.window ?? NOT_KNOWN,
    [task.phase, WAYS[task.way]].filter(Boolean).join(", ") || NOT_KNOWN,
    task.state,
    task.attempts,
    task.outcome ?? NOT_KNOWN,
    task.branch ?? NOT_KNOWN,
    task.worker ?? NOT_KNOWN,
    rounded(task.seconds, 3),
  ]);
  const heads = ["task", "A", "kind", "window", "seed", "state", "attempts", "outcome", "branch", "worker", "time, s"];
  const made = details(`Tasks (${rows.length})`);
  // There may be thousands: they are laid out when somebody wants to see them.
  made.addEventListener("toggle", () => {
    if (made.children.length === 1) made.append(tableOf("Tasks", heads, rows, "No task has been handed out yet."));
  });
  return made;
}

function factsOf({ run, account, branches }) {
  const points = branches.reduce((sum, { size }) => sum + size, 0);
  return [
    ["run", run.id],
    ["model", run.model],
    ["study file", run.study_file],
    ["program", run.program],
    ["started", run.created],
    ["page made", run.made],
    ["points of the backbone", String(account.backbone_points)],
    ["branches", String(branches.length)],
    ["points of branches", String(points)],
    ["charts", `BokehJS ${Bokeh.version} (BSD-3-Clause)`],
  ];
}
