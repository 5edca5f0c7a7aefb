//! Numbers against tabulated digits, functions against their identities, points against their manifolds.

use super::{Precise, Sampler};
use crate::expr::Number;
use crate::spec;

const BITS: usize = 256;

fn rational(numerator: i64, denominator: i64) -> Precise {
    Precise::integer(numerator, BITS) / Precise::integer(denominator, BITS)
}

/// Whether two numbers agree to `2^-exponent` of the larger one.
fn agree(a: &Precise, b: &Precise, exponent: i32) -> bool {
    let size = match a.abs().compare(&b.abs()) {
        Some(std::cmp::Ordering::Less) => b.abs(),
        _ => a.abs(),
    };
    (a - b)
        .abs()
        .compare(&size.halved(exponent))
        .is_some_and(|order| order.is_le())
}

/// First 61 significant digits.
fn digits(value: &Precise) -> String {
    let text = value.to_string();
    let mantissa = text.split('e').next().unwrap_or_default();
    mantissa.chars().take(62).collect()
}

/// Digits of π (OEIS A000796), e (A001113), ln 2 (A002162) and √2 (A002193).
#[test]
fn constants_have_their_digits() {
    let one = Precise::integer(1, BITS);
    let two = Precise::integer(2, BITS);
    let expected = [
        (
            Precise::pi(BITS),
            "3.141592653589793238462643383279502884197169399375105820974944",
        ),
        (
            one.exp(),
            "2.718281828459045235360287471352662497757247093699959574966967",
        ),
        (
            two.ln(),
            "6.931471805599453094172321214581765680755001343602552541206800",
        ),
        (
            two.sqrt(),
            "1.414213562373095048801688724209698078569671875376948073176679",
        ),
    ];
    for (value, text) in expected {
        assert_eq!(digits(&value), text);
    }
}

#[test]
fn doubles_come_back() {
    let tiny = f64::from_bits(1);
    for value in [
        0.0,
        1.0,
        -0.1,
        1e300,
        -1e-300,
        f64::MIN_POSITIVE,
        tiny,
        f64::MAX,
    ] {
        assert_eq!(Precise::from_f64(value, BITS).to_f64(), value);
    }
    // 1 + 2^-53 is a tie and goes to even; a bit far below decides.
    let tie = Precise::integer(1, BITS) + Precise::integer(1, BITS).halved(53);
    assert_eq!(tie.to_f64(), 1.0);
    let above = tie + Precise::integer(1, BITS).halved(200);
    assert_eq!(above.to_f64(), 1.0 + f64::EPSILON);
    assert!(
        (Precise::integer(0, BITS) / Precise::integer(0, BITS))
            .to_f64()
            .is_nan()
    );
    assert_eq!(
        Precise::from_f64(1e300, BITS).power(2).to_f64(),
        f64::INFINITY
    );
}

/// sin(π/6), cos(π/3), atan2 at all octants, and sin² + cos² after a million turns.
#[test]
fn angles_are_known() {
    let sixth = Precise::pi(BITS) / Precise::integer(6, BITS);
    assert!(agree(&sixth.sin(), &rational(1, 2), 250));
    assert!(agree(&sixth.halved(-1).cos(), &rational(1, 2), 250));
    let quarter = Precise::pi(BITS).halved(2);
    let octants = [
        (0, 1, 0),
        (1, 1, 1),
        (1, 0, 2),
        (1, -1, 3),
        (0, -1, 4),
        (-1, -1, -3),
        (-1, 0, -2),
        (-1, 1, -1),
    ];
    for (y, x, turns) in octants {
        let angle = Precise::integer(y, BITS).atan2(&Precise::integer(x, BITS));
        assert!(
            agree(&angle, &(quarter.same(turns) * &quarter), 250),
            "{y} {x}"
        );
    }
    let angle = Precise::from_f64(6_283_185.307_179_586, BITS);
    let (sin, cos) = (angle.sin(), angle.cos());
    assert!(agree(&(&sin * &sin + &cos * &cos), &angle.same(1), 250));
}

/// tanh = sinh / cosh, and ln cosh = ln(1 + 2 sinh²(x/2)), in bits enough for the smallest.
#[test]
fn hyperbolic_functions_keep_their_digits_at_every_size() {
    for size in [1e-200, 1e-9, 0.3, 1.0, 7.2, 720.0, 1e4, -7.2, -1e-9] {
        let x = Precise::from_f64(size, BITS);
        let quotient = &x.sinh() / &x.cosh();
        assert!(agree(&x.tanh(), &quotient, 250), "tanh {size}");
        let small = x.ln_cosh();
        let u = (x.halved(1).sinh() * &x.halved(1).sinh()).halved(-1);
        let wide = &u.to_bits(2048).same(1) + &u.to_bits(2048);
        assert!(
            agree(&small, &wide.ln().to_bits(BITS), 240),
            "ln cosh {size}"
        );
    }
}

/// Arguments of both signs, small, of a turn, of many turns; on both sides of where the method changes.
fn arguments() -> Vec<Precise> {
    let sizes = [
        1e-300, 1e-20, 0.01, 2.5, 39.0, 400.0, 9_999.0, 10_001.0, 4e13,
    ];
    let both = sizes.iter().flat_map(|s| [*s, -s]);
    // cosh of more than 1e4 is beyond every use.
    both.filter(|s| *s > -1e6)
        .map(|s| Precise::from_f64(s, BITS))
        .collect()
}

