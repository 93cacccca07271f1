//! The page of a run: one file of HTML with everything inside, for a browser without a network.

use crate::report::Report;
use askama::Template;
use serde::Serialize;

/// Scripts one after the other; each uses what stands before it.
macro_rules! scripts {
    ($($name:literal)*) => { concat!($(include_str!(concat!("../page/js/", $name, ".js")), "\n"),*) };
}

/// Charts: BokehJS, BSD-3-Clause.
const BOKEH: &str =
    concat!(include_str!("../page/vendor/bokeh.min.js"), "\n", include_str!("../page/vendor/bokeh-api.min.js"));

const STYLE: &str = include_str!("../page/style.css");

/// Up to the figure of the forced response, which both pages have.
const COMMON: &str = scripts!(
    "data" "format" "dom" "theme" "tools" "chart" "labels" "inspect" "legend" "levels" "windows" "layers" "response"
);

/// The other figures of the report.
const FIGURES: &str = scripts!(
    "amplitude" "balance" "map" "ways" "modes" "oscillation" "motion" "shape" "account" "main"
);

/// What follows a run.
const LIVE: &str = scripts!("live");

/// The page of `isola report`.
#[derive(Template)]
#[template(path = "report.html")]
struct ReportPage<'p> {
    title: &'p str,
    style: &'p str,
    bokeh: &'p str,
    script: &'p str,
    data: &'p str,
}

/// The page of `isola watch --page`.
#[derive(Template)]
#[template(path = "live.html")]
struct LivePage<'p> {
    title: &'p str,
    style: &'p str,
    bokeh: &'p str,
    script: &'p str,
}

/// The report as one page.
pub fn report(report: &Report) -> String {
    let page = ReportPage {
        title: &report.run.name,
        style: STYLE,
        bokeh: BOKEH,
        script: &[COMMON, FIGURES].concat(),
        data: &inside_html(report),
    };
    page.render().expect("texts are written to memory")
}

/// The page that follows the run of this name.
pub fn live(name: &str) -> String {
    let page = LivePage { title: name, style: STYLE, bokeh: BOKEH, script: &[COMMON, LIVE].concat() };
    page.render().expect("texts are written to memory")
}

/// JSON that cannot end the script element that it is in.
fn inside_html(value: &impl Serialize) -> String {
    serde_json::to_string(value).expect("numbers and texts have JSON forms").replace('<', "\\u003c")
}
