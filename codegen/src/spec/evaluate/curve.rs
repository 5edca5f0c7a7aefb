//! Curves in expressions: `lift(x)`, `derivative(lift, x)`, `derivative(lift, x, 2)`.

use super::super::ast::{Name, Node, NodeKind};
use super::super::value::Value;
use super::super::{Fallible, code};
use super::Evaluator;
use super::elementary::is_negative;
use super::function::Call;
use crate::diagnostic::Diagnostic;
use crate::expr::Expr;
use crate::expr::curve::{Curve, Outside};
use crate::model::Declared;
use num_traits::ToPrimitive;
use std::ops::Range;

impl Evaluator<'_> {
    /// The value of a curve, or of a derivative of one.
    pub(super) fn curve(
        &mut self,
        name: &Name,
        arguments: &[Node],
        span: &Range<usize>,
    ) -> Option<Value> {
        let call = Call {
            name: &name.text,
            span,
        };
        if name.text != "derivative" {
            let known = self.curves.get(&name.text).copied().flatten();
            let values = self.values(arguments)?;
            return self.called(&call, known?, &values, &[]);
        }
        let Some((first, rest)) = arguments.split_first() else {
            self.report(*call.refuse("a curve and an argument", &[]));
            return None;
        };
        let known = match &first.kind {
            NodeKind::Name(curve) => self.curves.get(curve).copied(),
            _ => None,
        };
        let Some(known) = known else {
            if !self.lenient {
                self.report(no_curve(first));
            }
            return None;
        };
        let values = self.values(rest)?;
        let (argument, order) = values.split_at(values.len().min(1));
        self.called(&call, known?, argument, order)
    }

    /// The value of a call, which is kept.
    fn called(
        &mut self,
        call: &Call<'_>,
        curve: Curve,
        arguments: &[Value],
        order: &[Value],
    ) -> Option<Value> {
        let value = value(call, curve, arguments, order);
        let value = self.settle(value)?;
        if let [Value::Scalar(argument)] = arguments {
            self.calls.push(Declared {
                value: (curve, argument.clone()),
                span: call.span.clone(),
            });
        }
        Some(value)
    }
}

fn no_curve(node: &Node) -> Diagnostic {
    let message = "`derivative` takes the name of a curve and an argument";
    Diagnostic::new(code::ARGUMENTS, node.span.clone(), message)
        .label("not a curve")
        .help("derivatives of other expressions are formed where they are needed")
}

/// The derivative of an order; without one, of a call of the curve its value and of `derivative` the first.
fn value(call: &Call<'_>, curve: Curve, arguments: &[Value], order: &[Value]) -> Fallible<Value> {
    let [Value::Scalar(x)] = arguments else {
        return Err(call.refuse("one scalar", arguments));
    };
    let highest = curve.definition().kind.degree();
    let order = match order {
        [] => Some(u8::from(call.name == "derivative")),
        [Value::Scalar(order)] => order
            .as_rational()
            .filter(|order| order.is_integer())
            .and_then(|order| order.to_u8())
            .filter(|order| (1..=highest).contains(order)),
        _ => None,
    };
    let Some(order) = order else {
        let takes = format!("a curve, a scalar and an order from 1 to {highest}");
        return Err(call.refuse(&takes, arguments));
    };
    match is_outside(curve, x) {
        false => Ok(Value::Scalar(curve.at(x, order))),
        true => {
            let (first, last) = [false, true].map(|last| curve.end_as_argument(last)).into();
            let name = curve.name();
            Err(call.undefined(&format!(
                "the curve `{name}` has values from {first} to {last}, and not at {x}"
            )))
        }
    }
}

/// Whether a number is where the curve has no value.
fn is_outside(curve: Curve, x: &Expr) -> bool {
    curve.definition().outside == Outside::Undefined
        && (is_negative(&(x - &curve.end_as_argument(false)))
            || is_negative(&(&curve.end_as_argument(true) - x)))
}
