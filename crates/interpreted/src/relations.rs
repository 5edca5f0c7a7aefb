//! What is found by the relations of a manifold where these alone say how Q moves: as emitted joints find it, by the iterations of [`finite`].
//!
//! A joint of r relations in a group of dimension g = K + r has room for R of them and G = K + R displacements: of the others each relation is the
//! displacement of that number, so that all systems stay square and regular, and none of them moves Q.

use crate::joint::Interpreted;
use hamel_codegen::derived::KernelKind;
use hamel_runtime::finite;
use hamel_runtime::nalgebra::{SMatrix, SVector};
use hamel_runtime::scalar::Scalar;

type Bases<T, const K: usize, const R: usize, const G: usize> =
    (SMatrix<T, G, K>, SMatrix<T, G, R>);

impl<const N: usize, const K: usize, const S: usize, const C: usize, const R: usize, const G: usize>
    Interpreted<N, K, S, C, R, G>
{
    /// For each displacement that is not used, 1 at its row and its column: those of `first` on.
    fn with_idle<T: Scalar, const ROWS: usize, const COLUMNS: usize>(
        &self,
        mut matrix: SMatrix<T, ROWS, COLUMNS>,
        first: (usize, usize),
    ) -> SMatrix<T, ROWS, COLUMNS> {
        for i in 0..G - self.kernels.displacements.min(G) {
            matrix[(first.0 + i, first.1 + i)] = T::one();
        }
        matrix
    }

    fn tangent_basis<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, G, K> {
        self.matrix(KernelKind::TangentBasis, &[q.as_slice()])
    }

    fn normal_basis<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, G, R> {
        let normal = self.matrix(KernelKind::NormalBasis, &[q.as_slice()]);
        self.with_idle(normal, (self.kernels.displacements, self.kernels.declared))
    }

    /// B and N.
    fn bases<T: Scalar>(&self, q: &SVector<T, N>) -> Bases<T, K, R, G> {
        (self.tangent_basis(q), self.normal_basis(q))
    }

    /// The declared relations.
    fn relations<T: Scalar>(&self, q: &SVector<T, N>) -> SVector<T, R> {
        let (all, own) = (self.all_relations(q), self.kernels.own);
        SVector::from_fn(|i, _| match i < self.kernels.declared {
            true => all[own + i],
            false => T::zero(),
        })
    }

    fn relation_gradient<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, R, G> {
        let gradient = self.matrix(KernelKind::RelationGradient, &[q.as_slice()]);
        self.with_idle(
            gradient,
            (self.kernels.declared, self.kernels.displacements),
        )
    }

    fn displaced<T: Scalar>(&self, q: &SVector<T, N>, xi: &SVector<T, G>) -> SVector<T, N> {
        self.column(KernelKind::Displaced, &[q.as_slice(), xi.as_slice()])
    }

    fn displacement<T: Scalar>(&self, q: &SVector<T, N>, target: &SVector<T, N>) -> SVector<T, G> {
        self.column(KernelKind::Displacement, &[q.as_slice(), target.as_slice()])
    }

    /// dexp(ξ); nothing where it is the identity.
    fn displaced_differential<T: Scalar>(&self, xi: &SVector<T, G>) -> Option<SMatrix<T, G, G>> {
        let kind = KernelKind::DisplacedDifferential;
        self.kernels.bodies[0].tape(kind)?;
        let differential = self.matrix(kind, &[xi.as_slice()]);
        let first = self.kernels.displacements;
        Some(self.with_idle(differential, (first, first)))
    }

    /// Φ.
    pub(crate) fn retract_by_relations<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        phi: &SVector<T, K>,
    ) -> SVector<T, N> {
        finite::retract(
            phi,
            self.bases(q),
            |xi| self.displaced(q, xi),
            |q, xi| {
                let gradient = self.relation_gradient(q);
                let along = match self.displaced_differential(xi) {
                    Some(differential) => gradient * differential,
                    None => gradient,
                };
                (self.relations(q), along)
            },
        )
    }

    /// The inverse of Φ.
    pub(crate) fn local_by_relations<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        target: &SVector<T, N>,
    ) -> SVector<T, K> {
        finite::along_tangent(&self.displacement(q, target), self.bases(q))
    }

    /// D.
    pub(crate) fn differential_by_relations<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        phi: &SVector<T, K>,
    ) -> SMatrix<T, K, K> {
        let moved = self.retract_by_relations(q, phi);
        let rates = self.displacement_rates(q, &moved, self.tangent_basis(&moved));
        finite::inverse(&finite::along_tangent(&rates, self.bases(q)))
    }

    /// D⁻¹ of a rate.
    pub(crate) fn differential_inverse_by_relations<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        phi: &SVector<T, K>,
        rate: &SVector<T, K>,
    ) -> SVector<T, K> {
        let moved = self.retract_by_relations(q, phi);
        let rates = self.displacement_rates(q, &moved, self.tangent_basis(&moved) * rate);
        finite::along_tangent(&rates, self.bases(q))
    }

    /// The rates of the displacement from Q to Q′, where Q′⁻¹Q̇′ has the values `there`.
    fn displacement_rates<T: Scalar, const M: usize>(
        &self,
        q: &SVector<T, N>,
        moved: &SVector<T, N>,
        there: SMatrix<T, G, M>,
    ) -> SMatrix<T, G, M> {
        match self.displaced_differential(&self.displacement(q, moved)) {
            Some(differential) => finite::least_squares(&differential, &there),
            None => there,
        }
    }

    /// The home that a guess means.
    pub(crate) fn assembled<T: Scalar>(&self, guess: &SVector<T, N>) -> SVector<T, N> {
        finite::assemble(
            guess,
            self.kernels.codimension,
            |q| self.all_relations(q),
            |q| self.relation_gradient(q) * self.normal_basis(q),
        )
    }

    /// The nearest configuration on the manifold.
    pub(crate) fn project_by_displacements<T: Scalar>(
        &self,
        start: &SVector<T, N>,
    ) -> SVector<T, N> {
        finite::project_by_displacements(
            start,
            |q, xi| self.displaced(q, xi),
            |q| (self.relations(q), self.relation_gradient(q)),
        )
    }

    /// N (∂φ N)⁻¹.
    fn relation_displacements<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, G, R> {
        let normal = self.normal_basis(q);
        normal * finite::inverse(&(self.relation_gradient(q) * normal))
    }

    /// The twists of the body at the displacement rate of each relation.
    pub(crate) fn twists_of_relations<T: Scalar>(&self, q: &SVector<T, N>) -> Vec<[T; 6]> {
        if !self.kernels.implicit {
            return vec![];
        }
        let along: SMatrix<T, 6, G> = self.matrix(KernelKind::RelationTwists, &[q.as_slice()]);
        let twists = along * self.relation_displacements(q);
        let twist = |j: usize| std::array::from_fn(|i| twists[(i, j)]);
        (0..self.kernels.declared).map(twist).collect()
    }

    /// The rates of the ports at these displacement rates, relation by relation.
    pub(crate) fn ports_of_relations<T: Scalar>(&self, q: &SVector<T, N>) -> Vec<T> {
        if !self.kernels.implicit || self.kernels.ports.is_empty() {
            return vec![];
        }
        let (displacements, size) = (self.relation_displacements(q), self.kernels.displacements);
        let mut rates = vec![T::zero(); self.kernels.ports.len() * self.kernels.declared];
        let mut along = vec![T::zero(); self.kernels.ports.len() * size];
        self.fill(KernelKind::RelationPorts, &[q.as_slice()], &mut along);
        let ports = self.kernels.ports.len();
        for (n, rate) in rates.iter_mut().enumerate() {
            let (relation, port) = (n / ports, n % ports);
            let row = along.iter().skip(port * size).take(size).enumerate();
            *rate = row.fold(T::zero(), |sum, (i, along)| {
                along.mul_add(displacements[(i, relation)], sum)
            });
        }
        rates
    }
}
