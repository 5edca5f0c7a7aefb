//! The lines of a spec that a kernel comes from.

mod statements;

pub use statements::Statement;

use crate::derived::{Derived, KernelKind};
use crate::model::{JointSpec, VelocityFrame};
use crate::spec::comments::without_comments;
use std::ops::Range;

/// All statements that the values of a kernel depend on, in the order of the spec, `let` among them.
pub fn sources(derived: &Derived, kind: KernelKind) -> Vec<Statement> {
    let spec = &derived.spec;
    let all = statements::statements(&spec.source);
    let mut used: Vec<bool> = all.iter().map(|_| false).collect();
    for part in parts(spec, kind) {
        let spans = part.spans(derived);
        for (statement, used) in all.iter().zip(&mut used) {
            let holds =
                |span: &Range<usize>| !span.is_empty() && statement.span.contains(&span.start);
            *used |=
                spans.iter().any(holds) || part.keywords().contains(&statement.keyword.as_str());
        }
    }
    // A `let` sees those above it: one pass from below finds all that are used.
    for i in (0..all.len()).rev() {
        let name = all[i].defines();
        used[i] |=
            name.is_some_and(|name| (i + 1..all.len()).any(|j| used[j] && all[j].mentions(name)));
    }
    let chosen = all.into_iter().zip(used).filter(|(_, used)| *used);
    chosen.map(|(statement, _)| statement).collect()
}

/// What a kernel is derived from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Manifold,
    Home,
    Loci,
    /// What ϕ means: Φ, and the directions of the degrees of freedom.
    Motion,
    Pose,
    /// What v means: X, or the frame in which v is read.
    Velocity,
    Constraint,
    SpeedBasis,
    Ports,
    Pins,
}

impl Part {
    /// Where the spec declares it, as far as its model says.
    fn spans(self, derived: &Derived) -> Vec<Range<usize>> {
        let spec = &derived.spec;
        let of = |declared: Option<Range<usize>>| declared.into_iter().collect::<Vec<_>>();
        match self {
            Self::Manifold => vec![spec.manifold.span.clone()],
            Self::Home => of(spec.home.as_ref().map(|declared| declared.span.clone())),
            Self::Loci => derived
                .space
                .loci
                .iter()
                .map(|locus| locus.span.clone())
                .collect(),
            Self::Ports => spec.ports.iter().map(|port| port.span.clone()).collect(),
            Self::Pins => spec.pins.iter().map(|pin| pin.span.clone()).collect(),
            Self::Motion => of(spec.retract.as_ref().map(|declared| declared.span.clone())),
            Self::Pose => vec![spec.pose.span.clone()],
            Self::Velocity => of(spec
                .twist_map
                .as_ref()
                .map(|declared| declared.span.clone())),
            Self::Constraint => of(spec
                .constraint
                .as_ref()
                .map(|declared| declared.span.clone())),
            Self::SpeedBasis => of(spec
                .speed_basis
                .as_ref()
                .map(|declared| declared.span.clone())),
        }
    }

    /// Statements that belong to it wherever they stand.
    fn keywords(self) -> &'static [&'static str] {
        match self {
            Self::Manifold => &["config"],
            Self::Motion => &["basis", "local"],
            Self::Velocity => &["velocity"],
            _ => &[],
        }
    }
}

/// The parts that a kernel is derived from.
fn parts(spec: &JointSpec, kind: KernelKind) -> Vec<Part> {
    use Part::{Constraint, Home, Loci, Manifold, Motion, Pins, Ports, Pose, SpeedBasis, Velocity};
    // Without a declared X, its columns are the twists of H along ϕ.
    let twist: &[Part] = match (&spec.twist_map, spec.velocity.value) {
        (Some(_), _) => &[Velocity],
        (None, _) => &[Velocity, Pose, Motion],
    };
    let speeds: &[Part] = match (&spec.speed_basis, &spec.constraint) {
        (Some(_), _) => &[SpeedBasis],
        (None, Some(_)) => &[Constraint],
        (None, None) => &[],
    };
    let constraint: &[Part] = match &spec.constraint {
        Some(_) => &[Constraint],
        None => speeds,
    };
    let groups: Vec<&[Part]> = match kind {
        KernelKind::Home => vec![if spec.home.is_some() {
            &[Home]
        } else {
            &[Manifold]
        }],
        KernelKind::Pose => vec![&[Pose]],
        KernelKind::TwistMap => vec![twist],
        KernelKind::TwistMapChild => vec![twist, &[Pose]],
        KernelKind::TwistMapChildGradient
        | KernelKind::VelocityMap
        | KernelKind::VelocityMapInverse
        | KernelKind::VelocityMapGradient
        | KernelKind::Gamma
        | KernelKind::J22
        | KernelKind::ConfigurationRate => vec![twist, &[Pose, Motion]],
        KernelKind::Constraint => vec![constraint],
        KernelKind::SpeedBasis => vec![speeds],
        KernelKind::SpeedBasisGradient if speeds.is_empty() => vec![],
        KernelKind::SpeedBasisGradient => vec![speeds, &[Motion]],
        KernelKind::Retract
        | KernelKind::TangentBasis
        | KernelKind::NormalBasis
        | KernelKind::Displaced
        | KernelKind::DisplacedDifferential
        | KernelKind::Displacement
        | KernelKind::Local
        | KernelKind::RetractDifferential
        | KernelKind::RetractDifferentialInverse => vec![&[Manifold, Motion]],
        KernelKind::Relations
        | KernelKind::RelationGradient
        | KernelKind::Project
        | KernelKind::Residual => vec![&[Manifold]],
        KernelKind::Singularity => vec![&[Loci]],
        KernelKind::RelationDisplacements => vec![&[Manifold, Motion]],
        KernelKind::RelationTwists => vec![&[Manifold, Motion, Pose]],
        KernelKind::RelationPorts => vec![&[Manifold, Motion, Ports]],
        KernelKind::PortMap => vec![&[Ports], twist, &[Pose, Motion]],
        KernelKind::PortValues => vec![&[Ports]],
        KernelKind::Pins => vec![&[Pins, Pose]],
        KernelKind::BiasAcceleration | KernelKind::BiasMomentum => {
            vec![twist, speeds, &[Pose, Motion]]
        }
    };
    groups.concat()
}

