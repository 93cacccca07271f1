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
  const run = decodeRun(await answer.json());
  document.title = run.run.name;
  document.querySelector("#run-name").textContent = run.run.name;
  document.querySelector("#run-facts").textContent = `Model ${run.run.model}`;
  const figure = responseFigure(place, run, { runName: run.run.name });
  listenForBranches(figure, run.levels, say);
}

function listenForBranches(figure, levels, say) {
  const events = new EventSource("/events");
  events.addEventListener("open", () => say("Connected: branches appear as they are computed."));
  events.addEventListener("branch", ({ data }) => {
    const raw = JSON.parse(data);
    const level = levels.findIndex(({ value }) => value === raw.value);
    if (level < 0) return; // All levels are known from the beginning: this is none of this run.
    figure.add(decodeBranch({ ...raw, level }));
    const received = `${countOf(figure.branches.size, "branch", "branches")} received`;
    say(`${received}; last: ${raw.name} at A = ${levels[level].amplitude}`);
  });
  events.addEventListener("backbone", ({ data }) => figure.setBackbone(decodeBackbone(JSON.parse(data))));
  events.addEventListener("status", ({ data }) => say(JSON.parse(data).text));
  events.addEventListener("end", ({ data }) => {
    events.close(); // The browser would connect again.
    say(`${JSON.parse(data)} This page keeps what it received; “isola report RUN” makes the complete one.`);
  });
  // The browser connects again by itself, unless the answer was none of a run.
  events.addEventListener("error", () => {
    const isGivenUp = events.readyState === EventSource.CLOSED;
    say(`The connection is lost; ${isGivenUp ? "reload to try again." : "trying again …"}`);
  });
}

startLive();
