//! Joints that carry several bodies: each body is what a joint with that body alone would be, and ranks are of all of them together.

use hamel_codegen::derive;
use hamel_codegen::derived::{Derived, KernelKind};
use hamel_codegen::expr::Expr;
use hamel_codegen::matrix::Matrix;
use hamel_codegen::spec::code;

fn derived(source: &str) -> Derived {
    derive(source, "test").unwrap_or_else(|errors| panic!("{errors}"))
}

fn codes(source: &str) -> Vec<&'static str> {
    match derive(source, "test") {
        Ok(_) => vec![],
        Err(errors) => errors.errors.iter().map(|error| error.code).collect(),
    }
}

/// A spec with the statements and one H for each body; of one body alone, without its name.
fn spec(head: &str, poses: &[(&str, &str)], body: Option<usize>) -> String {
    let names: Vec<&str> = poses.iter().map(|(name, _)| *name).collect();
    let text: String = match body {
        Some(body) => format!("H = {};", poses[body].1),
        None => {
            let poses = poses.iter().map(|(name, h)| format!("H.{name} = {h};"));
            format!("bodies {}; {}", names.join(", "), poses.collect::<String>())
        }
    };
    format!("hamel = 1;\njoint test{head} {text} }}")
}

const FOUR_BAR: &str = "(d: m > 0, a: m > 0, b: m > 0, c: m > 0) {
    require d > a; require b + c > d + a; require d + c > a + b; require d + b > a + c;
    config s: S1, t: S1, u: S1;
    relation a * s.c + b * t.c - c * u.c - d = 0;
    relation a * s.s + b * t.s - c * u.s = 0;
    home near [1, 0], [3/5, 4/5], [-3/5, 4/5];
    basis turn of so2(s);";

const LINKS: [(&str, &str); 3] = [
    ("crank", "rot_z(s)"),
    ("coupler", "pose(rot_z(t), [a * s.c, a * s.s, 0])"),
    ("rocker", "pose(rot_z(u), [d, 0, 0])"),
];

const CART: &str = "(half: m > 0, radius: m > 0) {
    config Q: SE2, l: R1, r: R1;
    basis turn, forward, sideways of se2;
    velocity in child;
    let place = pose(rot_z(Q), [Q.x, Q.y, radius]);
    A = [0, half, -half; 0, -1, -1; 1, 0, 0; 0, radius, 0; 0, 0, radius];
    S_bar = [1, 0; 0, 1; 0, 0; -half / radius, 1 / radius; half / radius, 1 / radius];
    speeds turn, drive;";

const WHEELS: [(&str, &str); 3] = [
    ("frame", "place"),
    ("left", "place * trans([0, half, 0]) * rot_y(l)"),
    ("right", "place * trans([0, -half, 0]) * rot_y(r)"),
];

/// Whether two kernels have one value on the manifold.
fn is_same(joint: &Derived, left: &[Matrix], right: &[Matrix]) -> bool {
    let ideal = joint.space.manifold.ideal();
    let difference = |(left, right): (&Matrix, &Matrix)| left.minus(right);
    let differences: Vec<Matrix> = left.iter().zip(right).map(difference).collect();
    left.len() == right.len()
        && differences
            .iter()
            .flat_map(Matrix::entries)
            .all(|entry| ideal.vanishes(entry))
}

#[test]
fn each_body_is_that_of_a_joint_with_it_alone() {
    for (head, poses) in [(FOUR_BAR, LINKS), (CART, WHEELS)] {
        let joint = derived(&spec(head, &poses, None));
        assert_eq!(joint.bodies().count(), poses.len());
        for (body, seen) in joint.bodies().enumerate() {
            assert_eq!(seen.body_name(), Some(poses[body].0));
            let text = spec(head, &poses, Some(body));
            if poses[body].0 == "rocker" {
                // It stands still at its dead points, where the crank tells how the joint moves.
                assert_eq!(codes(&text), [code::TWIST_MAP_LOCUS]);
                continue;
            }
            let alone = derived(&text);
            assert_eq!(seen.unidentifiable, alone.unidentifiable);
            for kernel in &alone.kernels {
                let own = seen.kernel(kernel.kind).expect("the same kernels");
                let same = is_same(&alone, &own.expanded(), &kernel.expanded());
                assert!(same, "{} {:?}", poses[body].0, kernel.kind);
                assert_eq!(own.structure, kernel.structure, "{:?}", kernel.kind);
            }
            let ideal = alone.space.manifold.ideal();
            let moves = seen.local_twist_map.minus(&alone.local_twist_map);
            assert!(moves.entries().iter().all(|entry| ideal.vanishes(entry)));
        }
    }
}

