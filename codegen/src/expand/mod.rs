//! The paper's step: from what a spec declares to every kernel, in symbols, at ϕ = 0 and beyond.
//!
//! What kernels are made of is not trusted: [`crate::prove`] substitutes it back into its definition.

mod complement;
pub(crate) mod dimension;
pub(crate) mod directions;
mod elimination;
pub(crate) mod finite;
mod forbidden;
mod general;
mod hamel;
mod implicit;
mod kernels;
mod motion;
mod nonholonomic;
mod numbers;
pub(crate) mod pins;
pub(crate) mod ports;
pub(crate) mod rank;
mod steps;
mod still;
pub(crate) mod task;
mod twist;
mod unidentifiable;
mod velocity;

pub use dimension::Confinement;
pub use forbidden::Forbidden;
pub use implicit::{Directions as RelationDirections, Flow, Systems, without_content};

pub use kernels::{kernels, of_body, speed_map};
pub use motion::Motion;
pub use nonholonomic::{Nonholonomic, speed_names};
pub use numbers::{beyond_doubles, rough_curve};
pub use pins::{PinDrive, Source};
pub use steps::Steps;
pub use still::Still;
pub use twist::{TwistJacobian, bracket, in_child_frames};
pub use unidentifiable::unidentifiable;
pub use velocity::VelocityMap;

use crate::algebra;
use crate::diagnostic::Diagnostic;
use crate::domain::Domain;
use crate::expr::{Expr, Role, Symbol, budget};
use crate::kernel::{Arguments, Shape, Word};
use crate::manifold::Ideal;
use crate::matrix::Matrix;
use crate::model::VelocityFrame;
use crate::prepare::Prepared;
use crate::spec::code;

/// Everything that the kernels and the proofs are made of.
#[derive(Clone, Debug)]
pub struct Expansion {
    /// Sizes.
    pub shape: Shape,
    /// Symbols of the kernels' arguments.
    pub arguments: Arguments,
    /// Whether Φ is Q exp(ϕ), so that the finite maps have closed forms.
    pub exponential: bool,
    /// Φ to second order.
    pub motion: Motion,
    /// How v moves Q, where relations alone say so.
    pub flow: Option<Flow>,
    /// Structure constants: slice k is `ad_{b_k}` in the declared basis, entry (i, j) = c^i_kj.
    pub structure_constants: Vec<Matrix>,
    /// J to first order; of several bodies one below the other, as X and X^c.
    pub jacobian: TwistJacobian,
    /// X.
    pub twist_map: Matrix,
    /// X^c.
    pub twist_map_child: Matrix,
    /// S to first order.
    pub velocity_map: VelocityMap,
    /// det S₀.
    pub determinant: Expr,
    /// S₀⁻¹.
    pub velocity_map_inverse: Matrix,
    /// A, S̄ and ∂S̄/∂ϕ.
    pub nonholonomic: Nonholonomic,
    /// The degrees of freedom that move no body.
    pub still: Still,
    /// P: v to the rates of the ports.
    pub port_map: Matrix,
    /// Point, axis of turning and axis of sliding of each pin, by rows of nine.
    pub pins: Matrix,
    /// The efforts that act at each pin.
    pub pin_drives: Vec<Vec<PinDrive>>,
    /// What displacements that relations forbid would do, where these alone say how Q moves.
    pub forbidden: Option<Forbidden>,
}

impl Expansion {
    /// The names in which B was derived where relations alone say how Q moves, each after those in its value.
    pub fn named(&self) -> &[Word] {
        self.flow.as_ref().map_or(&[], Flow::words)
    }

    /// That of the joint as if it carried that body alone: what belongs to Q and v stays as it is.
    pub fn carrying(&self, body: usize) -> Self {
        Self {
            jacobian: self.jacobian.rows_of_body(body),
            twist_map: self.twist_map.rows_of_body(body),
            twist_map_child: self.twist_map_child.rows_of_body(body),
            forbidden: self.forbidden.as_ref().map(|own| own.of_body(body)),
            ..self.clone()
        }
    }
}

