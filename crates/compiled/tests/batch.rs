//! Many states at once: the same as one by one, at every level, whatever their number and the threads; wrong sizes are named.
#![cfg(all(feature = "alloc", feature = "rayon"))]

use hamel_compiled::{
    Batch, BatchError, Equations, InLanes, LANES, LaneScalar, Lanes, Level, OfEight, Registers,
    many_states,
};
use hamel_runtime::scalar::Scalar;

/// Two angles with speeds and three efforts: what a module holds, by hand.
fn forward<T: Scalar>(q: &[T; 2], v: &[T; 2], u: &[T; 3]) -> [T; 2] {
    let ([s0, s1], [c0, _]) = T::sin_cos_all(&[q[0], q[1]]);
    let inertia = c0.mul_add(c0, T::from_f64(1.5));
    let first = v[1].mul_add(-v[0], u[0] - s0 * T::from_f64(9.81)) / inertia;
    [first, s1.mul_add(u[1], u[2] * v[0]) - first]
}

struct Forward;
impl OfEight<2, 2, 3, 2> for Forward {
    #[inline(always)]
    fn eight<T: LaneScalar, I: Registers>(
        _simd: I,
        q: &[Lanes; 2],
        v: &[Lanes; 2],
        u: &[Lanes; 3],
        results: &mut [Lanes; 2],
    ) {
        for lane in 0..LANES {
            let n = |entry: &Lanes| T::from_f64(entry.0[lane]);
            let (q, v) = ([n(&q[0]), n(&q[1])], [n(&v[0]), n(&v[1])]);
            let [first, second] = forward(&q, &v, &[n(&u[0]), n(&u[1]), n(&u[2])]);
            results[0].0[lane] = first.number();
            results[1].0[lane] = second.number();
        }
    }
}

const IN_LANES: Equations = Equations {
    scene: "by hand",
    configuration: 2,
    freedoms: 3,
    speeds: 2,
    momenta: None,
    speeds_from_momenta: None,
    momentum_rates: None,
    hamiltonian: None,
    forward_dynamics: Some(|q, v, u, rates| {
        if let (Some(q), Some(v), Some(u), Some(rates)) = (
            q.first_chunk(),
            v.first_chunk(),
            u.first_chunk(),
            rates.first_chunk_mut(),
        ) {
            *rates = forward(q, v, u);
        }
    }),
    inverse_dynamics: None,
    forward_dynamics_derivatives: None,
    inverse_dynamics_derivatives: None,
    forward_dynamics_second_derivatives: None,
    inverse_dynamics_second_derivatives: None,
    forward_slopes: 0,
    mass_matrix: None,
    inverse_mass_matrix: None,
    in_lanes: InLanes {
        forward_dynamics: Some(many_states::<Forward, 2, 2, 3, 2>),
        ..InLanes::NONE
    },
};

const ONE_BY_ONE: Equations = Equations {
    in_lanes: InLanes::NONE,
    ..IN_LANES
};

/// Numbers that repeat nowhere, of magnitudes up to some tens.
fn numbers(count: usize, scale: f64) -> Vec<f64> {
    (0..count)
        .map(|i| scale * (0.731 * i as f64 + 0.2).sin())
        .collect()
}

struct Case {
    q: Vec<f64>,
    v: Vec<f64>,
    u: Vec<f64>,
}

impl Case {
    fn new(states: usize) -> Self {
        Self {
            q: numbers(2 * states, 30.0),
            v: numbers(2 * states, 3.0),
            u: numbers(3 * states, 5.0),
        }
    }

    fn run(&self, batch: &Batch) -> Vec<f64> {
        let mut rates = vec![f64::NAN; self.v.len()];
        let done = batch.forward_dynamics(&self.q, &self.v, &self.u, &mut rates);
        done.expect("sizes fit");
        rates
    }

    /// The same with eight states side by side.
    fn run_side_by_side(&self, batch: &Batch) -> Vec<f64> {
        let [q, v, u] = [(&self.q, 2), (&self.v, 2), (&self.u, 3)]
            .map(|(of, width)| Lanes::side_by_side(of, width));
        let mut rates = vec![Lanes([f64::NAN; 8]); v.len()];
        let done = batch.forward_dynamics(&q, &v, &u, &mut rates);
        done.expect("sizes fit");
        let mut shared = rates.clone();
        let done = batch.par_forward_dynamics(&q, &v, &u, &mut shared);
        done.expect("sizes fit");
        let rates = Lanes::apart(&rates, 2);
        assert_eq!(bits(&Lanes::apart(&shared, 2)), bits(&rates));
        rates[..self.v.len()].to_vec()
    }
}

/// NaN equals NaN.
fn bits(numbers: &[f64]) -> Vec<u64> {
    numbers.iter().map(|number| number.to_bits()).collect()
}

fn levels() -> impl Iterator<Item = Level> {
    Level::ALL.into_iter().filter(|level| level.is_available())
}

