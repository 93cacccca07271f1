//! Options of what a newcomer needs: a model to start from, and what its keys mean.

use super::{StudyArgs, one_of};
use crate::reference::File;
use crate::templates::{TEMPLATES, Template};
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use results::summary_table::UnitChoice;
use std::path::PathBuf;

/// Examples of `new`.
pub(super) const NEW: &str = "\
Examples:
  isola new first                               a model with an isola, and its study
  isola new mine --template blade               a blade with matrices in files
  isola sweep first";

/// Examples of `schema`.
pub(super) const SCHEMA: &str = "\
Examples:
  isola schema model > model.schema.json        for an editor: `#:schema model.schema.json` in line 1 of model.toml
  isola schema --explain contact.gap
  isola schema --explain harmonics
  isola schema --all                            every key in tables: a Markdown text
  isola schema --columns                        what words and columns of results mean";

/// Arguments of `new`.
#[derive(Debug, Args)]
pub struct NewArgs {
    /// Folder to write: a new one, or an empty one.
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// What to start from.
    #[arg(long, value_name = "NAME", default_value = "absorber", value_parser = templates())]
    pub template: &'static Template,
}

/// Arguments of `check`.
#[derive(Debug, Args)]
pub struct CheckArgs {
    /// Study.
    #[command(flatten)]
    pub study: StudyArgs,
    /// Units of what is printed: one of m, mm, um and one of rad/s, Hz, as in mm,Hz [default: as the study says, else m,rad/s]. Keys keep
    /// their own.
    #[arg(long, value_name = "UNITS", value_parser = str::parse::<UnitChoice>)]
    pub units: Option<UnitChoice>,
}

/// Arguments of `schema`.
#[derive(Debug, Args)]
pub struct SchemaArgs {
    /// Of which file [default: a schema that either of them fits].
    #[arg(value_parser = files())]
    pub file: Option<File>,
    /// Say what a key means, its unit, range and default, instead.
    #[arg(long, value_name = "KEY", conflicts_with = "file")]
    pub explain: Option<String>,
    /// Every key of both files in tables, as Markdown, instead.
    #[arg(long, conflicts_with_all = ["file", "explain"])]
    pub all: bool,
    /// What the words and columns of results mean, as Markdown, instead.
    #[arg(long, conflicts_with_all = ["file", "explain", "all"])]
    pub columns: bool,
}

fn templates() -> impl TypedValueParser<Value = &'static Template> {
    let names = TEMPLATES.iter().map(|template| PossibleValue::new(template.name).help(template.about));
    PossibleValuesParser::new(names).map(|chosen| {
        let template = TEMPLATES.iter().find(|template| template.name == chosen);
        template.expect("clap lets no other name through")
    })
}

fn files() -> impl TypedValueParser<Value = File> {
    one_of(&[(File::Model, "model", "model.toml"), (File::Study, "study", "study.toml")])
}

#[cfg(test)]
mod tests {
    use crate::cli::{Cli, Command};
    use clap::Parser;

    #[test]
    fn a_check_is_in_the_units_that_are_asked_for() {
        let line = ["isola", "check", "study", "--set", "units=m", "--units", "mm,Hz"];
        let Command::Check(args) = Cli::try_parse_from(line).unwrap().command else { panic!("it is a check") };
        // The last one counts.
        let changes = args.study.changes(args.units);
        assert_eq!(changes.last(), Some(&("units".to_string(), "\"mm,Hz\"".to_string())));
        let refused = Cli::try_parse_from(["isola", "check", "study", "--units", "inch"]).unwrap_err().to_string();
        assert!(refused.contains("`inch` is none of m, mm, um, rad/s and Hz"), "{refused}");
    }
}
