//! Integration: order, conservation, agreement of the two forms, closed forms, sample times, refusals.

#[path = "../../../../runtime/tests/common/mod.rs"]
mod common;

mod adaptive;
mod choice;
mod coupled;
mod dense;
mod doubts;
mod elements;
mod energy;
mod estimates;
mod events;
mod finite;
mod motion;
mod order;
mod requests;
mod singular;
mod stiff;
mod support;
mod together;
