//! Rotor 67 against what is known of it: figures of an independent implementation, the paper's picture, time marching,
//! and what must hold whatever the model.

mod account;
mod backbones;
mod common;
mod growth;
mod marching;
mod responses;
mod special;
mod stability;
