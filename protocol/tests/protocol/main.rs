//! Bytes, keys and conversions of the messages; runs that are followed.

mod digest;
mod follow;
mod frozen;
mod fuzz;
mod keys;
mod round_trips;
mod samples;
mod view;
