//! Loops as relations of a joint: where they close, which relations are independent, and which coordinates follow from the others.
//!
//! A loop that is closed by a joint whose motions are a group F holds the pose A of its second frame in the first in F. Along its tree joints A moves in the group G that their
//! axes generate, as they stand at one configuration: turns about parallel axes never leave the plane. So dim(𝔤 + 𝔣) − dim 𝔣 relations are independent wherever that many are at the start, and
//! the others follow from them. Fewer at the start mean that it is singular, or that dimensions alone let the loop move, as Bennett's do: these are refused.

mod newton;
mod order;
mod relations;
mod search;
mod span;

use super::tie::Tie as Named;
use crate::description::Closing;
use crate::diagnostics::Diagnostic;
use crate::suggest::all_of;
use hamel_runtime::joint::{Link, LinkMotion, Relation, Tie, linkage_length};
use hamel_runtime::shown::Number;
use nalgebra::Vector6;
use newton::Loops;
use search::Search;
use span::{Unclear, algebra, basis, independent};

/// A tie with how it is closed; couplings of sums are not closed by anything.
pub(super) struct Candidate<'a> {
    pub(super) named: Named<'a>,
    pub(super) closing: Option<Closing>,
    pub(super) tie: Tie,
}

/// What is to be made one joint. The links follow as many coordinates as there are `names`.
pub(super) struct Problem<'a> {
    pub(super) links: Vec<Link>,
    pub(super) candidates: Vec<Candidate<'a>>,
    /// The joints whose position each coordinate is.
    pub(super) names: Vec<&'a str>,
    pub(super) guess: Vec<f64>,
    /// Whether the scene says where it is.
    pub(super) given: Vec<bool>,
    /// Where coordinates of which it does not say that are to be: from the least to the greatest value that limits leave.
    pub(super) ranges: Vec<[f64; 2]>,
    /// Coordinates that the scene wants independent.
    pub(super) wanted: Vec<usize>,
    /// Coordinates whose rate it gives.
    pub(super) rated: Vec<usize>,
}

/// The joint, its independent coordinates first.
pub(super) struct Plan {
    pub(super) links: Vec<Link>,
    pub(super) ties: Vec<Tie>,
    pub(super) start: Vec<f64>,
    /// The coordinates of the problem in the order of the joint's.
    pub(super) order: Vec<usize>,
    /// How many are independent.
    pub(super) independent: usize,
    /// The most that a coordinate differs from its guess, rad or m, and which one.
    pub(super) moved: (f64, usize),
}

/// All of a tie's relations, by how it is closed.
pub(super) fn relations_of(closing: Closing) -> Vec<Relation> {
    relations::all(closing)
}

