//! The whole pipeline: text in, proven kernels out.

use crate::derived::{Claim, Derived, programs};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::expand::task;
use crate::expand::{self, Expansion};
use crate::expr::budget::{self, Exhausted};
use crate::expr::curve::Curve;
use crate::expr::{Expr, Rational};
use crate::kernel::{Kernel, KernelKind};
use crate::manifold::Ideal;
use crate::matrix::Matrix;
use crate::model::{ConfigurationSpace, Declared, JointSpec, Locus};
use crate::prepare::Prepared;
use crate::simplify::{View, Written};
use crate::{prove, spec};
use num_bigint::BigInt;
use std::path::Path;

/// Bound on symbolic work for one joint without relations, in term operations: less than a second, also on a machine that is busy. The largest joint of
/// the library spends less than two thirds (`cargo run -p hamel-codegen --example phases -- joint-specs`).
pub const WORK_LIMIT: u64 = 2_000_000;

/// What each relation adds to it: their second derivatives are by pairs of degrees of freedom. A platform on six legs spends 8.7 million.
const WORK_OF_RELATION: u64 = 1_500_000;

/// Term operations that take as long as writing one term of a kernel.
const WORK_OF_WRITTEN_TERM: u64 = 100;

/// Parses, expands and proves one spec. `file` is the name by which errors call it; where it ends in `.joint`, its stem is
/// the name of the joint.
///
/// # Errors
/// All errors of the text at once; if there are none, those of the derivation and its proofs.
pub fn derive(source: &str, file: &str) -> Result<Derived, Diagnostics> {
    derive_in(source, file, None)
}

/// The same of a spec in a folder, in which files with knots of curves are looked for.
///
/// # Errors
/// As [`derive()`], and files that cannot be read.
pub fn derive_in(source: &str, file: &str, folder: Option<&Path>) -> Result<Derived, Diagnostics> {
    let spec = spec::parse_in(source, file, folder)?;
    let failed = |mut errors: Vec<Diagnostic>| {
        errors.sort_by_key(|error| error.span.start);
        Diagnostics {
            file: file.to_owned(),
            source: source.to_owned(),
            errors,
        }
    };
    let relations = spec.manifold.value.declared().len() as u64;
    let limit = WORK_LIMIT + WORK_OF_RELATION * relations;
    match budget::scope(limit, || derive_spec(spec.clone())) {
        Ok(Ok(derived)) => match misnamed(&derived.spec, file) {
            None => Ok(derived),
            Some(error) => Err(failed(vec![error])),
        },
        Ok(Err(errors)) => Err(failed(errors)),
        Err(exhausted) => Err(failed(vec![too_much_work(&spec, exhausted)])),
    }
}

/// The error that the file is called otherwise than its joint: a scene finds a joint, and a reader its spec, by that name.
fn misnamed(spec: &JointSpec, file: &str) -> Option<Diagnostic> {
    let path = Path::new(file);
    let stem = path.file_stem()?.to_str()?;
    let name = spec.name.value.as_str();
    let is_spec = path
        .extension()
        .is_some_and(|extension| extension == "joint");
    (is_spec && stem != name).then(|| {
        let message = format!("joint `{name}` in a file that is called `{stem}.joint`");
        Diagnostic::new(spec::code::FILE_NAME, spec.name.span.clone(), message)
            .label("the file is not named after it")
            .help(format!(
                "name the file `{name}.joint`, or the joint `{stem}`"
            ))
    })
}

fn derive_spec(spec: JointSpec) -> Result<Derived, Vec<Diagnostic>> {
    budget::begin(task::PROOF);
    let joint = Prepared::new(spec)?;
    let mut claims = prove::prove_declared(&joint)?;
    prove::retract_is_smooth(&joint).map_err(|error| vec![*error])?;
    let expansion = expand::expand(&joint)?;
    budget::begin(task::PROOF);
    claims.extend(prove::prove(&joint, &expansion)?);
    let needless = prove::needlessly_unproved(&joint.spec, &claims);
    if !needless.is_empty() {
        return Err(needless);
    }
    let loci = loci(&joint);
    budget::begin(task::KERNELS);
    let written = kernels(&joint, &expansion, &loci)?;
    let speed_map = expand::speed_map(&joint, &expansion);
    let is_still = |j: &usize| speed_map.column(*j).iter().all(Expr::is_zero);
    let known = Known {
        still_speeds: (0..speed_map.columns()).filter(is_still).collect(),
        space: ConfigurationSpace {
            loci,
            ..joint.space.clone()
        },
        joint,
        expansion,
        claims,
    };
    let (first, others) = written;
    let others = others.into_iter().zip(1..);
    Ok(Derived {
        more: others
            .map(|(written, body)| known.of_body(body, written))
            .collect(),
        ..known.of_body(0, first)
    })
}

