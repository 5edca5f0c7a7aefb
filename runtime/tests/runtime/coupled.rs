//! Joints that follow one another: one joint of several bodies is the tree of its links with the coupling eliminated.
//!
//! In the tree every link has a joint of its own, and `y = G q + y₀` with a constant G: `M = Gᵀ M_tree G`, and accelerations a are those whose efforts
//! in the tree, at `G a`, are `τ` in every direction that the coupling leaves.

use crate::common::joints;
use crate::common::random::Random;
use crate::common::trees::{GRAVITY, body, mass, pose};
use hamel_runtime::dynamics::{Dynamics, MassMatrix, Recursive, Reference};
use hamel_runtime::elements::{Element, PortEffort, PortSpring};
use hamel_runtime::erased::{AnyJoint, erase};
use hamel_runtime::joint::{
    Coupled, Joint, Link, LinkFault, LinkMotion, Patterns, Port, Structures, VelocityFrame,
    coupled, rows_at,
};
use hamel_runtime::mechanism::{BodySpec, Mechanism};
use hamel_runtime::scalar::Scalar;
use hamel_runtime::spatial::Pose;
use nalgebra::{DMatrix, DVector, SMatrix, SVector};
use std::sync::Arc;

/// Rounding times the condition of mass matrices of seven joints, below 1e3.
const ROUNDING: f64 = 1e-12;

const PORTS: [Port; 5] = [
    port("a", "rad"),
    port("b", "rad"),
    port("c", "m"),
    port("d", "rad"),
    port("e", "m"),
];

const fn port(name: &'static str, unit: &'static str) -> Port {
    Port {
        name,
        unit,
        wraps: false,
    }
}

/// A displacement along z.
#[derive(Clone, Debug)]
struct Slider;

