//! From formulas to operations.

use super::{Operation, Place, Tape};
use hamel_codegen::derived::Primitive;
use hamel_codegen::expr::curve::{Curve, Outside};
use hamel_codegen::expr::{Function, Rational, Symbol};
use hamel_codegen::formula::{Binding, Chain, Node, Program};
use hamel_runtime::curve;
use std::collections::BTreeMap;

/// What the formulas of a program are made of.
pub struct Inputs<'a> {
    /// The symbols of each argument, in order.
    pub arguments: Vec<&'a [Symbol]>,
    /// The symbols of the parameters.
    pub parameters: Vec<&'a Symbol>,
}

/// The program as a tape.
pub fn assemble(program: &Program, inputs: &Inputs<'_>) -> Tape {
    let mut assembler = Assembler {
        inputs,
        tape: Tape::default(),
        symbols: BTreeMap::new(),
        numbers: BTreeMap::new(),
    };
    for binding in &program.bindings {
        assembler.binding(binding);
    }
    let outputs = program.outputs.iter();
    assembler.tape.outputs = outputs.map(|output| assembler.value(output)).collect();
    assembler.tape
}

struct Assembler<'a> {
    inputs: &'a Inputs<'a>,
    tape: Tape,
    symbols: BTreeMap<Symbol, Place>,
    numbers: BTreeMap<Rational, Place>,
}

