//! States of robots in the coordinates of MuJoCo, and the accelerations that Hamel gives them there.
//!
//! A table has a line `model`, its file; a line `joint` for each joint that moves independently, in MuJoCo's order, with name (`-` without one) and type; and for each
//! state lines `q` and `v`, MuJoCo's `qpos` and `qvel`, and `a`, its `qacc_smooth`, where it is known. Parts of a line are between tabs, numbers between blanks.

use hamel::Model;
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use std::error::Error;

/// A model with its states.
#[derive(Debug, Default)]
pub struct Table {
    pub file: String,
    pub joints: Vec<(String, Kind)>,
    pub states: Vec<State>,
}

#[derive(Debug, Default)]
pub struct State {
    pub q: Vec<f64>,
    pub v: Vec<f64>,
    pub a: Vec<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Scalar,
    /// An angle, of which Hamel stores cosine and sine.
    Circle,
    Ball,
    Free,
}

/// The tables of a text.
pub fn tables(text: &str) -> Vec<Table> {
    let mut tables: Vec<Table> = Vec::new();
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        let parts: Vec<&str> = line.split('\t').collect();
        let numbers = || -> Vec<f64> {
            let own = parts
                .get(1)
                .into_iter()
                .flat_map(|own| own.split_whitespace());
            own.map(|number| number.parse().expect("a number"))
                .collect()
        };
        if let ["model", file] = parts[..] {
            tables.push(Table {
                file: file.to_owned(),
                ..Table::default()
            });
            continue;
        }
        let Some(table) = tables.last_mut() else {
            continue;
        };
        match (parts[0], table.states.last_mut()) {
            ("joint", _) => {
                let kind = match parts[2] {
                    "ball" => Kind::Ball,
                    "free" => Kind::Free,
                    _ => Kind::Scalar,
                };
                table.joints.push((parts[1].to_owned(), kind));
            }
            ("q", _) => table.states.push(State {
                q: numbers(),
                ..State::default()
            }),
            ("v", Some(state)) => state.v = numbers(),
            ("a", Some(state)) => state.a = numbers(),
            _ => {}
        }
    }
    tables
}

/// Where the entries of a joint are: in Q, and in v̄.
type Place = (usize, usize);

/// A model of Hamel with the joints of one of MuJoCo.
pub struct Peer {
    model: Model,
    joints: Vec<(Kind, Place)>,
}

/// Accelerations, and the largest and the least singular value of the mass matrix.
pub struct Answer {
    pub a: Vec<f64>,
    pub singular: [f64; 2],
}

impl Answer {
    /// How far it may be from accelerations of that size: 1e-9 of them, or where more digits are lost by the condition of M, a few roundings of those.
    pub fn allowed(&self, size: f64) -> f64 {
        let [largest, least] = self.singular;
        size.max(1.0) * f64::max(1e-9, largest / least * 1e-15)
    }
}

impl Peer {
    /// # Errors
    /// A file that is refused; a joint that the model does not have.
    pub fn new(path: &str, joints: &[(String, Kind)]) -> Result<Self, Box<dyn Error>> {
        let model = hamel::load(path)?;
        let mut unnamed = places(&model);
        let is_named = |own: &str| {
            joints
                .iter()
                .any(|(name, _)| own.split('+').any(|own| own == name))
        };
        unnamed.retain(|(name, _)| !is_named(name));
        let mut unnamed = unnamed.into_iter();
        let found = joints.iter().map(|(name, kind)| {
            let place = match name.as_str() {
                "-" => unnamed.next().map(|(_, place)| place),
                name => named(&model, name),
            };
            let (place, is_circle) = place.ok_or_else(|| format!("no joint `{name}`"))?;
            let kind = if is_circle { Kind::Circle } else { *kind };
            Ok((kind, place))
        });
        let joints = found.collect::<Result<_, Box<dyn Error>>>()?;
        Ok(Self { model, joints })
    }

    /// # Errors
    /// What the equations of motion refuse.
    pub fn answer(&mut self, given: &State) -> Result<Answer, Box<dyn Error>> {
        let mut state = self.model.state();
        let (mut q, mut v) = (&given.q[..], &given.v[..]);
        let mut turned = Vec::new();
        for (kind, (at, speed)) in &self.joints {
            let own = &mut state.configuration[*at..];
            let speeds = &mut state.speeds[*speed..];
            let (positions, rates) = match kind {
                Kind::Scalar | Kind::Circle => (1, 1),
                Kind::Ball => (4, 3),
                Kind::Free => (7, 6),
            };
            let (here, rest) = q.split_at(positions);
            let (moving, still) = v.split_at(rates);
            (q, v) = (rest, still);
            let mut r = Matrix3::identity();
            match kind {
                Kind::Scalar => own[0] = here[0],
                Kind::Circle => (own[1], own[0]) = here[0].sin_cos(),
                Kind::Ball => {
                    r = rotation(here);
                    own[..9].copy_from_slice(r.transpose().as_slice());
                }
                Kind::Free => {
                    r = rotation(&here[3..]);
                    for row in 0..3 {
                        (0..3).for_each(|column| own[4 * row + column] = r[(row, column)]);
                        own[4 * row + 3] = here[row];
                    }
                }
            }
            match kind {
                Kind::Free => {
                    speeds[..3].copy_from_slice(&moving[3..]);
                    let linear = r.transpose() * Vector3::from_column_slice(&moving[..3]);
                    speeds[3..6].copy_from_slice(linear.as_slice());
                }
                _ => speeds[..rates].copy_from_slice(moving),
            }
            turned.push(r);
        }
        let efforts = vec![0.0; self.model.sizes().freedoms];
        let rates = self.model.forward_dynamics(&state, &efforts)?;
        let mut a = Vec::new();
        for ((kind, (_, speed)), r) in self.joints.iter().zip(turned) {
            let own = &rates.as_slice()[*speed..];
            match kind {
                Kind::Scalar | Kind::Circle => a.push(own[0]),
                Kind::Ball => a.extend(&own[..3]),
                Kind::Free => {
                    let [turning, moving] = [0, 3].map(|from| {
                        Vector3::from_column_slice(&state.speeds[speed + from..speed + from + 3])
                    });
                    let linear =
                        r * (Vector3::from_column_slice(&own[3..6]) + turning.cross(&moving));
                    a.extend(linear.iter());
                    a.extend(&own[..3]);
                }
            }
        }
        let mass = self.model.mass_matrix(&state)?;
        let values = mass.singular_values();
        let singular = [values.max(), values.min()];
        Ok(Answer { a, singular })
    }
}

fn rotation(wxyz: &[f64]) -> Matrix3<f64> {
    let quaternion = Quaternion::new(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
    UnitQuaternion::from_quaternion(quaternion)
        .to_rotation_matrix()
        .into_inner()
}

/// Joints by name, and whether each turns on a circle.
fn places(model: &Model) -> Vec<(String, (Place, bool))> {
    let joints = model.mechanism().joints();
    let places = joints.map(|(_, body)| {
        let ranges = body.ranges();
        let place = (ranges.configuration.start, ranges.speeds.start);
        let is_circle = body.joint().name() == "revolute_circle";
        (body.joint_name().to_owned(), (place, is_circle))
    });
    places.collect()
}

fn named(model: &Model, name: &str) -> Option<(Place, bool)> {
    places(model)
        .into_iter()
        .find_map(|(own, ((q, v), is_circle))| {
            let number = own.split('+').position(|own| own == name)?;
            Some(((q + number, v + number), is_circle))
        })
}
