//! The joint that loops make of the joints in them: what the scene says of their state, and of which move independently, as a [`Problem`], and what becomes of it.

use super::closing::{Candidate, Plan, Problem, relations_of};
use super::forces::Owner;
use super::initial::{self, Given};
use super::limit;
use super::lower::Lowering;
use crate::description::{InitialDescription, Motion, PortRate, Position};
use crate::diagnostics::Diagnostic;
use crate::notice::Notices;
use crate::source::Located;
use hamel_runtime::joint::{LinkMotion, Tie};
use hamel_runtime::shown::Number;
use hamel_runtime::spatial::Pose;

/// Most that a position at time 0 may differ from that of the closed loop without being reported: digits that files leave out.
const TOLD: f64 = 1e-6;

/// The joint of a group that ties hold, whose links take their coordinates, and its state.
pub(super) fn made(
    lowering: &Lowering<'_>,
    owners: &mut [Owner<'_>],
    notices: &mut Notices,
) -> Result<(Plan, InitialDescription), Diagnostic> {
    let leaders: Vec<usize> = (0..owners.len())
        .filter(|&own| !owners[own].follows)
        .collect();
    let positions = owners
        .iter()
        .map(|owner| initial::position(owner.name, owner.movement, &owner.body.initial.position));
    let positions: Vec<Given> = positions.collect::<Result<_, _>>()?;
    let rates = owners
        .iter()
        .map(|owner| initial::rate(owner.body, owner.movement, &owner.body.initial));
    let rates: Vec<Given> = rates.collect::<Result<_, _>>()?;
    let problem = Problem {
        links: owners.iter().map(|owner| owner.link).collect(),
        candidates: candidates(lowering, owners),
        names: leaders.iter().map(|&own| owners[own].name).collect(),
        guess: guess(owners, &positions, leaders.len()),
        given: leaders
            .iter()
            .map(|&own| positions[own].is_some())
            .collect(),
        ranges: ranges(owners, &positions, leaders.len()),
        wanted: wanted(lowering, owners, &leaders)?,
        rated: leaders
            .iter()
            .filter(|&&own| rates[own].is_some())
            .map(|&own| owners[own].link.coordinate)
            .collect(),
    };
    let plan = problem.plan()?;
    tell(&problem, &plan, lowering, notices);
    for (owner, link) in owners.iter_mut().zip(&plan.links) {
        owner.link = *link;
    }
    let initial = state(owners, &plan, &rates);
    Ok((plan, initial))
}

/// Where the coordinates are, or are guessed to be: 0 where nothing is said.
fn guess(owners: &[Owner<'_>], positions: &[Given], coordinates: usize) -> Vec<f64> {
    let mut values = vec![0.0; coordinates];
    // What is followed comes last, and so has the last word.
    for follows in [true, false] {
        let own = owners.iter().zip(positions);
        for (owner, given) in own.filter(|(owner, _)| owner.follows == follows) {
            if let Some((value, _)) = given {
                values[owner.link.coordinate] = (value - owner.link.offset) / owner.link.ratio;
            }
        }
    }
    values
}

/// Where the limits of joints leave coordinates, except for those whose position the scene gives: there it has the last word.
fn ranges(owners: &[Owner<'_>], positions: &[Given], coordinates: usize) -> Vec<[f64; 2]> {
    let open = [f64::NEG_INFINITY, f64::INFINITY];
    let mut ranges = vec![open; coordinates];
    for owner in owners {
        if let Some(limit) = &owner.body.forces.limit {
            let own = limit::followed(&limit.value, owner);
            let [lower, upper] = &mut ranges[owner.link.coordinate];
            *lower = own.lower.map_or(*lower, |end| end.max(*lower));
            *upper = own.upper.map_or(*upper, |end| end.min(*upper));
        }
    }
    for (owner, _) in owners.iter().zip(positions).filter(|own| own.1.is_some()) {
        ranges[owner.link.coordinate] = open;
    }
    ranges
}

/// The coordinates that ties of the group want independent, or whose motion is prescribed.
fn wanted(
    lowering: &Lowering<'_>,
    owners: &[Owner<'_>],
    leaders: &[usize],
) -> Result<Vec<usize>, Diagnostic> {
    let mut wanted = Vec::new();
    for (place, _) in &lowering.group.ties {
        let Some(tie) = lowering.ties.get(*place) else {
            continue;
        };
        for name in tie.independent {
            let own = owners.iter().find(|owner| owner.name == name.value);
            match own {
                Some(owner) if !owner.follows => wanted.push(owner.link.coordinate),
                _ => {
                    let why = match own {
                        None => "is no joint of it",
                        Some(_) => "follows another joint",
                    };
                    let message = format!(
                        "{}: joint `{}` is to move independently, and {why}",
                        tie.called(),
                        name.value
                    );
                    return Err(Diagnostic::new(name.span.clone(), message));
                }
            }
        }
    }
    let driven = leaders.iter().map(|&own| &owners[own]);
    let driven = driven.filter(|owner| owner.body.forces.motion.is_some());
    wanted.extend(driven.map(|owner| owner.link.coordinate));
    wanted.sort_unstable();
    wanted.dedup();
    Ok(wanted)
}

/// The ties of the group, with the links that they hold.
fn candidates<'a>(lowering: &Lowering<'a>, owners: &[Owner<'_>]) -> Vec<Candidate<'a>> {
    let own = lowering.group.ties.iter();
    let own = own.filter_map(|(place, _)| Some((*place, *lowering.ties.get(*place)?)));
    own.map(|(place, named)| match lowering.scene.loops.get(place) {
        Some(closed) => Candidate {
            named,
            closing: Some(closed.closing),
            tie: Tie::Closure {
                links: closed
                    .ends
                    .map(|end| end.body.and_then(|body| lowering.number(body))),
                frames: closed.ends.map(|end| {
                    let body = end.body.filter(|&body| lowering.number(body).is_some());
                    let own = body.map(|body| lowering.scene.bodies[body].body_at);
                    own.unwrap_or_else(Pose::identity) * end.at
                }),
                relations: relations_of(closed.closing),
                implied: Vec::new(),
            },
        },
        None => Candidate {
            named,
            closing: None,
            tie: sum(
                lowering,
                owners,
                named.ends,
                named.law.unwrap_or((1.0, 0.0)),
            ),
        },
    })
    .collect()
}

/// `Σ y − ratio Σ y = offset`, over the ways to the successor and to the predecessor.
fn sum(
    lowering: &Lowering<'_>,
    owners: &[Owner<'_>],
    ends: [Option<usize>; 2],
    (ratio, constant): (f64, f64),
) -> Tie {
    let way = |end: Option<usize>| {
        let first = end.and_then(|end| lowering.number(end));
        let before = |link: &usize| owners[*link].link.before;
        std::iter::successors(first, before).collect::<Vec<usize>>()
    };
    let [first, second] = ends.map(way);
    let apart = |own: &[usize], other: &[usize], weight: f64| {
        let own = own.iter().filter(|link| !other.contains(link));
        own.map(|&link| (link, weight)).collect::<Vec<_>>()
    };
    let terms = [apart(&second, &first, 1.0), apart(&first, &second, -ratio)];
    Tie::Sum {
        terms: terms.concat(),
        constant,
    }
}

/// The state at time 0.
fn state(owners: &[Owner<'_>], plan: &Plan, rates: &[Given]) -> InitialDescription {
    let span = owners
        .first()
        .map_or(0..0, |owner| owner.body.joint.span.clone());
    let given = owners.iter().zip(rates);
    let given = given.filter_map(|(owner, rate)| Some((owner, rate.as_ref()?.0)));
    let given: Vec<(&Owner<'_>, f64)> = given.collect();
    let leads = |owner: &Owner<'_>| !owner.follows && owner.link.coordinate < plan.independent;
    let motion = match given.iter().all(|(owner, _)| leads(owner)) {
        true if given.iter().all(|(_, rate)| *rate == 0.0) => Motion::Rest,
        true => {
            let mut speeds = vec![0.0; plan.independent];
            given
                .iter()
                .for_each(|(owner, rate)| speeds[owner.link.coordinate] = *rate);
            Motion::Speeds(Located::new(speeds, span.clone()))
        }
        // The rates of others say what those of the independent ones are.
        false => {
            let rates = given.iter().map(|(owner, rate)| PortRate {
                name: owner.body.joint.name.clone(),
                rate: *rate,
            });
            Motion::Rates(Located::new(rates.collect(), span.clone()))
        }
    };
    InitialDescription {
        position: Position::Configuration(Located::new(plan.start.clone(), span)),
        motion,
    }
}

/// Tells what has been chosen where the scene leaves it open.
fn tell(problem: &Problem<'_>, plan: &Plan, lowering: &Lowering<'_>, notices: &mut Notices) {
    let names = lowering
        .group
        .ties
        .iter()
        .map(|(_, name)| format!("`{name}`"));
    let names: Vec<String> = names.collect();
    let what = match lowering.ties.get(lowering.group.ties[0].0) {
        Some(tie) if tie.law.is_some() => "coupling",
        _ => "loop",
    };
    let owner = format!("{what} {}", names.join(", "));
    if problem.wanted.len() < plan.independent {
        let free = plan.order.iter().take(plan.independent);
        let free: Vec<String> = free.map(|&k| format!("`{}`", problem.names[k])).collect();
        let message = format!(
            "the file does not say which joints move independently: {}",
            free.join(", ")
        );
        notices.add(message, owner.clone());
    }
    let (way, which) = plan.moved;
    if way > TOLD {
        let mut links = problem.links.iter();
        let slides = links.any(|link| link.coordinate == which && link.motion == LinkMotion::Slide);
        let unit = if slides { "m" } else { "rad" };
        let message = format!(
            "positions at time 0 are changed by up to {:?} {unit}, that of joint `{}`, so that it closes{}",
            Number(way),
            problem.names[which],
            posture(problem, plan)
        );
        notices.add(message, owner.clone());
    }
    for (place, &k) in plan.order.iter().enumerate() {
        let [lower, upper] = problem.ranges[k];
        let value = plan.start[place];
        if value < lower || value > upper {
            let message = format!(
                "joint `{}` begins at {:?}, beyond its limits: no posture was found within those of all joints",
                problem.names[k],
                Number(value)
            );
            notices.add(message, owner.clone());
        }
    }
}

/// Where its joints are, if the file says nothing of that.
fn posture(problem: &Problem<'_>, plan: &Plan) -> String {
    if problem.given.iter().any(|given| *given) {
        return String::new();
    }
    let found = plan.order.iter().zip(&plan.start);
    let found = found.map(|(&k, value)| format!("`{}` at {:?}", problem.names[k], Number(*value)));
    let found: Vec<String> = found.collect();
    format!(": {}", found.join(", "))
}
