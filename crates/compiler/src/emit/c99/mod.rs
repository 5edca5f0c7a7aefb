//! A module of functions in C99: a source that needs nothing but `<math.h>`, and its header. The same functions in CUDA C++, with a kernel for each.
//!
//! Templates lay the texts out (`crates/compiler/templates`); what they are filled with is made here, operation by operation as in Rust. Sums of
//! products are multiply–adds, fused only where the target does that in hardware. Sines and cosines are those of the C library, one by one;
//! functions of many states take the polynomials of the Rust runtime, in loops that compilers vectorise.

mod breaks;
mod curve;
mod formula;
mod helpers;
mod lanes;
mod layout;
mod pairs;
mod results;
mod statement;

use super::{Function, Lowered, argument_size, curves, identifier, identifiers};
use crate::graph::Argument;
use crate::model::Model;
use breaks::broken;
use formula::value;
use hamel_codegen::text::one_line;
use helpers::Used;
use serde::Serialize;
use statement::{Array, Statement};
use tera::{Context, Tera};

const TEMPLATES: [(&str, &str); 9] = [
    ("module.h", include_str!("../../../templates/module.h.tera")),
    ("module.c", include_str!("../../../templates/module.c.tera")),
    (
        "module.cu",
        include_str!("../../../templates/module.cu.tera"),
    ),
    ("layout.c", include_str!("../../../templates/layout.c.tera")),
    ("sizes.c", include_str!("../../../templates/sizes.c.tera")),
    (
        "function.c",
        include_str!("../../../templates/function.c.tera"),
    ),
    (
        "helpers.c",
        include_str!("../../../templates/helpers.c.tera"),
    ),
    ("lanes.c", include_str!("../../../templates/lanes.c.tera")),
    ("line.c", include_str!("../../../templates/line.c.tera")),
];

/// Names that lines must not take: arguments, what the functions bind themselves, helpers, and what `<math.h>` defines.
const RESERVED: [&str; 43] = [
    "arguments",
    "q",
    "v",
    "p",
    "tau",
    "a",
    "lambda",
    "i",
    "lane",
    "lanes",
    "angles",
    "sines",
    "cosines",
    "sin_cos",
    "side_by_side",
    "apart",
    "results",
    "work",
    "matrix",
    "tables",
    "pairs",
    "pair_entries",
    "pair_masses",
    "pair_slopes",
    "pair_product",
    "numbers",
    "places",
    "mul_add",
    "curve",
    "stumpff",
    "stumpff_direct",
    "inverse_factorials",
    "dexp_inverse",
    "cotangent",
    "pole_tails",
    "power",
    "powers",
    "rotation_vector",
    "quaternion_vector",
    "nearest_rotation",
    "double_t",
    "float_t",
    "math_errhandling",
];

/// The texts of a module.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Texts {
    /// The functions.
    pub source: String,
    /// Their prototypes, sizes and layouts.
    pub header: String,
}

/// The module `name` that holds `functions` of the model, and those `in_lanes` of many states as well: its functions begin with the name, its header is
/// `NAME.h`. `label` names the scene's file.
///
/// # Errors
/// A fault in a template, which is part of this crate.
pub fn module(
    model: &Model,
    (functions, in_lanes): (&[Function], &[Function]),
    label: &str,
    name: &str,
) -> tera::TeraResult<Texts> {
    let mut context = context(model, (functions, in_lanes), label, name);
    context.insert("device", "");
    let tera = templates()?;
    Ok(Texts {
        source: broken(&tera.render("module.c", &context)?),
        header: broken(&tera.render("module.h", &context)?),
    })
}

/// The same functions in CUDA C++, each with a kernel `NAME_..._states` that computes one state a thread: one source, without a header.
///
/// # Errors
/// A fault in a template, which is part of this crate.
pub fn cuda(
    model: &Model,
    functions: &[Function],
    label: &str,
    name: &str,
) -> tera::TeraResult<String> {
    let mut context = context(model, (functions, &[]), label, name);
    context.insert("device", "__device__ ");
    Ok(broken(&templates()?.render("module.cu", &context)?))
}

fn templates() -> tera::TeraResult<Tera> {
    let mut tera = Tera::new();
    tera.add_raw_templates(TEMPLATES)?;
    Ok(tera)
}

