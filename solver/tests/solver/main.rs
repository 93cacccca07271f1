//! What the solver computes, against closed forms, publications, other formulations and time marching: one program, so that
//! the compiler links the solver once.

mod bad_input;
mod bad_values;
mod balance;
mod branch_points;
mod branching;
mod carried;
mod cases;
mod closed_forms;
mod continuation;
mod crossing_backbones;
mod default_range;
mod examples;
mod far_backbones;
mod folds;
mod free_structures;
mod isolas;
mod known_isolas;
mod light_damping;
mod lineage;
mod main_pieces;
mod marching;
mod meetings;
mod models;
mod passing;
mod random_chains;
mod recheck;
mod resuming;
mod rotor67;
mod stability;
mod starts;
mod steps;
mod subharmonics;
mod support;
mod switching;
mod two_formulations;
