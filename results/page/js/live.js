/* A live page: the forced response while it is computed. Branches come one by one as server-sent events. */

async function startLive() {
  startTheme(document.querySelector("#theme"));
  startCharts();
  const place = document.querySelector("[data-figure]");
  const status = document.querySelector("#status");
  const say = (text) => (status.textContent = text);
  say("Connecting …");
  const answer = await fetch("/data").catch(() => null);
  if (!answer?.ok) {
    say("The run does not answer. Is it still going on? Reload to try again.");
    return;
  }
  const run = await answer.json();
  theme.palettes = run.palette;
  frequencyUnit.set(run.frequency_unit);
  chosenLength.unit = run.length_unit;
  document.title = run.run.name;
  document.querySelector("#run-name").textContent = run.run.name;
  document.querySelector("#run-facts").textContent = `Model ${run.run.model}`;
  const context = { columns: lazyColumns(run.columns), file: run.run.name };
  const section = new ResponseSection(place, run.figure, { ...run, branches: [] }, context);
  listenForBranches(section, run.levels, say);
}

/** What an event brings has its own columns. */
const columnsOf = ({ columns, first_column }) => lazyColumns(columns, first_column);

function listenForBranches(section, levels, say) {
  const events = new EventSource("/events");
  const on = (name, take) => events.addEventListener(name, ({ data }) => take(JSON.parse(data)));
  events.addEventListener("open", () => say("Connected: branches appear as they are computed."));
  on("branch", ({ branch, series, renamed, ...rest }) => {
    section.add(branch, series, columnsOf(rest), renamed);
    const received = `${countOf(section.branches.length, "branch", "branches")} received`;
    say(`${received}; last: ${branch.name} at A = ${levels[branch.level].amplitude}`);
  });
  on("backbone", ({ series, frames, ...rest }) => section.setBackbone(series, columnsOf(rest), frames));
  on("figure", (description) => section.figure.update(description));
  on("status", ({ text }) => say(text));
  on("end", (why) => {
    events.close(); // The browser would connect again.
    say(`${why} This page keeps what it received; “isola report RUN” makes the complete one.`);
  });
  // The browser connects again by itself, unless the answer was none of a run.
  events.addEventListener("error", () => {
    const isGivenUp = events.readyState === EventSource.CLOSED;
    say(`The connection is lost; ${isGivenUp ? "reload to try again." : "trying again …"}`);
  });
}

startLive();
