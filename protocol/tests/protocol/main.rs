//! Bytes, keys and conversions of the messages.

mod frozen;
mod keys;
mod round_trips;
mod samples;
mod view;
