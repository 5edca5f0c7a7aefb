//! The claims of a spec, proved: H, Φ to second order, X, X^c, S to first order, S₀⁻¹, A and S̄ are substituted back into what defines them.
//!
//! The kernels that follow from these by products and derivatives (∂S̄/∂ϕ, γ, J22, c and its slopes, the finite maps, N_X) are not
//! proved again: the law suite measures them on compiled joints.
//!
//! Identities hold when their difference has normal form 0 modulo the manifold's relations and the laws of the functions in it. Where
//! algebra does not decide, a search looks for a place where an identity fails. If it finds none the spec is refused all the same, as
//! undecided, unless it says `unproved` for that claim. Ranks, signs and invertibility need a certificate that holds at every
//! configuration.

mod advice;
mod assembled;
mod claim;
mod defined;
mod degenerate;
mod fibres;
mod named;
mod nonholonomic;
mod pins;
mod ports;
mod retract;
mod search;
mod twist;

pub use claim::{Claim, Proof};

pub use defined::retract_is_smooth;

use crate::diagnostic::Diagnostic;
use crate::domain::{Domain, LAST_PRECISION};
use crate::expand::Expansion;
use crate::expr::{Expr, budget};
use crate::kernel::Word;
use crate::manifold::Ideal;
use crate::matrix::Matrix;
use crate::model::{Declared, JointSpec, Unproved};
use crate::prepare::Prepared;
use crate::spec::code;
use search::{Points, Verdict};
use std::ops::{Deref, Range};

/// The claims about what is declared, which need no derivation; an error of these makes errors of all others.
pub fn prove_declared(joint: &Prepared) -> Result<Vec<Claim>, Vec<Diagnostic>> {
    let declared = Identities::new(joint);
    declared.settled([declared.pose_is_rigid(), declared.retract_starts_at_q()])
}

/// All other claims. What rests on a claim that fails is not looked at: the first cause is told, and what does not hang on it.
pub fn prove(joint: &Prepared, expansion: &Expansion) -> Result<Vec<Claim>, Vec<Diagnostic>> {
    let prover = Prover {
        identities: Identities {
            words: expansion.named(),
            ..Identities::new(joint)
        },
        x: expansion,
    };
    let mut claims = prover.settled([prover.declared_is_defined(), prover.has_dimension()])?;
    claims.extend(prover.settled([
        prover.names_solve_systems(),
        prover.retract_stays_on_manifold(),
        prover.declared_retract(),
    ])?);
    claims.extend(prover.settled([prover.declared_twist_map(), prover.twists_agree()])?);
    claims.extend(prover.settled([
        prover.velocity_map_is_invertible(),
        prover.twist_map_has_full_rank(),
        prover.constraint_is_met(),
        prover.speed_basis_has_full_rank(),
        prover.constraint_has_full_rank(),
    ])?);
    claims.extend(prover.settled([
        prover.is_defined(),
        prover.slopes_agree(),
        prover.rates_agree(),
        prover.velocity_map_is_inverted(),
        prover.child_twist_map_agrees(),
        prover.port_angles(),
        prover.port_rates(),
        prover.pins_meet(),
        prover.pins_hold(),
    ])?);
    claims.sort_by_key(|claim| place(claim.name));
    claims.extend(fibres::claim(
        joint,
        &prover.domain,
        &expansion.still.scalars,
    ));
    Ok(claims)
}

/// The order in which pages list claims: from what is declared to what is derived.
fn place(name: &str) -> usize {
    let order = [
        "defined",
        "manifold_dimension",
        "retract_by_relations",
        "manifold_orbit",
        "tangent_basis_solves",
        "retract_on_manifold",
        "retract_is_exponential",
        "retract_local_diffeomorphism",
        "twist_map_in_frame",
        "twist_map_matches_pose",
        "velocity_map_first_order",
        "velocity_map_of_motion",
        "velocity_map_invertible",
        "velocity_map_inverse",
        "twist_map_child",
        "twist_map_rank",
        "speeds_meet_constraint",
        "speed_basis_rank",
        "constraint_rank",
        "port_angles",
        "port_rates",
        "pins_meet",
        "pins_hold",
    ];
    let found = order.iter().position(|other| *other == name);
    found.unwrap_or(order.len())
}