/// c_k + s c_{k+2} = 1/k!, and c_0, c_1 by sine and cosine.
#[test]
fn stumpff_functions_obey_their_recurrence() {
    for s in arguments() {
        let angle = s.abs().sqrt();
        let (c0, c1) = match s.is_negative() {
            true => (angle.cosh(), &angle.sinh() / &angle),
            false => (angle.cos(), &angle.sin() / &angle),
        };
        // The argument is rounded to 256 bits: at 6e6 rad that is 2^-233 rad.
        assert!(agree(&s.stumpff(0), &c0, 220), "c0({s})");
        assert!(agree(&s.stumpff(1), &c1, 220), "c1({s})");
        let mut inverse_factorial = s.same(1);
        for k in 0..9u32 {
            let second = &s * &s.stumpff(k + 2);
            let sum = &s.stumpff(k) + &second;
            let size = [second.abs(), inverse_factorial.clone()].into_iter();
            let error = (&sum - &inverse_factorial).abs().to_f64();
            let scale = size.fold(0.0, |m: f64, x| m.max(x.to_f64()));
            assert!(error <= scale * 2f64.powi(-245), "k = {k}, s = {s}");
            inverse_factorial = inverse_factorial / s.same(i64::from(k) + 1);
        }
    }
}

/// G(s) against (1 − (θ/2) cot(θ/2)) / θ² where that cancels little, and G(0) = 1/12, G′(0) = 1/720, G″(0) = 1/15120.
#[test]
fn dexp_inverse_is_its_definition() {
    for angle in [1e-3, 0.4, 3.0, 6.27] {
        let angle = Precise::from_f64(angle, BITS);
        let square = &angle * &angle;
        let half = angle.halved(1);
        let cotangent = half.cos() / half.sin();
        let expected = (angle.same(1) - half * cotangent) / square.clone();
        // 1 − (θ/2) cot(θ/2) is 1e-7 at θ = 1e-3: 24 bits.
        assert!(agree(&square.dexp_inverse(0), &expected, 220), "{angle}");
    }
    let zero = Precise::integer(0, BITS);
    for (order, denominator) in [(0, 12), (1, 720), (2, 15_120)] {
        assert!(agree(
            &zero.dexp_inverse(order),
            &rational(1, denominator),
            250
        ));
    }
}

/// The derivatives against a difference quotient of order h²: h = 2^-80 leaves 2^-160 of error, and 256 − 80 bits.
#[test]
fn derivatives_of_dexp_inverse_are_derivatives() {
    let step = Precise::integer(1, BITS).halved(80);
    for s in [0.5, 9.0, -3.0] {
        let s = Precise::from_f64(s, BITS);
        for order in 0..4 {
            let ahead = (&s + &step).dexp_inverse(order);
            let behind = (&s - &step).dexp_inverse(order);
            let slope = (ahead - behind) / step.halved(-1);
            assert!(
                agree(&slope, &s.dexp_inverse(order + 1), 150),
                "{s} {order}"
            );
        }
    }
}

const JOINTS: [&str; 5] = [
    "joint known(lead: m) { config u: S3, t: S1, z: R2; basis a, b, c of so3; basis k of so2; velocity in child;
     H = pose(rot(u) * rot_z(t), [z.x, z.y, lead]); }",
    "joint turn { config c: SO2; basis a of so2; velocity in child; H = rot_z(c); }",
    "joint ball { config Q: SO3; basis a, b, c of so3; velocity in parent; H = pose(Q, [0, 0, 0]); }",
    "joint free { config Q: SE3; basis a, b, c, d, e, f of se3; velocity in child; H = Q; }",
    "joint plane { config Q: SE2; basis a, b, c of se2; velocity in child; H = pose(rot_z(Q), [Q.x, Q.y, 0]); }",
];

fn parsed(text: &str) -> crate::model::ConfigurationSpace {
    let spec = spec::parse(&format!("hamel = 1;\n{text}"), "test.joint")
        .unwrap_or_else(|errors| panic!("{errors}"));
    crate::model::ConfigurationSpace::declared(&spec)
}

#[test]
fn points_lie_on_the_manifold() {
    for space in JOINTS.map(parsed) {
        let mut sampler = Sampler::new(&space, BITS);
        for _ in 0..20 {
            let point = sampler.point().expect("nothing is forbidden");
            for relation in space.manifold.relations() {
                let (value, scale) = point.evaluate_with_scale(&relation);
                assert!(
                    value.to_f64().abs() <= scale.max(1.0) * 2f64.powi(-250),
                    "{value}"
                );
            }
        }
    }
}

/// A circle of radius 1/2 declared by relations, twice, and with a redundant third that is the sum of both.
#[test]
fn declared_relations_are_met_by_newton() {
    let mut space = parsed("joint plane { config z: R3; H = trans(z); }");
    let manifold = space.manifold.clone();
    let q: Vec<_> = manifold
        .coordinates()
        .iter()
        .map(crate::expr::Expr::symbol)
        .collect();
    let circle = &(&q[0].square() + &q[1].square()) - &crate::expr::Expr::fraction(1, 4);
    let height = &q[2] - &(&q[0] * &q[1]);
    let both = &circle + &height;
    space.manifold = manifold.constrained(vec![circle, height, both]);
    let mut sampler = Sampler::new(&space, BITS);
    let mut different = std::collections::BTreeSet::new();
    for _ in 0..20 {
        let point = sampler.point().expect("Newton converges");
        for relation in space.manifold.relations() {
            let (value, scale) = point.evaluate_with_scale(&relation);
            assert!(
                value.to_f64().abs() <= scale.max(1.0) * 2f64.powi(-230),
                "{value}"
            );
        }
        different.insert(
            point
                .value(&space.manifold.coordinates()[0])
                .to_f64()
                .to_bits(),
        );
    }
    assert_eq!(different.len(), 20);
}
