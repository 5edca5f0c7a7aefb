//! The fibres of H: whether one pose has one Q.

use crate::derived::{Claim, Proof};
use crate::domain::Domain;
use crate::expr::{Atom, Expr, Function, Role, Symbol};
use crate::model::JointSpec;
use std::collections::{BTreeMap, BTreeSet};

/// What is known of the configurations that share a pose; `None` where it was not decided.
pub fn claim(spec: &JointSpec, domain: &Domain<'_>) -> Option<Claim> {
    let ideal = spec.manifold.value.ideal();
    let pose = &spec.pose.value;
    let entries: Vec<Expr> = pose
        .rotation
        .entries()
        .iter()
        .chain(pose.translation.entries())
        .map(|e| ideal.normal_form(e))
        .collect();
    let coordinates = spec.manifold.value.coordinates();
    let read = recovered(domain, &entries, &coordinates);
    let rest: Vec<&Symbol> = coordinates
        .iter()
        .filter(|symbol| !read.contains(*symbol))
        .collect();
    let statement = match rest.as_slice() {
        [] => (
            "one pose has one Q".to_owned(),
            "every stored scalar can be read off H",
        ),
        _ if is_even(&entries, &rest, spec) => (
            "Q and −Q have one pose: a double cover".to_owned(),
            "H is even in them",
        ),
        _ if rest.iter().all(|symbol| is_periodic(&entries, symbol)) => {
            let names: Vec<&str> = rest.iter().map(|symbol| &*symbol.name).collect();
            (
                format!(
                    "one pose has one Q up to full turns of {}",
                    names.join(", ")
                ),
                "they enter H through sine and cosine alone",
            )
        }
        _ => return None,
    };
    Some(Claim {
        name: "fibres",
        statement: statement.0,
        proof: Proof::Certificate,
        detail: statement.1.into(),
        residual: 0.0,
        points: 0,
        bits: 0,
    })
}

/// Scalars that are linear in some entry of H, the other terms of which hold only scalars that are known already.
fn recovered(domain: &Domain<'_>, entries: &[Expr], coordinates: &[Symbol]) -> BTreeSet<Symbol> {
    let ideal = domain.ideal();
    let mut known: BTreeSet<Symbol> = BTreeSet::new();
    loop {
        let before = known.len();
        for symbol in coordinates {
            let normal = ideal.normal_form(&Expr::symbol(symbol));
            let reduces = normal.as_symbol() != Some(symbol);
            let determined = reduces && normal.symbols().iter().all(|s| known.contains(s));
            if determined
                || entries
                    .iter()
                    .any(|entry| gives(entry, symbol, &known, domain))
            {
                known.insert(symbol.clone());
            }
        }
        if known.len() == before {
            return known;
        }
    }
}

fn gives(entry: &Expr, symbol: &Symbol, known: &BTreeSet<Symbol>, domain: &Domain<'_>) -> bool {
    let slope = entry.derivative(symbol);
    let others = entry
        .symbols()
        .into_iter()
        .filter(|s| s.role == Role::Coordinate && s != symbol);
    domain.is_unit(&slope) && others.into_iter().all(|s| known.contains(&s))
}

fn is_even(entries: &[Expr], rest: &[&Symbol], spec: &JointSpec) -> bool {
    let negated: BTreeMap<Symbol, Expr> = rest
        .iter()
        .map(|&symbol| (symbol.clone(), -Expr::symbol(symbol)))
        .collect();
    let ideal = spec.manifold.value.ideal();
    entries
        .iter()
        .all(|entry| ideal.vanishes(&(&entry.substitute(&negated) - entry)))
}

/// Whether the symbol stands in the entries as the whole argument of sines and cosines, and nowhere else.
fn is_periodic(entries: &[Expr], symbol: &Symbol) -> bool {
    entries
        .iter()
        .flat_map(Expr::atoms)
        .all(|atom| match &atom {
            Atom::Symbol(other) => other != symbol,
            Atom::Apply(application) => {
                let trigonometric = matches!(application.function, Function::Cos | Function::Sin);
                let itself =
                    application.arguments.first().and_then(Expr::as_symbol) == Some(symbol);
                let absent = application
                    .arguments
                    .iter()
                    .all(|argument| !argument.symbols().contains(symbol));
                absent || (trigonometric && itself)
            }
        })
}