/// An error for each claim that is said to be unproved and is proved.
pub fn needlessly_unproved(spec: &JointSpec, claims: &[Claim]) -> Vec<Diagnostic> {
    let needless = |unproved: &&Declared<Unproved>| {
        let checked =
            |claim: &Claim| claim.name == unproved.value.claim && claim.proof == Proof::Checked;
        !claims.iter().any(checked)
    };
    let error = |unproved: &Declared<Unproved>| {
        let name = &unproved.value.claim;
        let proved = claims.iter().any(|claim| claim.name == name);
        let (message, label) = match proved {
            true => (format!("the claim `{name}` is proved"), "not unproved"),
            false => (
                format!("this joint makes no claim `{name}`"),
                "nothing to prove",
            ),
        };
        Diagnostic::new(code::UNPROVED, unproved.span.clone(), message)
            .label(label)
            .help("remove this statement")
    };
    spec.unproved.iter().filter(needless).map(error).collect()
}

/// Longest function that a statement shows in full, in bytes.
const LONGEST: usize = 200;

/// Most undecided constants that one error names.
const MOST_UNDECIDED: usize = 3;

type Attempt = Result<Option<Claim>, Box<Diagnostic>>;

/// What identities are decided with.
struct Identities<'a> {
    joint: &'a Prepared,
    /// Whether Φ is Q exp(ϕ).
    exponential: bool,
    ideal: &'a Ideal,
    domain: Domain<'a>,
    points: Points,
    /// Names in what is proved.
    words: &'a [Word],
}

/// The same with what was derived.
struct Prover<'a> {
    identities: Identities<'a>,
    x: &'a Expansion,
}

impl<'a> Deref for Prover<'a> {
    type Target = Identities<'a>;
    fn deref(&self) -> &Identities<'a> {
        &self.identities
    }
}

impl<'a> Identities<'a> {
    fn new(joint: &'a Prepared) -> Self {
        Self {
            joint,
            exponential: joint.exponential,
            ideal: joint.space.manifold.ideal(),
            domain: Domain::new(&joint.space),
            points: Points::default(),
            words: &[],
        }
    }

    /// The claims that hold, or the errors of those that do not.
    fn settled<const N: usize>(
        &self,
        attempts: [Attempt; N],
    ) -> Result<Vec<Claim>, Vec<Diagnostic>> {
        let (mut claims, mut errors) = (vec![], vec![]);
        for attempt in attempts {
            match attempt {
                Ok(claim) => claims.extend(claim),
                Err(error) => errors.push(self.with_undecided(*error)),
            }
        }
        match errors.is_empty() {
            true => Ok(claims),
            false => Err(errors),
        }
    }

    /// The error, with the constants of which no number of bits decided the sign.
    fn with_undecided(&self, error: Diagnostic) -> Diagnostic {
        let undecided = self.domain.undecided();
        undecided
            .iter()
            .take(MOST_UNDECIDED)
            .fold(error, |error, constant| {
                error.note(format!(
                    "undecided: in {LAST_PRECISION} bits {constant} is neither above nor below 0"
                ))
            })
    }

    /// The statement with the places where it is not claimed.
    fn where_it_holds(&self, statement: &str) -> String {
        let loci: Vec<String> = self
            .joint
            .spec
            .loci
            .iter()
            .map(|locus| match locus.value.function.to_string() {
                function if function.len() <= LONGEST => format!("{function} ≠ 0"),
                _ => format!("not {}", locus.value.text),
            })
            .collect();
        match loci.is_empty() {
            true => statement.to_owned(),
            false => format!("{statement} where {}", loci.join(" and ")),
        }
    }

