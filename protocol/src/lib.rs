//! What crosses the bus of Isola: ids, keys, messages, one codec.
//!
//! A coordinator answers queries of workers (lease, renew, submit, fail, release) and of anyone (manifest, model,
//! backbone, windows, results, status), and announces what happens. Messages are MessagePack maps, so that a field can be
//! added; arrays travel as little-endian bytes with type and shape ([`array::Array`]).
//!
//! | module | holds |
//! |---|---|
//! | [`ids`], [`keys`], [`level`] | names of runs, tasks, workers and forcing levels; key expressions |
//! | [`codec`], [`mod@array`] | bytes of a message; arrays of numbers |
//! | [`model`], [`curve`], [`backbone`], [`branch`], [`critical`], [`landings`], [`steps`], [`orbits`] | the solver's nouns as arrays, there and back without loss |
//! | [`from_worker`], [`to_worker`], [`to_everyone`], [`control`] | messages by direction |
//! | [`digest`] | size and SHA-256 of a stored result |
//! | [`secret`], [`certificate`], [`credentials`] | what lets somebody take part in a run |
//! | [`role`] | what coordinator, worker and viewer may do, by their certificates |
//! | [`session`] | Zenoh sessions that open nothing but what they are told to; requests with a deadline |
//! | [`follow`] | a run followed from anywhere: every announcement exactly once |

#![warn(clippy::missing_errors_doc)]

pub mod array;
pub mod backbone;
pub mod branch;
pub mod certificate;
pub mod codec;
pub mod columns;
pub mod control;
pub mod credentials;
pub mod critical;
pub mod curve;
pub mod digest;
pub mod follow;
pub mod from_worker;
mod handshake;
pub mod ids;
pub mod keys;
pub mod landings;
pub mod level;
pub mod model;
pub mod orbits;
pub mod pieces;
pub mod role;
pub mod secret;
pub mod session;
mod size;
pub mod steps;
pub mod to_everyone;
pub mod to_worker;

/// Version of the messages, the `v13` of keys and encodings. Workers of another version are refused.
pub const VERSION: u32 = 13;

/// Version of the program, for the record of who computed what.
pub const PROGRAM: &str = env!("CARGO_PKG_VERSION");
