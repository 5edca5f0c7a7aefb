//! Inertial parameters: efforts and energies that are linear in them, and which of them a mechanism feels.

mod base;
mod regressor;