#[test]
fn what_moves_one_body_alone_moves_the_joint() {
    let apart =
        "{ config a: R1, b: R1; bodies left, right; H.left = rot_z(a); H.right = rot_z(b); }";
    let joint = derived(&format!("hamel = 1;\njoint test {apart}"));
    assert!(joint.still.is_empty());
    let rank = joint
        .claims
        .iter()
        .find(|claim| claim.name == "twist_map_rank");
    assert!(rank.is_some_and(|claim| claim.statement.starts_with("rank X = k")));
    // Of one body alone, the coordinate of the other moves none.
    let alone = derived("hamel = 1;\njoint test { config a: R1, b: R1; H = rot_z(a); }");
    assert_eq!(alone.still, [1]);
}

#[test]
fn what_moves_no_body_is_still() {
    let text = "{ config a: R1, b: R1, c: R1; bodies left, right; H.left = rot_z(a); H.right = rot_z(b); }";
    let joint = derived(&format!("hamel = 1;\njoint test {text}"));
    assert_eq!(
        (joint.still.as_slice(), joint.still_speeds.as_slice()),
        (&[2][..], &[2][..])
    );
    assert!(
        joint
            .still_in_words()
            .is_some_and(|words| words.starts_with("c moves no body"))
    );
}

#[test]
fn a_motion_that_no_body_shows_is_refused() {
    let sum = "{ config a: R1, b: R1; bodies left, right; H.left = rot_z(a + b); H.right = rot_x(2 * a + 2 * b); }";
    assert_eq!(
        codes(&format!("hamel = 1;\njoint test {sum}")),
        [code::TWIST_MAP_LOCUS]
    );
    let shown = "{ config a: R1, b: R1; bodies left, right; H.left = rot_z(a + b); H.right = rot_x(a - b); }";
    assert_eq!(codes(&format!("hamel = 1;\njoint test {shown}")), [""; 0]);
}

#[test]
fn twists_are_declared_one_below_the_other() {
    // v is twice the rate of the angle.
    let with = |x: &str| {
        format!(
            "hamel = 1;\njoint test(n: 1 > 0) {{ config q: R1; bodies slow, fast; H.slow = rot_z(q); H.fast = trans_x(n) * rot_z(n * q); \
             X = [0; 0; 1/2; 0; 0; 0; {x}]; }}"
        )
    };
    let joint = derived(&with("0; 0; n/2; 0; -n*n/2; 0"));
    let map = joint.kernel(KernelKind::VelocityMap).expect("a kernel");
    assert_eq!(map.outputs, [Matrix::column_vector(vec![Expr::integer(2)])]);
    let twists: Vec<(usize, usize)> = joint.bodies().map(|b| b.speed_map.shape()).collect();
    assert_eq!(twists, [(6, 1), (6, 1)]);
    assert_eq!(codes(&with("0; 0; n/2; 0; n*n/2; 0")), [code::TWIST_MAP]);
}

/// The second body has a pose on one side of the exception alone: the joint ends there.
#[test]
fn a_side_of_any_body_is_one_of_the_joint() {
    let with = |poses: &str| {
        let text =
            format!("hamel = 1;\njoint test {{ config q: R1; home = 1; except q = 0; {poses} }}");
        let joint = derived(&text);
        let singular = joint.kernel(KernelKind::Singularity).expect("a kernel");
        singular.outputs.clone()
    };
    let both = with("bodies plain, root; H.plain = trans_x(q); H.root = trans_x(sqrt(q));");
    assert_eq!(both, with("H = trans_x(sqrt(q));"));
    assert_eq!(both.len(), 2);
}

/// `bodies` begins a statement, and is a name in specs that are older than that.
#[test]
fn a_parameter_may_be_called_bodies() {
    let text = "(bodies: m > 0) { config q: R1; bodies one, bodies; H.one = trans_x(bodies * q); H.bodies = rot_x(q); }";
    let joint = derived(&format!("hamel = 1;\njoint test{text}"));
    assert_eq!(joint.spec.bodies, ["one", "bodies"]);
}

#[test]
fn poses_of_all_bodies_tell_q() {
    let fibres = |poses: &str| {
        let text = format!("hamel = 1;\njoint test {{ config a: R1, b: R1; {poses} }}");
        let claims = derived(&text).claims;
        claims
            .into_iter()
            .find(|claim| claim.name == "fibres")
            .map(|claim| claim.statement)
    };
    let both = "; the poses of all bodies count as one";
    assert_eq!(
        fibres("bodies left, right; H.left = trans_x(a); H.right = trans_y(b);"),
        Some(format!("one pose has one Q{both}"))
    );
    assert_eq!(
        fibres("bodies left, right; H.left = trans_x(a); H.right = rot_y(b);"),
        Some(format!("one pose has one Q up to full turns of b{both}"))
    );
}
