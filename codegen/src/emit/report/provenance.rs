//! The lines of a spec that a kernel comes from.

use crate::derived::KernelKind;
use crate::model::{JointSpec, VelocityFrame};
use std::ops::Range;

/// The statements that a kernel comes from directly, as written; nothing for kernels that follow from several.
pub fn statement(spec: &JointSpec, kind: KernelKind) -> Option<String> {
    let span = match kind {
        KernelKind::Pose => spec.pose.span.clone(),
        KernelKind::TwistMap => match &spec.twist_map {
            Some(declared) => declared.span.clone(),
            // Nothing in the spec says what follows from H alone.
            None if spec.velocity.value == VelocityFrame::Rates => return None,
            None => spec.velocity.span.clone(),
        },
        KernelKind::Constraint => spec.constraint.as_ref()?.span.clone(),
        KernelKind::SpeedBasis => spec.speed_basis.as_ref()?.span.clone(),
        KernelKind::Retract => match &spec.retract {
            Some(declared) => declared.span.clone(),
            None => spec.freedoms.span.clone(),
        },
        KernelKind::Project | KernelKind::Residual | KernelKind::Home => spec.manifold.span.clone(),
        KernelKind::Singularity => spec.loci.first()?.span.clone(),
        _ => return None,
    };
    lines_around(&spec.source, span)
}

/// The full lines that a span touches, without comments, on one line.
fn lines_around(source: &str, span: Range<usize>) -> Option<String> {
    if span.is_empty() {
        return None;
    }
    let start = source.get(..span.start)?.rfind('\n').map_or(0, |at| at + 1);
    let end = source
        .get(span.end..)?
        .find('\n')
        .map_or(source.len(), |at| span.end + at);
    let code = source
        .get(start..end)?
        .lines()
        .map(|line| line.split("//").next().unwrap_or_default().trim());
    let words: Vec<&str> = code.filter(|line| !line.is_empty()).collect();
    let one_line = words
        .join(" ")
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ");
    (!one_line.is_empty()).then_some(one_line)
}
