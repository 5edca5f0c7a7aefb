//! What kind of scene a scene is: the page says for each kind which method serves best.

use super::case::Case;
use hamel::mechanism::{Body, Mechanism};
use hamel::registry::JointRegistry;
use hamel_scene::{Scene, SceneDescription};
use itertools::{Itertools, MinMaxResult};

/// Masses or principal moments whose ratio is larger than this are far apart: more than an ordinary robot has between its base and its last link.
const FAR_APART: f64 = 1e4;

/// Kinds, in the order in which they are tried: a scene is of the first that describes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Damped,
    Springs,
    FarApart,
    Wheels,
    Linkages,
    OneBody,
    Trees,
}

impl Kind {
    /// All of them, in the order of the page.
    pub const ALL: [Self; 7] = [
        Self::OneBody,
        Self::Trees,
        Self::Wheels,
        Self::Linkages,
        Self::FarApart,
        Self::Springs,
        Self::Damped,
    ];

    /// As the page writes it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Damped => "springs with damping",
            Self::Springs => "springs without damping",
            Self::FarApart => "masses or moments far apart",
            Self::Wheels => "wheels, blades and rolling balls",
            Self::Linkages => "linkages and gears",
            Self::OneBody => "one body, free or on a pivot",
            Self::Trees => "chains and trees",
        }
    }

    /// That of the scene of this name; `None` where this program does not know it.
    pub fn of(name: &str, registry: &JointRegistry) -> Option<Self> {
        let cases = Case::chosen(&[name.to_owned()]).ok()?;
        let description = cases.first()?.description().ok()?;
        let scene = description.build(registry).ok()?;
        Some(Self::of_scene(&description, &scene))
    }

    fn of_scene(description: &SceneDescription, scene: &Scene) -> Self {
        let forces = || description.bodies.iter().map(|body| &body.forces);
        let has_springs = forces().any(|forces| forces.spring.is_some());
        let has_damping = forces().any(|forces| forces.damping.is_some());
        let bodies = scene.mechanism.bodies();
        let is_nonholonomic =
            |body: &Body| body.joint().speeds().len() < body.joint().freedoms().len();
        match () {
            () if has_springs && has_damping => Self::Damped,
            () if has_springs => Self::Springs,
            () if is_far_apart(&scene.mechanism) => Self::FarApart,
            () if bodies.iter().any(is_nonholonomic) => Self::Wheels,
            () if { bodies.iter() }.any(|body| body.joint().bodies().len() > 1) => Self::Linkages,
            () if bodies.len() == 1 => Self::OneBody,
            () => Self::Trees,
        }
    }
}

/// Whether masses of bodies, or the principal moments of one, differ by more than [`FAR_APART`].
fn is_far_apart(mechanism: &Mechanism) -> bool {
    let masses = mechanism.bodies().iter().map(|body| body.mass().mass);
    let moments = |body: &Body| {
        let moments = body.mass().inertia_com.symmetric_eigenvalues();
        ratio(moments.iter().copied())
    };
    let moments = mechanism.bodies().iter().map(moments);
    moments
        .chain([ratio(masses)])
        .any(|ratio| ratio > FAR_APART)
}

/// The largest over the smallest of values that are not zero.
fn ratio(values: impl Iterator<Item = f64>) -> f64 {
    let positive = values.filter(|value| *value > 0.0);
    match positive.minmax_by(f64::total_cmp) {
        MinMaxResult::MinMax(least, most) => most / least,
        _ => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::Kind;

    #[test]
    fn scenes_are_of_the_kind_that_their_names_say() {
        let registry = hamel_joints::registry();
        for (name, kind) in [
            ("torsion_1e8_damped", Kind::Damped),
            ("ball_spring", Kind::Springs),
            ("needle", Kind::FarApart),
            ("ratio_light_tip", Kind::FarApart),
            ("plate_cart_arm_level", Kind::Wheels),
            ("crank_rocker", Kind::Linkages),
            ("heavy_top", Kind::OneBody),
            ("chain_8", Kind::Trees),
        ] {
            assert_eq!(Kind::of(name, &registry), Some(kind), "{name}");
        }
        assert_eq!(Kind::of("no_such_scene", &registry), None);
    }
}
