//! Scenes with references, as they were when the program was built.

use hamel::integrate::{Method, Scheme};
use hamel_console::output::Failure;
use hamel_scene::{Scene, SceneDescription, Settings};
use serde::Deserialize;

/// A scene and what is known of its motion.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Name of the files.
    pub name: &'static str,
    scene: &'static str,
    reference: &'static str,
}

include!(concat!(env!("OUT_DIR"), "/cases.rs"));

/// A motion that is known to more digits than doubles have; SI units.
#[derive(Clone, Debug, Deserialize)]
pub struct Reference {
    /// Where the figures are from.
    pub source: String,
    /// Change of the final state per unit relative change of the initial velocities.
    pub conditioning: f64,
    /// Highest natural frequency, rad/s; 0 if nothing stiff swings.
    #[serde(default)]
    pub frequency: f64,
    /// Names of the bodies that it knows.
    pub bodies: Vec<String>,
    /// From time 0, ascending.
    pub samples: Vec<Sample>,
}

/// The bodies at one time.
#[derive(Clone, Debug, Deserialize)]
pub struct Sample {
    /// Time, s.
    pub t: f64,
    /// In the order of the names.
    pub bodies: Vec<Body>,
}

/// The motion of one body.
#[derive(Clone, Debug, Deserialize)]
pub struct Body {
    /// World axes, m.
    pub position_com: [f64; 3],
    /// Body to world.
    pub rotation_body_to_world_rowmajor: [f64; 9],
    /// World axes, m/s.
    pub velocity_com_world: [f64; 3],
    /// Body axes, rad/s.
    pub angular_velocity_body: [f64; 3],
}

impl Reference {
    /// Error that one rounding of the initial state, or of a phase, grows to.
    pub fn floor(&self) -> f64 {
        let phase = self.frequency * self.end();
        self.conditioning.max(phase).max(1.0) * 0.5 * f64::EPSILON
    }

    /// Time of the last sample, s.
    pub fn end(&self) -> f64 {
        self.samples.last().map_or(0.0, |sample| sample.t)
    }
}

impl Case {
    /// All cases, or those that are called by these names.
    ///
    /// # Errors
    /// A name that no case has.
    pub fn chosen(names: &[String]) -> Result<Vec<Self>, Failure> {
        let known = |name: &&String| !CASES.iter().any(|case| case.name == **name);
        if let Some(unknown) = names.iter().find(known) {
            let names: Vec<&str> = CASES.iter().map(|case| case.name).collect();
            return Err(Failure::Options(format!(
                "no scene with a reference is called `{unknown}`: there are {}",
                names.join(", ")
            )));
        }
        let chosen = CASES.iter().copied();
        Ok(chosen
            .filter(|case| names.is_empty() || names.iter().any(|name| name == case.name))
            .collect())
    }

    /// What the scene says.
    ///
    /// # Errors
    /// A scene with mistakes.
    pub fn description(&self) -> Result<SceneDescription, Failure> {
        Ok(Scene::from_toml(
            self.scene,
            &format!("{}.toml", self.name),
        )?)
    }

    /// What is known of its motion.
    ///
    /// # Errors
    /// A file that is no reference.
    pub fn reference(&self) -> Result<Reference, Failure> {
        serde_json::from_str(self.reference)
            .map_err(|error| Failure::Page(format!("{}.json: {error}", self.name)))
    }
}

/// Methods that are measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Methods {
    /// Those of a name.
    pub schemes: Vec<Scheme>,
    /// Whether the one that is chosen for the scene is.
    pub chooses: bool,
}

/// The methods of these names; all of them where none is named.
///
/// # Errors
/// A name that no method has.
pub fn methods(names: &[String]) -> Result<Methods, Failure> {
    if names.is_empty() {
        return Ok(Methods {
            schemes: Scheme::ALL.to_vec(),
            chooses: true,
        });
    }
    let (open, named): (Vec<&String>, Vec<&String>) =
        names.iter().partition(|name| *name == Settings::AUTO);
    let schemes = named.into_iter().map(|name| {
        Scheme::named(name).ok_or_else(|| {
            let known = Scheme::ALL.map(|scheme| scheme.name());
            let known = known.join(", ");
            let auto = Settings::AUTO;
            Failure::Options(format!(
                "no method is called `{name}`: there are {known}, and {auto}"
            ))
        })
    });
    Ok(Methods {
        schemes: schemes.collect::<Result<_, _>>()?,
        chooses: !open.is_empty(),
    })
}

/// The tolerance or the step of a method.
pub const fn accuracy(method: &Method) -> f64 {
    match method {
        Method::Fixed { dt, .. } => *dt,
        Method::Controlled { control, .. } => control.tolerance,
    }
}