impl Problem<'_> {
    /// The joint that the links make.
    pub(super) fn plan(&self) -> Result<Plan, Diagnostic> {
        let ties: Vec<Tie> = self.candidates.iter().map(|own| own.tie.clone()).collect();
        let loops = Loops {
            links: &self.links,
            ties: &ties,
            coordinates: self.names.len(),
            length: linkage_length(&self.links, &ties),
        };
        let start = self.closed(&loops)?;
        let rows = loops.rows(&start);
        let mut chosen = Vec::new();
        for (candidate, rows) in self.candidates.iter().zip(&rows) {
            self.refuse_turned(candidate, &start)?;
            chosen.push(self.chosen(candidate, rows, (&start, loops.length))?);
        }
        let selected = rows.iter().zip(&chosen);
        let selected = selected.flat_map(|(rows, own)| own.iter().map(|&row| rows[row].1.clone()));
        let selected: Vec<Vec<f64>> = selected.collect();
        self.refuse_dependent(&selected)?;
        let order = self.ordered(&selected)?;
        let ties = self.candidates.iter().zip(&chosen);
        let ties = ties.map(|(candidate, own)| kept(&candidate.tie, own));
        let place = |coordinate: usize| order.iter().position(|own| *own == coordinate);
        let links = self.links.iter().map(|link| Link {
            coordinate: place(link.coordinate).unwrap_or(0),
            ..*link
        });
        let away = |k: usize| (start[k] - self.guess[k]).abs();
        let farthest = (0..start.len()).max_by(|&a, &b| away(a).total_cmp(&away(b)));
        let farthest = farthest.unwrap_or(0);
        Ok(Plan {
            links: links.collect(),
            ties: ties.collect(),
            start: order.iter().map(|&k| start[k]).collect(),
            independent: order.len() - selected.len(),
            moved: (away(farthest), farthest),
            order,
        })
    }

    /// A configuration on all ties: with what is given and what is wanted independent held; failing that with the latter alone; failing that with all moving.
    fn closed(&self, loops: &Loops<'_>) -> Result<Vec<f64>, Diagnostic> {
        let wanted = |k: usize| self.wanted.contains(&k);
        let held: [&dyn Fn(usize) -> bool; 3] =
            [&|k| self.given[k] || wanted(k), &wanted, &|_| false];
        // Where the file says nothing of positions, any posture will do.
        let anywhere = !self.given.iter().any(|given| *given);
        let is_sound = |q: &[f64]| {
            let mut candidates = self.candidates.iter();
            candidates.all(|own| self.refuse_turned(own, q).is_ok())
        };
        let mut nearest = self.guess.clone();
        for held in held {
            let free: Vec<bool> = (0..self.names.len()).map(|k| !held(k)).collect();
            let search = Search {
                loops,
                guess: &self.guess,
                free: &free,
                ranges: &self.ranges,
                is_sound: &is_sound,
            };
            match search.posture(anywhere) {
                Ok(found) => return Ok(found),
                Err(found) => nearest = found,
            }
        }
        let others = match self.given.iter().any(|given| *given) {
            true => String::new(),
            false => format!(", nor from {} other postures", search::GUESSES),
        };
        let candidate = self.candidates.iter().max_by(|a, b| {
            let [a, b] = [a, b].map(|own| self.gap(own, &nearest).iter().sum::<f64>());
            a.total_cmp(&b)
        });
        // There is one.
        let Some(candidate) = candidate else {
            return Ok(nearest);
        };
        let [there, best] =
            [&self.guess, &nearest].map(|q| apart(candidate, self.gap(candidate, q)));
        let best = match loops.is_stuck(&self.guess) {
            true => String::from("no small motion brings them nearer"),
            false => format!("{best} where they come nearest"),
        };
        let why = format!(
            "it does not close near the start{others}: its ends are {there} off there, and {best}"
        );
        let error = candidate.named.refuse(&why);
        Err(error.help(
            "give positions at time 0 near which it closes (`initial` of its bodies in a scene; `hamel import` makes a scene of a robot in URDF), and check the frames of its ends",
        ))
    }

    /// How far a tie is from holding: the lengths and the numbers among its relations.
    fn gap(&self, candidate: &Candidate<'_>, q: &[f64]) -> [f64; 2] {
        let mut values = Vec::new();
        candidate
            .tie
            .relations(&self.links, q, |(value, _)| values.push(value));
        let is_length = |row: usize| match &candidate.tie {
            Tie::Closure { relations, .. } => matches!(relations[row], Relation::Meets(_)),
            Tie::Sum { .. } => false,
        };
        let mut squares = [0.0_f64; 2];
        for (row, value) in values.into_iter().enumerate() {
            squares[usize::from(!is_length(row))] += value * value;
        }
        squares.map(f64::sqrt)
    }

    /// Axes that may only point one way.
    fn refuse_turned(&self, candidate: &Candidate<'_>, q: &[f64]) -> Result<(), Diagnostic> {
        let (Some(closing), Tie::Closure { links, frames, .. }) =
            (candidate.closing, &candidate.tie)
        else {
            return Ok(());
        };
        let [first, second] =
            [0, 1].map(|end| Link::stands(&self.links, q, links[end]) * frames[end]);
        let between = first.inverse() * second;
        let mut axes = relations::directed(closing).iter();
        match axes.find(|&&axis| between.rotation[(axis, axis)] < 0.0) {
            None => Ok(()),
            Some(&axis) => {
                let axis = ["x", "y", "z"][axis];
                let why =
                    format!("at the start the {axis} axes of its ends point against each other");
                Err(candidate.named.refuse(&why))
            }
        }
    }

    /// The rows of a tie that must hold, from which the others follow.
    fn chosen(
        &self,
        candidate: &Candidate<'_>,
        rows: &[(f64, Vec<f64>)],
        (start, length): (&[f64], f64),
    ) -> Result<Vec<usize>, Diagnostic> {
        let unclear = |Unclear(left): Unclear| {
            let why = format!(
                "at the start its axes are nearly parallel, or nearly meet: what they are off by, {:?}, is neither rounding nor clear",
                Number(left)
            );
            let error = candidate.named.refuse(&why);
            error.help("give angles and positions in full digits: π/2 is 1.5707963267948966")
        };
        let expected = self.expected(candidate, (start, length)).map_err(unclear)?;
        if expected == 0 {
            let why = "it asks for nothing: whatever its joints do, its ends stay together";
            return Err(candidate.named.refuse(why));
        }
        let slopes: Vec<Vec<f64>> = rows.iter().map(|(_, slopes)| slopes.clone()).collect();
        let nearly = |Unclear(left): Unclear| {
            let why = format!(
                "at the start it is nearly in a singular position, as a linkage that is stretched or folded: the last of its {} differs from what the others say by {:?}, which is neither rounding nor clear",
                relations(expected),
                Number(left)
            );
            let error = candidate.named.refuse(&why);
            error.help("give other positions at time 0 (`initial` of its bodies in a scene), or full digits where it is to be at that position")
        };
        let mut found = independent(&slopes).map_err(nearly)?;
        let moving = (0..self.names.len()).filter(|&k| slopes.iter().any(|row| row[k] != 0.0));
        let moving = moving.count();
        if found.len() < expected && found.len() == moving {
            let joints = if moving == 1 { "joint" } else { "joints" };
            let why = format!(
                "it cannot move: {moving} {joints} obey {} independent {}",
                found.len(),
                relations_word(found.len())
            );
            return Err(candidate.named.refuse(&why));
        }
        if found.len() < expected {
            let (found, what) = (found.len(), relations_word(expected));
            let why = format!(
                "at the start {found} of its {expected} {what} are independent: it is in a singular position, or its dimensions alone let it move, as those of Bennett's linkage do"
            );
            let error = candidate.named.refuse(&why);
            return Err(error.help("give other positions at time 0 (`initial` of its bodies in a scene); linkages that dimensions alone let move are not read"));
        }
        found.sort_unstable();
        Ok(found)
    }

    /// How many relations of a tie are independent, by the groups of motions.
    fn expected(
        &self,
        candidate: &Candidate<'_>,
        (q, length): (&[f64], f64),
    ) -> Result<usize, Unclear> {
        let Tie::Closure {
            links,
            frames,
            relations,
            ..
        } = &candidate.tie
        else {
            return Ok(1);
        };
        let Some(allowed) = candidate.closing.and_then(relations::motions) else {
            return Ok(relations.len());
        };
        let first = Link::stands(&self.links, q, links[0]) * frames[0];
        let back = first.inverse();
        let mut twists = Vec::new();
        for link in self.between(*links) {
            let own = &self.links[link];
            let mut axis = Vector6::zeros();
            axis[if own.motion == LinkMotion::Turn { 2 } else { 5 }] = 1.0;
            let placed = back * Link::stands(&self.links, q, Some(link));
            twists.push(as_numbers(&placed.act_twist(&axis), length));
        }
        let allowed = allowed.iter().map(|twist| as_numbers(twist, length));
        let allowed: Vec<Vector6<f64>> = allowed.collect();
        let moved = algebra(&twists)?;
        let both = basis(&[moved, allowed.clone()].concat())?;
        Ok(both.len() - allowed.len())
    }

    /// The links on the ways to both ends, from the last that carries both.
    fn between(&self, ends: [Option<usize>; 2]) -> Vec<usize> {
        let [first, second] = ends.map(|end| {
            let before = |link: &usize| self.links[*link].before;
            std::iter::successors(end, before).collect::<Vec<usize>>()
        });
        let apart = |own: &[usize], other: &[usize]| {
            let own = own.iter().filter(|link| !other.contains(link));
            own.copied().collect::<Vec<usize>>()
        };
        [apart(&first, &second), apart(&second, &first)].concat()
    }

    fn refuse_dependent(&self, selected: &[Vec<f64>]) -> Result<(), Diagnostic> {
        let rank = independent(selected);
        if rank
            .as_ref()
            .is_ok_and(|found| found.len() == selected.len())
        {
            return Ok(());
        }
        let names = self
            .candidates
            .iter()
            .map(|own| own.named.name.value.as_str());
        let why = format!(
            "with {} it asks for {} relations, and {} are independent at the start",
            all_of(names.skip(1)),
            selected.len(),
            rank.map_or_else(
                |_| String::from("nearly fewer"),
                |found| found.len().to_string()
            )
        );
        let first = self.candidates.first().map(|own| own.named.refuse(&why));
        let error = first.unwrap_or_else(|| Diagnostic::without_place(why));
        Err(error.help("loops that close each other twice over, or a singular position: leave one out, or give other positions at time 0"))
    }
}

