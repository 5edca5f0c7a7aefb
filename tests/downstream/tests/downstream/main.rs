//! Joints of a crate that uses Hamel, and those that the generator's tests hold out: what the library's own joints do not have.
//!
//! One program for all suites: each program links some hundred joints, which takes more time than most of its tests.

mod common;
mod curves;
mod derivatives;
mod dynamics;
mod exponentials;
mod five_bar;
mod gauss;
mod held_out;
mod laws;
mod loops;
mod mixed_origins;
mod multipliers;
mod names;
mod pins;
mod plants;
mod port_contacts;
mod port_control;
mod ports;
mod rotors;
mod several_bodies;
mod still_coordinates;
