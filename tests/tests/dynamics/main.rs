//! Dynamics of trees: both forms against each other, against other formulations and against other programs.

mod allocation;
mod batches;
mod c99;
mod chains;
mod compiled;
mod cuda;
mod derivatives;
mod emitted;
mod errata;
mod euler_lagrange;
mod frames;
mod growth;
mod instructions;
mod left_out;
mod linear_step;
mod newton_euler;
mod numbers;
mod packs;
mod pairs_in_lanes;
mod random_trees;
mod reference_form;
mod refined;
mod robot_references;
mod slopes;
