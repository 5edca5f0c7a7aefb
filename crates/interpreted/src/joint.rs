//! [`Interpreted`]: a joint whose kernels are tapes.

use crate::kernels::{BodyKernels, KernelTape, Kernels};
use crate::tape::Places;
use hamel_codegen::derived::{KernelKind, Method, Structure};
use hamel_runtime::erased::{Shared, erase};
use hamel_runtime::finite;
use hamel_runtime::joint::{
    Facts, Joint, Patterns, Port, Products, Structures, Units, VelocityFrame, from_rows,
};
use hamel_runtime::nalgebra::{ArrayStorage, SMatrix, SVector};
use hamel_runtime::scalar::Scalar;
use hamel_runtime::spatial::Pose;
use std::fmt::{Debug, Formatter};
use std::sync::Arc;

/// Most relations of a joint, those of its known factors among them.
pub const MOST_RELATIONS: usize = 24;

/// A joint whose kernels are evaluated operation by operation, in any scalar, with the values of its parameters.
///
/// It has room for N stored scalars, of which the last may be [idle](Joint::idle), and where relations alone say how it moves for R of these and for G = K + R
/// displacements of Q; R = 0 and G = K otherwise. Unlike joints that are compiled it may allocate while it is evaluated, and what is trivial of it only
/// [`Joint::facts`] tells, not the constants of its type.
#[derive(Clone)]
pub struct Interpreted<
    const N: usize,
    const K: usize,
    const S: usize,
    const C: usize,
    const R: usize,
    const G: usize,
> {
    pub(crate) kernels: Arc<Kernels>,
    parameters: Arc<[f64]>,
    body: usize,
}

impl<const N: usize, const K: usize, const S: usize, const C: usize, const R: usize, const G: usize>
    Debug for Interpreted<N, K, S, C, R, G>
{
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Interpreted")
            .field("name", &self.kernels.facts.name)
            .field("parameters", &self.parameters)
            .field("body", &self.body)
            .finish()
    }
}

