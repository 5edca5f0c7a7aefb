//! A joint's share in the recursions behind slices: NaN or an error for what is of another size.

use crate::common::joints;
use crate::common::polar::polar;
use crate::support::wrong_sizes;
use hamel_runtime::erased::AnyJoint;
use hamel_runtime::spatial::{ArticulatedInertia, Pose, SpatialInertia, Symmetric3};
use hamel_runtime::steps::{ChartDerivatives, Motion, Pivot, Placement, Variation};
use nalgebra::{Matrix3, Vector3, Vector6};

/// What the steps take and fill in.
#[derive(Clone)]
struct Slices {
    q: Vec<f64>,
    speeds: Vec<f64>,
    velocity: Vec<f64>,
    columns: Vec<Vector6<f64>>,
    pivots: Vec<Pivot<f64>>,
    loads: Vec<f64>,
    square: Vec<f64>,
    variations: Vec<Variation<f64>>,
}

/// Gives one of them another size.
type Resize = fn(&mut Slices, usize);

impl Slices {
    /// Of the sizes of a joint.
    fn new(joint: &dyn AnyJoint) -> Self {
        let layout = joint.layout();
        let (k, s) = (layout.freedoms, layout.speeds);
        let mut q = vec![0.0; layout.configuration];
        joint.home(&mut q);
        Self {
            q,
            speeds: vec![0.25; s],
            velocity: vec![0.25; k],
            columns: vec![Vector6::zeros(); s],
            pivots: vec![Pivot::zero(); s],
            loads: vec![0.0; s],
            square: vec![0.0; k * k],
            variations: vec![Variation::zero(); k],
        }
    }

    /// The same with one of them of other sizes.
    fn wrong(&self) -> Vec<Self> {
        let resized: [(usize, Resize); 8] = [
            (self.q.len(), |own, size| own.q.resize(size, 0.25)),
            (self.speeds.len(), |own, size| own.speeds.resize(size, 0.25)),
            (self.velocity.len(), |own, size| {
                own.velocity.resize(size, 0.25)
            }),
            (self.columns.len(), |own, size| {
                own.columns.resize(size, Vector6::zeros())
            }),
            (self.pivots.len(), |own, size| {
                own.pivots.resize(size, Pivot::zero())
            }),
            (self.loads.len(), |own, size| own.loads.resize(size, 0.0)),
            (self.square.len(), |own, size| own.square.resize(size, 0.0)),
            (self.variations.len(), |own, size| {
                own.variations.resize(size, Variation::zero())
            }),
        ];
        let mut all = Vec::new();
        for (own, resize) in resized {
            for size in wrong_sizes(own).iter().map(Vec::len) {
                let mut other = self.clone();
                resize(&mut other, size);
                all.push(other);
            }
        }
        all
    }
}

fn motion() -> Motion<f64> {
    Motion {
        placement: Placement::world(),
        twist: Vector6::repeat(0.5),
        rate: Vector6::repeat(0.5),
    }
}

fn inertia() -> SpatialInertia<f64> {
    SpatialInertia {
        mass: 2.0,
        first_moment: Vector3::zeros(),
        inertia: Symmetric3::diagonal(1.0),
    }
}

/// All steps one after the other: their results, NaN for an error.
fn results(joint: &dyn AnyJoint, slices: &mut Slices) -> Vec<f64> {
    let mut out = Vec::new();
    let (frame, world) = (Pose::identity(), motion());
    let (mut placed, mut moved) = (Placement::world(), motion());
    let Slices {
        q,
        speeds,
        velocity,
        columns,
        pivots,
        loads,
        square,
        variations,
    } = slices;
    joint.place(q, &frame, &world.placement, &mut placed);
    out.extend(placed.rotation.iter());
    joint.stand(q, &frame, &world.placement, &mut placed, columns);
    out.extend(columns.iter().map(Vector6::sum));
    joint.speed_map(q, columns);
    out.extend(columns.iter().map(Vector6::sum));
    joint.advance((q, speeds, speeds), &frame, &world, &mut moved, columns);
    out.extend(moved.twist.iter().chain(&moved.rate));
    joint.vary((q, speeds, speeds), (&moved, &world), columns, variations);
    out.extend(variations.iter().map(|v| v.rate.sum() + v.speed_rate.sum()));

    let mut momenta = vec![Vector6::zeros(); joint.layout().speeds];
    joint.momenta(&inertia(), columns, &mut momenta);
    out.extend(momenta.iter().map(Vector6::sum));
    let mut wrench = Vector6::repeat(0.5);
    joint.gather(&wrench, columns, loads);
    out.extend(loads.iter());
    let mut carried = ArticulatedInertia::from(&inertia());
    let armature = vec![0.5; speeds.len()];
    if let Err(failure) = joint.articulate(&mut carried, columns, &armature, pivots) {
        assert!(failure.pivot.is_nan());
        out.push(f64::NAN);
    }
    let whole = (&mut carried, &mut wrench);
    if joint
        .eliminate(whole, columns, (&armature, speeds), pivots, loads)
        .is_err()
    {
        out.push(f64::NAN);
    }
    joint.reduce(&mut wrench, columns, pivots, speeds, loads);
    out.extend(wrench.iter().chain(loads.iter()));
    joint.resolve(&mut wrench, columns, pivots, loads, speeds);
    out.extend(wrench.iter().chain(speeds.iter()));

    joint.reduce_efforts(q, velocity, loads);
    out.extend(loads.iter());
    joint.spring_slope(q, q, square, &mut square.clone());
    joint.turn_slope(q, &Matrix3::identity(), 1.0, square);
    out.extend(square.iter());
    joint.rotor_slopes(q, velocity, velocity, &mut square.clone(), square);
    out.extend(square.iter());
    let mut chart = ChartDerivatives {
        carried: &mut square.clone(),
        moved: &mut square.clone(),
        rate_by_base: &mut square.clone(),
        rate_by_phi: square,
        rate_by_speeds: &mut vec![0.0; velocity.len() * speeds.len()],
    };
    joint.differentiate(q, velocity, speeds, &mut chart);
    out.extend(chart.rate_by_phi.iter().chain(&*chart.rate_by_speeds));
    out
}

#[test]
fn steps_of_other_sizes_are_nan() {
    let joints = [
        joints::revolute(),
        joints::ball(),
        joints::cart(),
        joints::drift(),
        joints::planar(),
        joints::planar_euclidean(),
        polar(1.0),
    ];
    for joint in joints {
        let mut slices = Slices::new(&*joint);
        let found = results(&*joint, &mut slices.clone());
        assert!(found.iter().all(|x| x.is_finite()), "{}", joint.name());
        for (number, other) in slices.wrong().iter_mut().enumerate() {
            let found = results(&*joint, other);
            let told = format!("{} slices {number}", joint.name());
            // Where there is no room for results, there are none.
            let holds = !other.square.is_empty() && !other.variations.is_empty();
            assert!(!holds || found.iter().any(|x| x.is_nan()), "{told}");
        }
        let beyond = joint.layout().speeds + 1;
        assert_eq!(joint.column_parts(beyond), (false, false));
        slices.q.clear();
        assert!(joint.extended().project(&mut []).is_err());
    }
}