/// What templates are filled with, except for the qualifier of functions.
fn context(
    model: &Model,
    (functions, in_lanes): (&[Function], &[Function]),
    label: &str,
    name: &str,
) -> Context {
    let bodies = identifiers(model);
    let lines = |functions: &[Function]| -> Vec<Lowered> {
        let lowered = functions.iter();
        lowered
            .map(|function| Lowered::new(function, &bodies, &RESERVED))
            .collect()
    };
    let (lowered, side_by_side) = (lines(functions), lines(in_lanes));
    let mut used = Used::default();
    let all = lowered.iter().chain(&side_by_side);
    all.for_each(|lowered| used.note(lowered));
    let lanes = in_lanes.iter().zip(&side_by_side);
    let lanes: Vec<lanes::Written> = lanes
        .map(|(function, lowered)| lanes::Written::new(function, lowered))
        .collect();
    let turns = lanes.iter().any(lanes::Written::turns);
    if turns {
        used.note_turns();
    }
    functions
        .iter()
        .for_each(|function| used.note_pairs(function));
    let prefix = identifier(name, "scene");
    let macros = prefix.to_uppercase();
    let written = functions.iter().zip(&lowered);
    let written: Vec<Written> = written
        .map(|(function, lowered)| Written::new(function, lowered, &macros))
        .collect();

    let mut context = Context::new();
    let [configuration, freedoms, speeds] = model.sizes();
    context.insert("label", &one_line(label));
    context.insert("scene", &one_line(&model.name));
    context.insert("name", name);
    context.insert("prefix", &prefix);
    context.insert("macros", &macros);
    context.insert("configuration", &configuration);
    context.insert("freedoms", &freedoms);
    context.insert("speeds", &speeds);
    let gravity = model.gravity.iter().map(|entry| format!("{entry:?}"));
    context.insert("gravity", &gravity.collect::<Vec<_>>());
    let is_coupled = !model.coupling.constraints.is_empty();
    context.insert("is_coupled", &is_coupled);
    context.insert("bodies", &layout::layout(model));
    context.insert("functions", &written);
    context.insert("lanes", &lanes);
    context.insert("turns", &turns);
    context.insert("count_of_lanes", &lanes::LANES);
    let curves = curves(functions.iter().chain(in_lanes));
    let curves = curves.into_iter().map(curve::Table::new);
    context.insert("curves", &curves.collect::<Vec<_>>());
    context.insert("used", &used.helpers());
    context
}

/// A function as the templates see it.
#[derive(Serialize)]
struct Written {
    name: &'static str,
    summary: String,
    /// Units, axes and order of its results.
    results: &'static str,
    operations: String,
    /// What it reads, in order.
    arguments: Vec<Parameter>,
    /// Declarations of its parameters, in order.
    parameters: Vec<String>,
    /// Parameters that it does not read.
    unused: Vec<&'static str>,
    /// How many results there are, and in rows of what length.
    count: usize,
    columns: usize,
    /// Arrays of the rows that blocks leave.
    arrays: Vec<Array>,
    lines: Vec<Statement>,
    /// Results that no line assigns.
    outputs: Vec<String>,
    /// What lines assign.
    target: &'static str,
    /// Loops over pairs of joints, where lines assign numbers of bodies.
    pairs: Option<pairs::Written>,
}

impl Written {
    fn new(function: &Function, lowered: &Lowered, macros: &str) -> Self {
        let mut used = Used::default();
        used.note(lowered);
        let count = function.results();
        let arguments = function.arguments.iter();
        let parameters = arguments.clone().map(|&(argument, size)| {
            let name = argument.name();
            // An array without entries is no C.
            match size {
                0 => format!("const double *{name}"),
                _ => format!("const double {name}[{macros}_{}]", size_macro(argument)),
            }
        });
        let results = match count {
            0 => "double *results".to_owned(),
            count => format!("double results[{count}]"),
        };
        let unused = arguments.filter(|(argument, _)| !used.reads(*argument));
        let unused = unused.map(|(argument, _)| argument.name());
        let outputs = lowered.outputs.iter().flatten().map(value);
        Self {
            name: function.name,
            summary: one_line(&function.summary),
            results: results::results(function.name),
            operations: function.operations().to_string(),
            arguments: Parameter::all(function),
            parameters: parameters.chain([results]).collect(),
            unused: unused.chain((count == 0).then_some("results")).collect(),
            count,
            columns: function.columns.unwrap_or(1),
            arrays: statement::arrays(lowered),
            lines: statement::statements(&lowered.lines, &used),
            outputs: outputs.collect(),
            target: if function.pairs.is_some() {
                "work"
            } else {
                "results"
            },
            pairs: function
                .pairs
                .as_ref()
                .map(|tables| pairs::Written::new(tables, function.outputs.len())),
        }
    }
}

/// An argument, and how many entries it has for one state.
#[derive(Serialize)]
struct Parameter {
    name: &'static str,
    size: usize,
}

impl Parameter {
    fn all(function: &Function) -> Vec<Self> {
        let parameters = function.arguments.iter();
        let parameters = parameters.map(|&(argument, size)| Self {
            name: argument.name(),
            size,
        });
        parameters.collect()
    }
}

/// The macro of the header that is the size of an argument.
fn size_macro(argument: Argument) -> &'static str {
    argument_size(argument, ["CONFIGURATION", "FREEDOMS", "SPEEDS"])
}
