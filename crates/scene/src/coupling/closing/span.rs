//! Ranks of sets of vectors, and the smallest Lie algebra that contains given twists. What is neither rounding nor clearly there is reported, and never decided.

use hamel_runtime::spatial::bracket_product;
use nalgebra::Vector6;

/// Part of a unit vector that rounding of products of some ten poses explains, many times over.
const ROUNDING: f64 = 1e-10;

/// Part of a unit vector that is clearly there: angles in files with five digits are off by less.
const CLEAR: f64 = 1e-4;

/// What is left of a vector beside those before it, of a size between rounding and what is clear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Unclear(pub(super) f64);

/// The places of independent vectors among `vectors`, the longest first, then what is longest beside those that are taken. Vectors are of length about 1.
pub(super) fn independent(vectors: &[Vec<f64>]) -> Result<Vec<usize>, Unclear> {
    let (taken, left) = clear(vectors);
    match left <= ROUNDING {
        true => Ok(taken),
        false => Err(Unclear(left)),
    }
}

/// The places of those that are clearly independent, and the most that is left of another beside them.
fn clear(vectors: &[Vec<f64>]) -> (Vec<usize>, f64) {
    let mut left = vectors.to_vec();
    let mut taken = Vec::new();
    loop {
        let lengths = left.iter().map(|vector| norm(vector)).enumerate();
        let rest = lengths.filter(|(place, _)| !taken.contains(place));
        let longest = rest.fold(None, |best: Option<(usize, f64)>, own| match best {
            Some(best) if best.1 >= own.1 => Some(best),
            _ => Some(own),
        });
        match longest {
            None => return (taken, 0.0),
            Some((_, length)) if length < CLEAR => return (taken, length),
            Some((place, length)) => {
                let direction: Vec<f64> = left[place].iter().map(|x| x / length).collect();
                left.iter_mut().for_each(|own| eliminate(own, &direction));
                taken.push(place);
            }
        }
    }
}

fn norm(vector: &[f64]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Takes a direction out of a vector, twice against rounding.
fn eliminate(own: &mut [f64], direction: &[f64]) {
    for _ in 0..2 {
        let share: f64 = own.iter().zip(direction).map(|(a, b)| a * b).sum();
        own.iter_mut()
            .zip(direction)
            .for_each(|(a, b)| *a -= share * b);
    }
}

/// Independent ones of these twists, each scaled to length 1.
pub(super) fn basis(twists: &[Vector6<f64>]) -> Result<Vec<Vector6<f64>>, Unclear> {
    let (found, left) = clear_basis(twists);
    match left <= ROUNDING {
        true => Ok(found),
        false => Err(Unclear(left)),
    }
}

/// Those of these twists that are clearly independent, each scaled to length 1, and the most that is left of another beside them.
fn clear_basis(twists: &[Vector6<f64>]) -> (Vec<Vector6<f64>>, f64) {
    let scaled = twists.iter().map(|twist| match twist.norm() {
        length if length > 0.0 => twist / length,
        _ => *twist,
    });
    let scaled: Vec<Vector6<f64>> = scaled.collect();
    let vectors: Vec<Vec<f64>> = scaled
        .iter()
        .map(|twist| twist.as_slice().to_vec())
        .collect();
    let (places, left) = clear(&vectors);
    (
        places.into_iter().map(|place| scaled[place]).collect(),
        left,
    )
}

/// A basis of the smallest Lie algebra that contains these twists. What is not clearly independent of some may still lie in what they generate: three parallel axes nearly in
/// one plane move what two of them do.
pub(super) fn algebra(twists: &[Vector6<f64>]) -> Result<Vec<Vector6<f64>>, Unclear> {
    let mut found = clear_basis(twists).0;
    loop {
        let brackets = found.iter().enumerate().flat_map(|(i, a)| {
            let others = found[..i].iter();
            others.map(move |b| bracket_product(a, b))
        });
        let brackets: Vec<Vector6<f64>> = brackets.filter(|own| own.norm() > ROUNDING).collect();
        let (more, left) = clear_basis(&[found.as_slice(), &brackets, twists].concat());
        if more.len() == found.len() {
            return match left <= ROUNDING {
                true => Ok(found),
                false => Err(Unclear(left)),
            };
        }
        found = more;
    }
}

#[cfg(test)]
mod tests {
    use super::{Unclear, algebra, independent};
    use nalgebra::{Vector3, Vector6};

    /// A turn about an axis through a point.
    fn turn(axis: [f64; 3], point: [f64; 3]) -> Vector6<f64> {
        let (axis, point) = (Vector3::from(axis), Vector3::from(point));
        let linear = point.cross(&axis);
        Vector6::new(axis.x, axis.y, axis.z, linear.x, linear.y, linear.z)
    }

    fn size(twists: &[Vector6<f64>]) -> usize {
        algebra(twists).expect("clear").len()
    }

    const Z: [f64; 3] = [0.0, 0.0, 1.0];

    #[test]
    fn algebras_are_those_of_the_motions() {
        let parallel = [turn(Z, [0.0; 3]), turn(Z, [1.0, 0.2, 5.0])];
        assert_eq!(size(&parallel), 3, "planar motion");
        assert_eq!(
            size(&[turn(Z, [0.0; 3]), turn(Z, [0.0, 0.0, 2.0])]),
            1,
            "one axis"
        );
        let slide = Vector6::new(0.0, 0.0, 0.0, 0.0, 0.0, 1.0);
        assert_eq!(size(&[parallel[0], slide]), 2, "a cylinder");
        assert_eq!(
            size(&[parallel[0], parallel[1], slide]),
            4,
            "Schönflies motion"
        );
        let meeting = [turn(Z, [0.0; 3]), turn([1.0, 0.0, 0.0], [0.0; 3])];
        assert_eq!(size(&meeting), 3, "turns about a point");
        let skew = [turn(Z, [0.0; 3]), turn([1.0, 0.0, 0.0], [0.0, 0.5, 0.5])];
        assert_eq!(size(&skew), 6, "all motions");
    }

    /// Three parallel axes that are nearly in one plane, as those of a linkage that is folded.
    #[test]
    fn what_is_generated_need_not_be_clear_at_once() {
        let axes = [[0.0; 3], [0.5, 0.0, 0.0], [0.2, 3e-7, 0.0]].map(|point| turn(Z, point));
        assert_eq!(size(&axes), 3);
        let numbers = axes.map(|axis| axis.as_slice().to_vec());
        assert!(independent(&numbers).is_err());
    }

    /// π written as 3.1416 and an axis turned by it back and forth.
    #[test]
    fn nearly_parallel_axes_are_told() {
        let tilted = turn([0.0, 7.3e-6, 1.0], [1.0, 0.0, 0.0]);
        let Err(Unclear(left)) = algebra(&[turn(Z, [0.0; 3]), tilted]) else {
            panic!("they are neither parallel nor not");
        };
        // Once or twice the tilt.
        assert!((7e-6..2e-5).contains(&left), "{left}");
        assert_eq!(
            independent(&[vec![1.0, 0.0], vec![1.0, 1e-12]]),
            Ok(vec![0])
        );
    }
}
