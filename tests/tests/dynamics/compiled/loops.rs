//! Loops over like bodies, as they are written.

use chacha20::ChaCha8Rng;
use hamel_compiler::emit::{Lowered, lines::Line};
use hamel_compiler::functions::{Kind, Loops, compile};
use hamel_tests::{compiled, random};
use rand::SeedableRng;

/// In Rust, a row that is read later in the same turn is borrowed until then: nothing else of its array can be written before.
#[test]
fn a_turn_leaves_its_row_last() {
    let registry = hamel_joints::registry();
    for name in ["revolute", "ball_child"] {
        let entry = registry.get(name).expect("a joint of the library");
        let joint = (entry.build)(&[]).expect("it has no parameters");
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let model = compiled::model(name, &random::chain(&mut random, &joint, 12));
        let mut rows = 0;
        for kind in Kind::ALL {
            // Derivatives of so many ball joints are too long, and have no loops.
            let Ok(chosen) = compile(&model, kind, Loops::Always) else {
                continue;
            };
            for line in Lowered::new(&chosen.function, &[], &[]).lines {
                let Line::Loop(turn) = line else { continue };
                let row = turn
                    .lines
                    .iter()
                    .position(|line| matches!(line, Line::Row(_)));
                if let Some(row) = row {
                    assert_eq!(row, turn.lines.len() - 1, "{name}, {kind:?}: {turn:?}");
                    rows += 1;
                }
            }
        }
        assert!(rows > 0, "{name}");
    }
}
