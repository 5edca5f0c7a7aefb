//! Joints of machines that the library has not: cams, rattlebacks, couplings, rails. Algebra proves each, and the judge, which shares nothing
//! with the proofs, finds no law of their kernels violated.

use hamel_codegen::derived::{Derived, Proof};
use hamel_tests::enclosure::{Point, Verdict, dimensions, judge};
use hamel_tests::refusals::files;
use num_traits::ToPrimitive;
use std::path::Path;

fn joints() -> Vec<(String, Derived)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus/kinds");
    let paths = files(&folder, "joint").expect("the folder is there");
    let derived = paths.iter().map(|path| {
        let file = path.file_name().expect("a name").to_string_lossy();
        let text = std::fs::read_to_string(path).expect("a spec");
        let joint = hamel_codegen::derive(&text, &file);
        let joint = joint.unwrap_or_else(|errors| panic!("{file}:\n{errors}"));
        (file.into_owned(), joint)
    });
    derived.collect()
}

#[test]
fn joints_of_machines_are_proved_by_algebra_alone() {
    let joints = joints();
    assert!(joints.len() >= 16, "{}", joints.len());
    for (file, joint) in joints {
        let mut claims = joint.claims.iter();
        let checked = claims.find(|claim| claim.proof == Proof::Checked);
        assert!(checked.is_none(), "{file}: {checked:?}");
    }
}

/// A value inside the range; without both ends each is smaller than the one before, as `require a > b;` wants it, and in proportion to `size`.
fn parameters(joint: &Derived, size: f64) -> Vec<f64> {
    let parameters = joint.spec.parameters.iter().enumerate();
    let value = |(n, parameter): (usize, &hamel_codegen::model::Parameter)| {
        let end = |end: &Option<hamel_codegen::model::End>| end.as_ref()?.value.to_f64();
        let index = u32::try_from(n).expect("few parameters");
        match (end(&parameter.range.lower), end(&parameter.range.upper)) {
            (Some(low), Some(high)) => 0.5 * (low + high),
            _ => size * 0.7_f64.powi(index.cast_signed()),
        }
    };
    parameters.map(value).collect()
}

#[test]
fn no_law_of_these_joints_is_violated() {
    for (file, joint) in joints() {
        let mut held = 0;
        let mut undecided = vec![];
        for n in 0..6_u32 {
            let size = [0.4, 1.3, 7.0][n as usize % 3];
            let scale = if n < 3 { 1.75 } else { 17.5 };
            let dimensions = u32::try_from(dimensions(&joint.space)).expect("few dimensions");
            let point = Point {
                parameters: parameters(&joint, scale),
                // No number occurs twice, and none is a special one.
                chart: (0..dimensions)
                    .map(|k| size * (1.0 + 1.7 * f64::from(n + 5 * k)).sin())
                    .collect(),
            };
            match judge(&joint, &point) {
                Verdict::Holds => held += 1,
                verdict @ (Verdict::Outside | Verdict::Undecided(_)) => undecided.push(verdict),
                verdict => panic!("{file}: {verdict:?} at {point:?}"),
            }
        }
        // Points of a manifold by relations are not chosen freely.
        let by_relations = !joint.space.manifold.declared().is_empty();
        assert!(held > 1 || by_relations, "{file}: {undecided:?}");
    }
}
