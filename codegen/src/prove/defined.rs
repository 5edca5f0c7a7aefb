//! The claim that everything is defined: no quotient divides by zero, no root or logarithm leaves the positive numbers.

use super::{Attempt, Prover, certified, refuted};
use crate::expr::{Atom, Expr, Function, Role};
use crate::matrix::Matrix;
use crate::spec::code;
use std::collections::BTreeSet;

impl Prover<'_> {
    /// Every quotient, root and logarithm in what is evaluated at Q is regular there.
    pub(super) fn is_defined(&self) -> Attempt {
        let critical = self.critical();
        if critical.is_empty() {
            return Ok(None);
        }
        let open: Vec<&(Function, Expr)> = critical
            .iter()
            .filter(|(function, argument)| !self.is_regular(*function, argument))
            .collect();
        let Some((function, argument)) = open.first() else {
            let count = critical.len();
            return Ok(Some(certified(
                "defined",
                &self.where_it_holds("H, Φ, X, S, A and S̄ are smooth at Q"),
                &format!(
                    "quotients, roots and logarithms in them: {count}; none of their arguments vanishes"
                ),
            )));
        };
        let message = match function {
            Function::Recip => format!("a quotient by {argument}, which may be 0"),
            Function::Ln => {
                format!("the logarithm of {argument}, which is not shown to be positive")
            }
            _ => format!("the root of {argument}, which is not smooth where that is 0"),
        };
        Err(Box::new(
            refuted(code::NOT_DEFINED, &self.spec.pose.span, &message, "the joint needs it")
                .help(format!("if the joint ends there, declare it: `except {argument} = 0;`; ranges of parameters and `require` help to show that it does not vanish")),
        ))
    }

    fn is_regular(&self, function: Function, argument: &Expr) -> bool {
        let nonzero = || self.domain.nonzero(argument).is_some();
        match function {
            Function::Recip => nonzero(),
            // Where it is not 0 it keeps its sign on the component of home.
            _ => {
                self.domain.is_positive(argument)
                    || (nonzero() && self.domain.is_positive(&self.at_home(argument)))
            }
        }
    }

    fn at_home(&self, argument: &Expr) -> Expr {
        let manifold = &self.spec.manifold.value;
        let home = self.spec.home.as_ref().map(|home| home.value.clone());
        let home = home.unwrap_or_else(|| manifold.home());
        argument.substitute(&manifold.coordinates().into_iter().zip(home).collect())
    }

    /// Functions with a singular argument, with that argument, in all that is evaluated at a configuration.
    fn critical(&self) -> BTreeSet<(Function, Expr)> {
        let spec = self.spec;
        let mut found = BTreeSet::new();
        let pose = &spec.pose.value;
        let declared = [&spec.twist_map, &spec.constraint, &spec.speed_basis]
            .into_iter()
            .flatten();
        let matrices: Vec<&Matrix> = [&pose.rotation, &pose.translation]
            .into_iter()
            .chain(declared.map(|d| &d.value))
            .chain([&self.x.velocity_map.base, &self.x.velocity_map_inverse])
            .chain(&self.x.velocity_map.slopes)
            .chain([
                &self.x.nonholonomic.constraint,
                &self.x.nonholonomic.speed_basis,
            ])
            .collect();
        matrices
            .iter()
            .flat_map(|m| m.entries())
            .for_each(|e| collect(e, &mut found));
        let moved = spec.retract.as_ref().filter(|_| !self.x.exponential);
        let at_base = moved.map(|d| d.value.iter().map(|e| e.at_zero(&self.x.arguments.local)));
        at_base
            .into_iter()
            .flatten()
            .for_each(|e| collect(&e, &mut found));
        found
    }
}

fn collect(expression: &Expr, found: &mut BTreeSet<(Function, Expr)>) {
    for atom in expression.atoms() {
        let Atom::Apply(application) = &atom else {
            continue;
        };
        application
            .arguments
            .iter()
            .for_each(|argument| collect(argument, found));
        let singular = matches!(
            application.function,
            Function::Recip | Function::Sqrt | Function::Ln
        );
        if let (true, [argument]) = (singular, application.arguments.as_slice())
            && argument
                .symbols()
                .iter()
                .any(|symbol| matches!(symbol.role, Role::Coordinate | Role::Parameter))
        {
            found.insert((application.function, argument.clone()));
        }
    }
}
