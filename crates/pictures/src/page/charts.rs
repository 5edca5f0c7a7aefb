//! What the page plots: which columns there are, what they are called, and their values at a time.

use super::unwrapped::Unwrapped;
use crate::sample::Sample;
use hamel::erased::AnyJoint;
use hamel::mechanism::{Body, Mechanism};
use hamel::scene::Scene;
use hamel::spatial::split;
use serde::Serialize;

/// What is known of a motion before it begins, by which its charts are chosen.
#[derive(Clone, Copy, Debug, Default)]
pub struct Contents {
    /// Whether samples have the efforts of a controller.
    pub has_efforts: bool,
    /// Whether the ends of steps are noted.
    pub has_steps: bool,
    /// Whether anything but gravity can change the energy.
    pub does_work: bool,
}

/// Whether anything but gravity and inputs can change the energy of a mechanism.
pub fn does_work(mechanism: &Mechanism) -> bool {
    !mechanism.elements().is_empty()
        || mechanism.changes_with_time()
        || !mechanism.frictions().is_empty()
        || !mechanism.stops().is_empty()
}

/// A plot: one of its variants at a time is shown.
#[derive(Debug, Serialize)]
pub struct Chart {
    title: &'static str,
    /// Whether the vertical axis is logarithmic.
    log: bool,
    variants: Vec<Variant>,
}

/// Columns in one plot.
#[derive(Debug, Serialize)]
struct Variant {
    name: String,
    unit: String,
    /// The body that it is about, if it is about one.
    body: Option<usize>,
    columns: Vec<Column>,
}

/// A column of the recorded numbers.
#[derive(Debug, Serialize)]
struct Column {
    name: String,
    index: usize,
}

/// Fills the columns and describes them.
#[derive(Debug)]
pub struct Charts<'a> {
    mechanism: &'a Mechanism,
    described: Vec<Chart>,
    columns: usize,
    first_energy: Option<f64>,
    /// Where they are noted.
    steps: Option<Steps>,
    /// One a body: the coordinates of its joint from home.
    followed: Vec<Unwrapped>,
    coordinates: Vec<f64>,
}

impl<'a> Charts<'a> {
    /// The charts of a motion of `scene`.
    pub fn new(scene: &'a Scene, contents: Contents) -> Self {
        let mechanism = &*scene.mechanism;
        let mut columns = 0;
        let described = described(mechanism, contents, &mut columns);
        Self {
            mechanism,
            described,
            columns,
            first_energy: None,
            steps: contents.has_steps.then(Steps::default),
            followed: mechanism
                .joints()
                .map(|(_, body)| Unwrapped::new(body.joint(), body.home()))
                .collect(),
            coordinates: Vec::new(),
        }
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Describes one column more: the estimated error.
    pub fn add_error(&mut self) {
        let columns = numbered(["largest of all bodies"].into_iter(), &mut self.columns);
        self.described.push(Chart {
            title: "Estimated error",
            log: true,
            variants: vec![variant("", "1", None, columns)],
        });
    }

    /// The charts, in the order of the page.
    pub fn into_described(self) -> Vec<Chart> {
        self.described
    }

    /// Notes the end of a step.
    pub fn step(&mut self, time: f64) {
        if let Some(steps) = &mut self.steps {
            steps.note(time);
        }
    }

    /// Follows the coordinates to a sample, also to one that is no frame: the fewer turn between two, the surer.
    pub fn follow(&mut self, configuration: &[f64]) {
        let joints = self.mechanism.joints().zip(&mut self.followed);
        let coordinates = joints.flat_map(|((_, body), followed)| {
            followed.follow(body.joint(), body.configuration(configuration))
        });
        self.coordinates = coordinates.collect();
    }

    /// The columns' values at a sample, to which the coordinates have been followed, in the order of [`described`].
    pub fn values(&mut self, sample: &Sample<'_>) -> Vec<f64> {
        let kinematics = &sample.kinematics;
        let energy = kinematics.energy();
        let first = *self.first_energy.get_or_insert(energy);
        let (about_origin, linear) = split(&kinematics.momentum());
        let (about_com, _) = split(&kinematics.momentum_com());
        let mut values = vec![
            kinematics.kinetic_energy(),
            kinematics.potential_energy(),
            energy,
            energy - first,
        ];
        for momentum in [linear, about_origin, about_com] {
            values.extend(momentum.iter());
        }
        values.extend(&self.coordinates);
        values.extend(sample.speeds);
        values.extend(sample.efforts);
        values.extend(self.steps.iter_mut().flat_map(Steps::take));
        values
    }
}

/// Longest and shortest step since the last frame.
#[derive(Debug, Default)]
struct Steps {
    last_time: Option<f64>,
    extremes: Option<[f64; 2]>,
}

impl Steps {
    fn note(&mut self, time: f64) {
        if let Some(last) = self.last_time.replace(time) {
            let length = time - last;
            let [longest, shortest] = self.extremes.unwrap_or([length; 2]);
            self.extremes = Some([longest.max(length), shortest.min(length)]);
        }
    }

