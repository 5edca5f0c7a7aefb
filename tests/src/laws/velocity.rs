//! Laws of X, S and the Boltzmann–Hamel terms.

use super::dual::{constant, slopes, twist, unit};
use super::{At, D2, close};
use hamel::joint::{Joint, Turning};
use hamel::nalgebra::{SMatrix, SVector, Vector3, Vector6};
use hamel::scalar::Dual;

impl<J: Joint<N, K, S, C>, const N: usize, const K: usize, const S: usize, const C: usize>
    At<'_, J, N, K, S, C>
{
    /// Laws of X, S and the Boltzmann–Hamel terms, at ϕ = 0.
    pub(super) fn velocity_laws(&self, v: &SVector<f64, K>, p: &SVector<f64, K>) {
        let (joint, q) = (self.joint, &self.q);
        let x = joint.twist_map(q);
        let s = joint.velocity_map(q);
        let inverse = joint.velocity_map_inverse(q);
        close(
            "S₀ S₀⁻¹ = I",
            self.joint.facts().name,
            &(s * inverse),
            &SMatrix::identity(),
        );
        let child = joint.twist_map_child(q);
        close(
            "X = Ad X^c",
            self.joint.facts().name,
            &(joint.pose(q).adjoint() * child),
            &x,
        );
        let gradient = joint.velocity_map_gradient(q);
        let child_gradient = joint.twist_map_child_gradient(q);
        for k in 0..K {
            let moved = self.along(&unit(k));
            close(
                "J₀ = X S₀",
                self.joint.facts().name,
                &twist(&joint.pose(&moved)),
                &(x * s.column(k)),
            );
            close(
                "∂X^c/∂ϕ",
                self.joint.facts().name,
                &slopes(&joint.twist_map_child(&moved)),
                &child_gradient[k],
            );
            let left = x * gradient[k] + slopes(&joint.twist_map(&moved)) * s;
            close(
                "X ∂S + ∂X S = ∂J",
                self.joint.facts().name,
                &left,
                &self.jacobian_slope(k),
            );
        }
        let rate = inverse * v;
        close(
            "Q̇",
            self.joint.facts().name,
            &joint.configuration_rate(q, v),
            &slopes(&self.along(&rate)),
        );
        self.hamel_laws(v, p, &gradient, &inverse);
        self.port_laws(&s);
        self.pin_laws();
    }

    /// Bodies turn and slide at pins as these say, and in no other way.
    fn pin_laws(&self) {
        let places = self.joint.pins(&self.q);
        let places = places.as_ref();
        assert_eq!(
            places.len(),
            self.joint.facts().pins.len(),
            "{}: pins",
            self.joint.facts().name
        );
        // As the first body sees it: `more` has the others.
        if self.joint.body() != 0 {
            return;
        }
        let maps = self.twist_maps();
        for (pin, place) in self.joint.facts().pins.iter().zip(places) {
            let [first, second] = pin.bodies.map(|body| match body {
                Some(body) => maps[body],
                None => SMatrix::zeros(),
            });
            let [point, turning, sliding] =
                [0, 3, 6].map(|n| Vector3::from_column_slice(&place[n..n + 3]));
            for column in (first - second).column_iter() {
                let angular: Vector3<f64> = column.fixed_rows::<3>(0).into_owned();
                let there = column.fixed_rows::<3>(3) + angular.cross(&point);
                let otherwise = match pin.turning {
                    Turning::Freely => Vector3::zeros(),
                    Turning::AboutAxis => angular.cross(&turning),
                    Turning::Not => angular,
                };
                close(
                    "turns as the pin says",
                    self.joint.facts().name,
                    &otherwise,
                    &Vector3::zeros(),
                );
                let otherwise = match pin.slides {
                    true => there.cross(&sliding),
                    false => there,
                };
                close(
                    "slides as the pin says",
                    self.joint.facts().name,
                    &otherwise,
                    &Vector3::zeros(),
                );
            }
        }
    }

    /// X of every body.
    fn twist_maps(&self) -> Vec<SMatrix<f64, 6, K>> {
        let mut maps = vec![self.joint.twist_map(&self.q)];
        self.joint.more(&mut |body| {
            let mut map = SMatrix::<f64, 6, K>::zeros();
            body.twist_map(self.q.as_slice(), map.as_mut_slice());
            maps.push(map);
        });
        maps
    }

    /// The rates of ports are those of their values: P S₀ = ∂y/∂ϕ.
    fn port_laws(&self, s: &SMatrix<f64, K, K>) {
        let map = self.joint.port_map(&self.q);
        let here = self.joint.port_values(&self.q);
        let sizes = [map.as_ref().len(), here.as_ref().len()];
        assert_eq!(
            sizes,
            [self.joint.ports().len(); 2],
            "{}: ports",
            self.joint.facts().name
        );
        for k in 0..K {
            let moved = self.along(&unit(k));
            let values = self.joint.port_values(&moved);
            for (row, value) in map.as_ref().iter().zip(values.as_ref()) {
                let found = SVector::from(*row).dot(&s.column(k));
                close(
                    "P S₀ = ∂y/∂ϕ",
                    self.joint.facts().name,
                    &SVector::from([found]),
                    &SVector::from([value.derivative()]),
                );
            }
        }
    }

    /// ∂J/∂ϕ_l at ϕ = 0, by nested dual numbers on H(Φ(Q, ϕ)).
    pub(super) fn jacobian_slope(&self, l: usize) -> SMatrix<f64, 6, K> {
        let column = |k: usize| {
            let phi: SVector<D2, K> = SVector::from_fn(|i, _| {
                let outer = f64::from(u8::from(i == l));
                let inner = f64::from(u8::from(i == k));
                Dual::new(Dual::new(0.0, outer), Dual::constant(inner))
            });
            let q: SVector<D2, N> = constant(&constant(&self.q));
            slopes(&twist(&self.joint.pose(&self.joint.retract(&q, &phi))))
        };
        let columns: Vec<Vector6<f64>> = (0..K).map(column).collect();
        SMatrix::from_fn(|i, k| columns[k][i])
    }

    /// (17) and (28) from S₀⁻¹ and ∂S/∂ϕ.
    pub(super) fn hamel_laws(
        &self,
        v: &SVector<f64, K>,
        p: &SVector<f64, K>,
        gradient: &[SMatrix<f64, K, K>; K],
        inverse: &SMatrix<f64, K, K>,
    ) {
        let w = inverse * v;
        let inner = SMatrix::<f64, K, K>::from_fn(|l, j| {
            (0..K)
                .map(|m| (gradient[m][(j, l)] - gradient[l][(j, m)]) * w[m])
                .sum()
        });
        let gamma = self.joint.gamma(&self.q, v);
        close(
            "γ, (17)",
            self.joint.facts().name,
            &gamma,
            &inverse.tr_mul(&inner),
        );
        let b =
            SMatrix::<f64, K, K>::from_fn(|i, m| (0..K).map(|l| gradient[m][(l, i)] * p[l]).sum());
        let j22 = self.joint.j22(&self.q, p);
        close(
            "J22, (28)",
            self.joint.facts().name,
            &j22,
            &(inverse.tr_mul(&(b.transpose() - b)) * inverse),
        );
        close(
            "Σ γ_k v_k p = −J22 v",
            self.joint.facts().name,
            &(gamma * p),
            &(j22 * v * -1.0),
        );
    }
}
