//! Many states of one compiled scene: rows of Q, v̄ and inputs in, rows of results out.

mod call;

pub use call::BatchError;

use super::{Entry, Equations, Level};
use call::{Asked, Call, Numbers};

/// A compiled scene for many states at once.
///
/// A row of `q` holds `configuration` numbers, one of `v`, of rates and of efforts `speeds`, one of τ `freedoms`, each in the mechanism's layout; of a matrix it
/// holds all rows, one after the other. Rows are of `f64`,
/// one for each state, or of [`Lanes`](super::Lanes), one for eight states side by side, which saves turning rows into lanes and back: a fifth of the time and more.
/// Modules compiled with lanes take eight states at a time at the [`Level`] that was chosen; others take them one by one. A state's
/// results depend on that state and the level alone: not on the other states, nor on the number of threads. Between levels they
/// differ by rounding. A state without finite results (a singular mass, an angle beyond 8e5 rad) is computed again in `f64`, so that what
/// is not finite then is not finite in [`Equations`] either. Nothing allocates but this where states are side by side, and what `rayon` itself needs for its tasks.
#[derive(Clone, Copy, Debug)]
pub struct Batch {
    equations: &'static Equations,
    level: Level,
}

impl Batch {
    /// At the best level that the machine has.
    pub fn new(equations: &'static Equations) -> Self {
        let level = Level::default();
        Self { equations, level }
    }

    /// At a given level.
    ///
    /// # Errors
    /// A level that the machine does not have.
    pub fn at(equations: &'static Equations, level: Level) -> Result<Self, BatchError> {
        match level.is_available() {
            true => Ok(Self { equations, level }),
            false => Err(BatchError::Level(level)),
        }
    }

    /// The level at which it computes.
    pub fn level(&self) -> Level {
        self.level
    }

    /// Accelerations v̄̇ of all states, (24), (34), on this thread.
    ///
    /// # Errors
    /// A module without forward dynamics; numbers that are no whole rows, or not the same number of rows in all arguments.
    pub fn forward_dynamics<N: Entry>(
        &self,
        q: &[N],
        v: &[N],
        tau: &[N],
        rates: &mut [N],
    ) -> Result<(), BatchError> {
        self.forward(q, v, tau, rates)?.run(0, rates);
        Ok(())
    }

    /// Efforts τ̄ that the accelerations `a` take at all states, (24), (34), on this thread.
    ///
    /// # Errors
    /// A module without inverse dynamics; numbers that are no whole rows, or not the same number of rows in all arguments.
    pub fn inverse_dynamics<N: Entry>(
        &self,
        q: &[N],
        v: &[N],
        a: &[N],
        efforts: &mut [N],
    ) -> Result<(), BatchError> {
        self.inverse(q, v, a, efforts)?.run(0, efforts);
        Ok(())
    }

    /// For each state and speed a row of `∂v̄̇/∂ϕ`, `∂v̄̇/∂v̄`, `∂v̄̇/∂τ` and v̄̇, as [`Equations::forward_dynamics_derivatives`] has them, on this thread.
    ///
    /// # Errors
    /// A module without these derivatives; numbers that are no whole rows, or not the same number of rows in all arguments.
    pub fn forward_dynamics_derivatives<N: Entry>(
        &self,
        q: &[N],
        v: &[N],
        tau: &[N],
        rows: &mut [N],
    ) -> Result<(), BatchError> {
        self.forward_slopes(q, v, tau, rows)?.run(0, rows);
        Ok(())
    }

    /// For each state and speed a row of `∂τ̄/∂ϕ` and `∂τ̄/∂v̄` at the accelerations `a`, as [`Equations::inverse_dynamics_derivatives`] has them, on this thread.
    ///
    /// # Errors
    /// A module without these derivatives; numbers that are no whole rows, or not the same number of rows in all arguments.
    pub fn inverse_dynamics_derivatives<N: Entry>(
        &self,
        q: &[N],
        v: &[N],
        a: &[N],
        rows: &mut [N],
    ) -> Result<(), BatchError> {
        self.inverse_slopes(q, v, a, rows)?.run(0, rows);
        Ok(())
    }

