//! The library, loaded, as functions that [`hamel::compiled::Compiled`] calls. They hold it: it is unloaded with the last of them.

#![allow(
    unsafe_code,
    reason = "functions of another language are called: see the safety comments"
)]

use hamel::compiled::{Function, Functions, WeightedFunction};
use std::ffi::c_long;
use std::path::Path;
use std::sync::Arc;

/// A function of one array, Q.
type One = unsafe extern "C" fn(*const f64, *mut f64);
/// A function of two arrays, Q and v̄ or p̄.
type Two = unsafe extern "C" fn(*const f64, *const f64, *mut f64);
/// A function of three arrays, with inputs.
type Three = unsafe extern "C" fn(*const f64, *const f64, *const f64, *mut f64);

/// A function of four arrays, with inputs and λ.
type Four = unsafe extern "C" fn(*const f64, *const f64, *const f64, *const f64, *mut f64);

/// Numbers of bodies, of stored scalars, of degrees of freedom, of speeds, and of results of the derivatives of forward dynamics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sizes {
    pub bodies: usize,
    pub configuration: usize,
    pub freedoms: usize,
    pub speeds: usize,
    pub derivatives: usize,
}

/// Why a library is not taken.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    /// The system refuses it, and says why.
    #[error("{0}")]
    System(String),
    /// It lacks what a module has.
    #[error("it has no `{symbol}`: {cause}")]
    Missing {
        /// The name.
        symbol: String,
        /// What the system says.
        cause: String,
    },
    /// It is of another mechanism.
    #[error(
        "its `{symbol}` is {found}, and that of the mechanism is {expected}: it was compiled for another one"
    )]
    Size {
        /// Which size.
        symbol: String,
        /// That of the library.
        found: String,
        /// That which was expected.
        expected: String,
    },
}

/// The functions `functions` of the library at `path`, which was built of the module `name`; its own sizes are compared with `sizes` before any is called.
///
/// # Errors
/// A file that cannot be loaded; a library that lacks one of the functions, or the sizes; other sizes.
pub fn load(
    path: &Path,
    name: &str,
    functions: &[&str],
    sizes: Sizes,
) -> Result<Functions, LoadError> {
    Module::open(path, name, functions, sizes)?.functions()
}

/// A library whose functions are being looked up.
struct Module<'a> {
    library: Arc<libloading::Library>,
    name: &'a str,
    /// Those that are wanted.
    wanted: &'a [&'a str],
    sizes: Sizes,
}

