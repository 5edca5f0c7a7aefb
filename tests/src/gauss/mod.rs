//! Gauss's principle of least constraint in extended precision: an oracle for joints of several bodies and joints that relations give, from their specs alone.
//!
//! It takes of a spec what its author wrote: the poses H of the bodies and the relations between the stored scalars x of Q. Twists and accelerations of bodies are derivatives of H. The
//! equations are
//!
//! ```text
//! Σ Jᵀ (M (J ẍ + J̇ ẋ) + bias) + Cᵀ λ = 0,   C ẍ + Ċ ẋ = 0,
//! ```
//!
//! with C the derivatives of all relations, those of the factors of Q included, and what wheels and axles keep of velocities ([`Ground`]). No tangent basis, no local coordinates, no recursion and no kernel of the generator is used. Where relations are
//! redundant, multipliers are not determined, but ẍ is.

mod ground;
mod solve;

pub use ground::{Ground, coordinate, parameter, pose};

use hamel::nalgebra::{Matrix3, Vector3};
use hamel_codegen::derived::Derived;
use hamel_codegen::expr::{Expr, Symbol};
use hamel_codegen::precise::{Point, Precise, Sampler};
use solve::solve;

/// Bits of the numbers.
const BITS: usize = 256;

/// Steps of Newton's method that bring doubles to [`BITS`]: each doubles their digits.
const STEPS: usize = 6;

/// An expression with its first and second derivatives by the stored scalars.
struct Smooth {
    value: Expr,
    first: Vec<Expr>,
    second: Vec<Vec<Expr>>,
}

/// A body's mass, its centre in the body's frame, and its inertia about that in the body's axes.
pub type Inertia = (f64, Vector3<f64>, Matrix3<f64>);

/// Angular acceleration in axes of the body, and acceleration of its centre of mass in axes of the joint.
pub type Acceleration = [Vector3<f64>; 2];

/// A joint by its spec.
pub struct Gauss {
    coordinates: Vec<Symbol>,
    relations: Vec<Smooth>,
    /// Of each constraint on velocities what multiplies ẋ.
    kept: Vec<Vec<Smooth>>,
    /// Of each body the nine entries of R row by row, and the three of p.
    poses: Vec<Vec<Smooth>>,
    point: Point,
    /// Moments of inertia that turn as fast as a stored scalar changes.
    rotors: Vec<(usize, f64)>,
}

/// A value with its derivative along the motion, what of its second derivative is not of ẍ, and its slopes.
struct Moving {
    value: Precise,
    rate: Precise,
    bend: Precise,
    slopes: Vec<Precise>,
}

impl Gauss {
    /// A joint with these parameters, on wheels and axles if it has some.
    ///
    /// # Panics
    /// Where no configuration of it is found.
    pub fn new(derived: &Derived, parameters: &[f64], ground: &[Ground]) -> Self {
        let space = &derived.space;
        let coordinates = space.manifold.coordinates();
        let smooth = |e: &Expr| Smooth::new(e, &coordinates);
        let relations = space.manifold.relations();
        let bodies = std::iter::once(derived).chain(&derived.more);
        let poses = bodies.map(|body| {
            let pose = &body.spec.pose.value;
            let entries = pose.rotation.entries().iter();
            entries
                .chain(pose.translation.entries())
                .map(smooth)
                .collect()
        });
        let found = Sampler::new(space, BITS).single().point();
        let mut point = found.expect("a configuration");
        for (parameter, &value) in space.parameters.iter().zip(parameters) {
            point.bind(&parameter.symbol, Precise::from_f64(value, BITS));
        }
        Self {
            relations: relations.iter().map(smooth).collect(),
            kept: ground.iter().flat_map(|own| own.rows(derived)).collect(),
            rotors: vec![],
            poses: poses.collect(),
            coordinates,
            point,
        }
    }

    /// With a rotor that turns as fast as a stored scalar changes.
    ///
    /// # Panics
    /// Where no stored scalar has this name.
    #[must_use]
    pub fn with_rotor(mut self, coordinate: &str, inertia: f64) -> Self {
        let place = self
            .coordinates
            .iter()
            .position(|own| own.name() == coordinate);
        self.rotors.push((place.expect("a stored scalar"), inertia));
        self
    }

