//! Families of joints that are true by construction.

use super::draft::Draft;
use super::formulas::{nothing, number, pick, positive, smooth};
use chacha20::ChaCha8Rng;
use rand::RngExt;

type Family = fn(&mut Draft, &mut ChaCha8Rng);

const FAMILIES: [Family; 12] = [
    graph,
    graph,
    cam,
    general_real,
    declared_twist,
    circle,
    rotation,
    rigid,
    sphere,
    sphere_of_relation,
    rolling,
    plane_of_angles,
];

/// Fills the draft with a random joint.
pub fn fill(draft: &mut Draft, random: &mut ChaCha8Rng) {
    FAMILIES[random.random_range(0..FAMILIES.len())](draft, random);
}

/// Real coordinates, and with them the names by which errors reach them.
fn reals(draft: &mut Draft, count: usize) -> Vec<String> {
    let names: Vec<String> = ["x", "y", "z"][..count]
        .iter()
        .map(|n| (*n).to_owned())
        .collect();
    let config: Vec<String> = names.iter().map(|n| format!("{n}: R1")).collect();
    draft.line(format!("config {};", config.join(", ")));
    draft.reals = names
        .iter()
        .cloned()
        .enumerate()
        .map(|(i, n)| (n, i))
        .collect();
    names
}

/// A random factor of a function: a number or a parameter.
fn scale(draft: &mut Draft, random: &mut ChaCha8Rng) -> String {
    match random.random_bool(0.4) && draft.parameters.len() < 3 {
        true => draft.parameter(random),
        false => number(random),
    }
}

fn function(draft: &mut Draft, random: &mut ChaCha8Rng, of: &[String]) -> String {
    let count = random.random_range(1..=2);
    let terms: Vec<String> = (0..count)
        .map(|_| {
            let x = of[random.random_range(0..of.len())].clone();
            format!("{} * {}", scale(draft, random), smooth(random, &x))
        })
        .collect();
    let zero = match random.random_bool(0.15) {
        true => format!(" + {}", nothing(random, &of[0])),
        false => String::new(),
    };
    terms.join(" + ") + &zero
}

/// The graph of functions over one or two coordinates: these stand in H as they are, so that X has full rank.
fn graph(draft: &mut Draft, random: &mut ChaCha8Rng) {
    let count = random.random_range(1..=2);
    let q = reals(draft, count);
    let height = function(draft, random, &q);
    let factor = draft.factor();
    if count == 1 {
        let side = function(draft, random, &q);
        draft.line(format!("let side = {side};"));
        draft.line(format!(
            "H = trans([{}{}, side, {height}]);",
            q[0],
            if random.random_bool(0.5) {
                factor
            } else {
                String::new()
            }
        ));
    } else {
        draft.line(format!("let height = {height};"));
        draft.line(format!("H = trans([{}{factor}, {}, height]);", q[0], q[1]));
    }
}

/// A turn by an angle while the child moves along any curve: the turn alone has rank 1.
fn cam(draft: &mut Draft, random: &mut ChaCha8Rng) {
    let q = reals(draft, 1);
    let lift = function(draft, random, &q);
    let axis = pick(random, &["x", "y", "z"]);
    let (turn, sum) = (number(random), draft.sum());
    // The rotation is written out, so that it can be none.
    match random.random_bool(0.5) {
        true => draft.line(format!("H = trans_{axis}({lift}) * rot_{axis}({turn} * x);")),
        false => draft.line(format!("H = pose([cos({turn} * x){sum}, -sin({turn} * x), 0; sin({turn} * x), cos({turn} * x), 0; 0, 0, 1], [{lift}, 0, x]);")),
    }
}

/// Φ = q + p(q) ϕ + r(q) ϕ², p positive.
fn general_real(draft: &mut Draft, random: &mut ChaCha8Rng) {
    let q = reals(draft, 2);
    draft.line("local u, v;");
    let (p, r, p2) = (
        positive(random, &q[0]),
        smooth(random, &q[1]),
        positive(random, &q[1]),
    );
    let (sum, factor) = (draft.sum(), draft.factor());
    let other = draft.sum();
    draft.line(format!(
        "Phi = x{sum} + {p}{factor} * phi.u + ({r}) * phi.u * phi.v, y{other} + {p2} * phi.v;"
    ));
    let height = function(draft, random, &q);
    draft.line(format!("H = trans([x, y, {height}]);"));
}

