//! The same motions by other libraries, as `tests/peers/work/run.sh` measures them: `peers.csv` beside the page, where somebody has put it there.

use super::curve::front;
use super::store::foreign;
use hamel_console::output::Failure;
use itertools::Itertools;
use serde::Deserialize;
use std::path::Path;

/// The name of the file.
const FILE: &str = "peers.csv";

/// How names of our own programs begin.
const OWN: &str = "hamel";

/// An error of nothing is a tenth of a rounding: it stands on logarithmic axes, and between others.
const LEAST: f64 = 1e-17;

/// A run of a library.
#[derive(Clone, Debug, Deserialize)]
pub struct Peer {
    pub scene: String,
    pub library: String,
    /// At the last sample; infinite where the run failed.
    pub error: f64,
    pub seconds_least: Option<f64>,
    /// Of the library.
    pub version: String,
    pub machine: String,
}

impl Peer {
    /// Whether it is a run of this library.
    pub fn is_own(&self) -> bool {
        self.library.starts_with(OWN)
    }

    /// The error and the run time, s, of a run that came to its end.
    pub fn point(&self) -> Option<(f64, f64)> {
        self.seconds_least
            .map(|seconds| (self.error.max(LEAST), seconds))
            .filter(|(error, seconds)| error.is_finite() && *seconds > 0.0)
    }
}

/// The runs that the folder knows; none where the file is not there.
///
/// # Errors
/// A file that holds something else.
pub fn read(folder: &Path) -> Result<Vec<Peer>, Failure> {
    let path = folder.join(FILE);
    if !path.exists() {
        return Ok(Vec::new());
    }
    let reader = csv::Reader::from_path(&path).map_err(|error| foreign(&path, &error))?;
    let rows: csv::Result<Vec<Peer>> = reader.into_deserialize().collect();
    rows.map_err(|error| foreign(&path, &error))
}

/// Of one scene, the best of each library: its points (error, time) that no other method or tolerance of it beats.
pub fn fronts<'a>(peers: &'a [Peer], scene: &str) -> Vec<(&'a str, Vec<(f64, f64)>)> {
    let own: Vec<&Peer> = peers.iter().filter(|peer| peer.scene == scene).collect();
    let libraries = own.iter().map(|peer| peer.library.as_str()).unique();
    let fronts = libraries.map(|library| {
        let runs = own.iter().filter(|peer| peer.library == library);
        (library, front(runs.filter_map(|peer| peer.point())))
    });
    fronts.collect()
}