/// Expands a joint.spec.
pub fn expand(joint: &Prepared) -> Result<Expansion, Vec<Diagnostic>> {
    let ideal = joint.space.manifold.ideal();
    let domain = Domain::new(&joint.space);
    let exponential = joint.exponential;
    dimension::check(joint, exponential)?;
    let arguments = arguments(joint);
    budget::begin(task::MOTION);
    let (motion, flow) = match (&joint.spec.implicit, &joint.spec.retract) {
        (Some(implicit), _) => {
            let (motion, flow) = implicit::expand(joint, implicit, &domain)?;
            (motion, Some(flow))
        }
        (None, Some(declared)) if !exponential => (Motion::of_map(joint, &declared.value), None),
        _ => (Motion::of_exponential(joint), None),
    };
    let structure_constants = structure_constants(joint);
    budget::begin(task::TWIST);
    let jacobian = TwistJacobian::of_bodies(&joint.spec, &motion, ideal);
    budget::begin(task::TWIST_MAP);
    let twist_map = twist_map(joint, &jacobian, ideal)?;
    let twist_map_child = match twist_map == jacobian.base {
        true => jacobian.child.clone(),
        false => ideal.simplest_entries(&in_child_frames(&joint.spec, &twist_map)),
    };
    budget::begin(task::VELOCITY_MAP);
    let still = Still::new(joint, &motion);
    read_in_child(joint, &still, &structure_constants)?;
    let velocity_map = velocity::Solver {
        jacobian: &still.below_jacobian(&jacobian),
        twist_map: &still.below(&twist_map),
        child: &still.below(&twist_map_child),
        to_child: &still.beside(&twist::adjoint_inverses(&joint.spec)),
        motion: &motion,
        flow: flow.as_ref(),
        domain: &domain,
        structure_constants: exponential.then_some(&structure_constants),
    }
    .solve()
    .ok_or_else(|| vec![singular_twist_map(joint, &twist_map)])?;
    let simplify = |e: &Expr| ideal.normal_form(e);
    let determinant = velocity_map.base.determinant(&simplify);
    let inverse = determinant
        .recip()
        .ok_or_else(|| vec![singular_velocity_map(joint, &velocity_map.base)])?;
    let velocity_map_inverse = velocity_map.inverse.clone().unwrap_or_else(|| {
        ideal.simplest_entries(&velocity_map.base.adjugate(&simplify).scale(&inverse))
    });
    budget::begin(task::PORTS);
    let gradient = ports::gradient(&joint.spec.ports, &motion, ideal);
    let port_map = ideal.simplest_entries(&gradient.times(&velocity_map_inverse));
    budget::begin(task::TWIST);
    let forbidden = flow.as_ref().map(|_| Forbidden::new(joint));
    budget::begin(task::CONSTRAINT);
    let nonholonomic = Nonholonomic::new(joint, &motion, &domain)?;
    let mut expansion = Expansion {
        shape: Shape {
            configuration: arguments.configuration.len(),
            freedoms: motion.freedoms(),
            speeds: nonholonomic.speed_basis.columns(),
            constraints: nonholonomic.constraint.columns(),
            displacements: arguments.displacement.len(),
            ports: joint.spec.ports.len(),
            pins: joint.spec.pins.len(),
        },
        pins: pins::places(&joint.spec, ideal),
        pin_drives: vec![],
        arguments,
        exponential,
        motion,
        flow,
        structure_constants,
        jacobian,
        twist_map,
        twist_map_child,
        velocity_map,
        determinant,
        velocity_map_inverse,
        nonholonomic,
        still,
        port_map,
        forbidden,
    };
    budget::begin(task::PINS);
    expansion.pin_drives = pins::drives(&joint.spec, &expansion, ideal);
    Ok(expansion)
}

fn arguments(joint: &Prepared) -> Arguments {
    let manifold = &joint.space.manifold;
    let freedoms = &joint.spec.freedoms.value;
    let named = |role: Role, prefix: &str| -> Vec<Symbol> {
        let name = |(i, freedom): (usize, &crate::model::Freedom)| {
            Symbol::new(role, i, &format!("{prefix}_{}", freedom.name))
        };
        freedoms.iter().enumerate().map(name).collect()
    };
    let speeds = nonholonomic::speed_names(&joint.spec);
    Arguments {
        configuration: manifold.coordinates(),
        target: manifold
            .target()
            .into_iter()
            .flat_map(|factor| factor.coordinates)
            .collect(),
        local: freedoms
            .iter()
            .map(|freedom| freedom.local.clone())
            .collect(),
        displacement: implicit::displacement(joint),
        velocity: named(Role::Velocity, "v"),
        speeds: speeds
            .iter()
            .enumerate()
            .map(|(i, name)| Symbol::new(Role::Speed, i, &format!("speed_{name}")))
            .collect(),
        momentum: named(Role::Momentum, "p"),
        wrench: Symbol::series(Role::Wrench, "h", 6),
    }
}