/// The statements that a kernel comes from directly, as written; nothing for kernels that follow from several.
pub fn statement(derived: &Derived, kind: KernelKind) -> Option<String> {
    let spec = &derived.spec;
    let span = match kind {
        KernelKind::Pose => spec.pose.span.clone(),
        KernelKind::TwistMap => match &spec.twist_map {
            Some(declared) => declared.span.clone(),
            // Nothing in the spec says what follows from H alone.
            None if spec.velocity.value == VelocityFrame::Rates => return None,
            None => spec.velocity.span.clone(),
        },
        KernelKind::Constraint => spec.constraint.as_ref()?.span.clone(),
        KernelKind::SpeedBasis => spec.speed_basis.as_ref()?.span.clone(),
        KernelKind::Retract => match &spec.retract {
            Some(declared) => declared.span.clone(),
            None => spec.freedoms.span.clone(),
        },
        KernelKind::Project | KernelKind::Residual | KernelKind::Home => spec.manifold.span.clone(),
        KernelKind::Singularity => derived.space.loci.first()?.span.clone(),
        _ => return None,
    };
    lines_around(&spec.source, span)
}

/// The full lines that a span touches, without comments, on one line.
fn lines_around(source: &str, span: Range<usize>) -> Option<String> {
    if span.is_empty() {
        return None;
    }
    let start = source.get(..span.start)?.rfind('\n').map_or(0, |at| at + 1);
    let end = source
        .get(span.end..)?
        .find('\n')
        .map_or(source.len(), |at| span.end + at);
    // Comments are found from the start of the text: a line may stand inside one.
    let bare = without_comments(source);
    let words: Vec<&str> = bare.get(start..end)?.split_whitespace().collect();
    (!words.is_empty()).then(|| words.join(" "))
}

#[cfg(test)]
mod tests {
    use super::sources;
    use crate::derive;
    use crate::derived::KernelKind;

    const SPEC: &str = "hamel = 1;
/// Doc; with a semicolon.
joint slider(lead: m) {
    config  q: R1;          // an angle; in rad
    let unused = lead;
    let pitch = lead
        / (2 * pi);
    let travel = pitch * q + 0 * unused;
    H = rot_z(q) * trans_z(travel);
}";

    const CART: &str = "hamel = 1;
joint cart {
    config  Q: SE2;
    basis   turn, forward, sideways of se2;
    velocity in child;
    Phi   = Q * exp(phi);
    H     = pose(rot_z(Q), [Q.x, Q.y, 0]);
    A     = [0; 0; 1];
    S_bar = [1, 0; 0, 1; 0, 0];
    speeds  turn, forward;
}";

    #[test]
    fn sources_are_found_with_their_lines_through_lets() {
        let derived = derive(SPEC, "test").unwrap_or_else(|errors| panic!("{errors}"));
        let lines = |kind| -> Vec<usize> {
            let sources = sources(&derived, kind);
            sources.iter().map(|statement| statement.line).collect()
        };
        assert_eq!(lines(KernelKind::Pose), [5, 6, 8, 9]);
        assert_eq!(lines(KernelKind::Home), [4]);
        assert_eq!(lines(KernelKind::SpeedBasis), [0; 0]);
        let pose = sources(&derived, KernelKind::Pose);
        assert_eq!(pose[1].text, "let pitch = lead / (2 * pi);");
    }

    #[test]
    fn kernels_name_what_they_are_derived_from() {
        let derived = derive(CART, "cart.joint").unwrap_or_else(|errors| panic!("{errors}"));
        let keywords = |kind| -> Vec<String> {
            let sources = sources(&derived, kind);
            sources
                .into_iter()
                .map(|statement| statement.keyword)
                .collect()
        };
        assert_eq!(keywords(KernelKind::Constraint), ["A"]);
        assert_eq!(keywords(KernelKind::Retract), ["config", "basis", "Phi"]);
        assert_eq!(
            keywords(KernelKind::BiasMomentum),
            ["basis", "velocity", "Phi", "H", "S_bar"]
        );
    }
}
