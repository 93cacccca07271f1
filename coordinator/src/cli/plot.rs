//! Options of `plot`.

use super::{one_of, whole, within};
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use results::plot::{Along, FigureName};
use results::summary_table::UnitChoice;
use std::path::PathBuf;

/// Arguments of `plot`.
#[derive(Debug, Args)]
pub struct PlotArgs {
    /// Folders of runs; several are drawn over each other (response, resonance).
    #[arg(required = true, value_name = "RUN")]
    pub runs: Vec<PathBuf>,
    /// Which figure.
    #[arg(long, value_name = "NAME", value_parser = figure_names())]
    pub figure: FigureName,
    /// File to write; its ending says what: .svg, .pdf or .png (300 pixels an inch).
    #[arg(short, long, value_name = "FILE")]
    pub out: PathBuf,
    /// Show these forcing amplitudes only: 20,60 or start:stop:step with both ends (response, map, resonance).
    #[arg(long, value_name = "LIST")]
    pub levels: Option<String>,
    /// Show motions that last so many periods of the force (search.harmonics) [default: the first order].
    #[arg(long, value_name = "M", value_parser = whole)]
    pub order: Option<usize>,
    /// Monitored dof whose amplitude is shown [default: the first one].
    #[arg(long, value_name = "DOF")]
    pub monitor: Option<String>,
    /// Any forcing amplitude, of balance and backbone [default: the lowest level with an isola, else the middle one].
    #[arg(long, value_name = "A", allow_negative_numbers = true)]
    pub amplitude: Option<String>,
    /// Mode whose backbone is drawn, from 1 (balance, backbone, modes) [default: one whose window at this amplitude led to an isola, else
    /// the first one that was followed].
    #[arg(long, value_name = "NUMBER", value_parser = whole)]
    pub mode: Option<usize>,
    /// Point of motion: amplitude, branch and index from 0, or peak [default: peak of the highest isola].
    #[arg(long, value_name = "A/BRANCH/INDEX")]
    pub at: Option<String>,
    /// What balance and modes are drawn over [default: arc].
    #[arg(long, value_name = "QUANTITY", value_parser = quantities())]
    pub along: Option<Along>,
    /// Show these frequencies only, in the unit of the axis [default: where something happens] (response, map, backbone, resonance).
    #[arg(long, num_args = 2, value_names = ["MIN", "MAX"], allow_negative_numbers = true)]
    pub frequency: Option<Vec<f64>>,
    /// Show these amplitudes of the response only, in the unit of the axis (response, backbone, folds, resonance).
    #[arg(long, num_args = 2, value_names = ["MIN", "MAX"], allow_negative_numbers = true)]
    pub response: Option<Vec<f64>>,
    /// Show these forcing amplitudes along the axis only (map, folds, resonance).
    #[arg(long, num_args = 2, value_names = ["MIN", "MAX"], allow_negative_numbers = true)]
    pub forcing: Option<Vec<f64>>,
    /// Units of axes, --frequency and --response: one of m, mm, um and one of rad/s, Hz, as in mm,Hz, or one of them only [default: those of
    /// the run, else rad/s, and what lengths are read best in].
    #[arg(long, value_name = "UNITS", value_parser = str::parse::<UnitChoice>)]
    pub units: Option<UnitChoice>,
    /// Width, mm.
    #[arg(long, value_name = "MM", allow_negative_numbers = true, default_value_t = 170.0, value_parser = millimetres)]
    pub width: f64,
    /// Height, mm.
    #[arg(long, value_name = "MM", allow_negative_numbers = true, default_value_t = 110.0, value_parser = millimetres)]
    pub height: f64,
}

fn millimetres(text: &str) -> Result<f64, String> {
    within(text, 30.0..=1000.0, "mm")
}

fn quantities() -> impl TypedValueParser<Value = Along> {
    one_of(&[
        (Along::Arc, "arc", "Arc length"),
        (Along::Omega, "omega", "Frequency"),
        (Along::Amplitude, "amplitude", "Amplitude"),
    ])
}

fn figure_names() -> impl TypedValueParser<Value = FigureName> {
    let names = FigureName::ALL.map(|figure| PossibleValue::new(figure.name()).help(figure.about()));
    PossibleValuesParser::new(names).map(|chosen| {
        let figure = FigureName::ALL.into_iter().find(|figure| figure.name() == chosen);
        figure.expect("clap lets no other name through")
    })
}
