//! On how many scenes motions come near the floor.

use super::is_main;
use crate::row::Work;
use hamel_scene::Settings;
use serde::Serialize;

/// A line of the table.
#[derive(Debug, Serialize)]
pub struct Floors {
    what: &'static str,
    within_10: usize,
    within_100: usize,
    scenes: usize,
    /// Scenes beyond 10 floors, with how many floors.
    beyond: Vec<String>,
}

/// Of each form and of compiled equations, by the best method; and of the method that is chosen.
pub fn lines(rows: &[Work]) -> Vec<Floors> {
    type Which = fn(&Work) -> bool;
    let kinds: [(&str, Which); 4] = [
        ("best method, Lagrangian form", |row| {
            is_main(row) && row.form == "lagrangian"
        }),
        ("best method, Hamiltonian form", |row| {
            is_main(row) && row.form == "hamiltonian"
        }),
        ("best method, compiled, Lagrangian form", |row| {
            row.implementation == "compiled"
        }),
        ("the method that is chosen, Lagrangian form", |row| {
            row.method == Settings::AUTO && row.form == "lagrangian"
        }),
    ];
    let lines = kinds.map(|(what, which)| line(what, rows.iter().filter(|row| which(row))));
    lines.into_iter().filter(|line| line.scenes > 0).collect()
}

fn line<'a>(what: &'static str, rows: impl Iterator<Item = &'a Work>) -> Floors {
    let mut least: Vec<(&str, f64)> = Vec::new();
    for row in rows {
        let floors = row.error_worst.map_or(f64::INFINITY, |e| e / row.floor);
        match least.iter_mut().find(|(scene, _)| *scene == row.scene) {
            Some((_, own)) => *own = own.min(floors),
            None => least.push((&row.scene, floors)),
        }
    }
    let within = |most: f64| least.iter().filter(|(_, floors)| *floors <= most).count();
    let beyond = least.iter().filter(|(_, floors)| *floors > 10.0);
    Floors {
        what,
        within_10: within(10.0),
        within_100: within(100.0),
        scenes: least.len(),
        beyond: beyond.map(|&(scene, floors)| told(scene, floors)).collect(),
    }
}

fn told(scene: &str, floors: f64) -> String {
    match floors {
        floors if floors.is_infinite() => format!("{scene} fails"),
        floors if floors < 1e4 => format!("{scene} {floors:.0}"),
        floors => format!("{scene} {floors:.0e}"),
    }
}