/// X = J g(q), g positive, so that v = ϕ̇ / g.
fn declared_twist(draft: &mut Draft, random: &mut ChaCha8Rng) {
    reals(draft, 2);
    let (g, h) = (positive(random, "x"), positive(random, "y"));
    let (sum, factor, other) = (draft.sum(), draft.factor(), draft.sum());
    let zero = match random.random_bool(0.3) {
        true => nothing(random, "x"),
        false => "0".into(),
    };
    draft.line("H = trans([x, y, 0]) * rot_z(1.5 * x);");
    // ω = 1.5 ẋ e_z, v_O = ṗ − ω × p = (ẋ + 1.5 ẋ y, ẏ − 1.5 ẋ x).
    draft.line(format!("let g = {g}{factor};"));
    draft.line(format!("let h = {h};"));
    draft.line(format!(
        "X = [0, 0; {zero}{sum}, 0; 1.5 * g, 0; g * (1 + 1.5 * y), 0{other}; -1.5 * x * g, h; 0, 0];"
    ));
}

/// A closed curve over the unit circle.
fn circle(draft: &mut Draft, random: &mut ChaCha8Rng) {
    let (group, algebra) = [("S1", "so2"), ("SO2", "so2")][random.random_range(0..2)];
    let real = random.random_bool(0.6);
    draft.line(match real {
        true => format!("config q: {group}, x: R1;"),
        false => format!("config q: {group};"),
    });
    draft.line(format!("basis turn of {algebra};"));
    draft.line("velocity in child;");
    let (a, b) = (draft.parameter(random), draft.parameter(random));
    let height = match real {
        true => {
            draft.reals = vec![("x".into(), 1)];
            let of = ["x".to_owned()];
            let f = function(draft, random, &of);
            let factor = draft.factor();
            format!("[{a} * q.c, {b} * q.s + {f}, x{factor}]")
        }
        false => format!("[{a} * q.c, {b} * q.s * q.c, {} * q.s]", number(random)),
    };
    let sum = draft.sum();
    draft.line(format!(
        "H = pose([q.c{sum}, -q.s, 0; q.s, q.c, 0; 0, 0, 1], {height});"
    ));
}

/// A rotation, with exponential, Cayley or product coordinates.
fn rotation(draft: &mut Draft, random: &mut ChaCha8Rng) {
    let real = random.random_bool(0.6);
    let quaternion = random.random_bool(0.25);
    let kind = if quaternion { "S3" } else { "SO3" };
    draft.line(match real {
        true => format!("config R: {kind}, x: R1;"),
        false => format!("config R: {kind};"),
    });
    if real {
        draft.reals = vec![("x".into(), 3)];
    }
    draft.line("basis wx, wy, wz of so3;");
    let part = if real { "phi.R" } else { "phi" };
    let rest = if real { ", x + phi.x" } else { "" };
    draft.line("velocity in child;");
    let sum = draft.sum();
    match random.random_range(0..3) {
        1 if !quaternion => {
            draft.line(format!(
                "Phi = R * (I(3) + (tilde({part}) + tilde({part}) * tilde({part}) / 2) * (1 / (1 + dot({part}, {part}) / 4{sum}))){rest};"
            ));
        }
        2 if real => draft.line(format!("Phi = R * exp({part}), x + phi.x{sum};")),
        _ => {}
    }
    let turn = if quaternion { "rot(R)" } else { "R" };
    let a = draft.parameter(random);
    let shift = match real {
        true => format!("[{a}, 0, x]"),
        false => format!("{turn} * [{a}, 0, {}]", number(random)),
    };
    draft.line(format!("H = pose({turn}, {shift});"));
}

/// A group of rigid motions, with forbidden velocities or without.
fn rigid(draft: &mut Draft, random: &mut ChaCha8Rng) {
    if random.random_bool(0.3) {
        draft.line("config Q: SE3;");
        draft.line("basis turn = e3, x = e4, y = e5, z = e6 of se3;");
        draft.line(format!(
            "velocity in {};",
            pick(random, &["child", "parent"])
        ));
        draft.line("H = Q;");
        return;
    }
    draft.line("config Q: SE2;");
    draft.line("basis turn, ahead, left of se2;");
    draft.line("velocity in child;");
    draft.line("H = pose(rot_z(Q), [Q.x, Q.y, 0]);");
    draft.reals = vec![("Q.x".into(), 1), ("Q.y".into(), 2)];
    let (f, p) = (smooth(random, "Q.x"), positive(random, "Q.y"));
    let (sum, factor) = (draft.sum(), draft.factor());
    // left = f turn.
    draft.line(format!("let f = {f};"));
    draft.line("A = [-f; 0; 1];");
    draft.line(format!("S_bar = [1, 0; 0, {p}{factor}; f{sum}, 0];"));
    draft.line("speeds turning, rolling;");
}

