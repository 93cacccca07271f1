//! What a run of Isola has found: its database on disk, what was found level by level, exports, figures, report and live
//! page. Knows nothing of the bus.

pub mod clock;
#[cfg(any(feature = "figures", feature = "page"))]
pub mod compare;
#[cfg(any(feature = "figures", feature = "page"))]
pub mod curves;
pub mod error;
pub mod export;
#[cfg(any(feature = "figures", feature = "page"))]
pub mod figure;
#[cfg(any(test, feature = "fixture"))]
pub mod fixture;
pub mod journal;
#[cfg(feature = "page")]
pub mod live;
pub mod overview;
#[cfg(feature = "page")]
pub mod page;
#[cfg(feature = "figures")]
pub mod plot;
#[cfg(any(feature = "figures", feature = "page"))]
pub mod report;
pub mod resolved_study;
pub mod store;
pub mod summary_table;
pub mod told;
pub mod words;