    /// M̄ of all states, by rows, on this thread.
    ///
    /// # Errors
    /// A module without the mass matrix; numbers that are no whole rows, or not the same number of rows in all arguments.
    pub fn mass_matrix<N: Entry>(&self, q: &[N], matrices: &mut [N]) -> Result<(), BatchError> {
        self.mass(q, matrices)?.run(0, matrices);
        Ok(())
    }

    /// M̄⁻¹ of all states, by rows; those of joints whose motion is prescribed are 0, on this thread.
    ///
    /// # Errors
    /// A module without the inverse mass matrix; numbers that are no whole rows, or not the same number of rows in all arguments.
    pub fn inverse_mass_matrix<N: Entry>(
        &self,
        q: &[N],
        matrices: &mut [N],
    ) -> Result<(), BatchError> {
        self.inverse_mass(q, matrices)?.run(0, matrices);
        Ok(())
    }

    /// [`Batch::forward_dynamics`] on the threads of rayon's current pool.
    ///
    /// # Errors
    /// Those of [`Batch::forward_dynamics`].
    #[cfg(feature = "rayon")]
    pub fn par_forward_dynamics<N: Entry>(
        &self,
        q: &[N],
        v: &[N],
        tau: &[N],
        rates: &mut [N],
    ) -> Result<(), BatchError> {
        self.forward(q, v, tau, rates)?.share(rates);
        Ok(())
    }

    /// [`Batch::inverse_dynamics`] on the threads of rayon's current pool.
    ///
    /// # Errors
    /// Those of [`Batch::inverse_dynamics`].
    #[cfg(feature = "rayon")]
    pub fn par_inverse_dynamics<N: Entry>(
        &self,
        q: &[N],
        v: &[N],
        a: &[N],
        efforts: &mut [N],
    ) -> Result<(), BatchError> {
        self.inverse(q, v, a, efforts)?.share(efforts);
        Ok(())
    }

    /// [`Batch::forward_dynamics_derivatives`] on the threads of rayon's current pool.
    ///
    /// # Errors
    /// Those of [`Batch::forward_dynamics_derivatives`].
    #[cfg(feature = "rayon")]
    pub fn par_forward_dynamics_derivatives<N: Entry>(
        &self,
        q: &[N],
        v: &[N],
        tau: &[N],
        rows: &mut [N],
    ) -> Result<(), BatchError> {
        self.forward_slopes(q, v, tau, rows)?.share(rows);
        Ok(())
    }

    /// [`Batch::inverse_dynamics_derivatives`] on the threads of rayon's current pool.
    ///
    /// # Errors
    /// Those of [`Batch::inverse_dynamics_derivatives`].
    #[cfg(feature = "rayon")]
    pub fn par_inverse_dynamics_derivatives<N: Entry>(
        &self,
        q: &[N],
        v: &[N],
        a: &[N],
        rows: &mut [N],
    ) -> Result<(), BatchError> {
        self.inverse_slopes(q, v, a, rows)?.share(rows);
        Ok(())
    }

    /// [`Batch::mass_matrix`] on the threads of rayon's current pool.
    ///
    /// # Errors
    /// Those of [`Batch::mass_matrix`].
    #[cfg(feature = "rayon")]
    pub fn par_mass_matrix<N: Entry>(&self, q: &[N], matrices: &mut [N]) -> Result<(), BatchError> {
        self.mass(q, matrices)?.share(matrices);
        Ok(())
    }

    /// [`Batch::inverse_mass_matrix`] on the threads of rayon's current pool.
    ///
    /// # Errors
    /// Those of [`Batch::inverse_mass_matrix`].
    #[cfg(feature = "rayon")]
    pub fn par_inverse_mass_matrix<N: Entry>(
        &self,
        q: &[N],
        matrices: &mut [N],
    ) -> Result<(), BatchError> {
        self.inverse_mass(q, matrices)?.share(matrices);
        Ok(())
    }

