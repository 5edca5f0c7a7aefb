//! The joint of several bodies that a coupling is, in the place of the joints of the scene.

use super::closing::Plan;
use super::forces::{self, Owner};
use super::graph::{Group, Movement, Node, groups};
use super::initial::{self, Given};
use super::joint::{self, Coupling};
use super::{linkage, tie::Tie};
use crate::description::{
    BodyDescription, InitialDescription, JointDescription, Motion, Part, Position, SceneDescription,
};
use crate::diagnostics::Diagnostic;
use crate::notice::Notices;
use crate::read::Sink;
use crate::source::Located;
use hamel_runtime::joint::{Link, LinkMotion};
use hamel_runtime::mechanism::CONFIGURATION_TOLERANCE;
use hamel_runtime::shown::Number;
use hamel_runtime::spatial::Pose;
use std::collections::HashSet;
use std::f64::consts::TAU;

/// What messages call the type of such joints.
const KIND: &str = "coupled";

/// And of those that loops close.
const CLOSED_KIND: &str = "linkage";

/// The scene with its couplings and loops as joints.
pub(super) fn lower(
    scene: &SceneDescription,
    notices: &mut Notices,
    sink: &mut Sink,
) -> Option<SceneDescription> {
    let nodes: Vec<Node<'_>> = scene.bodies.iter().map(Node::of).collect();
    let loops = scene.loops.iter().map(Tie::of_loop);
    let ties: Vec<Tie<'_>> = loops
        .chain(scene.couplings.iter().map(Tie::of_coupling))
        .collect();
    let found = groups(&nodes, &ties, "scene", sink)?;
    let mut lowered = scene.clone();
    let names = scene.bodies.iter().map(|body| &*body.joint.name.value);
    let names: HashSet<&str> = names.collect();
    for group in &found {
        let coupling = Lowering {
            scene,
            ties: &ties,
            group,
        };
        coupling.refuse_name(&names, sink)?;
        for (place, body) in coupling.bodies(notices, sink)? {
            *lowered.bodies.get_mut(place)? = body;
        }
    }
    (lowered.loops, lowered.couplings) = (Vec::new(), Vec::new());
    (sink.len() == 0).then_some(lowered)
}

/// A group of a scene.
pub(super) struct Lowering<'a> {
    pub(super) scene: &'a SceneDescription,
    /// Loops, then couplings.
    pub(super) ties: &'a [Tie<'a>],
    pub(super) group: &'a Group,
}

impl<'a> Lowering<'a> {
    /// The bodies of the coupling with their places.
    fn bodies(
        &self,
        notices: &mut Notices,
        sink: &mut Sink,
    ) -> Option<Vec<(usize, BodyDescription)>> {
        let members = &self.group.members;
        self.refuse_order(sink)?;
        let mut owners = self.owners();
        let (joint, initial, coordinates) = match self.group.ties.is_empty() {
            true => {
                let coordinates = self.group.leaders().len();
                let initial = state(&owners, coordinates).map_err(|error| sink.push(error));
                (self.joint(&owners, None), initial.ok(), coordinates)
            }
            false => {
                let made = linkage::made(self, &mut owners, notices);
                let (plan, initial) = made.map_err(|error| sink.push(error)).ok()?;
                let independent = plan.independent;
                (self.joint(&owners, Some(plan)), Some(initial), independent)
            }
        };
        let acting = forces::joined(&owners, coordinates, sink);
        let (mut initial, mut acting) = (Some(initial?), Some(acting));
        let bodies = owners.iter().zip(members).enumerate();
        let bodies = bodies.map(|(number, (owner, (place, _)))| {
            let name = format!("link_{}", number + 1);
            let body = BodyDescription {
                parent: self.group.base,
                joint: joint.clone(),
                part: Some(Part {
                    name: Located::new(name, owner.body.name.span.clone()),
                    number,
                }),
                // The links of a loop stand in one frame, that of the base.
                at: match owner.closed {
                    true => Pose::identity(),
                    false => self.root(*place).at,
                },
                initial: initial.take().unwrap_or_default(),
                forces: acting.take().unwrap_or_default(),
                mimic: None,
                ..owner.body.clone()
            };
            (*place, body)
        });
        Some(bodies.collect())
    }

    /// Whether the bodies follow each other.
    fn refuse_order(&self, sink: &mut Sink) -> Option<()> {
        let members = &self.group.members;
        let (first, _) = members.first()?;
        let mut places = members.iter().map(|(place, _)| *place).zip(*first..);
        let Some((place, _)) = places.find(|(place, wanted)| place != wanted) else {
            return Some(());
        };
        let body = &self.scene.bodies[place].name;
        let message = format!(
            "body `{}`: it does not follow the other bodies of its coupling",
            body.value
        );
        sink.push(Diagnostic::new(body.span.clone(), message));
        None
    }

    /// Whether the name of several joints is that of another.
    fn refuse_name(&self, names: &HashSet<&str>, sink: &mut Sink) -> Option<()> {
        let leaders = self.group.leaders();
        let of = |place: usize| &self.scene.bodies[place].joint.name;
        let name = self.group.name(|place| of(place).value.clone());
        let span = of(*leaders.first()?).span.clone();
        if self.group.ties.is_empty() && leaders.len() == 1 || !names.contains(name.as_str()) {
            return Some(());
        }
        let message = match self.group.ties.is_empty() {
            true => format!(
                "joint `{name}`: so are called the joints that are coupled and move independently"
            ),
            false => format!("joint `{name}`: so is called the joint that a loop makes"),
        };
        sink.push(Diagnostic::new(span, message).help("give another name to one of them"));
        None
    }

