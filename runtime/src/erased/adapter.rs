//! [`AnyJoint`] for every [`Joint`]: sizes are checked here, once a call, and what is done is done on arrays.

use super::extended::check_finite;
use super::kernels::{kernels, operand, passed_on};
use super::slices::{Store, array, array_mut, nan, vector};
use super::stored::{self, stored};
use super::{AnyJoint, ExtendedJoint, FiniteMapError, Layout, Shared, Sizes};
use crate::joint::{Joint, Pin, Port, PortLaw, Products, Structures, Units, VelocityFrame};
use crate::matrix::{of_columns, product, transposed_product, zeros};
use crate::spatial::{ArticulatedInertia, Pose, SpatialInertia};
use crate::steps::{
    AtPort, Carrying, ChartDerivatives, EffortLaw, Field, Motion, MotionGradient, Pivot,
    PivotFailure, Placement, RotorTerm, Steps, Variation, VirtualState,
};
use alloc::sync::Arc;
use alloc::vec::Vec;
use nalgebra::{Matrix3, SVector, Vector6};

impl<J, const N: usize, const K: usize, const S: usize, const C: usize> AnyJoint
    for (J, Sizes<N, K, S, C>)
where
    J: Joint<N, K, S, C>,
{
    fn extended(self: Arc<Self>) -> Arc<dyn ExtendedJoint> {
        self
    }

    fn name(&self) -> &'static str {
        self.0.facts().name
    }

    fn layout(&self) -> Layout {
        Layout {
            configuration: stored::size(&self.0),
            freedoms: K,
            speeds: S,
            constraints: C,
        }
    }

    fn bodies(&self) -> &'static [&'static str] {
        self.0.bodies()
    }

    fn body(&self) -> usize {
        self.0.body()
    }

    fn more(&self) -> Vec<Shared> {
        let mut more = Vec::new();
        self.0.more(&mut |joint| more.push(joint));
        more
    }

    fn structures(&self) -> Structures {
        self.0.facts().structures
    }

    fn velocity_frame(&self) -> VelocityFrame {
        self.0.facts().velocity_frame
    }

    fn coordinates(&self) -> &'static [&'static str] {
        stored::used(&self.0, self.0.facts().coordinates)
    }

    fn relations(&self) -> &'static [&'static str] {
        stored::used(&self.0, self.0.facts().relations)
    }

    fn relation_units(&self) -> &'static [&'static str] {
        stored::used(&self.0, self.0.facts().relation_units)
    }

    fn units(&self) -> Units {
        self.0.units()
    }

    fn ports(&self) -> &'static [Port] {
        self.0.ports()
    }

    fn pins(&self) -> &'static [Pin] {
        self.0.facts().pins
    }

    fn freedoms(&self) -> &'static [&'static str] {
        self.0.facts().freedoms
    }

    fn speeds(&self) -> &'static [&'static str] {
        self.0.facts().speeds
    }

    fn unidentifiable(&self) -> &'static [[f64; 10]] {
        self.0.facts().unidentifiable
    }

    fn singularities(&self) -> &'static [&'static str] {
        self.0.facts().singularities
    }

    fn parameters(&self, visit: &mut dyn FnMut(&'static str, f64)) {
        for (name, value) in self.0.parameters() {
            visit(name, value);
        }
    }

    fn home(&self, out: &mut [f64]) {
        stored::store(&self.0, &self.0.home(), out);
    }

    fn configuration_rate(&self, q: &[f64], v: &[f64], out: &mut [f64]) {
        let rate = self.0.configuration_rate(&stored(&self.0, q), &vector(v));
        stored::store(&self.0, &rate, out);
    }

    fn retract(&self, q: &[f64], phi: &[f64], out: &mut [f64]) {
        let moved = self.0.retract(&stored(&self.0, q), &vector(phi));
        stored::store(&self.0, &moved, out);
    }

    kernels!(passed_on);

    fn pose(&self, q: &[f64]) -> Pose<f64> {
        self.0.pose(&stored(&self.0, q))
    }

    fn residual(&self, q: &[f64]) -> f64 {
        self.0.residual(&stored(&self.0, q))
    }

    fn singularity(&self, q: &[f64]) -> f64 {
        self.0.singularity(&stored(&self.0, q))
    }

    fn bias_acceleration(&self, q: &[f64], speeds: &[f64]) -> Vector6<f64> {
        self.0
            .bias_acceleration(&stored(&self.0, q), &vector(speeds))
    }

    fn local(&self, q: &[f64], target: &[f64], phi: &mut [f64]) -> Result<(), FiniteMapError> {
        self.0
            .local(&stored(&self.0, q), &stored(&self.0, target))
            .store(phi);
        check_finite(self.0.facts().name, "local coordinates", phi, K)
    }

    fn project(&self, q: &mut [f64]) -> Result<(), FiniteMapError> {
        let found = self.0.project(&stored(&self.0, q));
        stored::store(&self.0, &found, q);
        check_finite(self.0.facts().name, "projection", q, stored::size(&self.0))
    }

    fn local_rate(&self, q: &[f64], phi: &[f64], moved: &[f64], speeds: &[f64], out: &mut [f64]) {
        let joint = &self.0;
        let moved = stored(joint, moved);
        let velocity: SVector<f64, K> = match const { J::STRUCTURES.speed_basis.is_identity() } {
            true => vector(speeds),
            false => product(&joint.speed_basis(&moved), &vector(speeds)),
        };
        let rate = match const { J::STRUCTURES.velocity_map.is_identity() } {
            true => velocity,
            false => product(&joint.velocity_map_inverse(&moved), &velocity),
        };
        let local_rate = match const { J::STRUCTURES.retract_differential.is_identity() } {
            true => rate,
            false => joint.retract_differential_inverse(&stored(&self.0, q), &vector(phi), &rate),
        };
        local_rate.store(out);
    }

    fn reduce_efforts(&self, q: &[f64], efforts: &[f64], out: &mut [f64]) {
        let efforts = vector::<f64, K>(efforts);
        match const { J::STRUCTURES.speed_basis.is_identity() } {
            true => efforts.store(out),
            false => {
                let basis = self.0.speed_basis(&stored(&self.0, q));
                transposed_product(&basis, &efforts).store(out)
            }
        }
    }

    fn port_value(&self, q: &[f64], port: usize) -> f64 {
        let q = stored(&self.0, q);
        let values = self.0.port_values(&q);
        values.as_ref().get(port).copied().unwrap_or(nan())
    }

    fn port_row(&self, q: &[f64], port: usize, out: &mut [f64]) {
        Steps(&self.0)
            .port_row(&stored(&self.0, q), port)
            .store(out);
    }

    fn pin_place(&self, q: &[f64], pin: usize) -> [f64; 9] {
        let q = stored(&self.0, q);
        let places = self.0.pins(&q);
        places.as_ref().get(pin).copied().unwrap_or([nan(); 9])
    }

    fn relation_twist(&self, q: &[f64], relation: usize) -> Vector6<f64> {
        let q = stored(&self.0, q);
        let twists = self.0.relation_twists(&q);
        let own = twists.as_ref().get(relation).copied();
        own.map_or(Vector6::repeat(nan()), Vector6::from)
    }

    fn relation_port(&self, q: &[f64], relation: usize, port: usize) -> f64 {
        let q = stored(&self.0, q);
        let rates = self.0.relation_ports(&q);
        let mut of_relation = rates.as_ref().chunks_exact(self.0.ports().len().max(1));
        let own = of_relation.nth(relation);
        own.and_then(|own| own.get(port).copied()).unwrap_or(nan())
    }

    fn port_slope(
        &self,
        q: &[f64],
        velocity: &[f64],
        port: usize,
        law: &PortLaw<f64>,
        out: &mut [f64],
    ) {
        Steps(&self.0)
            .port_slope((&stored(&self.0, q), &vector(velocity)), port, law)
            .store(out);
    }

    fn port_row_rate(&self, q: &[f64], speeds: &[f64], port: usize, out: &mut [f64]) {
        let [_, rate] = Steps(&self.0).port_row_motion(&stored(&self.0, q), &vector(speeds), port);
        rate.store(out);
    }

    fn port_row_gradient(&self, q: &[f64], port: usize, out: &mut [f64]) {
        Steps(&self.0)
            .port_row_gradient(&stored(&self.0, q), port)
            .store(out);
    }

    fn rotor_term_slopes(
        &self,
        (q, speeds, x): (&[f64], &[f64], &[f64]),
        port: usize,
        term: RotorTerm,
        by_local: &mut [f64],
        by_speeds: &mut [f64],
    ) {
        let state = (&stored(&self.0, q), &vector(speeds), &vector(x));
        let slopes = Steps(&self.0).rotor_term_slopes(state, AtPort { port, term });
        slopes.0.store(by_local);
        slopes.1.store(by_speeds);
    }

    fn differentiate(
        &self,
        base: &[f64],
        phi: &[f64],
        speeds: &[f64],
        out: &mut ChartDerivatives<'_, f64>,
    ) {
        let field = Field {
            joint: &self.0,
            base: stored(&self.0, base),
            phi: vector(phi),
            speeds: vector(speeds),
        };
        field.fill(out);
    }

    fn spring_slope(&self, q: &[f64], rest: &[f64], stiffness: &[f64], out: &mut [f64]) {
        Steps(&self.0)
            .spring_slope((&stored(&self.0, q), &stored(&self.0, rest)), stiffness)
            .store(out);
    }

    fn turn_slope(&self, q: &[f64], rest: &Matrix3<f64>, stiffness: f64, out: &mut [f64]) {
        Steps(&self.0)
            .turn_slope(&stored(&self.0, q), rest, stiffness)
            .store(out);
    }

    fn rotor_slopes(
        &self,
        q: &[f64],
        velocity: &[f64],
        inertia: &[f64],
        by_local: &mut [f64],
        by_velocity: &mut [f64],
    ) {
        let (velocity, inertia) = (vector(velocity), vector(inertia));
        let slopes = Steps(&self.0).rotor_slopes(&stored(&self.0, q), &velocity, &inertia);
        slopes[0].store(by_local);
        slopes[1].store(by_velocity);
    }

    fn moves_body(&self, freedom: usize) -> bool {
        self.0.moves_body(freedom)
    }

    fn parts(&self) -> (bool, bool) {
        Steps::<J, N, K, S, C>::parts()
    }

    fn column_parts(&self, speed: usize) -> (bool, bool) {
        match speed < S {
            true => Steps::<J, N, K, S, C>::column_parts(speed),
            false => (false, false),
        }
    }

    fn place(
        &self,
        q: &[f64],
        joint_frame: &Pose<f64>,
        parent: &Placement<f64>,
        own: &mut Placement<f64>,
    ) {
        *own = match stored::exactly(&self.0, q) {
            Some(q) => Steps(&self.0).child(&q, joint_frame, parent),
            None => Placement::unknown(),
        };
    }

    fn stand(
        &self,
        q: &[f64],
        joint_frame: &Pose<f64>,
        parent: &Placement<f64>,
        own: &mut Placement<f64>,
        columns: &mut [Vector6<f64>],
    ) {
        let arrays = (stored::exactly(&self.0, q), array_mut(columns));
        let (Some(q), Some(own_columns)) = arrays else {
            *own = Placement::unknown();
            return columns.fill(Vector6::repeat(nan()));
        };
        *own = Steps(&self.0).child(&q, joint_frame, parent);
        *own_columns = Steps(&self.0).columns(&q, &own.rotation);
    }

    fn speed_map(&self, q: &[f64], columns: &mut [Vector6<f64>]) {
        match array_mut(columns) {
            Some(columns) => {
                *columns = Steps(&self.0).columns(&stored(&self.0, q), &Matrix3::identity())
            }
            None => columns.fill(Vector6::repeat(nan())),
        }
    }

    fn advance(
        &self,
        (q, speeds, accelerations): (&[f64], &[f64], &[f64]),
        joint_frame: &Pose<f64>,
        parent: &Motion<f64>,
        own: &mut Motion<f64>,
        columns: &mut [Vector6<f64>],
    ) {
        let q = stored::exactly(&self.0, q);
        let arrays = (q, array(speeds), array_mut(columns));
        let (Some(q), Some(speeds), Some(own_columns)) = arrays else {
            *own = Motion::unknown();
            return columns.fill(Vector6::repeat(nan()));
        };
        let state = (&q, &of_columns([*speeds]));
        *own = Steps(&self.0).advance(state, joint_frame, parent, own_columns);
        if !accelerations.is_empty() {
            let accelerations = vector(accelerations);
            own.rate = Steps::<J, N, K, S, C>::add_columns(&own.rate, own_columns, &accelerations);
        }
    }

    fn articulate(
        &self,
        inertia: &mut ArticulatedInertia<f64>,
        columns: &[Vector6<f64>],
        armature: &[f64],
        pivots: &mut [Pivot<f64>],
    ) -> Result<(), PivotFailure<f64>> {
        let (Some(columns), Some(pivots)) = (array(columns), array_mut(pivots)) else {
            return Err(PivotFailure::unknown());
        };
        Steps::<J, N, K, S, C>::inertia(inertia, columns, armature, pivots)
    }

    fn reduce(
        &self,
        wrench: &mut Vector6<f64>,
        columns: &[Vector6<f64>],
        pivots: &[Pivot<f64>],
        forces: &[f64],
        loads: &mut [f64],
    ) {
        let arrays = (
            array(columns),
            array(pivots),
            array(forces),
            array_mut(loads),
        );
        let (Some(columns), Some(pivots), Some(forces), Some(loads)) = arrays else {
            *wrench = Vector6::repeat(nan());
            return loads.fill(nan());
        };
        *wrench = Steps::<J, N, K, S, C>::wrench(wrench, columns, pivots, forces, loads);
    }

    fn resolve(
        &self,
        motion: &mut Vector6<f64>,
        columns: &[Vector6<f64>],
        pivots: &[Pivot<f64>],
        loads: &[f64],
        rates: &mut [f64],
    ) {
        let arrays = (
            array(columns),
            array(pivots),
            array(loads),
            array_mut(rates),
        );
        let (Some(columns), Some(pivots), Some(loads), Some(rates)) = arrays else {
            *motion = Vector6::repeat(nan());
            return rates.fill(nan());
        };
        *motion = Steps::<J, N, K, S, C>::motion(motion, columns, pivots, loads, rates);
    }

    fn momenta(
        &self,
        inertia: &SpatialInertia<f64>,
        columns: &[Vector6<f64>],
        out: &mut [Vector6<f64>],
    ) {
        let (Some(columns), Some(own)) = (array::<_, S>(columns), array_mut::<_, S>(out)) else {
            return out.fill(Vector6::repeat(nan()));
        };
        for j in 0..S {
            own[j] = Steps::<J, N, K, S, C>::momentum(inertia, j, &columns[j]);
        }
    }

    fn gather(&self, wrench: &Vector6<f64>, columns: &[Vector6<f64>], out: &mut [f64]) {
        let (Some(columns), Some(own)) = (array::<_, S>(columns), array_mut::<_, S>(out)) else {
            return out.fill(nan());
        };
        for j in 0..S {
            own[j] = Steps::<J, N, K, S, C>::power(j, &columns[j], wrench);
        }
    }

    fn vary(
        &self,
        (q, speeds, accelerations): (&[f64], &[f64], &[f64]),
        motions: (&Motion<f64>, &Motion<f64>),
        columns: &[Vector6<f64>],
        out: &mut [Variation<f64>],
    ) {
        let (Some(columns), Some(own)) = (array(columns), array_mut(out)) else {
            return out.fill(Variation::unknown());
        };
        let accelerations = match accelerations.is_empty() {
            true => zeros(),
            false => vector(accelerations),
        };
        let state = (&stored(&self.0, q), &vector(speeds), &accelerations);
        Steps(&self.0).variations(state, motions, columns, own);
    }

    fn second_variations(
        &self,
        state: (&[f64], &[f64], &[f64]),
        virtual_speeds: &[f64],
        carrying: &Carrying<f64>,
        gradient: &MotionGradient<f64>,
        out: [&mut [f64]; 3],
    ) {
        let state = virtual_state(&self.0, state, virtual_speeds);
        Steps(&self.0).second_variations(&state, carrying, gradient, out);
    }

    fn chart_terms(&self, q: &[f64], gradient: &[f64], out: &mut [f64]) {
        Steps(&self.0)
            .chart_terms(&stored(&self.0, q), &vector(gradient))
            .store(out);
    }

    fn power_hessian(
        &self,
        state: (&[f64], &[f64], &[f64]),
        virtual_speeds: &[f64],
        law: &EffortLaw<'_>,
        out: [&mut [f64]; 5],
    ) {
        let state = virtual_state(&self.0, state, virtual_speeds);
        Steps(&self.0).power_hessian(&state, law, out);
    }
}

/// The slices as vectors.
fn virtual_state<J, const N: usize, const K: usize, const S: usize, const C: usize>(
    joint: &J,
    (q, speeds, accelerations): (&[f64], &[f64], &[f64]),
    virtual_speeds: &[f64],
) -> VirtualState<f64, N, S>
where
    J: Joint<N, K, S, C>,
{
    VirtualState {
        q: stored(joint, q),
        speeds: vector(speeds),
        accelerations: vector(accelerations),
        virtual_speeds: vector(virtual_speeds),
    }
}