    fn forward<'a, N: Entry>(
        &self,
        q: &'a [N],
        v: &'a [N],
        tau: &'a [N],
        rates: &[N],
    ) -> Result<Call<'a, N>, BatchError> {
        let equations = self.equations;
        let function = (
            equations.forward_dynamics,
            equations.in_lanes.forward_dynamics,
        );
        let inputs = ("efforts", equations.freedoms, tau);
        let results = ("rates", equations.speeds, rates);
        self.call(("forward dynamics", function), [q, v], inputs, results)
    }

    fn inverse<'a, N: Entry>(
        &self,
        q: &'a [N],
        v: &'a [N],
        a: &'a [N],
        efforts: &[N],
    ) -> Result<Call<'a, N>, BatchError> {
        let equations = self.equations;
        let function = (
            equations.inverse_dynamics,
            equations.in_lanes.inverse_dynamics,
        );
        let inputs = ("accelerations", equations.speeds, a);
        let results = ("efforts", equations.speeds, efforts);
        self.call(("inverse dynamics", function), [q, v], inputs, results)
    }

    fn forward_slopes<'a, N: Entry>(
        &self,
        q: &'a [N],
        v: &'a [N],
        tau: &'a [N],
        rows: &[N],
    ) -> Result<Call<'a, N>, BatchError> {
        let equations = self.equations;
        let function = (
            equations.forward_dynamics_derivatives,
            equations.in_lanes.forward_dynamics_derivatives,
        );
        let inputs = ("efforts", equations.freedoms, tau);
        let results = ("rows", equations.forward_slopes, rows);
        self.call(
            ("derivatives of forward dynamics", function),
            [q, v],
            inputs,
            results,
        )
    }

    fn inverse_slopes<'a, N: Entry>(
        &self,
        q: &'a [N],
        v: &'a [N],
        a: &'a [N],
        rows: &[N],
    ) -> Result<Call<'a, N>, BatchError> {
        let equations = self.equations;
        let function = (
            equations.inverse_dynamics_derivatives,
            equations.in_lanes.inverse_dynamics_derivatives,
        );
        let inputs = ("accelerations", equations.speeds, a);
        let results = ("rows", equations.inverse_slopes(), rows);
        self.call(
            ("derivatives of inverse dynamics", function),
            [q, v],
            inputs,
            results,
        )
    }

    fn mass<'a, N: Entry>(&self, q: &'a [N], of: &[N]) -> Result<Call<'a, N>, BatchError> {
        let equations = self.equations;
        let function = (equations.mass_matrix, equations.in_lanes.mass_matrix);
        self.of_configuration(("mass matrix", function), q, of)
    }

    fn inverse_mass<'a, N: Entry>(&self, q: &'a [N], of: &[N]) -> Result<Call<'a, N>, BatchError> {
        let equations = self.equations;
        let function = (
            equations.inverse_mass_matrix,
            equations.in_lanes.inverse_mass_matrix,
        );
        self.of_configuration(("inverse mass matrix", function), q, of)
    }

    /// The call of a function of Q and v̄, where sizes fit: as many rows in all arguments as in the speeds.
    fn call<'a, N: Entry>(
        &self,
        (function, (one, many)): Asked,
        [q, v]: [&'a [N]; 2],
        inputs: Numbers<'a, N>,
        results: Numbers<'_, N>,
    ) -> Result<Call<'a, N>, BatchError> {
        let Equations {
            scene,
            configuration,
            speeds,
            ..
        } = *self.equations;
        let one = one.ok_or(BatchError::Missing { scene, function })?;
        let rows = self.rows(("speeds", speeds, v))?;
        let (_, width, _) = results;
        self.check(rows, [("configuration", configuration, q), inputs, results])?;
        Ok(Call {
            one,
            many,
            level: self.level,
            row: [configuration, speeds, inputs.1],
            width,
            of: [q, v, inputs.2],
        })
    }

    /// The same of Q alone, which stands in all three places: matrices of as many rows as columns as there are speeds.
    fn of_configuration<'a, N: Entry>(
        &self,
        (function, (one, many)): Asked,
        q: &'a [N],
        of: &[N],
    ) -> Result<Call<'a, N>, BatchError> {
        let Equations {
            scene,
            configuration,
            speeds,
            ..
        } = *self.equations;
        let one = one.ok_or(BatchError::Missing { scene, function })?;
        let rows = self.rows(("numbers of Q", configuration, q))?;
        let width = speeds.saturating_mul(speeds);
        self.check(rows, [("matrices", width, of)])?;
        Ok(Call {
            one,
            many,
            level: self.level,
            row: [configuration; 3],
            width,
            of: [q; 3],
        })
    }
}