/// A tie with its relations parted.
fn kept(tie: &Tie, chosen: &[usize]) -> Tie {
    match tie {
        Tie::Closure {
            links,
            frames,
            relations,
            ..
        } => {
            let part = |takes: bool| {
                let own = relations.iter().enumerate();
                let own = own.filter(|(row, _)| chosen.contains(row) == takes);
                own.map(|(_, relation)| *relation).collect()
            };
            Tie::Closure {
                links: *links,
                frames: *frames,
                relations: part(true),
                implied: part(false),
            }
        }
        sum => sum.clone(),
    }
}

fn relations_word(count: usize) -> &'static str {
    match count {
        1 => "relation",
        _ => "relations",
    }
}

/// Their number in words.
fn relations(count: usize) -> String {
    format!("{count} {}", relations_word(count))
}

/// A twist with lengths as parts of that of the linkage: an automorphism of the algebra.
fn as_numbers(twist: &Vector6<f64>, length: f64) -> Vector6<f64> {
    Vector6::from_fn(|i, _| if i < 3 { twist[i] } else { twist[i] / length })
}

fn apart(candidate: &Candidate<'_>, [lengths, numbers]: [f64; 2]) -> String {
    match candidate.closing {
        None => format!("{:?}", Number(numbers)),
        Some(Closing::Spherical) => format!("{:?} m", Number(lengths)),
        Some(_) => format!("{:?} m and {:?} rad", Number(lengths), Number(numbers)),
    }
}
