//! Scene files and robots: what is read, what is refused, and the motions that come of it.

mod branches;
mod control;
mod coupled_scenes;
mod elastic;
mod estimates;
mod extreme;
mod formats;
mod forms_agree;
mod free_bodies;
mod fuzz_scenes;
mod humanoid;
mod limits;
mod linkages;
mod loops;
mod methods;
mod mimic;
mod motions;
mod orthonormality;
mod pieces;
mod plate_cart_arm;
mod references;
mod robots;
mod scene_files;
mod size;
mod timed;
mod trials;