impl<'a> Module<'a> {
    /// Loads a library and compares its sizes.
    fn open(
        path: &Path,
        name: &'a str,
        wanted: &'a [&'a str],
        sizes: Sizes,
    ) -> Result<Self, LoadError> {
        // SAFETY: the library was built of a module that this program wrote, which has no code that runs when it is loaded.
        let library = unsafe { libloading::Library::new(path) };
        let module = Self {
            library: Arc::new(library.map_err(|error| LoadError::System(cause(&error)))?),
            name,
            wanted,
            sizes,
        };
        let symbol = format!("{name}_sizes");
        // SAFETY: a module has these four numbers under this name.
        let found = unsafe { module.find::<*const [c_long; 4]>(&symbol)?.read() };
        let expected = [
            sizes.bodies,
            sizes.configuration,
            sizes.freedoms,
            sizes.speeds,
        ];
        match are_same(&found, &expected) {
            true => Ok(module),
            false => Err(LoadError::Size {
                symbol,
                found: format!("{found:?}"),
                expected: format!("{expected:?}"),
            }),
        }
    }

    /// What has this name, which must have the type `T`: a pointer to data or to a function.
    ///
    /// # Safety
    /// What has the name must have the type, and is not to be used without the library.
    unsafe fn find<T: Copy>(&self, symbol: &str) -> Result<T, LoadError> {
        // SAFETY: the caller's.
        let found = unsafe { self.library.get::<T>(symbol) };
        let found = found.map(|found| *found);
        found.map_err(|error| LoadError::Missing {
            symbol: symbol.to_owned(),
            cause: cause(&error),
        })
    }

    /// A function that writes so many results, where it is wanted.
    ///
    /// # Safety
    /// As of [`Module::find`].
    unsafe fn function<T: Copy>(
        &self,
        function: &str,
        results: usize,
    ) -> Result<Option<T>, LoadError> {
        if !self.wanted.contains(&function) {
            return Ok(None);
        }
        let symbol = format!("{}_{function}_results", self.name);
        // SAFETY: a module has this number under this name.
        let found = unsafe { self.find::<*const c_long>(&symbol)?.read() };
        if !are_same(&[found], &[results]) {
            return Err(LoadError::Size {
                symbol,
                found: found.to_string(),
                expected: results.to_string(),
            });
        }
        // SAFETY: the caller's.
        unsafe { self.find::<T>(&format!("{}_{function}", self.name)) }.map(Some)
    }

    /// A function of Q; of slices of other sizes the results are NaN, as of the next two.
    fn of_configuration(&self, name: &str, count: usize) -> Result<Option<Function>, LoadError> {
        // SAFETY: the module has these functions of one array, and what calls it holds the library.
        let Some(own) = (unsafe { self.function::<One>(name, count)? }) else {
            return Ok(None);
        };
        let (held, size) = (Arc::clone(&self.library), self.sizes.configuration);
        Ok(Some(Box::new(move |q, _, _, results| {
            let _held = &held;
            match q.len() == size && results.len() == count {
                // SAFETY: the sizes are those for which the function was written, and what it writes overlaps nothing that it reads.
                true => unsafe { own(q.as_ptr(), results.as_mut_ptr()) },
                false => results.fill(f64::NAN),
            }
        })))
    }

    /// A function of Q and v̄ or p̄.
    fn of_state(&self, name: &str, count: usize) -> Result<Option<Function>, LoadError> {
        // SAFETY: the module has these functions of two arrays, and what calls it holds the library.
        let Some(own) = (unsafe { self.function::<Two>(name, count)? }) else {
            return Ok(None);
        };
        let (held, sizes) = (Arc::clone(&self.library), self.sizes);
        Ok(Some(Box::new(move |q, v, _, results| {
            let _held = &held;
            let fits = q.len() == sizes.configuration && v.len() == sizes.speeds;
            match fits && results.len() == count {
                // SAFETY: as of functions of Q.
                true => unsafe { own(q.as_ptr(), v.as_ptr(), results.as_mut_ptr()) },
                false => results.fill(f64::NAN),
            }
        })))
    }

    /// A function of Q, v̄ or p̄, and so many inputs.
    fn of_inputs(
        &self,
        name: &str,
        inputs: usize,
        count: usize,
    ) -> Result<Option<Function>, LoadError> {
        // SAFETY: the module has these functions of three arrays, and what calls it holds the library.
        let Some(own) = (unsafe { self.function::<Three>(name, count)? }) else {
            return Ok(None);
        };
        let (held, sizes) = (Arc::clone(&self.library), self.sizes);
        Ok(Some(Box::new(move |q, v, u, results| {
            let _held = &held;
            let fits = q.len() == sizes.configuration && v.len() == sizes.speeds;
            match fits && u.len() == inputs && results.len() == count {
                // SAFETY: as of functions of Q.
                true => unsafe { own(q.as_ptr(), v.as_ptr(), u.as_ptr(), results.as_mut_ptr()) },
                false => results.fill(f64::NAN),
            }
        })))
    }

    /// A function of Q, v̄, so many inputs and λ, whose results are a square matrix.
    fn of_weights(&self, name: &str, inputs: usize) -> Result<Option<WeightedFunction>, LoadError> {
        let sizes = self.sizes;
        let rows = sizes.freedoms + sizes.speeds + inputs;
        let count = rows * rows;
        // SAFETY: the module has these functions of four arrays, and what calls it holds the library.
        let Some(own) = (unsafe { self.function::<Four>(name, count)? }) else {
            return Ok(None);
        };
        let held = Arc::clone(&self.library);
        Ok(Some(Box::new(move |q, v, u, weights, results| {
            let _held = &held;
            let fits = q.len() == sizes.configuration && v.len() == sizes.speeds;
            let fits = fits && weights.len() == sizes.speeds;
            match fits && u.len() == inputs && results.len() == count {
                // SAFETY: as of functions of Q.
                true => unsafe {
                    own(
                        q.as_ptr(),
                        v.as_ptr(),
                        u.as_ptr(),
                        weights.as_ptr(),
                        results.as_mut_ptr(),
                    );
                },
                false => results.fill(f64::NAN),
            }
        })))
    }

    /// All that are wanted.
    fn functions(self) -> Result<Functions, LoadError> {
        let Sizes {
            bodies,
            configuration,
            freedoms,
            speeds,
            derivatives,
        } = self.sizes;
        let slopes = speeds * (freedoms + speeds);
        Ok(Functions {
            scene: "the scene",
            configuration,
            freedoms,
            speeds,
            forward_dynamics: self.of_inputs("forward_dynamics", freedoms, speeds)?,
            inverse_dynamics: self.of_inputs("inverse_dynamics", speeds, speeds)?,
            bias_forces: self.of_state("bias_forces", speeds)?,
            mass_matrix: self.of_configuration("mass_matrix", speeds * speeds)?,
            energies: self.of_state("energies", 2)?,
            poses: self.of_configuration("poses", 12 * bodies)?,
            momenta: self.of_state("momenta", speeds)?,
            speeds_from_momenta: self.of_state("speeds_from_momenta", speeds)?,
            momentum_rates: self.of_inputs("momentum_rates", freedoms, 2 * speeds)?,
            hamiltonian: self.of_state("hamiltonian", 1)?,
            forward_dynamics_derivatives: self.of_inputs(
                "forward_dynamics_derivatives",
                freedoms,
                derivatives,
            )?,
            inverse_dynamics_derivatives: self.of_inputs(
                "inverse_dynamics_derivatives",
                speeds,
                slopes,
            )?,
            forward_dynamics_second_derivatives: self
                .of_weights("forward_dynamics_second_derivatives", freedoms)?,
            inverse_dynamics_second_derivatives: self
                .of_weights("inverse_dynamics_second_derivatives", speeds)?,
        })
    }
}

fn are_same(found: &[c_long], expected: &[usize]) -> bool {
    let mut pairs = found.iter().zip(expected);
    pairs.all(|(&found, &expected)| usize::try_from(found) == Ok(expected))
}

/// What the system says of an error, which the error itself leaves to its source.
fn cause(error: &libloading::Error) -> String {
    use std::error::Error;
    let source = error.source().map(ToString::to_string);
    source.unwrap_or_else(|| error.to_string())
}
