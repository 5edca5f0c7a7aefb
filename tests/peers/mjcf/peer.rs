//! The accelerations that Hamel gives for the states of a table on stdin, a table on stdout: `compare.py` sends and reads both.

mod states;

use states::{Answer, Peer, tables};
use std::io::Read;

/// How far an answer may be from accelerations of that size where bodies are small: MuJoCo takes products of inertia below 1e-12 kg m² for 0 where it looks for principal axes, of meshes with the density 1, as if they weighed some
/// thousand times less.
fn allowed_of_small(answer: &Answer, size: f64) -> f64 {
    answer.allowed(size) + size.max(1.0) * 1e-9 / answer.singular[1]
}

fn main() -> std::io::Result<()> {
    let mut text = String::new();
    std::io::stdin().read_to_string(&mut text)?;
    for table in tables(&text) {
        println!("model\t{}", table.file);
        let mut peer = match Peer::new(&table.file, &table.joints) {
            Ok(peer) => peer,
            Err(error) => {
                let error = error.to_string();
                println!("refused\t{}", error.replace(['\n', '\t'], " "));
                continue;
            }
        };
        for state in &table.states {
            match peer.answer(state) {
                Ok(answer) => {
                    let a: Vec<String> = answer.a.iter().map(|a| format!("{a:e}")).collect();
                    let size = state.a.iter().map(|a| a * a).sum::<f64>().sqrt();
                    println!(
                        "a\t{}\t{:e}\t{:e}",
                        a.join(" "),
                        answer.allowed(size),
                        allowed_of_small(&answer, size)
                    );
                }
                Err(error) => println!("failed\t{error}"),
            }
        }
    }
    Ok(())
}
