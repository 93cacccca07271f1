//! The coordinator's library from outside: one program, so that the compiler links it once.

mod check;
mod check_laws;
mod interrupted;
mod reference;
mod study;
mod told;
