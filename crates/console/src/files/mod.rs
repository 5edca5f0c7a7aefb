//! The files that commands write: all of them through here.
//!
//! A command says all its files at once, with those that it reads, before it opens any: [`admit`] refuses what would destroy something. Each file is then
//! written beside its name, as a [`Draft`], and takes the name when it is whole. So whatever stops the program, a file that was there before is
//! as it was, or whole and new. The name `-` is stdout.

mod admit;
mod draft;
mod first;
mod lock;
mod place;
mod unfinished;

pub use admit::{IsOwn, Output, admit, is_stdout, new_file};
pub use draft::Draft;
pub use first::first_line;
pub use lock::Lock;
use std::path::Path;
use unfinished::Unfinished;
pub(crate) use unfinished::{private_folder, remove_unfinished};

/// The file that an option names, of a command that writes to stdout where it names none, or stdout itself.
pub fn named(option: Option<&Path>) -> Option<&Path> {
    option.filter(|path| !is_stdout(path))
}

/// Lets a command replace files that this program did not write.
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct Force {
    /// Replace files also where this program did not write them
    #[arg(long)]
    pub force: bool,
}
