//! Newton's and Euler's equations of bodies that points, rods and axes hold together, with a multiplier for each.

use hamel::nalgebra::{DMatrix, DVector, Matrix3, Vector3};

/// Where a body's frame is, in the frame of the joint.
pub(super) type Placed = (Matrix3<f64>, Vector3<f64>);

/// What holds bodies together. A body is a number; none is the ground, whose frame is that of the joint.
#[derive(Clone, Copy)]
pub(super) enum Held {
    /// A point of each, in its frame, is the same point.
    Pin(Option<usize>, [f64; 3], Option<usize>, [f64; 3]),
    /// Two points keep their distance.
    Rod(Option<usize>, [f64; 3], Option<usize>, [f64; 3]),
    /// An axis of each, in its frame, is at right angles to the other.
    Square(Option<usize>, [f64; 3], Option<usize>, [f64; 3]),
}

/// One of the linkages, with its oracle.
pub(super) struct Linkage {
    pub(super) joint: &'static str,
    pub(super) parameters: &'static [f64],
    /// Poses of the bodies at Q.
    pub(super) placed: fn(&[f64]) -> Vec<Placed>,
    pub(super) held: Vec<Held>,
    /// Body and axis of its frame about which it turns at the rate that is a speed.
    pub(super) driven: Vec<(usize, [f64; 3])>,
    pub(super) speeds: &'static [f64],
    /// It pulls towards home, about which the linkage then swings.
    pub(super) gravity: [f64; 3],
}

/// Mass, centre of mass in the body's frame, inertia about it in its axes.
pub(super) fn inertia(body: usize) -> (f64, Vector3<f64>, Matrix3<f64>) {
    let n = body as f64;
    let centre = Vector3::new(0.05 + 0.01 * n, 0.02, -0.01 * n);
    let moments = Matrix3::new(
        2e-3,
        1e-4,
        0.0,
        1e-4,
        3e-3,
        -2e-4,
        0.0,
        -2e-4,
        2.5e-3 + 1e-4 * n,
    );
    (0.4 + 0.3 * n, centre, moments)
}

/// The bodies at one configuration.
struct Bodies {
    placed: Vec<Placed>,
}

/// Six numbers of a body each: angular velocity, and velocity of the centre of mass.
fn six(motion: &DVector<f64>, body: usize) -> (Vector3<f64>, Vector3<f64>) {
    let part = |n: usize| Vector3::new(motion[n], motion[n + 1], motion[n + 2]);
    (part(6 * body), part(6 * body + 3))
}

impl Bodies {
    fn centre(&self, body: usize) -> Vector3<f64> {
        let (rotation, at) = self.placed[body];
        at + rotation * inertia(body).1
    }

    fn point(&self, body: Option<usize>, point: [f64; 3]) -> Vector3<f64> {
        let point = Vector3::from(point);
        body.map_or(point, |n| self.placed[n].1 + self.placed[n].0 * point)
    }

    fn axis(&self, body: Option<usize>, axis: [f64; 3]) -> Vector3<f64> {
        let axis = Vector3::from(axis);
        body.map_or(axis, |n| self.placed[n].0 * axis)
    }

    /// Rows by which the velocity of a point in a direction follows from all motions.
    fn row(&self, body: Option<usize>, at: Vector3<f64>, along: Vector3<f64>) -> DVector<f64> {
        let mut row = DVector::zeros(6 * self.placed.len());
        if let Some(n) = body {
            let lever = at - self.centre(n);
            row.fixed_rows_mut::<3>(6 * n)
                .copy_from(&lever.cross(&along));
            row.fixed_rows_mut::<3>(6 * n + 3).copy_from(&along);
        }
        row
    }

    fn turn(&self, body: Option<usize>, along: Vector3<f64>) -> DVector<f64> {
        let mut row = DVector::zeros(6 * self.placed.len());
        if let Some(n) = body {
            row.fixed_rows_mut::<3>(6 * n).copy_from(&along);
        }
        row
    }

    fn speed(&self, body: Option<usize>, at: Vector3<f64>, motion: &DVector<f64>) -> Vector3<f64> {
        body.map_or(Vector3::zeros(), |n| {
            let (omega, v) = six(motion, n);
            v + omega.cross(&(at - self.centre(n)))
        })
    }

    /// The acceleration of a point without those of its body.
    fn inward(&self, body: Option<usize>, at: Vector3<f64>, motion: &DVector<f64>) -> Vector3<f64> {
        body.map_or(Vector3::zeros(), |n| {
            let (omega, _) = six(motion, n);
            omega.cross(&omega.cross(&(at - self.centre(n))))
        })
    }

