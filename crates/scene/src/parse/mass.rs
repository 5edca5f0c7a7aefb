//! Mass, centre of mass and inertia of a body.

use crate::diagnostics::Diagnostic;
use crate::read::{Fields, Sink, Value};
use crate::source::Span;
use hamel_runtime::spatial::{MassError, MassProperties};
use nalgebra::{Matrix3, SVector, Vector3};

/// Where each part stands in the file.
struct Spans {
    mass: Span,
    com: Span,
    inertia: Span,
}

/// Reads the mass properties and checks that a rigid body can have them.
pub(super) fn mass(fields: &mut Fields<'_>, sink: &mut Sink) -> Option<MassProperties> {
    let mass = fields
        .required("mass", sink)
        .and_then(|mass| mass.number(sink));
    let com = match fields.optional("com") {
        Some(com) => com.vector(sink).map(|com| (com.value, com.span)),
        None => Some((Vector3::zeros(), fields.span())),
    };
    let inertia = inertia(fields, sink);
    let (mass, (com, com_span), (inertia, inertia_span)) = (mass?, com?, inertia?);
    let spans = Spans {
        mass: mass.span,
        com: com_span,
        inertia: inertia_span,
    };
    MassProperties::new(mass.value, com, inertia)
        .map_err(|error| sink.push(refusal(fields.owner(), &error, spans)))
        .ok()
}

fn inertia(fields: &mut Fields<'_>, sink: &mut Sink) -> Option<(Matrix3<f64>, Span)> {
    let (way, value) = fields.exactly_one(&["inertia", "inertia_xx_yy_zz_xy_xz_yz"], sink)?;
    let matrix = if way == 0 {
        value.matrix3(sink)?.value
    } else {
        from_six(&value, sink)?
    };
    Some((matrix, value.span()))
}

fn from_six(value: &Value<'_>, sink: &mut Sink) -> Option<Matrix3<f64>> {
    let six: SVector<f64, 6> = value.vector(sink)?.value;
    let [xx, yy, zz, xy, xz, yz] = six.into();
    Some(Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz))
}

fn refusal(owner: &str, error: &MassError, spans: Spans) -> Diagnostic {
    let span = match error {
        MassError::NegativeMass { .. } => spans.mass,
        MassError::NotFinite { .. } => spans.com,
        // All others are of the inertia.
        _ => spans.inertia,
    };
    Diagnostic::new(span, format!("{owner}{error}"))
}