impl<const N: usize, const K: usize, const S: usize, const C: usize, const R: usize, const G: usize>
    Interpreted<N, K, S, C, R, G>
{
    /// The joint as its first body sees it, for values of its parameters that have been checked.
    pub(crate) const fn new(kernels: Arc<Kernels>, parameters: Arc<[f64]>) -> Self {
        Self {
            kernels,
            parameters,
            body: 0,
        }
    }

    fn own(&self) -> &BodyKernels {
        &self.kernels.bodies[self.body]
    }

    /// The kernel: of this body where bodies differ in it, else of the joint.
    fn kernel(&self, kind: KernelKind) -> Option<&KernelTape> {
        match kind.is_of_body() {
            true => self.own().tape(kind),
            false => self.kernels.bodies[0].tape(kind),
        }
    }

    /// Whether formulas give the kernel.
    fn has_formula(&self, kind: KernelKind) -> bool {
        let kernel = self.kernel(kind);
        kernel.is_none_or(|kernel| kernel.method == Method::Formula)
    }

    fn is_zero(&self, kind: KernelKind) -> bool {
        let kernel = self.kernel(kind);
        kernel.is_none_or(|kernel| kernel.structure == Structure::Zero)
    }

    /// Writes what the kernel gives into `out`, which keeps what it has where there is no such kernel.
    fn run<T: Scalar>(
        &self,
        kernel: Option<&KernelTape>,
        arguments: &[&[T]],
        to: (&mut [T], Places),
    ) {
        if let Some(kernel) = kernel {
            kernel.tape.run(arguments, &self.parameters, to);
        }
    }

    /// All that the kernel gives, one after the other.
    fn values<T: Scalar>(&self, kernel: &KernelTape, arguments: &[&[T]]) -> Vec<T> {
        let mut values = vec![T::zero(); kernel.tape.outputs()];
        let to = (values.as_mut_slice(), Places::IN_ORDER);
        kernel.tape.run(arguments, &self.parameters, to);
        values
    }

    /// A column, with zeros behind what the kernel gives; zeros where there is no such kernel.
    pub(crate) fn column<T: Scalar, const D: usize>(
        &self,
        kind: KernelKind,
        arguments: &[&[T]],
    ) -> SVector<T, D> {
        let mut column = [[T::zero(); D]];
        let to = (column.as_flattened_mut(), Places::IN_ORDER);
        self.run(self.kernel(kind), arguments, to);
        of_columns(column)
    }

    /// A matrix, with zeros beside and below what the kernel gives.
    pub(crate) fn matrix<T: Scalar, const ROWS: usize, const COLUMNS: usize>(
        &self,
        kind: KernelKind,
        arguments: &[&[T]],
    ) -> SMatrix<T, ROWS, COLUMNS> {
        let mut matrix = [[T::zero(); ROWS]; COLUMNS];
        let kernel = self.kernel(kind);
        let places = Places {
            columns: kernel.map_or(1, KernelTape::columns),
            rows: ROWS,
            ..Places::IN_ORDER
        };
        self.run(kernel, arguments, (matrix.as_flattened_mut(), places));
        of_columns(matrix)
    }

    /// A matrix for each ϕ_k.
    fn slices<T: Scalar, const ROWS: usize, const COLUMNS: usize>(
        &self,
        kind: KernelKind,
        arguments: &[&[T]],
    ) -> [SMatrix<T, ROWS, COLUMNS>; K] {
        let mut slices = [[[T::zero(); ROWS]; COLUMNS]; K];
        if !self.is_zero(kind) {
            let places = Places {
                columns: COLUMNS,
                rows: ROWS,
                matrix: ROWS * COLUMNS,
            };
            let out = slices.as_flattened_mut().as_flattened_mut();
            self.run(self.kernel(kind), arguments, (out, places));
        }
        slices.map(of_columns)
    }

    /// The entries by rows.
    pub(crate) fn fill<T: Scalar>(&self, kind: KernelKind, arguments: &[&[T]], out: &mut [T]) {
        self.run(self.kernel(kind), arguments, (out, Places::IN_ORDER));
    }

    /// Rows of a fixed size, as many as the kernel gives.
    pub(crate) fn rows<T: Scalar, const COLUMNS: usize>(
        &self,
        kind: KernelKind,
        arguments: &[&[T]],
    ) -> Vec<[T; COLUMNS]> {
        let outputs = self.kernel(kind).map_or(0, |kernel| kernel.tape.outputs());
        let mut rows = vec![[T::zero(); COLUMNS]; outputs / COLUMNS.max(1)];
        self.fill(kind, arguments, rows.as_flattened_mut());
        rows
    }

    /// All relations of the manifold, with zeros behind them.
    pub(crate) fn all_relations<T: Scalar>(&self, q: &SVector<T, N>) -> SVector<T, MOST_RELATIONS> {
        self.column(KernelKind::Relations, &[q.as_slice()])
    }

    /// Where an iteration begins: at the value of the kernel's formulas, or at q where it has none.
    pub(crate) fn start<T: Scalar>(
        &self,
        kind: KernelKind,
        q: Option<&SVector<T, N>>,
    ) -> SVector<T, N> {
        let has_some = self
            .kernel(kind)
            .is_some_and(|kernel| kernel.tape.outputs() > 0);
        match q {
            Some(q) if !has_some => *q,
            Some(q) => self.column(kind, &[q.as_slice()]),
            None => self.column(kind, &[]),
        }
    }
}

fn of_columns<T, const ROWS: usize, const COLUMNS: usize>(
    columns: [[T; ROWS]; COLUMNS],
) -> SMatrix<T, ROWS, COLUMNS> {
    SMatrix::from_array_storage(ArrayStorage(columns))
}