/// A direction with rates that vanish at an equator or at poles.
fn sphere(draft: &mut Draft, random: &mut ChaCha8Rng) {
    let real = random.random_bool(0.5);
    let (also, rest, moved) = match real {
        true => (", x: R1", ", x", "x"),
        false => ("", "", ""),
    };
    if real {
        draft.reals = vec![("x".into(), 2)];
    }
    draft.line(format!("config n: S2{also};"));
    draft.line(format!(
        "home = [0, 0, 1]{};",
        if real { ", 0" } else { "" }
    ));
    draft.line(format!("local a1, a2{};", if real { ", a3" } else { "" }));
    draft.line("except n.z = 0;");
    let (sum, factor) = (draft.sum(), draft.factor());
    let p = if real {
        positive(random, "x")
    } else {
        "1".into()
    };
    draft.line(format!(
        "Phi = (n + [{p}{factor} * phi.a1, phi.a2, 0]) / norm(n + [{p} * phi.a1, phi.a2, 0]){};",
        if real {
            format!("{rest}{sum} + phi.a3")
        } else {
            String::new()
        }
    ));
    let radius = draft.parameter(random);
    let lift = if real {
        format!(" + [0, 0, {moved}]")
    } else {
        String::new()
    };
    match real {
        // Height apart from the direction would not be told from it.
        true => draft.line(format!("H = trans({radius} * n{lift}) * rot_x(x);")),
        false => draft.line(format!("H = trans({radius} * n);")),
    }
}

/// The same sphere by a relation.
fn sphere_of_relation(draft: &mut Draft, random: &mut ChaCha8Rng) {
    draft.line("config n: R3;");
    draft.line("relation dot(n, n) = 1;");
    draft.line("home = [1, 0, 0];");
    draft.line("local east, north;");
    draft.line("except n.x * n.x + n.y * n.y = 0;");
    draft.line("let e = [-n.y, n.x, 0];");
    draft.line("let u = cross(n, e);");
    let (p, factor) = (positive(random, "n.z"), draft.factor());
    draft.line(format!("let k = {p}{factor};"));
    draft.line("Phi = (n + k * phi.east * e + phi.north * u) / norm(n + k * phi.east * e + phi.north * u);");
    let radius = draft.parameter(random);
    draft.line(format!("H = trans({radius} * n);"));
}

/// Real coordinates with forbidden velocities.
fn rolling(draft: &mut Draft, random: &mut ChaCha8Rng) {
    let q = reals(draft, 3);
    let turn = if random.random_bool(0.5) {
        " * rot_z(z)"
    } else {
        ""
    };
    draft.line(format!("H = trans([x, y, z]){turn};"));
    let (f, at) = (function(draft, random, &q), random.random_range(0..3));
    let g = positive(random, &q[at]);
    let zero = match random.random_bool(0.4) {
        true => nothing(random, "x"),
        false => "0".into(),
    };
    let (sum, other, factor) = (draft.sum(), draft.sum(), draft.factor());
    let shape = random.random_range(0..3);
    if shape < 2 {
        draft.line(format!("let f = {f};"));
    }
    if shape != 1 {
        draft.line(format!("let g = {g};"));
    }
    match shape {
        // ż = f ẋ
        0 => {
            draft.line("A = [-f; 0; 1];");
            draft.line(format!(
                "S_bar = [g{factor}, {zero}{sum}; 0, 1; f * g{factor}{other}, 0];"
            ));
        }
        1 => {
            draft.line("A = [-f; 0; 1];");
        }
        _ => {
            draft.line(format!("A = [g{factor}, 0; 0, 1; 0, {zero}];"));
            draft.line(format!("S_bar = [{zero}{sum}; 0; 1];"));
        }
    }
}

/// Angles and slides with a singular set that is named.
fn plane_of_angles(draft: &mut Draft, random: &mut ChaCha8Rng) {
    let q = reals(draft, 3);
    match random.random_range(0..3) {
        0 => {
            draft.line("except cos(y) = 0;");
            draft.line("H = rot_z(x) * rot_y(y) * rot_x(z);");
        }
        1 => {
            let (a, b) = (draft.parameter(random), draft.parameter(random));
            draft.requires.push(format!("require {a} > 2 * {b};"));
            let n = draft.values.len();
            draft.values[n - 2].1 = 4.5;
            draft.values[n - 1].1 = 1.25;
            draft.line(format!(
                "H = rot_z(x) * trans_x({a}) * rot_y(y) * trans_x({b}) * rot_x(z);"
            ));
        }
        _ => {
            let f = function(draft, random, &q[..2]);
            let factor = draft.factor();
            draft.line(format!("let f = {f};"));
            draft.line(format!("H = trans([x{factor}, y, f]) * rot_z(z);"));
        }
    }
}
