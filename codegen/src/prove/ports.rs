//! The claims about ports: that each moves, that angles are those of directions, and that P gives the rates.

use super::{Attempt, Prover, refuted};
use crate::diagnostic::Diagnostic;
use crate::expand::ports;
use crate::expr::Expr;
use crate::matrix::Matrix;
use crate::model::{Declared, Port, PortValue};
use crate::spec::code;

impl Prover<'_> {
    /// `cos² + sin² = 1` of each port that is an angle.
    pub(super) fn port_angles(&self) -> Attempt {
        let ports = &self.joint.spec.ports;
        let length = |port: &Declared<Port>| match &port.value.value {
            PortValue::Scalar(_) => Expr::zero(),
            PortValue::Angle { cos, sin } => &(&cos.square() + &sin.square()) - &Expr::one(),
        };
        if !ports.iter().any(|port| port.value.wraps()) {
            return Ok(None);
        }
        let residual = Matrix::column_vector(ports.iter().map(length).collect());
        let statement = "cos² + sin² = 1 of each port that is an angle";
        self.identity("port_angles", statement, &residual, |residual| {
            let (port, entry) = first_of(ports, &residual);
            let message = format!("port `{}` is no angle", port.value.name);
            refuted(code::PORT, &port.span, &message, "no cosine and sine")
                .note(format!("cos² + sin² − 1 = {entry}"))
        })
    }

    /// `P S₀ = ∂y/∂ϕ`, with y the values of the ports.
    pub(super) fn port_rates(&self) -> Attempt {
        let (ports, x) = (&self.joint.spec.ports, self.x);
        if ports.is_empty() {
            return Ok(None);
        }
        let gradient = ports::gradient(ports, &x.motion, self.ideal);
        if let Some(still) =
            (0..ports.len()).find(|&i| (0..gradient.columns()).all(|k| gradient.at(i, k).is_zero()))
        {
            return Err(Box::new(still_port(&ports[still])));
        }
        let residual = x.port_map.times(&x.velocity_map.base).minus(&gradient);
        let statement = self.where_it_holds("P S₀ = ∂y/∂ϕ, y the values of the ports");
        self.identity("port_rates", &statement, &residual, |residual| {
            let (port, entry) = first_of(ports, &residual);
            let message = format!("P does not give the rate of port `{}`", port.value.name);
            refuted(code::PORT, &port.span, &message, "derived from this")
                .note(format!("(P S₀ − ∂y/∂ϕ) has the entry {entry}"))
        })
    }
}

/// The first port whose row of a residual is not zero, and the entry that is not.
fn first_of<'p>(ports: &'p [Declared<Port>], residual: &Matrix) -> (&'p Declared<Port>, Expr) {
    let places = residual.entries().iter().enumerate();
    let mut open = places.filter(|(_, entry)| !entry.is_zero());
    let (place, entry) = open
        .next()
        .map_or((0, Expr::zero()), |(n, e)| (n, e.clone()));
    (&ports[place / residual.columns().max(1)], entry)
}

fn still_port(port: &Declared<Port>) -> Diagnostic {
    let message = format!("no velocity moves port `{}`", port.value.name);
    refuted(code::PORT, &port.span, &message, "stands still")
        .note("its value is the same wherever the joint moves")
        .help("give an angle or a length that changes as the joint moves")
}