    fn take(&mut self) -> [f64; 2] {
        self.extremes.take().unwrap_or([f64::NAN; 2])
    }
}

/// Which columns there are, numbered in the order of [`Charts::values`].
fn described(mechanism: &Mechanism, contents: Contents, next: &mut usize) -> Vec<Chart> {
    let mut plain = |name: &str, unit: &str, columns: &[&str]| {
        let columns = numbered(columns.iter().copied(), next);
        variant(name, unit, None, columns)
    };
    let energy = vec![plain("", "J", &["kinetic", "potential", "total"])];
    let change = vec![plain("", "J", &["total − initial"])];
    // With nothing at work it is the integrator's alone.
    let change_title = match contents.does_work {
        true => "Energy change",
        false => "Energy drift",
    };
    let about = |point: &str| format!("angular, about {point}");
    let momentum = vec![
        plain("linear", "kg m/s", &["x", "y", "z"]),
        plain(&about("the world’s origin"), "kg m²/s", &["x", "y", "z"]),
        plain(&about("the centre of mass"), "kg m²/s", &["x", "y", "z"]),
    ];
    let joints = |names: fn(&Body) -> &[&'static str],
                  units: fn(&dyn AnyJoint) -> Vec<&'static str>,
                  next: &mut usize| {
        let variants = mechanism.joints().map(|(index, body)| {
            let columns = numbered(names(body).iter().copied(), next);
            let unit = distinct(units(body.joint()));
            variant(body.joint_name(), &unit, Some(index), columns)
        });
        variants.collect::<Vec<_>>()
    };
    let rates = |joint: &dyn AnyJoint| {
        let speeds = 0..joint.layout().speeds;
        speeds
            .map(|place| joint.units().speed(place).rate)
            .collect()
    };
    let coordinates = |joint: &dyn AnyJoint| {
        let freedoms = 0..joint.layout().freedoms;
        freedoms
            .map(|place| joint.units().freedom(place).name)
            .collect()
    };
    let forces = |joint: &dyn AnyJoint| {
        let freedoms = 0..joint.layout().freedoms;
        freedoms
            .map(|place| joint.units().velocity(place).effort)
            .collect()
    };
    let coordinates = joints(|body| body.joint().freedoms(), coordinates, next);
    let speeds = joints(|body| body.joint().speeds(), rates, next);
    let efforts = match contents.has_efforts {
        true => joints(|body| body.joint().freedoms(), forces, next),
        false => Vec::new(),
    };
    let steps = match contents.has_steps {
        true => {
            let columns = numbered(["longest", "shortest"].into_iter(), next);
            vec![variant("", "s", None, columns)]
        }
        false => Vec::new(),
    };
    [
        ("Energy", false, energy),
        (change_title, false, change),
        ("Momentum", false, momentum),
        ("Coordinates from home", false, coordinates),
        ("Speeds v̄", false, speeds),
        ("Controller’s efforts τ", false, efforts),
        ("Integration steps", true, steps),
    ]
    .map(|(title, log, variants)| Chart {
        title,
        log,
        variants,
    })
    .into_iter()
    .filter(|chart| !chart.variants.is_empty())
    .collect()
}

fn variant(name: &str, unit: &str, body: Option<usize>, columns: Vec<Column>) -> Variant {
    Variant {
        name: name.to_owned(),
        unit: unit.to_owned(),
        body,
        columns,
    }
}

fn numbered<'n>(names: impl Iterator<Item = &'n str>, next: &mut usize) -> Vec<Column> {
    let columns = names.map(|name| {
        let index = *next;
        *next += 1;
        Column {
            name: name.to_owned(),
            index,
        }
    });
    columns.collect()
}

/// Each unit once, in the order in which they come.
fn distinct(units: Vec<&'static str>) -> String {
    let mut distinct: Vec<&str> = Vec::new();
    for unit in units.into_iter().filter(|unit| !unit.is_empty()) {
        if !distinct.contains(&unit) {
            distinct.push(unit);
        }
    }
    distinct.join(", ")
}
