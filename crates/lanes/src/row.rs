//! One row of a sweep, ready to move with others.

use crate::joints::Joints;
use hamel::integrate::{FixedSteps, Form, Method, Tableau};
use hamel::registry::JointRegistry;
use hamel::scene::{Arithmetic, Scene, SceneDescription};
use hamel_compiler::model::Model;
use hamel_compiler::numbers::{self, Shape};
use hamel_compiler::prune::{Link, Pruning, prune};
use hamel_sweep::{Cells, Row, Sweep};

/// Steps of a motion at most: longer ones are left to the tree, which refuses what does not come to an end.
const MOST_STEPS: f64 = 1e9;

/// A scene with the pruned model of its equations.
#[derive(Debug)]
pub struct Described {
    /// What the row says.
    pub description: SceneDescription,
    /// Its scene.
    pub scene: Scene,
    /// What the scene compiler makes of it.
    pub model: Model,
    /// Its bodies in the frames of their equations.
    pub links: Vec<Link>,
    /// What is no number of it.
    pub shape: Shape,
    /// Its numbers.
    pub numbers: Vec<f64>,
    /// The method's coefficients.
    pub tableau: &'static Tableau,
    /// Its step, s.
    pub dt: f64,
}

/// Why a row does not go with others.
#[derive(Debug)]
pub enum Alone {
    /// It has a result already: it is refused.
    Refused(Row),
    /// It moves by the equations of the tree, for this reason.
    Tree(String),
}

/// What there is to know of a row.
///
/// # Errors
/// What keeps it from going with others.
pub fn described(
    sweep: &Sweep,
    registry: &JointRegistry,
    joints: &Joints,
    cells: &Cells,
) -> Result<Described, Alone> {
    let (description, scene) = sweep.described(cells, registry).map_err(Alone::Refused)?;
    let (tableau, dt) = method(&scene).map_err(Alone::Tree)?;
    let end = scene.settings.t_end;
    let times = sweep.times_until(end);
    let steps = FixedSteps::until(end, dt);
    if let Some(time) = times.iter().find(|time| !steps.has_end_at(**time)) {
        return Err(Alone::Tree(format!(
            "no step ends at {time} s, where a sample is taken"
        )));
    }
    let model = Model::new(&description, |name| joints.find(name));
    let mut model = model.map_err(|refused| {
        let reason = refused.reasons.into_iter().next().unwrap_or_default();
        Alone::Tree(format!("its equations are not compiled: {reason}"))
    })?;
    let mut links = prune(&model, Pruning::ALL);
    let mut all = Vec::new();
    numbers::numbers(&mut model, &mut links, &mut all);
    Ok(Described {
        shape: Shape::of(&model, &links),
        description,
        scene,
        model,
        links,
        numbers: all,
        tableau,
        dt,
    })
}

/// The explicit method of fixed step size by which the scene moves.
fn method(scene: &Scene) -> Result<(&'static Tableau, f64), String> {
    let refused = |why: &str| Err(why.to_owned());
    let (settings, mechanism) = (&scene.settings, &scene.mechanism);
    let Method::Fixed { scheme, dt } = settings.method else {
        return refused("its method controls the length of steps");
    };
    let Some(tableau) = scheme.tableau() else {
        return Err(format!(
            "its method `{}` is no explicit Runge-Kutta method",
            scheme.name()
        ));
    };
    if settings.chooses || settings.accuracy.is_some() {
        return refused("its method is chosen on the way");
    }
    if settings.form != Form::Lagrangian {
        return refused("its equations are in momenta");
    }
    if settings.arithmetic == Arithmetic::Refined {
        return refused("its arithmetic is refined");
    }
    if !scene.events.is_empty() {
        return refused("it has events");
    }
    if scene.control.is_some() {
        return refused("it has a controller");
    }
    if !mechanism.frictions().is_empty() || !mechanism.stops().is_empty() {
        return refused("it has friction or limits of joints");
    }
    if mechanism.changes_with_time() || !mechanism.drives().is_empty() {
        return refused("it changes with time");
    }
    if !mechanism.constraints().is_empty() {
        return refused("constraints couple its joints");
    }
    let mut joints = mechanism.joints();
    if let Some((_, body)) = joints.find(|(_, body)| !body.joint().singularities().is_empty()) {
        return Err(format!(
            "joint `{}` has singular configurations",
            body.joint_name()
        ));
    }
    if settings.t_end / dt > MOST_STEPS {
        return refused("it has more than 1e9 steps");
    }
    Ok((tableau, dt))
}
