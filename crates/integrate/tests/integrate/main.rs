//! Integration: order, conservation, agreement of the two forms, closed forms, sample times, refusals.

#[path = "../../../../runtime/tests/common/mod.rs"]
mod common;

mod choice;
mod dense;
mod energy;
mod events;
mod finite;
mod motion;
mod order;
mod requests;
mod singular;
mod stiff;
mod support;
