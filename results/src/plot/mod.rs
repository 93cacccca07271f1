//! Single figures ready for a paper, from the store alone: `isola plot`.

mod clip;
mod compose;
mod file;
mod layout;
mod motion;
mod named;
mod part;
mod request;
mod sheet;
mod sizes;
mod svg;
#[cfg(test)]
mod tests;
mod ticks;

pub use compose::{compose, compose_several};
pub use file::FileFormat;
pub use request::{Along, FigureName, Request};
pub use sheet::Sheet;