#[test]
fn lanes_are_single_states_to_rounding_at_every_level() {
    let case = Case::new(1003);
    let expected = case.run(&Batch::new(&ONE_BY_ONE));
    for level in levels() {
        let found = case.run(&Batch::at(&IN_LANES, level).expect("it is available"));
        for (state, (found, expected)) in found.chunks(2).zip(expected.chunks(2)).enumerate() {
            let largest = expected.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
            for (a, b) in found.iter().zip(expected) {
                // A dozen operations of numbers up to ten times the result, fused or not.
                let bound = 200.0 * f64::EPSILON * largest;
                assert!((a - b).abs() <= bound, "{level:?} {state}: {a} {b}");
            }
        }
    }
}

#[test]
fn states_side_by_side_are_those_of_rows() {
    for states in [0, 1, 8, 13, 1003] {
        let mut case = Case::new(states);
        if let Some(angle) = case.q.last_mut() {
            // Beyond the fast path.
            *angle = 1e6;
        }
        for level in levels() {
            let batch = Batch::at(&IN_LANES, level).expect("it is available");
            assert_eq!(case.run_side_by_side(&batch), case.run(&batch));
        }
        let one_by_one = Batch::new(&ONE_BY_ONE);
        assert_eq!(case.run_side_by_side(&one_by_one), case.run(&one_by_one));
    }
}

#[test]
fn rows_go_side_by_side_and_apart() {
    let rows: Vec<f64> = (0..33).map(f64::from).collect();
    let lanes = Lanes::side_by_side(&rows, 3);
    assert_eq!(lanes.len(), 6);
    assert_eq!(
        lanes[1],
        Lanes([1.0, 4.0, 7.0, 10.0, 13.0, 16.0, 19.0, 22.0])
    );
    // Three states are left, the last one repeated.
    assert_eq!(lanes[5].0, [26.0, 29.0, 32.0, 32.0, 32.0, 32.0, 32.0, 32.0]);
    assert_eq!(Lanes::apart(&lanes, 3)[..33], rows);
    assert!(Lanes::side_by_side(&[], 3).is_empty() && Lanes::side_by_side(&[], 0).is_empty());
}

#[test]
fn a_state_does_not_depend_on_the_number_of_states() {
    let many = Case::new(40);
    for level in levels() {
        let batch = Batch::at(&IN_LANES, level).expect("it is available");
        let all = many.run(&batch);
        for states in 0..=40 {
            let few = Case {
                q: many.q[..2 * states].to_vec(),
                v: many.v[..2 * states].to_vec(),
                u: many.u[..3 * states].to_vec(),
            };
            assert_eq!(few.run(&batch), all[..2 * states]);
        }
    }
}

#[test]
fn a_state_does_not_depend_on_the_number_of_threads() {
    let case = Case::new(2051);
    let batch = Batch::new(&IN_LANES);
    let expected = case.run(&batch);
    for threads in [1, 2, 3, 7] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let mut rates = vec![f64::NAN; case.v.len()];
        let (q, v, u) = (&case.q, &case.v, &case.u);
        let done = pool
            .expect("threads")
            .install(|| batch.par_forward_dynamics(q, v, u, &mut rates));
        done.expect("sizes fit");
        assert_eq!(rates, expected);
    }
}

#[test]
fn angles_beyond_the_fast_path_are_computed_again() {
    let mut case = Case::new(20);
    case.q[6] = 1e6;
    case.q[31] = f64::NAN;
    let expected = case.run(&Batch::new(&ONE_BY_ONE));
    let found = case.run(&Batch::new(&IN_LANES));
    assert!(expected[6].is_finite());
    assert_eq!(found[6..8], expected[6..8]);
    assert!(found[31].is_nan() && found[32].is_finite());
}

#[test]
fn what_does_not_fit_is_named() {
    let Case { q, v, u } = Case::new(5);
    let batch = Batch::new(&IN_LANES);
    let mut rates = vec![0.0; 9];
    let error = batch.forward_dynamics(&q[1..], &v, &u, &mut rates);
    let text = error.expect_err("too short").to_string();
    assert_eq!(
        text,
        "a batch of 5 rows of `by hand`: configuration must have 10 numbers, not 9; rates must have 10 numbers, not 9"
    );
    let error = batch.forward_dynamics(&q, &v[1..], &u, &mut rates);
    let text = error.expect_err("no whole state").to_string();
    assert_eq!(
        text,
        "9 speeds are no whole number of rows of `by hand`, which has 2"
    );
    let error = batch.inverse_dynamics(&q, &v, &u, &mut rates);
    let missing = BatchError::Missing {
        scene: "by hand",
        function: "inverse dynamics",
    };
    assert_eq!(error, Err(missing));
    for level in Level::ALL {
        assert_eq!(
            Batch::at(&IN_LANES, level).is_ok(),
            level.is_available(),
            "{level:?}"
        );
    }
}