impl<const N: usize, const K: usize, const S: usize, const C: usize, const R: usize, const G: usize>
    Joint<N, K, S, C> for Interpreted<N, K, S, C, R, G>
{
    const NAME: &'static str = "interpreted";
    const COORDINATES: [&'static str; N] = [""; N];
    const FREEDOMS: [&'static str; K] = [""; K];
    const SPEEDS: [&'static str; S] = [""; S];
    const VELOCITY_FRAME: VelocityFrame = VelocityFrame::Declared;
    const STRUCTURES: Structures = Structures::GENERAL;
    const PATTERNS: Patterns<K, S> = Patterns::DENSE;
    const HAS_PORTS: bool = true;
    const UNIDENTIFIABLE: &'static [[f64; 10]] = &[];
    const SINGULARITIES: &'static [&'static str] = &[];

    fn facts(&self) -> Facts {
        let own = &self.own().facts;
        Facts {
            structures: own.structures,
            unidentifiable: own.unidentifiable,
            ..self.kernels.facts
        }
    }

    fn moves_body(&self, freedom: usize) -> bool {
        let moves = self.own().facts.moves.get(freedom);
        moves.is_some_and(|moves| *moves)
    }

    fn units(&self) -> Units {
        self.kernels.units
    }

    fn ports(&self) -> &'static [Port] {
        self.kernels.ports
    }

    fn bodies(&self) -> &'static [&'static str] {
        self.kernels.body_names
    }

    fn body(&self) -> usize {
        self.body
    }

    fn idle(&self) -> usize {
        N.saturating_sub(self.kernels.stored)
    }

    fn more(&self, visit: &mut dyn FnMut(Shared)) {
        for body in 1..self.kernels.bodies.len() {
            visit(erase(Self {
                body,
                ..self.clone()
            }));
        }
    }

    fn parameters(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let names = self.kernels.parameters.iter().copied();
        names.zip(self.parameters.iter().copied())
    }

    fn home<T: Scalar>(&self) -> SVector<T, N> {
        let start = self.start(KernelKind::Home, None);
        match (self.has_formula(KernelKind::Home), self.kernels.implicit) {
            (true, _) => start,
            (false, true) => self.assembled(&start),
            (false, false) => {
                finite::project(&start, self.kernels.codimension, |q| self.all_relations(q))
            }
        }
    }

    fn pose<T: Scalar>(&self, q: &SVector<T, N>) -> Pose<T> {
        let (zero, one) = (T::zero(), T::one());
        // The rotation by rows, then the translation: the identity where there is no such kernel.
        let mut rows = [
            [one, zero, zero],
            [zero, one, zero],
            [zero, zero, one],
            [zero; 3],
        ];
        self.fill(KernelKind::Pose, &[q.as_slice()], rows.as_flattened_mut());
        let [x, y, z, translation] = rows;
        Pose {
            rotation: from_rows([x, y, z]),
            translation: translation.into(),
        }
    }

    fn twist_map<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, 6, K> {
        self.matrix(KernelKind::TwistMap, &[q.as_slice()])
    }

    fn twist_map_child<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, 6, K> {
        self.matrix(KernelKind::TwistMapChild, &[q.as_slice()])
    }

    fn twist_map_child_gradient<T: Scalar>(&self, q: &SVector<T, N>) -> [SMatrix<T, 6, K>; K] {
        self.slices(KernelKind::TwistMapChildGradient, &[q.as_slice()])
    }

    fn velocity_map<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, K, K> {
        self.matrix(KernelKind::VelocityMap, &[q.as_slice()])
    }

    fn velocity_map_inverse<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, K, K> {
        self.matrix(KernelKind::VelocityMapInverse, &[q.as_slice()])
    }

    fn velocity_map_gradient<T: Scalar>(&self, q: &SVector<T, N>) -> [SMatrix<T, K, K>; K] {
        self.slices(KernelKind::VelocityMapGradient, &[q.as_slice()])
    }

    fn gamma<T: Scalar>(&self, q: &SVector<T, N>, v: &SVector<T, K>) -> SMatrix<T, K, K> {
        self.matrix(KernelKind::Gamma, &[q.as_slice(), v.as_slice()])
    }

    fn j22<T: Scalar>(&self, q: &SVector<T, N>, p: &SVector<T, K>) -> SMatrix<T, K, K> {
        self.matrix(KernelKind::J22, &[q.as_slice(), p.as_slice()])
    }

    fn constraint<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, K, C> {
        self.matrix(KernelKind::Constraint, &[q.as_slice()])
    }

    fn speed_basis<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, K, S> {
        self.matrix(KernelKind::SpeedBasis, &[q.as_slice()])
    }

    fn speed_basis_gradient<T: Scalar>(&self, q: &SVector<T, N>) -> [SMatrix<T, K, S>; K] {
        self.slices(KernelKind::SpeedBasisGradient, &[q.as_slice()])
    }

    fn port_map<T: Scalar>(&self, q: &SVector<T, N>) -> impl AsRef<[[T; K]]> {
        self.rows::<T, K>(KernelKind::PortMap, &[q.as_slice()])
    }

    fn port_values<T: Scalar>(&self, q: &SVector<T, N>) -> impl AsRef<[T]> {
        let kernel = self.kernel(KernelKind::PortValues);
        kernel.map_or(vec![], |kernel| self.values(kernel, &[q.as_slice()]))
    }

    fn pins<T: Scalar>(&self, q: &SVector<T, N>) -> impl AsRef<[[T; 9]]> {
        self.rows::<T, 9>(KernelKind::Pins, &[q.as_slice()])
    }

    fn relation_twists<T: Scalar>(&self, q: &SVector<T, N>) -> impl AsRef<[[T; 6]]> {
        self.twists_of_relations(q)
    }

    fn relation_ports<T: Scalar>(&self, q: &SVector<T, N>) -> impl AsRef<[T]> {
        self.ports_of_relations(q)
    }

    fn configuration_rate<T: Scalar>(&self, q: &SVector<T, N>, v: &SVector<T, K>) -> SVector<T, N> {
        self.column(KernelKind::ConfigurationRate, &[q.as_slice(), v.as_slice()])
    }

    fn retract<T: Scalar>(&self, q: &SVector<T, N>, phi: &SVector<T, K>) -> SVector<T, N> {
        match self.has_formula(KernelKind::Retract) {
            true => self.column(KernelKind::Retract, &[q.as_slice(), phi.as_slice()]),
            false => self.retract_by_relations(q, phi),
        }
    }

    fn local<T: Scalar>(&self, q: &SVector<T, N>, target: &SVector<T, N>) -> SVector<T, K> {
        if self.has_formula(KernelKind::Local) {
            return self.column(KernelKind::Local, &[q.as_slice(), target.as_slice()]);
        }
        match self.kernels.implicit {
            true => self.local_by_relations(q, target),
            false => finite::local(q, target, |q, phi| self.retract(q, phi)),
        }
    }

    fn retract_differential<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        phi: &SVector<T, K>,
    ) -> SMatrix<T, K, K> {
        if self.has_formula(KernelKind::RetractDifferential) {
            let arguments = [q.as_slice(), phi.as_slice()];
            return self.matrix(KernelKind::RetractDifferential, &arguments);
        }
        match self.kernels.implicit {
            true => self.differential_by_relations(q, phi),
            false => finite::differential(q, phi, |q, phi| self.retract(q, phi)),
        }
    }

    fn retract_differential_inverse<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        phi: &SVector<T, K>,
        rate: &SVector<T, K>,
    ) -> SVector<T, K> {
        if self.has_formula(KernelKind::RetractDifferentialInverse) {
            let arguments = [q.as_slice(), phi.as_slice(), rate.as_slice()];
            return self.column(KernelKind::RetractDifferentialInverse, &arguments);
        }
        match self.kernels.implicit {
            true => self.differential_inverse_by_relations(q, phi, rate),
            false => finite::differential_inverse(q, phi, rate, |q, phi| self.retract(q, phi)),
        }
    }

    fn project<T: Scalar>(&self, q: &SVector<T, N>) -> SVector<T, N> {
        let start = self.start(KernelKind::Project, Some(q));
        match (self.has_formula(KernelKind::Project), self.kernels.implicit) {
            (true, _) => start,
            (false, true) => self.project_by_displacements(&start),
            (false, false) => {
                finite::project(&start, self.kernels.codimension, |q| self.all_relations(q))
            }
        }
    }

    fn residual<T: Scalar>(&self, q: &SVector<T, N>) -> T {
        let mut sum = T::zero();
        if let Some(kernel) = self.kernel(KernelKind::Residual) {
            for relation in self.values(kernel, &[q.as_slice()]) {
                sum = relation.mul_add(relation, sum);
            }
        }
        match self.is_zero(KernelKind::Residual) {
            true => T::zero(),
            false => sum.sqrt(),
        }
    }

    fn singularity<T: Scalar>(&self, q: &SVector<T, N>) -> T {
        let mut least = finite::least_absolute([]);
        if let Some(kernel) = self.kernel(KernelKind::Singularity) {
            let functions = kernel.rows();
            let values = self.values(kernel, &[q.as_slice()]);
            for (i, value) in values.into_iter().enumerate() {
                least = match i {
                    0 => finite::least_absolute([value]),
                    i if i < functions => finite::least_absolute([least, value]),
                    _ => T::select(T::zero().less(value), least, T::zero()),
                };
            }
        }
        least
    }

    fn bias_acceleration<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        speeds: &SVector<T, S>,
    ) -> SVector<T, 6> {
        match self.formula_of_bias(KernelKind::BiasAcceleration) {
            true => self.column(
                KernelKind::BiasAcceleration,
                &[q.as_slice(), speeds.as_slice()],
            ),
            false => self.bias_acceleration_by_products(q, speeds),
        }
    }

    fn bias_momentum<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        speeds: &SVector<T, S>,
        h: &SVector<T, 6>,
    ) -> SVector<T, S> {
        match self.formula_of_bias(KernelKind::BiasMomentum) {
            true => self.column(
                KernelKind::BiasMomentum,
                &[q.as_slice(), speeds.as_slice(), h.as_slice()],
            ),
            false => self.bias_momentum_by_products(q, speeds, h),
        }
    }
}

impl<const N: usize, const K: usize, const S: usize, const C: usize, const R: usize, const G: usize>
    Interpreted<N, K, S, C, R, G>
{
    /// Whether c or its dual has a formula here, as the emitted joint has it: the first body's may, those of others come by products.
    fn formula_of_bias(&self, kind: KernelKind) -> bool {
        let kernel = self.kernel(kind);
        kernel.is_some_and(|kernel| self.body == 0 && !kernel.by_products)
    }
}
