//! What the documentation shows to outsiders does what it says.

#[path = "../../examples/two_masses.rs"]
mod two_masses;

#[test]
fn two_masses_before_a_stop_have_an_isola() {
    two_masses::main().unwrap();
}
