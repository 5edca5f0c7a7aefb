//! One factor of a manifold as the functions of its group take it.

use crate::algebra::hat;
use crate::derived::KernelKind;
use crate::expand::finite::in_basis;
use crate::expr::{Expr, Role, Symbol};
use crate::manifold::{Factor, Kind};
use crate::model::{Freedom, JointSpec};

/// First index of the symbols made here, above all that a derivation numbers itself and below those of shared terms.
const FIRST_INDEX: usize = 0x4000;

/// How the degrees of freedom of a factor stand to the standard basis of its algebra.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basis {
    /// They are that basis, in its order and side by side.
    Standard,
    /// Another basis of the whole algebra.
    Other,
    /// A basis of a part of it.
    Subalgebra,
}

/// A factor, its place in Q, and its degrees of freedom' places in ϕ.
pub struct Part<'a> {
    /// Its place among the factors.
    pub number: usize,
    /// Where its stored scalars begin.
    pub start: usize,
    /// The places of its degrees of freedom.
    pub freedoms: Vec<usize>,
    /// Its basis.
    pub basis: Basis,
    /// The factor itself.
    pub factor: &'a Factor,
    spec: &'a JointSpec,
}

/// The factors of a joint.
pub fn parts(spec: &JointSpec) -> Vec<Part<'_>> {
    let mut start = 0;
    let factors = spec.manifold.value.factors().iter().enumerate();
    let part = factors.map(|(number, factor)| {
        let all = spec.freedoms.value.iter().enumerate();
        let own = all.filter(|(_, freedom)| freedom.factor == number);
        let freedoms: Vec<usize> = own.map(|(k, _)| k).collect();
        let basis = basis(spec, factor.kind, &freedoms);
        start += factor.coordinates.len();
        Part {
            number,
            start: start - factor.coordinates.len(),
            freedoms,
            basis,
            factor,
            spec,
        }
    });
    part.collect()
}

/// The same with all directions of their algebras as degrees of freedom, in the standard bases.
pub fn parts_of_displacements(spec: &JointSpec) -> Vec<Part<'_>> {
    let mut parts = parts(spec);
    let mut first = 0;
    for part in &mut parts {
        part.freedoms = (first..first + part.dimension()).collect();
        part.basis = Basis::Standard;
        first += part.dimension();
    }
    parts
}

fn basis(spec: &JointSpec, kind: Kind, freedoms: &[usize]) -> Basis {
    let is_unit = |(i, &k): (usize, &usize)| {
        let generator = &spec.freedoms.value[k].generator;
        let mut entries = generator.iter().enumerate();
        entries.all(|(j, entry)| {
            if i == j {
                entry.is_one()
            } else {
                entry.is_zero()
            }
        })
    };
    let is_whole = freedoms.len() == kind.dimension();
    let side_by_side = freedoms.windows(2).all(|pair| pair[1] == pair[0] + 1);
    match is_whole {
        true if side_by_side && freedoms.iter().enumerate().all(is_unit) => Basis::Standard,
        true => Basis::Other,
        false => Basis::Subalgebra,
    }
}

impl Part<'_> {
    /// Which manifold it is.
    pub fn kind(&self) -> Kind {
        self.factor.kind
    }

    /// Number of its stored scalars.
    pub fn stored_size(&self) -> usize {
        self.factor.coordinates.len()
    }

    /// Dimension of its algebra.
    pub fn dimension(&self) -> usize {
        self.factor.kind.dimension()
    }

    /// The function of its group for a kernel; nothing where the kernel leaves the factor as it is.
    pub fn function(&self, kernel: KernelKind) -> Option<&'static str> {
        let is_real = matches!(self.factor.kind, Kind::Real(_));
        let commutes = is_real || matches!(self.factor.kind, Kind::S1 | Kind::So2);
        let name = match kernel {
            KernelKind::Retract => "times_exp",
            KernelKind::Local => "log_between",
            KernelKind::RetractDifferential => "differential",
            KernelKind::RetractDifferentialInverse => "differential_inverse",
            KernelKind::ConfigurationRate => "rate",
            KernelKind::Project => "nearest",
            KernelKind::Residual => "residual_squared",
            _ => return None,
        };
        let is_left = match kernel {
            KernelKind::RetractDifferential | KernelKind::RetractDifferentialInverse => commutes,
            KernelKind::ConfigurationRate | KernelKind::Project | KernelKind::Residual => is_real,
            _ => false,
        };
        (!is_left).then_some(name)
    }

    /// The algebra element `Σ b_k ϕ_k`, in the standard basis.
    pub fn element(&self) -> Vec<Expr> {
        let freedoms = || self.own();
        let entry = |i: usize| {
            freedoms()
                .map(|freedom| &freedom.generator[i] * &Expr::symbol(&freedom.local))
                .sum()
        };
        (0..self.dimension()).map(entry).collect()
    }

    /// The rates `Q v^` of its stored scalars at a velocity with these symbols in the standard basis.
    pub fn rates(&self, velocity: &[Symbol]) -> Vec<Expr> {
        let own = self.freedoms.iter().map(|&k| Expr::symbol(&velocity[k]));
        let element = hat(self.factor.kind, &own.collect::<Vec<_>>());
        self.factor
            .coordinates_of(&self.factor.matrix().times(&element))
    }

    /// The names of the entries of a logarithm, in the standard basis.
    pub fn logarithm(&self) -> Vec<Symbol> {
        let prefix = self.factor.name.to_ascii_lowercase();
        let name = |i: usize| {
            let index = FIRST_INDEX + 8 * self.number + i;
            Symbol::new(Role::Intermediate, index, &format!("{prefix}_log{}", i + 1))
        };
        (0..self.dimension()).map(name).collect()
    }

    /// Each degree of freedom's ϕ from the logarithm, with its place.
    pub fn in_declared_basis(&self) -> Vec<(usize, Expr)> {
        let standard: Vec<Expr> = self.logarithm().iter().map(Expr::symbol).collect();
        let own: Vec<&Freedom> = self.own().collect();
        let values = in_basis(&own, &standard);
        self.freedoms.iter().copied().zip(values).collect()
    }

    fn own(&self) -> impl Iterator<Item = &Freedom> {
        self.freedoms.iter().map(|&k| &self.spec.freedoms.value[k])
    }
}

/// The module of a group in the runtime.
pub fn module(kind: Kind) -> &'static str {
    match kind {
        Kind::Real(_) => "real",
        Kind::S1 => "s1",
        Kind::So2 => "so2",
        Kind::Se2 => "se2",
        Kind::S2 => "s2",
        Kind::S3 => "s3",
        Kind::So3 => "so3",
        Kind::Se3 => "se3",
    }
}
