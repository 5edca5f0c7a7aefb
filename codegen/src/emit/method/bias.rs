//! c = Ẋ̄^c v̄ and its dual: by products of other kernels, as the runtime forms them, or by formulas of their own.

use super::Method;
use super::absent::{Absent, absent};
use crate::derived::{Derived, Kernel, KernelKind, Structure};
use crate::formula::Counts;
use crate::matrix::Matrix;

/// A formula of its own is written where the products take more than this many times its work, with function calls as [`Counts::work`]
/// weighs them: below that, a reader is better served by the definition than by a second derivation of the same.
pub const WORTH_WRITING: usize = 2;

/// Whether the runtime's products serve instead of the formula of this kernel of c or its dual.
pub fn is_by_products(derived: &Derived, kernel: &Kernel) -> bool {
    let own = Counts::of_program(derived.program(kernel));
    let products = operations(derived, kernel.kind);
    products.work() <= WORTH_WRITING * own.work()
}

/// The operations of the runtime's products where these serve instead of a kernel's own formula.
pub fn products(derived: &Derived, kernel: &Kernel) -> Option<Counts> {
    let is_absent = absent(derived, kernel) == Some(Absent::ByProducts);
    is_absent.then(|| operations(derived, kernel.kind))
}

/// The operations of the runtime's products: those of the kernels that they evaluate, and their own.
pub fn operations(derived: &Derived, kind: KernelKind) -> Counts {
    let mut counts = velocity(derived);
    counts += local_rate(derived);
    counts += by_slices(derived, kind, KernelKind::TwistMapChildGradient);
    if !is_zero(derived, KernelKind::TwistMapChildGradient) && kind == KernelKind::BiasMomentum {
        counts += velocity(derived);
    }
    if !is_zero(derived, KernelKind::SpeedBasisGradient) {
        counts += by_slices(derived, kind, KernelKind::SpeedBasisGradient);
        counts += product(derived, KernelKind::TwistMapChild);
    }
    counts
}

/// `S̄ v̄`, or `S̄ᵀ` of efforts.
fn velocity(derived: &Derived) -> Counts {
    let of = derived.kernel(KernelKind::SpeedBasis);
    match of.map(|kernel| kernel.structure) {
        Some(Structure::Identity) | None => Counts::default(),
        _ => product(derived, KernelKind::SpeedBasis),
    }
}

/// `S₀⁻¹ v`.
fn local_rate(derived: &Derived) -> Counts {
    let of = derived.kernel(KernelKind::VelocityMap);
    if of.is_none_or(|kernel| kernel.structure == Structure::Identity) {
        return Counts::default();
    }
    let mut counts = evaluated(derived, KernelKind::VelocityMapInverse);
    counts += fused(derived.shape.freedoms * derived.shape.freedoms);
    counts
}

/// The sum over the slices of a derivative, each times a vector and times a rate.
fn by_slices(derived: &Derived, kind: KernelKind, slices: KernelKind) -> Counts {
    let mut counts = Counts::default();
    if is_zero(derived, slices) {
        return counts;
    }
    counts += product(derived, slices);
    for slice in outputs(derived, slices) {
        let is_used =
            |entries: Vec<crate::expr::Expr>| entries.iter().any(|entry| !entry.is_zero());
        let lines = match kind {
            KernelKind::BiasMomentum => slice.transpose(),
            _ => slice.clone(),
        };
        let used = (0..lines.rows()).filter(|&i| is_used(lines.transpose().column(i)));
        counts += fused(used.count());
    }
    counts
}

/// A kernel and its product with a vector.
fn product(derived: &Derived, kind: KernelKind) -> Counts {
    let mut counts = evaluated(derived, kind);
    for entry in outputs(derived, kind).iter().flat_map(Matrix::entries) {
        counts += match (entry.is_zero(), entry.is_one()) {
            (true, _) => Counts::default(),
            (_, true) => Counts {
                additions: 1,
                ..Counts::default()
            },
            _ => fused(1),
        };
    }
    counts
}

fn evaluated(derived: &Derived, kind: KernelKind) -> Counts {
    let names = derived.names();
    let kernel = derived.kernel(kind);
    kernel.map_or_else(Counts::default, |kernel| {
        Method::new(derived, kernel, &names).counts()
    })
}

fn outputs(derived: &Derived, kind: KernelKind) -> &[Matrix] {
    derived.kernel(kind).map_or(&[], |kernel| &kernel.outputs)
}

fn is_zero(derived: &Derived, kind: KernelKind) -> bool {
    derived
        .kernel(kind)
        .is_none_or(|kernel| kernel.structure == Structure::Zero)
}

fn fused(count: usize) -> Counts {
    Counts {
        additions: count,
        multiplications: count,
        fused: count,
        ..Counts::default()
    }
}