    fn identity(
        &self,
        name: &'static str,
        statement: &str,
        difference: &Matrix,
        refuted: impl FnOnce(Matrix) -> Diagnostic,
    ) -> Attempt {
        budget::begin_claim(name);
        let mut difference = difference.clone();
        let mut residual = self.residual(&difference);
        if !residual.is_zero() && !self.words.is_empty() {
            // What does not hold for all values of the names may do so for their own.
            difference = difference.map(|entry| named::written_out(entry, self.words));
            residual = self.residual(&difference);
        }
        if residual.is_zero() {
            return Ok(Some(symbolic(
                name,
                statement,
                Proof::NormalForm,
                "the difference of both sides has normal form 0",
            )));
        }
        let open: Vec<(Expr, Expr)> = difference
            .entries()
            .iter()
            .zip(residual.entries())
            .filter(|(_, normal)| !normal.is_zero())
            .map(|(entry, normal)| (entry.clone(), normal.clone()))
            .collect();
        let said = self
            .joint
            .spec
            .unproved
            .iter()
            .find(|said| said.value.claim == name);
        let undecided = |refuted: Diagnostic, why: &str| {
            let message = format!("undecided: {statement}");
            Diagnostic::new(code::NOT_PROVED, refuted.span, message)
                .label(format!("the claim `{name}` is neither proved nor refuted"))
                .note(why.to_owned())
        };
        match (search::search(self, &open), said) {
            (Verdict::Refuted(place), _) => {
                Err(Box::new(refuted(residual).note(place.to_string())))
            }
            (Verdict::Agrees { points }, Some(said)) => Ok(Some(Claim {
                points,
                ..symbolic(name, statement, Proof::Checked, &said.value.reason)
            })),
            (Verdict::Agrees { points }, None) => {
                let why = format!("it holds at {points} points, which proves nothing");
                let help = format!(
                    "write it by functions of which the algebra knows the relations; or accept that it is checked, not proved: \
                     `unproved {name} because \"…\";`"
                );
                Err(Box::new(undecided(refuted(residual), &why).help(help)))
            }
            (Verdict::Undecided(why), _) => Err(Box::new(undecided(refuted(residual), &why))),
        }
    }

    fn residual(&self, difference: &Matrix) -> Matrix {
        difference.map(|entry| match self.ideal.vanishes(entry) {
            true => Expr::zero(),
            false => self.ideal.normal_form(entry),
        })
    }

    fn pose_is_rigid(&self) -> Attempt {
        let spec = &self.joint.spec;
        let conditions = spec.poses().flat_map(|pose| {
            let r = &pose.value.rotation;
            let gram = r.transpose().times(r).minus(&Matrix::identity(3));
            let volume = &r.determinant(&Expr::clone) - &Expr::one();
            [gram.entries(), &[volume]].concat()
        });
        let residual = Matrix::column_vector(conditions.collect());
        let statement = match spec.more.is_empty() {
            true => "H(Q) ∈ SE(3)",
            false => "H(Q) ∈ SE(3), of each body",
        };
        self.identity("pose_in_se3", statement, &residual, |residual| {
            let bodies = spec.poses().zip(residual.entries().chunks(RIGID));
            let is_wrong = |entries: &&[Expr]| !entries.iter().all(Expr::is_zero);
            let found = bodies.into_iter().find(|(_, entries)| is_wrong(entries));
            let (pose, entries) = found.unwrap_or((&spec.pose, residual.entries()));
            let gram = Matrix::from_fn(3, 3, |i, j| entries[3 * i + j].clone());
            refuted(
                code::NOT_RIGID,
                &pose.span,
                "H is not a rigid motion",
                "its rotation part is no rotation",
            )
            .note(format!("RᵀR − I =\n{gram}\ndet R − 1 = {}", entries[9]))
            .help(match gram.is_zero() {
                true => "the axes of this frame are left-handed: change the sign of one column",
                false => "the columns of a rotation are perpendicular and of length 1: products of `rot_x`, `rot_y` and `rot_z` are rotations",
            })
        })
    }
}

/// How many conditions make H a rigid motion: those of `RᵀR = I` and `det R = 1`.
const RIGID: usize = 10;

fn refuted(code: &'static str, span: &Range<usize>, message: &str, label: &str) -> Diagnostic {
    Diagnostic::new(code, span.clone(), message).label(label)
}

/// What to do about parameters for which there is no joint.
const LEAVE_OUT: &str = "leave those parameters out by their ranges or by `require`";

/// Whether a function has a value of parameters alone, at whatever configuration.
fn is_of_parameters(function: &Expr) -> bool {
    function.is_constant() && !function.symbols().is_empty()
}

fn symbolic(name: &'static str, statement: &str, proof: Proof, detail: &str) -> Claim {
    Claim {
        name,
        statement: statement.into(),
        proof,
        detail: detail.into(),
        points: 0,
    }
}

fn certified(name: &'static str, statement: &str, detail: &str) -> Claim {
    symbolic(name, statement, Proof::Certificate, detail)
}
