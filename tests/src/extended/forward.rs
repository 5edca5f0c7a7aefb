//! Forward dynamics of a chain in extended precision: elimination, degree of freedom by degree of freedom, from the tip to the root.

use super::chain::{Chain, Link};
use super::number::{Exact, cross, hat};
use hamel::nalgebra::{Matrix3, SMatrix, SVector, Vector3};

type Matrix6 = SMatrix<Exact, 6, 6>;
type Vector6 = SVector<Exact, 6>;

/// One eliminated freedom: `Y = I X`, `d = Xᵀ Y` and the load on it.
struct Pivot {
    momentum: Vector6,
    inertia: Exact,
    load: Exact,
}

impl Chain {
    /// v̇ under the efforts τ.
    pub fn forward_dynamics(&self, speeds: &[Exact], efforts: &[Exact]) -> Vec<Exact> {
        let size = self.freedoms.speeds();
        let biases = self.biases(speeds);
        let mut pivots: Vec<Pivot> = Vec::new();
        let mut carried = (Matrix6::zeros(), Vector6::zeros());
        for (index, link) in self.links.iter().enumerate().rev() {
            let mut inertia = link.spatial_inertia() + &carried.0;
            let (acceleration, wrench) = &biases[index];
            let mut wrench = wrench + &carried.1 + &inertia * acceleration;
            // The last degree of freedom of a joint is nearest to the child.
            for j in (0..size).rev() {
                let axis = j + 3 - size;
                let effort = efforts[size * index + j].clone();
                pivots.push(eliminate(axis, effort, &mut inertia, &mut wrench));
            }
            let map = link.transform();
            carried = (
                symmetric(&(map.transpose() * inertia * &map)),
                map.transpose() * wrench,
            );
        }
        self.substitute(&biases, pivots)
    }

    /// Outward: the accelerations, from pivots in the order of elimination.
    fn substitute(&self, biases: &[(Vector6, Vector6)], mut pivots: Vec<Pivot>) -> Vec<Exact> {
        let size = self.freedoms.speeds();
        let mut rates = Vec::new();
        let mut motion = Vector6::zeros();
        motion
            .fixed_rows_mut::<3>(3)
            .copy_from(&-self.gravity.clone());
        for (link, (bias, _)) in self.links.iter().zip(biases) {
            motion = link.transform() * motion;
            // Wrenches and loads hold the bias already; motions of the pivots are those without it.
            for axis in 3 - size..3 {
                let Some(pivot) = pivots.pop() else { break };
                let rate = (pivot.load - dot(&pivot.momentum, &motion)) / pivot.inertia;
                motion[axis] += rate.clone();
                rates.push(rate);
            }
            motion += bias;
        }
        rates
    }

    /// Of each body: `ad_V X v`, and `−ad_Vᵀ N V`.
    fn biases(&self, speeds: &[Exact]) -> Vec<(Vector6, Vector6)> {
        let mut velocity = Vector6::zeros();
        let mut biases = Vec::new();
        let shares = speeds.chunks(self.freedoms.speeds());
        for (link, own) in self.links.iter().zip(shares) {
            let turn = self.freedoms.turn(own);
            velocity = link.transform() * velocity;
            let (angular, linear) = halves(&velocity);
            let acceleration = join(&cross(&angular, &turn), &cross(&linear, &turn));
            let both = join(&(angular + turn), &linear);
            velocity = both;
            let (moment, force) = halves(&(link.spatial_inertia() * &velocity));
            let (angular, linear) = halves(&velocity);
            let turned = cross(&angular, &moment) + cross(&linear, &force);
            biases.push((acceleration, join(&turned, &cross(&angular, &force))));
        }
        biases
    }
}

/// Takes the rotation about one axis out of `inertia` and `wrench`.
fn eliminate(axis: usize, effort: Exact, inertia: &mut Matrix6, wrench: &mut Vector6) -> Pivot {
    let momentum = inertia.column(axis).into_owned();
    let pivot = momentum[axis].clone();
    let load = effort - wrench[axis].clone();
    let share = &momentum * (Exact::from(1.0) / pivot.clone());
    *inertia = symmetric(&(&*inertia - &share * momentum.transpose()));
    *wrench += share * load.clone();
    Pivot {
        momentum,
        inertia: pivot,
        load,
    }
}

/// The lower triangle on both sides: an asymmetry would grow from body to body.
fn symmetric(matrix: &Matrix6) -> Matrix6 {
    Matrix6::from_fn(|i, j| matrix[(i.max(j), i.min(j))].clone())
}

impl Link {
    /// Twists of the link before, in its axes, to twists in this link's.
    fn transform(&self) -> Matrix6 {
        let inverse = self.rotation.transpose();
        let lower = -(&inverse * hat(&self.offset));
        blocks(&inverse, &Matrix3::zeros(), &lower, &inverse)
    }

    /// N about the origin.
    fn spatial_inertia(&self) -> Matrix6 {
        let arm = hat(&self.com);
        let coupling = &arm * self.mass.clone();
        let angular = &self.inertia - &coupling * &arm;
        let linear = Matrix3::identity() * self.mass.clone();
        symmetric(&blocks(&angular, &coupling, &-coupling.clone(), &linear))
    }
}

fn blocks(
    a: &Matrix3<Exact>,
    b: &Matrix3<Exact>,
    c: &Matrix3<Exact>,
    d: &Matrix3<Exact>,
) -> Matrix6 {
    let mut matrix = Matrix6::zeros();
    for (block, place) in [(a, (0, 0)), (b, (0, 3)), (c, (3, 0)), (d, (3, 3))] {
        matrix
            .fixed_view_mut::<3, 3>(place.0, place.1)
            .copy_from(block);
    }
    matrix
}

fn halves(vector: &Vector6) -> (Vector3<Exact>, Vector3<Exact>) {
    let half = |start: usize| Vector3::from_fn(|i, _| vector[start + i].clone());
    (half(0), half(3))
}

fn join(angular: &Vector3<Exact>, linear: &Vector3<Exact>) -> Vector6 {
    Vector6::from_fn(|i, _| {
        if i < 3 {
            angular[i].clone()
        } else {
            linear[i - 3].clone()
        }
    })
}

fn dot(a: &Vector6, b: &Vector6) -> Exact {
    (a.transpose() * b)[(0, 0)].clone()
}
