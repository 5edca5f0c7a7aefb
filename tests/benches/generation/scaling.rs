//! Generation time against the number of joints: random valid specs through the library's own build script.

use crate::{report, run, seconds};
use std::error::Error;
use std::fs;
use std::path::Path;

const SIZES: [u64; 5] = [1, 5, 20, 100, 500];

/// Times the script in folders that look like the workspace to it, and says how the time grows.
pub fn scaling(script: &Path, scratch: &Path) -> Result<(), Box<dyn Error>> {
    let mut points = vec![];
    for size in SIZES {
        let root = scratch.join(format!("scaling/{size}"));
        let package = workspace(&root, size)?;
        // It writes files where they differ, so that all runs but the first do the same work: check and rewrite nothing.
        let times = run(script, &package, scratch, &[])?;
        points.push((size as f64, times.first().map_or(f64::NAN, seconds)));
        report(&format!("{size} random specs"), times);
    }
    for pair in points.windows(2) {
        let (small, large) = (pair[0], pair[1]);
        println!(
            "from {} to {} joints: exponent {:.2}",
            small.0,
            large.0,
            exponent(pair)
        );
    }
    println!(
        "exponent over all sizes from 5 joints: {:.2}",
        exponent(&points[1..])
    );
    Ok(())
}

/// A folder of specs and an empty library beside it.
fn workspace(root: &Path, size: u64) -> Result<std::path::PathBuf, Box<dyn Error>> {
    let package = root.join("generated");
    let specs = root.join("joint-specs");
    let _ = fs::remove_dir_all(root);
    fs::create_dir_all(&specs)?;
    fs::create_dir_all(package.join("src/joints"))?;
    fs::create_dir_all(package.join("pages"))?;
    fs::write(
        package.join("kernel_accuracy.csv"),
        "joint,kernel,type,worst ulp,points\n",
    )?;
    fs::write(root.join("Cargo.toml"), "[workspace]\n")?;
    for seed in 0..size {
        fs::write(
            specs.join(format!("joint_{seed}.joint")),
            hamel_tests::specs::random(seed),
        )?;
    }
    Ok(package)
}

/// The slope of log t over log n, by least squares.
fn exponent(points: &[(f64, f64)]) -> f64 {
    let logs: Vec<(f64, f64)> = points.iter().map(|(n, t)| (n.ln(), t.ln())).collect();
    let count = logs.len() as f64;
    let mean = |f: fn(&(f64, f64)) -> f64| logs.iter().map(f).sum::<f64>() / count;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let covariance: f64 = logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    let variance: f64 = logs.iter().map(|p| (p.0 - x).powi(2)).sum();
    covariance / variance
}