/// `c^i_kj` with `[b_k, b_j] = Σ_i c^i_kj b_i`, in the declared basis. The language has checked that the basis closes.
fn structure_constants(joint: &Prepared) -> Vec<Matrix> {
    let freedoms = &joint.spec.freedoms.value;
    let count = freedoms.len();
    let mut constants = vec![vec![vec![Expr::zero(); count]; count]; count];
    for (n, factor) in joint.space.manifold.factors().iter().enumerate() {
        let belongs = |&k: &usize| freedoms[k].factor == n && !freedoms[k].generator.is_empty();
        let places: Vec<usize> = (0..count).filter(belongs).collect();
        let basis = places
            .iter()
            .map(|&k| freedoms[k].generator.clone())
            .collect::<Vec<_>>();
        let columns = Matrix::from_columns(factor.kind.dimension(), &basis);
        for (a, &k) in places.iter().enumerate() {
            for (b, &j) in places.iter().enumerate() {
                let (x, y) = (
                    algebra::hat(factor.kind, &basis[a]),
                    algebra::hat(factor.kind, &basis[b]),
                );
                let bracket = algebra::vee(factor.kind, &algebra::commutator(&x, &y));
                for (place, value) in places
                    .iter()
                    .zip(algebra::coordinates_in(&columns, &bracket).unwrap_or_default())
                {
                    constants[k][*place][j] = value;
                }
            }
        }
    }
    constants
        .iter()
        .map(|slice| Matrix::from_fn(count, count, |i, j| slice[i][j].clone()))
        .collect()
}

/// X: as declared, else the velocity of Φ itself; read in the parent frame, the constant that the latter is in the child frame.
fn twist_map(
    joint: &Prepared,
    jacobian: &TwistJacobian,
    ideal: &Ideal,
) -> Result<Matrix, Vec<Diagnostic>> {
    match &joint.spec.twist_map {
        Some(declared) => Ok(declared.value.clone()),
        None => twist_map_in_frame(joint, jacobian, ideal),
    }
}

/// X as the declared frame of v has it.
pub(crate) fn twist_map_in_frame(
    joint: &Prepared,
    jacobian: &TwistJacobian,
    ideal: &Ideal,
) -> Result<Matrix, Vec<Diagnostic>> {
    if joint.spec.velocity.value != VelocityFrame::Parent {
        return Ok(jacobian.base.clone());
    }
    let child = ideal.normal_forms(&jacobian.child);
    match child.is_constant() {
        true => Ok(child),
        false => Err(vec![
            Diagnostic::new(
                code::PARENT_FRAME,
                joint.spec.velocity.span.clone(),
                "this joint has no constant velocity directions to read in the parent frame",
            )
            .label("declared here")
            .note(format!("in the child frame they are\n{child}"))
            .help("declare X, the twist of the child in the parent frame for each velocity"),
        ]),
    }
}

/// Refuses velocities in parent axes of what moves no body where these axes make a difference: there is no body to read them of.
fn read_in_child(
    joint: &Prepared,
    still: &Still,
    structure_constants: &[Matrix],
) -> Result<(), Vec<Diagnostic>> {
    let turns = |&k: &usize| !structure_constants[k].is_zero();
    let found = still.freedoms.iter().copied().find(turns);
    let Some(k) = found.filter(|_| joint.spec.velocity.value == VelocityFrame::Parent) else {
        return Ok(());
    };
    let name = &joint.spec.freedoms.value[k].name;
    Err(vec![
        Diagnostic::new(
            code::PARENT_FRAME,
            joint.spec.velocity.span.clone(),
            format!("`{name}` moves no body whose velocity could be read in the parent frame"),
        )
        .label("declared here")
        .help("read v in the child frame, or let H depend on what it moves"),
    ])
}

fn singular_twist_map(joint: &Prepared, twist_map: &Matrix) -> Diagnostic {
    let span = joint
        .spec
        .twist_map
        .as_ref()
        .map_or(joint.spec.pose.span.clone(), |declared| {
            declared.span.clone()
        });
    Diagnostic::new(
        code::DEPENDENT_TWISTS,
        span,
        "X has dependent columns at every configuration",
    )
    .label("some velocity moves nothing")
    .note(format!("X =\n{twist_map}"))
    .help("each velocity must move the child in a way of its own")
}

fn singular_velocity_map(joint: &Prepared, base: &Matrix) -> Diagnostic {
    let span = joint
        .spec
        .twist_map
        .as_ref()
        .map_or(joint.spec.freedoms.span.clone(), |declared| {
            declared.span.clone()
        });
    Diagnostic::new(
        code::SINGULAR_VELOCITY_MAP,
        span,
        "S₀ is singular at every configuration",
    )
    .label("the velocities do not determine the motion")
    .note(format!("S₀ =\n{base}"))
}
