//! The names that a joint's symbols have in every kernel; none is one that Rust or the emitted code reserves.

use super::layered::Layered;
use super::names::{NameSet, number_words};
use crate::expr::{Role, Symbol};
use crate::kernel::{Arguments, Word};
use crate::model::Parameter;

/// Names that every kernel and `build` may use: their arguments, the constants, and what is imported.
const RESERVED: &[&str] = &[
    "q",
    "phi",
    "v",
    "p",
    "rate",
    "target",
    "speeds",
    "h",
    "zero",
    "one",
    "pi",
    "relations",
    "relation",
    "values",
    "sum",
    "rotation",
    "nearest_rotation",
    "start",
    "moved",
    "tangent",
    "tangent_there",
    "from_rows",
    "rows_at",
    "dot",
    "part",
    "put",
    "put_block",
    "stacked",
    "differential",
    "local_rate",
    "nearest",
    "self",
    "core",
    "hamel",
    "std",
    "alloc",
];

/// What is added to the name of a symbol whose own is taken.
fn role_name(role: Role) -> &'static str {
    match role {
        Role::Parameter | Role::Constant => "parameter",
        Role::Coordinate => "coordinate",
        Role::Target => "target",
        Role::Local => "local",
        Role::Displacement => "displacement",
        Role::Velocity => "velocity",
        Role::Speed => "speed",
        Role::Momentum => "momentum",
        Role::Wrench => "wrench",
        Role::Inertia => "inertia",
        Role::Intermediate => "value",
    }
}

/// The identifiers of a joint's symbols in every kernel.
#[derive(Clone, Debug)]
pub struct Names {
    by_symbol: Layered<Symbol, String>,
    taken: NameSet,
}

impl Names {
    /// Names for the parameters, for the arguments of all kernels and for the `let`s of the spec, so that a name means one value in all of them.
    pub fn new(parameters: &[Parameter], arguments: &Arguments, words: &[Word]) -> Self {
        let mut names = Self::reserved();
        names.claim_coordinates(&arguments.configuration);
        let parameters = parameters.iter().map(|parameter| &parameter.symbol);
        let others = [
            &arguments.target,
            &arguments.local,
            &arguments.displacement,
            &arguments.velocity,
            &arguments.speeds,
            &arguments.momentum,
            &arguments.wrench,
        ];
        parameters
            .chain(others.into_iter().flatten())
            .chain(words.iter().map(|word| &word.symbol))
            .for_each(|symbol| names.claim(symbol));
        names.by_symbol.share();
        names.taken.share();
        names
    }

    /// Names of the parameters in `build`, where nothing else has a name but its argument and the constants.
    pub fn of_parameters(parameters: &[Parameter]) -> Self {
        let mut names = Self::reserved();
        let parameters = parameters.iter();
        parameters.for_each(|parameter| names.claim(&parameter.symbol));
        names
    }

    fn reserved() -> Self {
        let mut taken = NameSet::default();
        let reserved = RESERVED.iter().map(|name| (*name).to_owned());
        taken.reserve(reserved.chain(number_words()));
        Self {
            by_symbol: Layered::default(),
            taken,
        }
    }

    /// A single coordinate called `q` may shadow the argument that it is read from.
    fn claim_coordinates(&mut self, coordinates: &[Symbol]) {
        for symbol in coordinates {
            match symbol.name() == "q" {
                true => self.by_symbol.insert(symbol.clone(), "q".to_owned()),
                false => self.claim(symbol),
            }
        }
    }

    /// Gives a symbol its name.
    pub fn claim(&mut self, symbol: &Symbol) {
        if !self.by_symbol.contains(symbol) {
            let name = match self.taken.is_free(symbol.name()) {
                true => self.taken.claim(symbol.name()),
                false => self
                    .taken
                    .claim(&format!("{}_{}", symbol.name(), role_name(symbol.role))),
            };
            self.by_symbol.insert(symbol.clone(), name);
        }
    }

    /// Gives a symbol a name that is already its own.
    pub fn adopt(&mut self, symbol: &Symbol) {
        if !self.by_symbol.contains(symbol) {
            let name = symbol.name().to_owned();
            self.by_symbol.insert(symbol.clone(), name);
        }
    }

    /// The name of a symbol.
    pub fn get<'a>(&'a self, symbol: &'a Symbol) -> &'a str {
        self.by_symbol
            .get(symbol)
            .map_or(symbol.name(), String::as_str)
    }

    /// All names that are taken.
    pub fn taken(&self) -> &NameSet {
        &self.taken
    }
}
