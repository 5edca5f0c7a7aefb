//! The files that commands write: all of them through here.
//!
//! A command says all its files at once, with those that it reads, before it opens any: [`admit`] refuses what would destroy something. Each file is then
//! written beside its name, as a [`Draft`], and takes the name when it is whole. So whatever stops the program, a file that was there before is
//! as it was, or whole and new.

mod admit;
mod draft;
mod first;
#[cfg(feature = "report")]
mod lock;
mod place;
mod unfinished;

pub use admit::{Output, admit, new_file};
pub use draft::Draft;
pub use first::first_line;
#[cfg(feature = "report")]
pub use lock::Lock;
pub use unfinished::{Unfinished, private_folder, remove_unfinished};

/// Lets a command replace files that this program did not write.
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct Force {
    /// Replace files also where this program did not write them
    #[arg(long)]
    pub force: bool,
}
