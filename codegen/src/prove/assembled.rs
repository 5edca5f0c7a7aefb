//! Whether a joint whose motion relations give can be assembled: a configuration meets the relations, and Newton's method finds one from home.

use super::{Prover, refuted};
use crate::diagnostic::Diagnostic;
use crate::precise::{Point, Sampler};
use crate::spec::code;

/// Bits of the numbers in which a configuration is looked for.
const BITS: usize = 256;
/// Values of the parameters for which home is tried: of most linkages, every other choice of lengths can be assembled near home.
const CHOICES: usize = 16;

impl Prover<'_> {
    /// The error of relations that no configuration near home meets, or of a guess of home from which Newton's method finds none.
    ///
    /// Parameters are drawn from their ranges: a joint is refused where no choice of them works.
    pub(super) fn cannot_be_assembled(&self) -> Option<Box<Diagnostic>> {
        let space = &self.joint.space;
        let mut sampler = Sampler::new(space, BITS).single();
        let mut choices = std::iter::from_fn(|| sampler.anywhere())
            .take(CHOICES)
            .peekable();
        if choices.peek().is_none() {
            return Some(Box::new(self.none_found()));
        }
        let home = Sampler::new(space, BITS).single();
        let found = choices.any(|point| home.assembled(&self.at_home(point)).is_some());
        let span = self.joint.spec.home.as_ref().map(|home| &home.span);
        let span = span.unwrap_or(&self.joint.spec.freedoms.span);
        (!found).then(|| {
            let message = "no configuration was found from home: Newton's method does not converge there";
            let error = refuted(code::HOME, span, message, "here");
            Box::new(error.help(
                "`home near …;` takes a guess that is nearer to the relations, and at which their derivatives are independent",
            ))
        })
    }

    /// The error of relations that Newton's method does not solve from anywhere.
    fn none_found(&self) -> Diagnostic {
        let spec = &self.joint.spec;
        if spec.home.is_some() && !spec.home_is_guess {
            let message = "the relations hold at home, but do not say how the joint moves there: their derivatives are dependent";
            let error = refuted(
                code::RELATIONS,
                &spec.freedoms.span,
                message,
                "in this joint",
            );
            return error
                .note("Newton's method finds no configuration around home, as where the derivatives of a relation are 0 wherever it is met: those of a square are")
                .help("write relations with independent derivatives: `x = y;` for `pow(x - y, 2) = 0;`");
        }
        let message = "no configuration was found that meets the relations";
        refuted(code::RELATIONS, &spec.freedoms.span, message, "in this joint")
            .note("Newton's method was started from many places around home, with values of the parameters from their ranges")
            .note("nor does it find any where the derivatives of a relation are 0 wherever it is met, as those of a square are")
            .help("check signs and units of the relations; `home near …;` says around which configuration they are met")
    }

    /// The point with Q as the spec says of home.
    fn at_home(&self, mut point: Point) -> Point {
        let space = &self.joint.space;
        let values: Vec<_> = space
            .home
            .iter()
            .map(|entry| point.evaluate(entry))
            .collect();
        for (coordinate, value) in space.manifold.coordinates().iter().zip(values) {
            point.bind(coordinate, value);
        }
        point
    }
}