/// The kernels of each body, as they are written: of the first and of all others.
fn kernels(
    joint: &Prepared,
    expansion: &Expansion,
    loci: &[Declared<Locus>],
) -> Result<(Written, Vec<Written>), Vec<Diagnostic>> {
    let view = |body| View::of_body(joint, expansion, body);
    let mut first = view(0);
    first
        .kernels
        .extend(expand::kernels(joint, expansion, loci)?);
    first.kernels.sort_by_key(|kernel| kernel.kind);
    let others: Vec<View> = (1..=joint.spec.more.len()).map(view).collect();
    let (first, others) = crate::simplify::in_words(joint, &first, &others);
    let all = || std::iter::once(&first).chain(&others);
    if let Some(number) = all().find_map(|(kernels, _)| expand::beyond_doubles(kernels)) {
        return Err(vec![beyond_doubles(&joint.spec, &number)]);
    }
    if let Some(rough) = all().find_map(|(kernels, _)| expand::rough_curve(kernels)) {
        return Err(vec![rough_curve(&joint.spec, rough)]);
    }
    budget::begin(task::FORMULAS);
    first.0.iter().for_each(spend_on_formulas);
    let of_others = others.iter().flat_map(|(kernels, _)| kernels);
    let of_others = of_others.filter(|kernel| kernel.kind.is_of_body());
    of_others.for_each(spend_on_formulas);
    Ok((first, others))
}

/// What is known of a joint once it is proved.
struct Known {
    joint: Prepared,
    space: ConfigurationSpace,
    expansion: Expansion,
    claims: Vec<Claim>,
    still_speeds: Vec<usize>,
}

impl Known {
    /// The joint as one of its bodies sees it.
    fn of_body(&self, body: usize, (kernels, words): Written) -> Derived {
        let (joint, expansion) = (self.joint.carrying(body), self.expansion.carrying(body));
        let ideal = joint.space.manifold.ideal();
        let written = |kind: KernelKind| body == 0 || kind.is_of_body();
        Derived {
            body,
            more: vec![],
            shape: expansion.shape,
            cut_out: expand::dimension::cut_out(&joint),
            speed_names: expand::speed_names(&joint.spec),
            tangent: expansion.motion.tangent(),
            local_twist_map: ideal.simplest_entries(&expansion.jacobian.child),
            speed_map: expand::speed_map(&joint, &expansion),
            velocity_map_series: series(ideal, &expansion),
            unidentifiable: expand::unidentifiable(&expansion, ideal),
            programs: programs(&joint.spec, &expansion.arguments, &words, &kernels, written),
            named: expansion.named().to_vec(),
            arguments: expansion.arguments,
            still: expansion.still.freedoms,
            pin_drives: expansion.pin_drives,
            still_speeds: self.still_speeds.clone(),
            kernels,
            words,
            claims: self.claims.clone(),
            spec: joint.spec,
            space: self.space.clone(),
        }
    }
}

/// The exceptions. Where functions have a value on one component of the manifold alone and nothing is excepted, its border is one: the
/// runtime then refuses the other components.
fn loci(joint: &Prepared) -> Vec<Declared<Locus>> {
    let locus = |function: Expr| Declared {
        span: joint.spec.pose.span.clone(),
        value: Locus {
            text: format!("{function} = 0"),
            docs: "A root, logarithm or angle has a value on the side of home alone.".into(),
            function,
        },
    };
    match joint.space.loci.is_empty() {
        true => joint.sides().into_iter().map(locus).collect(),
        false => joint.space.loci.clone(),
    }
}

/// S to first order as a product: S₀ and I + Σ S₀⁻¹ S_k ϕ_k.
fn series(ideal: &Ideal, expansion: &Expansion) -> (Matrix, Matrix) {
    let s = &expansion.velocity_map;
    let start = Matrix::identity(s.base.rows());
    let right =
        s.slopes
            .iter()
            .zip(&expansion.arguments.local)
            .fold(start, |sum, (slope, local)| {
                let factored = expansion.velocity_map_inverse.times(slope);
                sum.plus(&ideal.normal_forms(&factored).scale(&Expr::symbol(local)))
            });
    (s.base.clone(), right)
}

/// The error that a kernel has a number beyond the range of doubles.
fn beyond_doubles(spec: &JointSpec, number: &Rational) -> Diagnostic {
    let bits = |n: &BigInt| n.bits().cast_signed();
    let size = bits(&number.numer()) - bits(&number.denom());
    let message = format!("a kernel has a number of about 2^{size}, which no double holds");
    Diagnostic::new(spec::code::TOO_LARGE, spec.pose.span.clone(), message)
        .label("derived from this")
        .help("use other units: doubles are between about 2^-1022 and 2^1024")
}

/// The error that a kernel holds a derivative of a curve that jumps.
fn rough_curve(spec: &JointSpec, (curve, order): (Curve, u8)) -> Diagnostic {
    let declared = spec.curves.iter().find(|declared| declared.curve == curve);
    let span = declared.map_or(&spec.pose.span, |declared| &declared.span);
    let name = curve.name();
    let message = format!(
        "the equations of motion need derivative {order} of the curve `{name}`, of which those up to {} are continuous",
        curve.smoothness()
    );
    Diagnostic::new(spec::code::ROUGH_CURVE, span.clone(), message)
        .label("not smooth enough")
        .help("a quintic curve has four continuous derivatives, two where it goes on straight; a cubic one has two")
}

/// What it takes to simplify a kernel and to write it, in code and in pages: in proportion to its terms.
fn spend_on_formulas(kernel: &Kernel) {
    let entries = kernel.outputs.iter().flat_map(Matrix::entries);
    let terms: usize = entries.map(|entry| entry.terms().len()).sum();
    budget::spend(WORK_OF_WRITTEN_TERM * terms as u64);
}

fn too_much_work(spec: &JointSpec, exhausted: Exhausted) -> Diagnostic {
    let span = task::span(spec, exhausted.task);
    Diagnostic::new(spec::code::WORK, span, exhausted.to_string())
        .label("the bound on symbolic work is met here")
        .help(task::advice(exhausted.task, exhausted.claim))
}
