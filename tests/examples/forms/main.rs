//! The Lagrangian and the port-Hamiltonian form beside each other: error at equal cost, drift, and extreme mass ratios.
//!
//! `cargo run --release --package hamel-tests --example forms` prints the tables of `docs/forms.md`.

mod cost;
mod drift;
mod motion;
mod ratio;

fn main() {
    cost::table();
    drift::table();
    ratio::table();
}