    /// The accelerations of its bodies at Q and Q̇, both brought onto the relations, under gravity in axes of the joint.
    pub fn accelerations(
        &mut self,
        (q, rates): (&[f64], &[f64]),
        inertias: &[Inertia],
        gravity: &Vector3<f64>,
    ) -> Vec<Acceleration> {
        self.settle(q);
        let rates = self.tangent(rates);
        let bodies: Vec<Body> = self
            .poses
            .iter()
            .zip(inertias)
            .map(|(pose, inertia)| {
                let entries = pose.iter().map(|entry| self.moving(entry, &rates));
                Body::new(&entries.collect::<Vec<_>>(), inertia)
            })
            .collect();
        let relations = self.relations.iter().map(|relation| {
            let Moving { slopes, bend, .. } = self.moving(relation, &rates);
            (slopes, bend)
        });
        let kept = self.kept.iter().map(|row| {
            let row: Vec<Moving> = row.iter().map(|own| self.moving(own, &rates)).collect();
            let bend = total(row.iter().zip(&rates).map(|(own, rate)| &own.rate * rate));
            (row.into_iter().map(|own| own.value).collect(), bend)
        });
        let constraints: Vec<(Vec<Precise>, Precise)> = relations.chain(kept).collect();
        let count = self.coordinates.len();
        let zero = Precise::integer(0, BITS);
        let mut rows = vec![vec![zero; count + constraints.len() + 1]; count + constraints.len()];
        for body in &bodies {
            body.add_to(&mut rows, count, gravity);
        }
        for &(place, inertia) in &self.rotors {
            rows[place][place] = &rows[place][place] + &Precise::from_f64(inertia, BITS);
        }
        for (n, (slopes, bend)) in constraints.iter().enumerate() {
            for (i, slope) in slopes.iter().enumerate() {
                rows[count + n][i] = slope.clone();
                rows[i][count + n] = slope.clone();
            }
            *rows[count + n].last_mut().expect("a right side") = -bend;
        }
        let solution = solve(rows);
        bodies
            .iter()
            .map(|body| body.acceleration(&solution[..count]))
            .collect()
    }

    /// Newton's method along the derivatives of the relations.
    fn settle(&mut self, q: &[f64]) {
        for (coordinate, &value) in self.coordinates.iter().zip(q) {
            self.point.bind(coordinate, Precise::from_f64(value, BITS));
        }
        for _ in 0..STEPS {
            let values = self
                .relations
                .iter()
                .map(|relation| self.point.evaluate(&relation.value));
            let step = self.across(self.slopes(), values.collect());
            for (coordinate, change) in self.coordinates.clone().iter().zip(step) {
                let moved = self.point.value(coordinate) - change;
                self.point.bind(coordinate, moved);
            }
        }
    }

    /// Rates without what of them leaves the relations, or what velocities keep.
    fn tangent(&self, rates: &[f64]) -> Vec<Precise> {
        let rates: Vec<Precise> = rates
            .iter()
            .map(|&rate| Precise::from_f64(rate, BITS))
            .collect();
        let kept = self.kept.iter().map(|row| self.values(row));
        let rows: Vec<Vec<Precise>> = self.slopes().into_iter().chain(kept).collect();
        let off = rows.iter().map(|row| dot(row, &rates)).collect();
        let back = self.across(rows, off);
        rates
            .iter()
            .zip(&back)
            .map(|(rate, back)| rate - back)
            .collect()
    }

    /// The shortest change of x that changes what has these slopes C by so much: Cᵀ μ with C Cᵀ μ = change.
    fn across(&self, slopes: Vec<Vec<Precise>>, change: Vec<Precise>) -> Vec<Precise> {
        let count = self.coordinates.len();
        if slopes.is_empty() {
            return vec![Precise::integer(0, BITS); count];
        }
        let rows = slopes.iter().zip(change).map(|(row, change)| {
            let products = slopes.iter().map(|other| dot(row, other));
            products.chain([change]).collect()
        });
        let multipliers = solve(rows.collect());
        let part = |i: usize| {
            let column: Vec<Precise> = slopes.iter().map(|row| row[i].clone()).collect();
            dot(&column, &multipliers)
        };
        (0..count).map(part).collect()
    }

    /// C.
    fn slopes(&self) -> Vec<Vec<Precise>> {
        let row = |relation: &Smooth| {
            relation
                .first
                .iter()
                .map(|e| self.point.evaluate(e))
                .collect()
        };
        self.relations.iter().map(row).collect()
    }

    fn values(&self, row: &[Smooth]) -> Vec<Precise> {
        row.iter()
            .map(|own| self.point.evaluate(&own.value))
            .collect()
    }

    fn moving(&self, smooth: &Smooth, rates: &[Precise]) -> Moving {
        let slopes: Vec<Precise> = smooth
            .first
            .iter()
            .map(|e| self.point.evaluate(e))
            .collect();
        let row = |row: &Vec<Expr>| {
            let entries: Vec<Precise> = row.iter().map(|e| self.point.evaluate(e)).collect();
            dot(&entries, rates)
        };
        let bends: Vec<Precise> = smooth.second.iter().map(row).collect();
        Moving {
            value: self.point.evaluate(&smooth.value),
            rate: dot(&slopes, rates),
            bend: dot(&bends, rates),
            slopes,
        }
    }
}

