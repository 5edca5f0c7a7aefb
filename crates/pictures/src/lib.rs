#![doc = include_str!("../README.md")]
//!
//! [`Page`] records a motion as a page of HTML, [`Pictures`] as still and moving pictures. Both take the same [`Sample`]s. [`Meshes`] are the files of meshes that a
//! scene names.

mod meshes;
mod page;
mod picture;
mod sample;

pub use meshes::{Meshes, locate};
pub use page::{Contents, Page, Told, does_work, is_page};
pub use picture::{Pictures, Playing, is_gif, is_png, is_svg};
pub use sample::Sample;