impl Joint<1, 1, 1, 0> for Slider {
    const NAME: &'static str = "slider";
    const COORDINATES: [&'static str; 1] = ["z"];
    const FREEDOMS: [&'static str; 1] = ["z"];
    const SPEEDS: [&'static str; 1] = ["z"];
    const VELOCITY_FRAME: VelocityFrame = VelocityFrame::Declared;
    const STRUCTURES: Structures = Structures::TRIVIAL;
    const PATTERNS: Patterns<1, 1> = Patterns::DENSE;
    const UNIDENTIFIABLE: &'static [[f64; 10]] = &[];
    const SINGULARITIES: &'static [&'static str] = &[];

    fn home<T: Scalar>(&self) -> SVector<T, 1> {
        SVector::zeros()
    }

    fn pose<T: Scalar>(&self, q: &SVector<T, 1>) -> Pose<T> {
        Pose::from_translation([T::zero(), T::zero(), q[0]].into())
    }

    fn twist_map<T: Scalar>(&self, _q: &SVector<T, 1>) -> SMatrix<T, 6, 1> {
        rows_at([(5, [T::one()])])
    }

    fn twist_map_child<T: Scalar>(&self, q: &SVector<T, 1>) -> SMatrix<T, 6, 1> {
        self.twist_map(q)
    }

    fn configuration_rate<T: Scalar>(
        &self,
        _q: &SVector<T, 1>,
        v: &SVector<T, 1>,
    ) -> SVector<T, 1> {
        *v
    }

    fn retract<T: Scalar>(&self, q: &SVector<T, 1>, phi: &SVector<T, 1>) -> SVector<T, 1> {
        q + phi
    }

    fn local<T: Scalar>(&self, q: &SVector<T, 1>, target: &SVector<T, 1>) -> SVector<T, 1> {
        target - q
    }
}

/// Five links on a base: two in a row, one beside, two behind that; turns and slides that follow two coordinates, or one.
fn links(random: &mut Random, coordinates: usize) -> Vec<Link> {
    let before = [None, Some(0), None, Some(2), Some(1)];
    let turns = [true, true, false, true, false];
    let links = before.into_iter().zip(turns).enumerate();
    let links = links.map(|(number, (before, turns))| {
        let leads = number < coordinates;
        Link {
            before,
            frame: before.map_or_else(Pose::identity, |_| pose(random)),
            motion: match turns {
                true => LinkMotion::Turn,
                false => LinkMotion::Slide,
            },
            coordinate: number % coordinates,
            ratio: if leads { 1.0 } else { 2.0 * random.next() },
            offset: if leads { 0.0 } else { random.next() },
        }
    });
    links.collect()
}

/// The same bodies, with their links as one joint and each on a joint of its own.
struct Pair {
    coupled: Arc<Mechanism>,
    tree: Arc<Mechanism>,
    /// G: degrees of freedom of the coupled mechanism to those of the tree.
    map: DMatrix<f64>,
    links: Vec<Link>,
}

/// Index of the first body of the coupling.
const FIRST: usize = 1;

fn pair(seed: u64, coordinates: usize) -> Pair {
    let mut random = Random::new(seed);
    let links = links(&mut random, coordinates);
    let joint = coupled(&links, &PORTS).expect("links of a joint");
    let types: Vec<Arc<dyn AnyJoint>> = std::iter::once(Arc::clone(&joint))
        .chain(joint.more())
        .collect();
    let base = body(
        "base",
        None,
        joints::ball(),
        pose(&mut random),
        mass(&mut random),
    );
    let (mut together, mut apart) = (vec![base.clone()], vec![base]);
    let roots: Vec<Pose<f64>> = links.iter().map(|_| pose(&mut random)).collect();
    for (number, (link, joint)) in links.iter().zip(types).enumerate() {
        let root = {
            let mut at = number;
            while let Some(before) = links[at].before {
                at = before;
            }
            at
        };
        let name = format!("link {number}");
        let mut spec = body(&name, Some(0), joint, roots[root], mass(&mut random));
        spec.joint_name = "coupling".into();
        spec.child_placement = pose(&mut random);
        let placement = match link.before {
            None => roots[number],
            Some(before) => {
                let child: &BodySpec = &together[FIRST + before];
                child.child_placement.inverse() * link.frame
            }
        };
        apart.push(BodySpec {
            joint_name: name,
            parent: Some(link.before.map_or(0, |before| FIRST + before)),
            placement,
            joint: match link.motion {
                LinkMotion::Turn => joints::revolute(),
                LinkMotion::Slide => erase(Slider),
            },
            ..spec.clone()
        });
        together.push(spec);
    }
    for (n, parent) in [FIRST + 1, FIRST + 4].into_iter().enumerate() {
        let name = format!("tail {n}");
        let spec = body(
            &name,
            Some(parent),
            joints::revolute(),
            pose(&mut random),
            mass(&mut random),
        );
        together.push(spec.clone());
        apart.push(spec);
    }
    let [coupled, tree] =
        [together, apart].map(|bodies| Arc::new(Mechanism::new(GRAVITY, bodies).expect("valid")));
    let (rows, columns) = (tree.layout().freedoms, coupled.layout().freedoms);
    let mut map = DMatrix::zeros(rows, columns);
    map.view_mut((0, 0), (3, 3)).fill_with_identity();
    for (number, link) in links.iter().enumerate() {
        map[(3 + number, 3 + link.coordinate)] = link.ratio;
    }
    map.view_mut((3 + links.len(), 3 + coordinates), (2, 2))
        .fill_with_identity();
    Pair {
        coupled,
        tree,
        map,
        links,
    }
}

impl Pair {
    /// With a rotor at every link of the coupling.
    fn geared(self) -> Self {
        let inertias = [0.3, 0.0, 1.1, 0.7, 0.2];
        let coupled = Mechanism::clone(&self.coupled).with_port_armature(FIRST, &inertias);
        let mut tree = Mechanism::clone(&self.tree);
        for (number, inertia) in inertias.into_iter().enumerate() {
            let geared = tree.with_armature(FIRST + number, &[inertia]);
            tree = geared.expect("it fits");
        }
        Self {
            coupled: Arc::new(coupled.expect("it fits")),
            tree: Arc::new(tree),
            ..self
        }
    }

    /// The tree's configuration.
    fn apart(&self, q: &[f64]) -> Vec<f64> {
        let ball = 9;
        let coordinates = self.map.ncols() - 5;
        let mut all = q[..ball].to_vec();
        let links = self.links.iter();
        all.extend(links.map(|link| link.ratio * q[ball + link.coordinate] + link.offset));
        all.extend(&q[ball + coordinates..]);
        all
    }
}

/// Every other pair with rotors at the ports, which are those of the joints of the tree.
fn all() -> impl Iterator<Item = (u64, Pair)> {
    (0..8).map(|seed| {
        let pair = pair(seed, 1 + seed as usize % 2);
        match (seed / 2) % 2 {
            0 => (seed, pair),
            _ => (seed, pair.geared()),
        }
    })
}

#[track_caller]
fn close(what: &str, found: &DVector<f64>, expected: &DVector<f64>) {
    let size = 1.0 + expected.amax();
    let error = (found - expected).amax() / size;
    assert!(error <= ROUNDING, "{what}: {error:e}");
}

#[test]
fn a_coupling_is_the_tree_with_the_coupling_eliminated() {
    for (seed, pair) in all() {
        let mut random = Random::new(90 + seed);
        let q = crate::common::trees::configuration(&mut random, &pair.coupled);
        let apart = pair.apart(&q);
        let speeds = DVector::from_vec(random.vec(pair.map.ncols()));
        let efforts = DVector::from_vec(random.vec(pair.map.nrows()));
        let own = pair.map.tr_mul(&efforts);
        let mut tree = Recursive::new(Arc::clone(&pair.tree));
        let mut matrix = MassMatrix::new(&pair.tree);
        tree.mass_matrix(&apart, &mut matrix).expect("finite");
        let expected = pair.map.tr_mul(&(matrix.matrix() * &pair.map));
        let forms: [Box<dyn Dynamics>; 2] = [
            Box::new(Recursive::new(Arc::clone(&pair.coupled))),
            Box::new(Reference::new(Arc::clone(&pair.coupled))),
        ];
        for mut form in forms {
            let mut momenta = DVector::zeros(speeds.len());
            form.momenta(&q, speeds.as_slice(), momenta.as_mut_slice())
                .expect("finite");
            close("momenta", &momenta, &(&expected * &speeds));
            let mut rates = DVector::zeros(speeds.len());
            form.forward_dynamics(&q, speeds.as_slice(), own.as_slice(), rates.as_mut_slice())
                .expect("regular");
            let (moved, rising) = (&pair.map * &speeds, &pair.map * &rates);
            let mut needed = vec![0.0; efforts.len()];
            tree.inverse_dynamics(&apart, moved.as_slice(), rising.as_slice(), &mut needed)
                .expect("finite");
            let needed = pair.map.tr_mul(&DVector::from_vec(needed));
            close("efforts", &needed, &own);
        }
    }
}

#[test]
fn both_forms_say_the_same_of_momenta() {
    for (seed, pair) in all() {
        let mut random = Random::new(190 + seed);
        let q = crate::common::trees::configuration(&mut random, &pair.coupled);
        let momenta = random.vec(pair.map.ncols());
        let efforts = random.vec(pair.map.ncols());
        let forms: [Box<dyn Dynamics>; 2] = [
            Box::new(Recursive::new(Arc::clone(&pair.coupled))),
            Box::new(Reference::new(Arc::clone(&pair.coupled))),
        ];
        let [found, expected] = forms.map(|mut form| {
            let (mut speeds, mut rates) = (momenta.clone(), momenta.clone());
            let mut act = |_: &[f64], out: &mut [f64]| out.copy_from_slice(&efforts);
            form.momentum_rates(&q, &momenta, &mut act, &mut speeds, &mut rates)
                .expect("regular");
            speeds.extend(rates);
            DVector::from_vec(speeds)
        });
        close("speeds and rates of momenta", &found, &expected);
    }
}

#[test]
fn what_acts_at_a_port_acts_at_the_joint_of_the_tree() {
    for (seed, pair) in all() {
        let mut random = Random::new(290 + seed);
        let q = crate::common::trees::configuration(&mut random, &pair.coupled);
        let (apart, zero) = (pair.apart(&q), vec![0.0; pair.map.ncols()]);
        let speeds = random.vec(pair.map.ncols());
        let port = 3;
        let (effort, spring, damping, rest) = (0.7, 3.0, 0.4, 0.2);
        let elements: Vec<Arc<dyn Element>> = vec![
            Arc::new(PortEffort {
                name: "effort".into(),
                body: FIRST,
                port,
                effort: effort.into(),
            }),
            Arc::new(PortSpring {
                name: "spring".into(),
                body: FIRST,
                port,
                stiffness: spring,
                damping,
                rest,
            }),
        ];
        let bare = Arc::clone(&pair.coupled);
        let acting = (*bare).clone().with_elements(elements).expect("fits");
        let value = bare.port_values(FIRST, bare.bodies()[FIRST].configuration(&q));
        let value = value.expect("on the manifold")[port];
        assert_eq!(value, apart[9 + port]);
        let rate = bare.port_rates(FIRST, &q, &speeds).expect("fits")[port];
        let force = effort - spring * (value - rest) - damping * rate;
        let mut at_joint = DVector::zeros(pair.map.nrows());
        at_joint[3 + port] = force;
        let by_efforts = pair.map.tr_mul(&at_joint);
        let rates = |mechanism: Arc<Mechanism>, efforts: &[f64]| {
            let mut rates = zero.clone();
            Recursive::new(mechanism)
                .forward_dynamics(&q, &speeds, efforts, &mut rates)
                .expect("regular");
            DVector::from_vec(rates)
        };
        let found = rates(Arc::new(acting), &zero);
        close("accelerations", &found, &rates(bare, by_efforts.as_slice()));
    }
}

/// Each fault with its message.
#[test]
fn links_that_make_no_joint_are_refused() {
    let sound = links(&mut Random::new(3), 2);
    let fault = |change: &dyn Fn(&mut Vec<Link>)| {
        let mut links = sound.clone();
        change(&mut links);
        let size = links.len().min(PORTS.len());
        coupled(&links, &PORTS[..size])
            .expect_err("a fault")
            .to_string()
    };
    assert_eq!(
        fault(&|links| links.clear()),
        "coupled links: 0 links, not 1 to 16"
    );
    assert_eq!(
        fault(&|links| links[1].before = Some(1)),
        "coupled link 1: it hangs on link 1, which does not come before it"
    );
    assert_eq!(
        fault(&|links| links[2].ratio = 0.0),
        "coupled link 2: its ratio is 0: it must be finite, and a ratio not 0"
    );
    assert_eq!(
        fault(&|links| links[2].offset = f64::NAN),
        "coupled link 2: its offset is NaN: it must be finite, and a ratio not 0"
    );
    assert_eq!(
        fault(&|links| links[2].coordinate = 4),
        "coupled links: they follow 5 coordinates, and must follow 1 to 4"
    );
    assert_eq!(
        fault(&|links| links[4].coordinate = 3),
        "coupled links: no link follows coordinate 2"
    );
    assert!(
        fault(&|links| links[1].frame.rotation *= 2.0).starts_with("coupled link 1: its frame: ")
    );
    let few = coupled(&sound, &PORTS[..2]).expect_err("a fault");
    assert_eq!(few.to_string(), "coupled links: 2 ports, not one a link");
    let other = Coupled::<3>::new(&sound, &PORTS).expect_err("two coordinates");
    assert_eq!(other, LinkFault::Coordinates { found: 2, most: 3 });
    assert!(Coupled::<2>::new(&sound, &PORTS).is_ok_and(|joint| joint.member(5).is_none()));
}

#[test]
fn rotors_that_do_not_fit_are_refused_by_name() {
    let (_, pair) = all().next().expect("a pair");
    let refused = |body: usize, inertia: &[f64]| {
        let mechanism = Mechanism::clone(&pair.coupled);
        let found = mechanism.with_port_armature(body, inertia);
        found.expect_err("it is refused").to_string()
    };
    assert_eq!(
        refused(99, &[]),
        "armature at ports of body 99: there is no body of index 99, the mechanism has 8"
    );
    assert_eq!(
        refused(FIRST, &[0.1; 3]),
        "armature at ports of joint `coupling`: inertia has 3 entries, it must have 5"
    );
    assert_eq!(
        refused(FIRST, &[0.1, 0.1, -0.5, 0.1, 0.1]),
        "armature at ports of joint `coupling`: inertia is -0.5, it must be finite and not negative"
    );
}
