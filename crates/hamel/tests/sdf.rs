//! Robots in SDF move as Drake moves them: the accelerations that it gave the models of `tests/data/sdf` at random states.

#[path = "../../../tests/peers/mjcf/states.rs"]
mod states;

use states::{Peer, tables};
use std::path::{Path, PathBuf};

fn data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/sdf")
}

#[test]
fn accelerations_are_those_of_drake() {
    let text = std::fs::read_to_string(data().join("accelerations.txt")).expect("the table");
    let tables = tables(&text);
    assert!(tables.len() >= 10, "{} models", tables.len());
    let mut wrong = Vec::new();
    for table in tables {
        let path = data().join(&table.file);
        let mut peer = Peer::new(&path.to_string_lossy(), &table.joints)
            .unwrap_or_else(|error| panic!("{}: {error}", table.file));
        assert!(table.states.len() >= 3, "{}", table.file);
        for state in &table.states {
            let answer = peer
                .answer(state)
                .expect("a mass matrix that is not singular");
            assert_eq!(answer.a.len(), state.a.len(), "{}", table.file);
            let differ = answer.a.iter().zip(&state.a).map(|(a, b)| (a - b).powi(2));
            let error = differ.sum::<f64>().sqrt();
            let size = state.a.iter().map(|a| a * a).sum::<f64>().sqrt();
            if error > answer.allowed(size) {
                wrong.push(format!(
                    "{}: {error:e} of {size:e}\n{:?}\n{:?}",
                    table.file, answer.a, state.a
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
