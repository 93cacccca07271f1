//! Forcing levels that are added to a run.

use crate::error::Error;
use crate::run::preparation;
use crate::study::{StudyError, levels, typed};
use protocol::to_everyone::Amplitude;
use results::journal::Extension;
use results::resolved_study::with_amplitudes;
use results::store::{RunHeader, Store};
use solver::response::orders::Orders;
use solver::structure::Model;

/// Of the amplitudes typed after `--amplitudes` those that a run does not have.
///
/// # Errors
/// If they are none, there is nothing new among them, or the run would have too many.
pub fn new_levels(header: &RunHeader, text: &str) -> Result<Vec<Amplitude>, Error> {
    let refused = |error| Error::Study(StudyError::from(error));
    let wanted = typed("--amplitudes", text).map_err(refused)?;
    let is_new = |level: &Amplitude| header.amplitudes.iter().all(|old| old.value != level.value);
    let new: Vec<Amplitude> = wanted.into_iter().filter(is_new).collect();
    if new.is_empty() {
        return Err(Error::Usage(format!("--amplitudes {text}: the run has all of these levels; give another one")));
    }
    typed("--amplitudes", &texts(&[&header.amplitudes[..], &new].concat()).join(",")).map_err(refused)?;
    let model = header.model.model().map_err(|error| Error::Other(format!("the stored model: {error}")))?;
    Ok(levels(&new, &Orders::of(&model, &header.settings)))
}

/// Adds levels to a run: to its study, and if its backbones are known windows and tasks of theirs.
///
/// # Errors
/// If the store cannot be read or written, or the new levels contradict the bounds of the study.
pub fn add(store: &mut Store, model: &Model, new: Vec<Amplitude>) -> Result<(), Error> {
    let header = store.header()?;
    let all = [&header.amplitudes[..], &new].concat();
    let list = texts(&all);
    let study = with_amplitudes(&header.study, &list)
        .map_err(|error| Error::Other(format!("the study of this run cannot be written: {error}")))?;
    let mut overrides = header.overrides.clone();
    overrides.retain(|(key, _)| key.trim() != "amplitudes");
    overrides.push(("amplitudes".into(), list.join(",")));
    let plan = preparation::extended(store, model, &header.settings, &all, header.amplitudes.len())?;
    store.extend(&Extension { overrides, study, amplitudes: new, plan })?;
    Ok(())
}

/// The amplitudes of levels as typed, once for all orders of motions.
fn texts(levels: &[Amplitude]) -> Vec<&str> {
    levels.iter().filter(|level| level.order().is_none()).map(|level| level.text.as_str()).collect()
}