impl Smooth {
    fn new(value: &Expr, coordinates: &[Symbol]) -> Self {
        let slopes =
            |e: &Expr| -> Vec<Expr> { coordinates.iter().map(|q| e.derivative(q)).collect() };
        let first = slopes(value);
        Self {
            value: value.clone(),
            second: first.iter().map(slopes).collect(),
            first,
        }
    }
}

/// A body at a state: Jacobians of its rotation in its own axes and of its centre of mass, and what of its accelerations is not of ẍ.
struct Body {
    /// Six rows, by stored scalars.
    jacobian: Vec<Vec<Precise>>,
    bias: [Precise; 6],
    turn: [Precise; 3],
    mass: Precise,
    inertia: [[Precise; 3]; 3],
}

impl Body {
    fn new(entries: &[Moving], (mass, centre, inertia): &Inertia) -> Self {
        let precise = |value: f64| Precise::from_f64(value, BITS);
        let centre = [0, 1, 2].map(|i| precise(centre[i]));
        let count = entries[0].slopes.len();
        // The skew part of RᵀA, as a vector.
        let turn_of = |part: &dyn Fn(&Moving) -> Precise| {
            let entry = |i: usize, j: usize| {
                let terms = (0..3).map(|k| &entries[3 * k + i].value * &part(&entries[3 * k + j]));
                total(terms)
            };
            [(2, 1), (0, 2), (1, 0)].map(|(i, j)| (entry(i, j) - entry(j, i)).halved(1))
        };
        let centre_of = |part: &dyn Fn(&Moving) -> Precise| {
            [0, 1, 2].map(|i| {
                let terms = (0..3).map(|k| &part(&entries[3 * i + k]) * &centre[k]);
                total(terms) + part(&entries[9 + i])
            })
        };
        let column = |n: usize| {
            let slope = move |own: &Moving| own.slopes[n].clone();
            [turn_of(&slope), centre_of(&slope)].concat()
        };
        let columns: Vec<Vec<Precise>> = (0..count).map(column).collect();
        let row = |r: usize| columns.iter().map(|column| column[r].clone()).collect();
        let bend = |own: &Moving| own.bend.clone();
        let ([a, b, c], [d, e, f]) = (turn_of(&bend), centre_of(&bend));
        Self {
            jacobian: (0..6).map(row).collect(),
            bias: [a, b, c, d, e, f],
            turn: turn_of(&|own| own.rate.clone()),
            mass: precise(*mass),
            inertia: [0, 1, 2].map(|i| [0, 1, 2].map(|j| precise(inertia[(i, j)]))),
        }
    }

    /// Momentum's rate of change at these accelerations, without the gyroscopic torque.
    fn weighed(&self, accelerations: &[Precise]) -> Vec<Precise> {
        let torque = self.inertia.iter().map(|row| dot(row, &accelerations[..3]));
        let force = accelerations[3..].iter().map(|entry| &self.mass * entry);
        torque.chain(force).collect()
    }

    fn add_to(&self, rows: &mut [Vec<Precise>], count: usize, gravity: &Vector3<f64>) {
        let spin: Vec<Precise> = self
            .inertia
            .iter()
            .map(|row| dot(row, &self.turn))
            .collect();
        let mut free = self.bias.to_vec();
        for (i, entry) in free[3..].iter_mut().enumerate() {
            *entry = &*entry - &Precise::from_f64(gravity[i], BITS);
        }
        let mut wrench = self.weighed(&free);
        for (i, torque) in wrench[..3].iter_mut().enumerate() {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            let gyroscopic = &(&self.turn[j] * &spin[k]) - &(&self.turn[k] * &spin[j]);
            *torque = &*torque + &gyroscopic;
        }
        let column =
            |n: usize| -> Vec<Precise> { self.jacobian.iter().map(|row| row[n].clone()).collect() };
        let columns: Vec<Vec<Precise>> = (0..count).map(column).collect();
        for (row, own) in rows.iter_mut().zip(&columns) {
            let weighed = self.weighed(own);
            for (entry, other) in row.iter_mut().zip(&columns) {
                *entry = &*entry + &dot(other, &weighed);
            }
            let right = row.last_mut().expect("a right side");
            *right = &*right - &dot(own, &wrench);
        }
    }

    fn acceleration(&self, second: &[Precise]) -> Acceleration {
        let rows = self.jacobian.iter().zip(&self.bias);
        let all: Vec<f64> = rows
            .map(|(row, bias)| (dot(row, second) + bias.clone()).to_f64())
            .collect();
        [
            Vector3::from_column_slice(&all[..3]),
            Vector3::from_column_slice(&all[3..]),
        ]
    }
}

fn dot(a: &[Precise], b: &[Precise]) -> Precise {
    total(a.iter().zip(b).map(|(a, b)| a * b))
}

fn total(terms: impl Iterator<Item = Precise>) -> Precise {
    terms.fold(Precise::integer(0, BITS), |sum, term| sum + term)
}
