//! What elements, inputs and rotors add: the power of all that acts under virtual speeds, differentiated twice on the graph.

use super::hessian::Hessian;
use crate::equations::Tree;
use crate::equations::derivatives::unit;
use crate::graph::{Argument, Slopes, Sym};
use num_traits::Zero;

impl Tree<'_> {
    /// Adds the derivatives of `μᵀ(M̄_rotors v̄̇ − what acts)` along one direction after the other, and returns those by ϕ.
    pub(super) fn add_acting(&self, efforts: Option<Argument>, hessian: &mut Hessian) -> Vec<Sym> {
        let value = self.rotor_power() - self.power(efforts);
        let columns = self.along_state(&Slopes::new(vec![value]));
        let gradient = columns.concat();
        let slopes = Slopes::new(gradient.clone());
        for (outer, column) in self.along_state(&slopes).into_iter().enumerate() {
            for (inner, entry) in column.into_iter().enumerate().take(outer + 1) {
                hessian.add(outer, inner, entry);
            }
        }
        let [_, freedoms, speeds] = self.model.sizes();
        let rates = (0..speeds).map(|speed| (Argument::Accelerations, speed));
        let efforts = efforts.into_iter();
        let efforts = efforts.flat_map(|own| (0..freedoms).map(move |freedom| (own, freedom)));
        let of_local = Slopes::new(gradient[..freedoms].to_vec());
        for input in rates.chain(efforts) {
            let place = match input {
                (Argument::Accelerations, speed) => hessian.of_rate(speed),
                (_, freedom) => hessian.of_effort(freedom),
            };
            let column = of_local.along(|argument, place| unit((argument, place) == input));
            for (local, entry) in column.into_iter().enumerate() {
                hessian.add(place, local, entry);
            }
        }
        gradient[..freedoms].to_vec()
    }

    /// The power of all that acts beside gravity, with the efforts of the argument.
    fn power(&self, efforts: Option<Argument>) -> Sym {
        let exerted = self.exerted(efforts).into_iter();
        let terms = exerted.zip(self.virtual_speeds());
        terms.map(|(force, speed)| force * speed).sum()
    }

    /// The power that rates take of rotors.
    fn rotor_power(&self) -> Sym {
        let (rates, weights) = (self.given_rates(), self.virtual_speeds());
        let mut power = Sym::zero();
        for (index, body) in self.joints() {
            let own = body.share.speeds.clone();
            for j in 0..own.len() {
                for k in 0..own.len() {
                    let pair = weights[own.start + j] * rates[own.start + k];
                    power += self.armature(index, j, k) * pair;
                }
            }
        }
        power
    }
}
