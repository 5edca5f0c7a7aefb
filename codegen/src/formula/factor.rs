//! From sums of terms to formulas: Horner's scheme, greedy on the factor that most terms share.

use super::Node;
use super::numbered::{Numbered, Term};
use crate::expr::{Atom, Expr, Function};
use std::cmp::Reverse;

/// The expression with common factors pulled out, terms in ascending order.
pub fn factored(expression: &Expr) -> Node {
    let (numbered, terms) = Numbered::new(expression);
    let atoms = numbered.atoms.iter().map(node_of_atom).collect();
    Writer { numbered, atoms }.sum(terms)
}

/// What several terms can share. The order decides between factors that equally many share: symbols go first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Factor {
    /// An atom in the numerator.
    Atom(usize),
    /// A parameter or π in the denominator.
    Divisor(usize),
    /// A rational other than ±1.
    Size(usize),
}

impl Factor {
    /// Takes this factor out of the term; false where the term does not have it.
    fn divide(self, term: &mut Term) -> bool {
        match self {
            Self::Atom(atom) => term.power(atom) > 0 && term.multiply(atom, -1),
            Self::Divisor(atom) => term.power(atom) < 0 && term.multiply(atom, 1),
            Self::Size(size) => {
                let has = term.size == size;
                if has {
                    term.size = Numbered::ONE;
                }
                has
            }
        }
    }
}

/// An atom in a formula.
enum Written {
    Factor(Node),
    /// A quotient is an atom of the ring; in a formula it divides.
    Divisor(Node),
}

/// Writes the terms of one expression.
struct Writer {
    numbered: Numbered,
    atoms: Vec<Written>,
}

impl Writer {
    /// The sum; factors go in front in the place of the first term that had them.
    fn sum(&self, mut terms: Vec<Term>) -> Node {
        let mut written = vec![];
        while let Some(factor) = self.most_shared(&terms) {
            let (mut inside, mut outside, mut first) = (vec![], vec![], None);
            for mut term in terms {
                let whole = first.is_none().then(|| term.clone());
                match factor.divide(&mut term) {
                    true => {
                        first = first.or(whole);
                        inside.push(term);
                    }
                    false => outside.push(term),
                }
            }
            inside.sort();
            if let Some(first) = first {
                written.push((first, self.times(factor, self.sum(inside))));
            }
            terms = outside;
        }
        let single = |term: Term| {
            let node = self.single_term(&term);
            (term, node)
        };
        written.extend(terms.into_iter().map(single));
        written.sort_by(|(a, _), (b, _)| a.cmp(b));
        Node::sum(written.into_iter().map(|(_, node)| node))
    }

    /// The factor in most terms, in two at least.
    fn most_shared(&self, terms: &[Term]) -> Option<Factor> {
        let mut above = vec![0_usize; self.numbered.atoms.len()];
        let mut below = above.clone();
        let mut sizes = vec![0_usize; self.numbered.sizes.len()];
        for term in terms {
            for (atom, power) in term.factors() {
                let counts = if power > 0 { &mut above } else { &mut below };
                counts[atom] += 1;
            }
            sizes[term.size] += usize::from(term.size != Numbered::ONE);
        }
        let numbered = |counts: Vec<usize>, factor: fn(usize) -> Factor| {
            let counted = counts.into_iter().enumerate();
            counted.map(move |(number, count)| (Reverse(count), factor(number)))
        };
        // Atoms and divisors stand in one order, by their atoms within each.
        let all = numbered(above, Factor::Atom)
            .chain(numbered(below, Factor::Divisor))
            .chain(numbered(sizes, Factor::Size));
        all.filter(|(Reverse(count), _)| *count >= 2)
            .min()
            .map(|(_, factor)| factor)
    }

    fn times(&self, factor: Factor, inside: Node) -> Node {
        match factor {
            Factor::Atom(atom) => match &self.atoms[atom] {
                Written::Factor(node) => Node::product([node.clone(), inside]),
                Written::Divisor(divisor) => inside.over(divisor.clone()),
            },
            Factor::Divisor(atom) => match &self.atoms[atom] {
                Written::Factor(node) => inside.over(node.clone()),
                Written::Divisor(divisor) => Node::product([divisor.clone(), inside]),
            },
            Factor::Size(size) => Node::product([Node::number(&self.numbered.sizes[size]), inside]),
        }
    }

    fn single_term(&self, term: &Term) -> Node {
        let size = Node::number(&self.numbered.sizes[term.size]);
        let mut above = vec![if term.negative { size.negated() } else { size }];
        let mut below = vec![];
        for (atom, power) in term.factors() {
            let (node, divides) = match &self.atoms[atom] {
                Written::Factor(node) => (node, false),
                Written::Divisor(node) => (node, true),
            };
            let side = match divides ^ (power < 0) {
                true => &mut below,
                false => &mut above,
            };
            side.extend(std::iter::repeat_n(
                node.clone(),
                power.unsigned_abs() as usize,
            ));
        }
        Node::product(above).over(Node::product(below))
    }
}

fn node_of_atom(atom: &Atom) -> Written {
    let application = match atom {
        Atom::Symbol(symbol) => return Written::Factor(Node::Symbol(symbol.clone())),
        Atom::Apply(application) => application,
    };
    Written::Factor(
        match (application.function, application.arguments.as_slice()) {
            (Function::Recip, [divisor]) => return Written::Divisor(factored(divisor)),
            (Function::Pi, _) => Node::Pi,
            (Function::Group, [sum]) => factored(sum),
            (function, arguments) => Node::Call(function, arguments.iter().map(factored).collect()),
        },
    )
}
