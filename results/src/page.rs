//! The page of a run: one file of HTML with everything inside, for a browser without a network.

mod compared;
mod data;
#[cfg(all(test, feature = "figures"))]
mod tests;

use crate::compare::Comparison;
use crate::report::Report;
pub use data::PageOfOrder;
pub(crate) use data::{length_unit, lengths};
use miniz_oxide::inflate::decompress_to_vec_zlib;
use serde::Serialize;

/// Scripts one after the other; each uses what stands before it.
macro_rules! scripts {
    ($($name:literal)*) => { concat!($(include_str!(concat!("../page/js/", $name, ".js")), "\n"),*) };
}

/// Charts: BokehJS, BSD-3-Clause; packed (`build.rs`).
const BOKEH: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/bokeh.zlib"));

const STYLE: &str = include_str!("../page/style.css");

/// Up to the figure of the forced response, which both pages have.
const COMMON: &str = scripts!(
    "data" "format" "dom" "units" "theme" "tools" "chart" "marks" "labels" "inspect" "legend" "signals" "curves" "amplitude"
    "panel" "figure" "levels" "response"
);

/// The other figures of the report.
const FIGURES: &str = scripts!("motion" "account" "main");

/// What compares runs.
const COMPARE: &str = scripts!("compare");

/// What follows a run.
const LIVE: &str = scripts!("live");

/// What both pages are in.
const FRAME: &str = include_str!("../page/frame.html");

/// The report as one page, with links to those of other orders of motions that are written beside it.
pub fn report(report: &Report, beside: &[PageOfOrder]) -> String {
    let title = escaped(&report.run.name);
    let data = inside_html(&data::PageData::new(report, beside));
    let body = filled(include_str!("../page/report.html"), &[("title", &title), ("data", &data)]);
    framed(&title, &body, &[COMMON, FIGURES].concat(), "")
}

/// Several runs as one page.
pub fn compare(comparison: &Comparison) -> String {
    let title = escaped(&comparison.names.join(" and "));
    let data = inside_html(&compared::ComparedData::new(comparison));
    let body = filled(include_str!("../page/compare.html"), &[("title", &title), ("data", &data)]);
    framed(&title, &body, &[COMMON, COMPARE].concat(), "")
}

/// The page that follows the run of this name.
pub fn live(name: &str) -> String {
    let title = escaped(name);
    let body = filled(include_str!("../page/live.html"), &[("title", &title)]);
    framed(&title, &body, &[COMMON, LIVE].concat(), "; connect-src 'self'")
}

/// A page with this title and body, and with what the security policy allows it to connect to.
fn framed(title: &str, body: &str, script: &str, connect: &str) -> String {
    let bokeh = decompress_to_vec_zlib(BOKEH).expect("packed by `build.rs`");
    let parts = [
        ("title", title),
        ("connect", connect),
        ("style", STYLE),
        ("body", body),
        ("bokeh", str::from_utf8(&bokeh).expect("a script")),
        ("script", script),
    ];
    filled(FRAME, &parts)
}

/// A template with every `{{ name }}` replaced by the part of that name; what is in the parts stays as it is.
fn filled(template: &str, parts: &[(&str, &str)]) -> String {
    let mut text = String::new();
    let mut rest = template;
    while let Some((before, after)) = rest.split_once("{{ ") {
        let (name, after) = after.split_once(" }}").expect("templates are ours");
        let part = parts.iter().find(|(known, _)| *known == name).expect("templates name parts that there are");
        text += before;
        text += part.1;
        rest = after;
    }
    text + rest
}

/// A text that is no markup.
fn escaped(text: &str) -> String {
    let entity = |c: char| match c {
        '&' => "&amp;".into(),
        '<' => "&lt;".into(),
        '>' => "&gt;".into(),
        '"' => "&quot;".into(),
        c => c.to_string(),
    };
    text.chars().map(entity).collect()
}

/// JSON that cannot end the script element that it is in.
fn inside_html(value: &impl Serialize) -> String {
    serde_json::to_string(value).expect("numbers and texts have JSON forms").replace('<', "\\u003c")
}
