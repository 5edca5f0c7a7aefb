//! Implicit steps of a chain with stiff springs and dampers at its joints, ready to be timed.

use crate::Timed;
use chacha20::ChaCha8Rng;
use cpu_time::ThreadTime;
use hamel::dynamics::Recursive;
use hamel::elements::{Element, JointDamper, JointSpring};
use hamel::integrate::{Form, Integration, Method, Options, Scheme, State};
use hamel::mechanism::Mechanism;
use hamel_tests::random;
use rand::SeedableRng;
use std::sync::Arc;

/// Steps from rest, and their length, s: the springs of bodies of order 1 have periods of 6e-3 s, and their dampers times of 1e-2 s.
const STEPS: usize = 10;
const DT: f64 = 5e-3;
const STIFFNESS: f64 = 1e6;
const DAMPING: f64 = 1e4;

/// A chain at its rest.
pub struct Implicit {
    mechanism: Arc<Mechanism>,
    scheme: Scheme,
}

impl Implicit {
    /// `count` bodies on ball joints.
    pub fn new(scheme: Scheme, count: usize) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(count as u64);
        let registry = hamel_joints::registry();
        let entry = registry.get("ball_child").expect("a joint of the library");
        let joint = (entry.build)(&[]).expect("it has no parameters");
        let bare = random::chain(&mut random, &joint, count);
        let elements = (0..count).flat_map(|body| -> [Arc<dyn Element>; 2] {
            let mut stiffness = vec![0.0; 9];
            stiffness.iter_mut().step_by(4).for_each(|k| *k = STIFFNESS);
            [
                Arc::new(JointSpring {
                    name: format!("spring {body}"),
                    body,
                    stiffness,
                    rest: bare.bodies()[body].home(),
                }),
                Arc::new(JointDamper {
                    name: format!("damper {body}"),
                    body,
                    coefficients: vec![DAMPING; 3],
                }),
            ]
        });
        let elements = elements.collect();
        let mechanism = (*bare).clone().with_elements(elements).expect("they fit");
        Self {
            mechanism: Arc::new(mechanism),
            scheme,
        }
    }

    fn run(&self) {
        let mechanism = &self.mechanism;
        let initial = State {
            time: 0.0,
            configuration: mechanism.home(),
            speeds: vec![0.0; mechanism.layout().speeds],
        };
        let options = Options {
            form: Form::Lagrangian,
            method: Method::fixed(self.scheme, DT),
            t_end: STEPS as f64 * DT,
            samples: Vec::new(),
        };
        let mut dynamics = Recursive::new(Arc::clone(mechanism));
        let solution = Integration::new(&mut dynamics, &initial, &options).run();
        assert_eq!(solution.expect("steps converge").statistics.steps, STEPS);
    }
}

impl Timed for Implicit {
    fn units(&self) -> usize {
        self.mechanism.bodies().len()
    }

    fn time(&mut self, calls: usize) -> f64 {
        let start = ThreadTime::now();
        for _ in 0..calls {
            self.run();
        }
        start.elapsed().as_nanos() as f64 / (calls * STEPS) as f64
    }
}