    /// The number of a body among those of the coupling.
    pub(super) fn number(&self, place: usize) -> Option<usize> {
        self.group.members.iter().position(|(own, _)| *own == place)
    }

    /// The body of the coupling that hangs on its base, and carries this one.
    fn root(&self, mut place: usize) -> &'a BodyDescription {
        while let Some(parent) = self.scene.bodies[place]
            .parent
            .filter(|own| self.number(*own).is_some())
        {
            place = parent;
        }
        &self.scene.bodies[place]
    }

    fn owners(&self) -> Vec<Owner<'a>> {
        let leaders = self.group.leaders();
        let closed = !self.group.ties.is_empty();
        let owners = self.group.members.iter().map(|(place, law)| {
            let body = &self.scene.bodies[*place];
            let movement = Movement::of(&body.joint.kind.value);
            let before = body.parent.and_then(|parent| self.number(parent));
            let coordinate = leaders.iter().position(|leader| *leader == law.leader);
            let hangs_on = body
                .parent
                .filter(|_| before.is_some())
                .map(|parent| &self.scene.bodies[parent]);
            Owner {
                name: &body.joint.name.value,
                body,
                movement,
                follows: law.leader != *place,
                closed,
                link: Link {
                    before,
                    frame: match hangs_on {
                        Some(parent) => parent.body_at * body.at,
                        None if closed => body.at,
                        None => Pose::identity(),
                    },
                    motion: match movement {
                        Movement::Slide => LinkMotion::Slide,
                        _ => LinkMotion::Turn,
                    },
                    // Every law is of one of the leaders.
                    coordinate: coordinate.unwrap_or(0),
                    ratio: law.ratio,
                    offset: law.offset,
                },
            }
        });
        owners.collect()
    }

    fn joint(&self, owners: &[Owner<'_>], plan: Option<Plan>) -> JointDescription {
        let of = |place: usize| &self.scene.bodies[place].joint;
        let leader = self.group.leaders().first().map_or(0, |leader| *leader);
        let span = of(leader).span.clone();
        let name = self.group.name(|place| of(place).name.value.clone());
        let ports = owners
            .iter()
            .map(|owner| joint::port(owner.name, owner.movement));
        let kind = if plan.is_some() { CLOSED_KIND } else { KIND };
        let (ties, start) = plan.map_or_else(Default::default, |plan| (plan.ties, plan.start));
        JointDescription {
            name: Located::new(name, of(leader).name.span.clone()),
            kind: Located::new(kind.to_owned(), span.clone()),
            parameters: Vec::new(),
            coupling: Some(Coupling {
                links: owners.iter().map(|owner| owner.link).collect(),
                ports: joint::list(ports.collect()),
                ties,
                start,
            }),
            span,
        }
    }
}

/// The state at time 0, where what the scene gives of all joints fits together.
fn state(owners: &[Owner<'_>], coordinates: usize) -> Result<InitialDescription, Diagnostic> {
    let positions = owners.iter().map(|owner| {
        let position = &owner.body.initial.position;
        initial::position(owner.name, owner.movement, position)
    });
    let positions: Vec<Given> = positions.collect::<Result<_, _>>()?;
    let rates = owners
        .iter()
        .map(|owner| initial::rate(owner.body, owner.movement, &owner.body.initial));
    let rates: Vec<Given> = rates.collect::<Result<_, _>>()?;
    let q = led(owners, coordinates, &positions);
    let speeds = led(owners, coordinates, &rates);
    for (owner, given) in owners.iter().zip(&positions) {
        let link = &owner.link;
        let follows = link.ratio * q[link.coordinate] + link.offset;
        agrees(
            owner,
            "position",
            given,
            follows,
            owner.movement == Movement::Circle,
        )?;
    }
    for (owner, given) in owners.iter().zip(&rates) {
        let follows = owner.link.ratio * speeds[owner.link.coordinate];
        agrees(owner, "rate", given, follows, false)?;
    }
    let span = owners
        .first()
        .map_or(0..0, |owner| owner.body.joint.span.clone());
    let moves = speeds.iter().any(|speed| *speed != 0.0);
    Ok(InitialDescription {
        position: Position::Configuration(Located::new(q, span.clone())),
        motion: match moves {
            true => Motion::Speeds(Located::new(speeds, span)),
            false => Motion::Rest,
        },
    })
}

/// The values of what is followed: 0 where none is given.
fn led(owners: &[Owner<'_>], coordinates: usize, given: &[Given]) -> Vec<f64> {
    let mut values = vec![0.0; coordinates];
    for (owner, given) in owners.iter().zip(given) {
        if let Some((value, _)) = given.as_ref().filter(|_| !owner.follows) {
            values[owner.link.coordinate] = *value;
        }
    }
    values
}

fn agrees(
    owner: &Owner<'_>,
    what: &str,
    given: &Given,
    follows: f64,
    wraps: bool,
) -> Result<(), Diagnostic> {
    let Some((value, span)) = given.as_ref().filter(|_| owner.follows) else {
        return Ok(());
    };
    let mut away = value - follows;
    if wraps {
        away -= TAU * (away / TAU).round();
    }
    if away.abs() <= CONFIGURATION_TOLERANCE * follows.abs().max(1.0) {
        return Ok(());
    }
    let message = format!(
        "joint `{}`: its {what} at time 0 is {:?}, and by what it follows {:?}",
        owner.name,
        Number(*value),
        Number(follows)
    );
    Err(Diagnostic::new(span.clone(), message)
        .help("leave it out, or give it to the joint that it follows"))
}