impl Assembler<'_> {
    fn push(&mut self, operation: Operation) -> Place {
        // A derivation of more terms than places is refused long before.
        let place = u32::try_from(self.tape.size).unwrap_or(u32::MAX);
        self.tape.size += operation.count();
        self.tape.operations.push(operation);
        place
    }

    fn binding(&mut self, binding: &Binding) {
        match binding {
            Binding::Value { name, value } => {
                let place = self.value(value);
                self.symbols.insert(name.clone(), place);
            }
            Binding::SinCos { sin, cos, angle } => {
                let angle = self.value(angle);
                let place = self.push(Operation::SinCos(angle));
                let names = [(sin, place), (cos, place + 1)].into_iter();
                let named = names.filter_map(|(name, place)| Some((name.clone()?, place)));
                self.symbols.extend(named);
            }
            Binding::Call {
                primitive,
                argument,
                outputs,
            } => {
                let entries: Vec<Place> = argument.iter().map(|part| self.value(part)).collect();
                let place = self.push(primitive_of(*primitive, &entries));
                self.symbols.extend(outputs.iter().cloned().zip(place..));
            }
        }
    }

    fn value(&mut self, node: &Node) -> Place {
        match node {
            Node::Number(value) => self.number(value),
            Node::Symbol(symbol) => self.symbol(symbol),
            Node::Pi => self.push(Operation::Constant(std::f64::consts::PI)),
            Node::Sum(terms) => self.sum(terms),
            Node::Product(factors) => self.product(factors),
            Node::Quotient(above, below) => {
                let (above, below) = (self.value(above), self.value(below));
                self.push(Operation::Divide(above, below))
            }
            Node::Negative(inner) => {
                let inner = self.value(inner);
                self.push(Operation::Negate(inner))
            }
            Node::Call(function, arguments) => self.call(*function, arguments),
        }
    }

    fn number(&mut self, value: &Rational) -> Place {
        if let Some(known) = self.numbers.get(value) {
            return *known;
        }
        let (above, below) = value.in_doubles();
        let place = self.push(Operation::Constant(above / below.unwrap_or(1.0)));
        self.numbers.insert(value.clone(), place);
        place
    }

    fn symbol(&mut self, symbol: &Symbol) -> Place {
        if let Some(known) = self.symbols.get(symbol) {
            return *known;
        }
        let operation = self.input(symbol);
        let place = self.push(operation.unwrap_or(Operation::Constant(f64::NAN)));
        self.symbols.insert(symbol.clone(), place);
        place
    }

    fn input(&self, symbol: &Symbol) -> Option<Operation> {
        let mut parameters = self.inputs.parameters.iter();
        if let Some(place) = parameters.position(|known| *known == symbol) {
            return Some(Operation::Parameter(u16::try_from(place).ok()?));
        }
        let mut arguments = self.inputs.arguments.iter().enumerate();
        let (argument, entry) = arguments.find_map(|(argument, symbols)| {
            Some((argument, symbols.iter().position(|known| known == symbol)?))
        })?;
        Some(Operation::Argument(
            u8::try_from(argument).ok()?,
            u16::try_from(entry).ok()?,
        ))
    }

    /// The sum; products in it as multiply–adds, as emitted code has them.
    fn sum(&mut self, terms: &[(bool, Node)]) -> Place {
        let Some(chain) = Chain::new(terms) else {
            return self.plain_sum(terms.iter());
        };
        let rest = self.plain_sum(chain.rest.iter().copied());
        let products = chain.products.iter().rev();
        products.fold(rest, |rest, (minus, factors, last)| {
            let first = self.product(factors);
            let last = match minus {
                true => self.value(&(*last).clone().negated().polished()),
                false => self.value(last),
            };
            self.push(Operation::MultiplyAdd(first, last, rest))
        })
    }

    fn plain_sum<'n>(&mut self, terms: impl Iterator<Item = &'n (bool, Node)>) -> Place {
        let mut sum = None;
        for (minus, term) in terms {
            let own = self.value(term);
            sum = Some(match (sum, minus) {
                (None, false) => own,
                (None, true) => self.push(Operation::Negate(own)),
                (Some(sum), false) => self.push(Operation::Add(sum, own)),
                (Some(sum), true) => self.push(Operation::Subtract(sum, own)),
            });
        }
        sum.unwrap_or_else(|| self.push(Operation::Constant(0.0)))
    }

    fn product(&mut self, factors: &[Node]) -> Place {
        let mut product = None;
        for factor in factors {
            let own = self.value(factor);
            product = Some(match product {
                None => own,
                Some(product) => self.push(Operation::Multiply(product, own)),
            });
        }
        product.unwrap_or_else(|| self.push(Operation::Constant(1.0)))
    }

    fn call(&mut self, function: Function, arguments: &[Node]) -> Place {
        let places: Vec<Place> = arguments.iter().map(|part| self.value(part)).collect();
        let operation = match (function, places.as_slice()) {
            (Function::Group, [inner]) => return *inner,
            (Function::Pi, _) => Operation::Constant(std::f64::consts::PI),
            (Function::Curve(curve, order), [at]) => Operation::Curve(table(curve), order, *at),
            (function, [only]) => Operation::Call(function, *only),
            (function, [first, second]) => Operation::CallTwo(function, *first, *second),
            _ => Operation::Constant(f64::NAN),
        };
        self.push(operation)
    }
}

/// The call of a function of the runtime; no number where it has another count of entries than the generator gives it.
fn primitive_of(primitive: Primitive, entries: &[Place]) -> Operation {
    let operation = match primitive {
        Primitive::RotationVector => entries.try_into().map(Operation::RotationVector),
        Primitive::NearestRotation => entries.try_into().map(Operation::NearestRotation),
        Primitive::QuaternionVector => entries.try_into().map(Operation::QuaternionVector),
    };
    operation.unwrap_or(Operation::Constant(f64::NAN))
}

/// A curve as the runtime has it.
fn table(curve: Curve) -> curve::Curve {
    let table = curve.table();
    let outside = match table.outside {
        Outside::Undefined => curve::Outside::Undefined,
        Outside::Periodic => curve::Outside::Periodic,
        Outside::Straight => curve::Outside::Straight,
        Outside::Polynomial => curve::Outside::Polynomial,
    };
    curve::Curve::new(&table.knots, &table.coefficients, outside)
}
