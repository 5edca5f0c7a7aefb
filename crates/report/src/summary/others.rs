//! Other libraries at equal error.

use super::{median, times};
use crate::curve::time_to;
use crate::peers::{Peer, fronts};
use itertools::Itertools;
use serde::Serialize;

/// Errors at the last sample that libraries are compared at.
const ASKED: [f64; 2] = [1e-6, 1e-9];

/// A library at one error.
#[derive(Debug, Serialize)]
pub struct Others {
    library: String,
    version: String,
    machine: String,
    error: String,
    /// Scenes that it can express, and those of them on which it has the error.
    scenes: usize,
    reached: usize,
    /// Its run time over ours, least, median and largest over the scenes: by the tree, and compiled.
    tree: String,
    compiled: String,
}

/// A line for each library and error.
pub fn lines(peers: &[Peer]) -> Vec<Others> {
    let libraries = peers.iter().filter(|peer| !peer.is_own());
    let libraries = libraries.unique_by(|peer| &peer.library);
    let lines = libraries.cartesian_product(ASKED);
    lines
        .map(|(peer, error)| line(peers, peer, error))
        .collect()
}

fn line(peers: &[Peer], peer: &Peer, error: f64) -> Others {
    let own = peers.iter().filter(|other| other.library == peer.library);
    let scenes: Vec<&str> = own.map(|other| other.scene.as_str()).unique().collect();
    // Run times of this library, of ours by the tree and of ours compiled.
    let found: Vec<[Option<f64>; 3]> = scenes
        .iter()
        .map(|scene| {
            let fronts = fronts(peers, scene);
            [peer.library.as_str(), "hamel", "hamel compiled"].map(|name| {
                let front = fronts.iter().find(|(library, _)| *library == name)?;
                time_to(&front.1, error)
            })
        })
        .collect();
    let ratios = |place: usize| {
        let ratios = found
            .iter()
            .filter_map(|times| Some(times[0]? / times[place]?));
        spread(&ratios.collect::<Vec<_>>())
    };
    Others {
        library: peer.library.clone(),
        version: peer.version.clone(),
        machine: peer.machine.clone(),
        error: format!("{error:.0e}"),
        scenes: scenes.len(),
        reached: found.iter().filter(|times| times[0].is_some()).count(),
        tree: ratios(1),
        compiled: ratios(2),
    }
}

fn spread(ratios: &[f64]) -> String {
    let least = ratios.iter().copied().reduce(f64::min);
    let most = ratios.iter().copied().reduce(f64::max);
    match (least, median(ratios.iter().copied()), most) {
        (Some(least), Some(middle), Some(most)) => {
            format!("{} … {} … {}", times(least), times(middle), times(most))
        }
        _ => "–".into(),
    }
}