    /// Rows G with `G motion = 0`, and `−Ġ motion` at a motion: what `G acceleration` is.
    fn rows(&self, held: &[Held], motion: &DVector<f64>) -> (Vec<DVector<f64>>, Vec<f64>) {
        let (mut rows, mut right) = (vec![], vec![]);
        for held in held {
            match *held {
                Held::Pin(a, of_a, b, of_b) => {
                    let (at, other) = (self.point(a, of_a), self.point(b, of_b));
                    let bias = self.inward(b, other, motion) - self.inward(a, at, motion);
                    for n in 0..3 {
                        let along = Vector3::ith(n, 1.0);
                        rows.push(self.row(a, at, along) - self.row(b, other, along));
                        right.push(bias[n]);
                    }
                }
                Held::Rod(a, of_a, b, of_b) => {
                    let (at, other) = (self.point(a, of_a), self.point(b, of_b));
                    let along = at - other;
                    let bias = self.inward(b, other, motion) - self.inward(a, at, motion);
                    let apart = self.speed(a, at, motion) - self.speed(b, other, motion);
                    rows.push(self.row(a, at, along) - self.row(b, other, along));
                    right.push(along.dot(&bias) - apart.norm_squared());
                }
                Held::Square(a, of_a, b, of_b) => {
                    let (u, w) = (self.axis(a, of_a), self.axis(b, of_b));
                    let omega = |n: Option<usize>| n.map_or(Vector3::zeros(), |n| six(motion, n).0);
                    let (of_u, of_w) = (omega(a), omega(b));
                    let [turned, tipped] = [of_u.cross(&u), of_w.cross(&w)];
                    let bias = of_u.cross(&turned).dot(&w)
                        + 2.0 * turned.dot(&tipped)
                        + of_w.cross(&tipped).dot(&u);
                    rows.push(self.turn(a, u.cross(&w)) - self.turn(b, u.cross(&w)));
                    right.push(-bias);
                }
            }
        }
        (rows, right)
    }
}

/// Singular values below this part of the largest one are those of pins that hold the same direction twice.
const REDUNDANT: f64 = 1e-9;

fn solved(rows: &[DVector<f64>], right: &[f64]) -> DVector<f64> {
    let rows: Vec<_> = rows.iter().map(DVector::transpose).collect();
    let matrix = DMatrix::from_rows(&rows);
    let svd = matrix.svd(true, true);
    let cut = REDUNDANT * svd.singular_values.max();
    let right = DVector::from_column_slice(right);
    svd.solve(&right, cut).expect("both sides are there")
}

/// The accelerations of the speeds, by Newton's and Euler's equations with multipliers.
pub(super) fn with_multipliers(linkage: &Linkage, q: &[f64], speeds: &[f64]) -> Vec<f64> {
    let bodies = Bodies {
        placed: (linkage.placed)(q),
    };
    let size = 6 * bodies.placed.len();
    let driven: Vec<DVector<f64>> = linkage
        .driven
        .iter()
        .map(|&(n, axis)| bodies.turn(Some(n), bodies.axis(Some(n), axis)))
        .collect();
    let (rows, _) = bodies.rows(&linkage.held, &DVector::zeros(size));
    let zeros = vec![0.0; rows.len()];
    let motion = solved(
        &[rows.clone(), driven.clone()].concat(),
        &[&zeros[..], speeds].concat(),
    );
    let (rows, bias) = bodies.rows(&linkage.held, &motion);
    // [M Gᵀ; G 0] [acceleration; −λ] = [forces; bias].
    let whole = size + rows.len();
    let mut equations = vec![DVector::zeros(whole); whole];
    let mut right = vec![0.0; whole];
    for n in 0..bodies.placed.len() {
        let (mass, _, moments) = inertia(n);
        let rotation = bodies.placed[n].0;
        let moments = rotation * moments * rotation.transpose();
        let (omega, _) = six(&motion, n);
        let torque = -omega.cross(&(moments * omega));
        for i in 0..3 {
            for j in 0..3 {
                equations[6 * n + i][6 * n + j] = moments[(i, j)];
            }
            equations[6 * n + 3 + i][6 * n + 3 + i] = mass;
            right[6 * n + i] = torque[i];
            right[6 * n + 3 + i] = mass * linkage.gravity[i];
        }
    }
    for (r, row) in rows.iter().enumerate() {
        for i in 0..size {
            equations[i][size + r] = row[i];
            equations[size + r][i] = row[i];
        }
        right[size + r] = bias[r];
    }
    let found = solved(&equations, &right);
    let acceleration = DVector::from_fn(size, |i, _| found[i]);
    // An axis about which a body turns against the ground does not move.
    driven.iter().map(|row| row.dot(&acceleration)).collect()
}
