//! Whether derivatives are finite, and what it comes from where they are not.

use super::Sensitivity;
use crate::dynamics::DynamicsError;
use crate::dynamics::recursive::Recursive;
use crate::dynamics::recursive::elements::Seen;
use crate::elements::View;
use crate::scalar::all_finite;

impl Recursive {
    /// Whether there are derivatives at (q, v̄), and finite ones.
    ///
    /// # Errors
    /// The first element whose force has no derivative there. Where some are not finite: the first joint with a kernel that is not, else the joint of the first row
    /// that is not.
    #[inline]
    pub(super) fn check_found(
        &self,
        state: (&[f64], &[f64]),
        found: &[&Sensitivity],
    ) -> Result<(), DynamicsError> {
        if self.acted_on {
            self.check_elements(state)?;
        }
        match found.iter().all(|matrix| all_finite(matrix.entries())) {
            true => Ok(()),
            false => Err(self.not_found(state, found)),
        }
    }

    fn check_elements(&self, (q, speeds): (&[f64], &[f64])) -> Result<(), DynamicsError> {
        let mechanism = &self.mechanism;
        let view = View {
            mechanism,
            configuration: q,
            speeds,
            motions: &Seen(&self.nodes),
            moment: self.moment,
        };
        mechanism.elements().iter().try_for_each(|element| {
            let slope = element.slope();
            match slope.and_then(|slope| slope.missing(&view)) {
                None => Ok(()),
                Some(what) => Err(DynamicsError::NoDerivative {
                    name: element.name().into(),
                    what,
                }),
            }
        })
    }

    #[cold]
    fn not_found(&self, (q, speeds): (&[f64], &[f64]), found: &[&Sensitivity]) -> DynamicsError {
        let mechanism = &self.mechanism;
        if let Some(cause) = mechanism.no_value(q, speeds) {
            return cause.into();
        }
        let rows = found.iter().flat_map(|matrix| {
            let rows = matrix.entries().chunks_exact(matrix.columns().max(1));
            rows.enumerate()
                .filter(|(_, row)| !all_finite(row))
                .map(|(row, _)| row)
        });
        let row = rows.min().unwrap_or(0);
        let mut bodies = mechanism.bodies().iter();
        let owner = bodies.find(|body| body.ranges().speeds.contains(&row));
        let owner = owner.or_else(|| mechanism.bodies().last());
        owner.map_or(DynamicsError::ForeignResults, |body| {
            body.without_value("derivative of the dynamics").into()
        })
    }
}
