//! What each body contributes to second derivatives, read at one frame, so that loops over pairs of joints find the rest (`hamel_compiled::Pairs`).

use super::pairs::Raised;
use crate::equations::pairs::{Found, Paired, at_root, of_twist, of_wrench};
use crate::equations::{Bias, Tree, number};
use crate::graph::{Argument, Sym, bound, put, section};
use crate::pairs::Product;

impl Tree<'_> {
    /// λᵀ∂²τ̄ of inverse dynamics at v̄̇, the argument.
    pub fn paired_second_inverse(&self) -> Paired {
        let [_, freedoms, speeds] = self.model.sizes();
        let size = freedoms + 2 * speeds;
        let mut found = self.found_bends(None, size);
        (found.rows, found.matrix) = (vec![], vec![]);
        self.tables(Product::SecondInverse, [size, size], found, None)
    }

    /// λᵀ∂²v̄̇ of forward dynamics, of a mechanism without prescribed motions.
    pub fn paired_second_forward(&self) -> Paired {
        let [_, freedoms, speeds] = self.model.sizes();
        let rates = self.articulated_accelerations(Bias::Within);
        let weights = self.virtual_speeds();
        let virtual_speeds = bound(&[(Argument::Momenta, &weights)], || {
            self.articulated_speeds()
        });
        let mut found = self.found_bends(Some(Argument::Efforts), 2 * (freedoms + speeds));
        self.add_armature(&mut found.matrix);
        let size = 2 * freedoms + speeds;
        let (numbers, tables) = self.tables(Product::SecondForward, [size, size], found, None);
        let numbers = put(&numbers, |argument, place| match argument {
            Argument::Accelerations => Some(rates[place]),
            Argument::Weights => Some(virtual_speeds[place]),
            _ => None,
        });
        (numbers, tables)
    }

    /// What derivatives of both orders at given v̄̇ and μ are made of, and so many rows of the Hessian.
    fn found_bends(&self, efforts: Option<Argument>, rows: usize) -> Found {
        let mut found = self.found((&self.given_rates(), false), efforts);
        let frames = self.root_frames();
        let hessian = self.contracted_but(efforts, |index, bodies, sums, _| {
            let mut raised: Option<Raised> = None;
            for body in self.model.carried(index) {
                let placed = &self.bodies[body];
                let (own, sums) = (&bodies[body], &sums[body]);
                section(number(body), "pairs");
                if placed.parent.is_some() {
                    let shown = Raised::of(&own.directions, &placed.columns, sums);
                    let shown = shown.at_parent(&frames[body]);
                    raised = Some(match raised {
                        Some(others) => others.plus(&shown),
                        None => shown,
                    });
                }
                let contribution = &mut found.contributions[index];
                let mut seen = contribution.seen.iter_mut();
                if let Some((_, seen)) = seen.find(|(other, _)| *other == body) {
                    let drifts = &own.directions[..placed.share.freedoms.len()];
                    let drifts = drifts.iter().map(|own| &own.virtual_drift);
                    seen.extend(drifts.flat_map(|drift| of_twist(&at_root(&frames[body], drift))));
                }
            }
            if let Some(raised) = raised {
                let by_rate = raised.by_rate.iter().flat_map(of_wrench);
                let by_drift = raised.by_drift.iter().flat_map(|own| own.iter().copied());
                let more: Vec<Sym> = by_rate.chain(by_drift).collect();
                let more = self.shown_by(index, more);
                found.contributions[index].shown.extend(more);
            }
        });
        found.bends = hessian.into_rows(rows);
        found
    }
}
