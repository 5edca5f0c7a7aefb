//! The library, loaded, behind the functions that [`hamel::compiled::Compiled`] calls.
//!
//! Those are plain functions without data, so what they call stands in a static: one scene at a time.

#![allow(
    unsafe_code,
    reason = "functions of another language are called: see the safety comments"
)]

use hamel::compiled::{Equations, InLanes};
use std::cell::RefCell;
use std::ffi::c_long;
use std::path::Path;
use std::ptr;
use std::sync::atomic::{AtomicPtr, Ordering};

/// A function of two arrays.
type Two = unsafe extern "C" fn(*const f64, *const f64, *mut f64);
/// A function of three arrays.
type Three = unsafe extern "C" fn(*const f64, *const f64, *const f64, *mut f64);

/// What is in use, or null. What was loaded stays in memory to the end of the program, so that a call of it can never meet nothing.
static IN_USE: AtomicPtr<Loaded> = AtomicPtr::new(ptr::null_mut());

/// A library in use: while this stands, its [`Equations`] call it.
#[derive(Debug)]
pub struct Library {
    equations: &'static Equations,
}

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
    /// Functions are without data, so that there is one at a time.
    #[error("another one is in use")]
    InUse,
}

/// The functions of a library, and the sizes for which they were written.
struct Loaded {
    sizes: Sizes,
    forward_dynamics: Option<Three>,
    derivatives: Option<Three>,
    momenta: Option<Two>,
    speeds_from_momenta: Option<Two>,
    momentum_rates: Option<Three>,
    hamiltonian: Option<Two>,
    equations: Equations,
    /// Keeps the functions where they are.
    _library: libloading::Library,
}

impl Library {
    /// The functions `functions` of the library at `path`, which was built of the module `name`; its own sizes are compared with `sizes` before any is called.
    ///
    /// # Errors
    /// A file that cannot be loaded; a library that lacks one of the functions, or the sizes; other sizes; another library in use.
    pub fn load(
        path: &Path,
        name: &str,
        functions: &[&str],
        sizes: Sizes,
    ) -> Result<Self, LoadError> {
        let module = Module::open(path, name, sizes)?;
        let loaded = Box::leak(Box::new(module.loaded(functions)?));
        let equations = &raw const loaded.equations;
        IN_USE
            .compare_exchange(ptr::null_mut(), loaded, Ordering::AcqRel, Ordering::Acquire)
            .map_err(|_| LoadError::InUse)?;
        // SAFETY: what it points to is never freed and never written again.
        let equations = unsafe { &*equations };
        Ok(Self { equations })
    }

    /// Functions that call it.
    pub const fn equations(&self) -> &'static Equations {
        self.equations
    }
}

impl Drop for Library {
    fn drop(&mut self) {
        IN_USE.store(ptr::null_mut(), Ordering::Release);
    }
}

/// What is in use.
fn in_use() -> Option<&'static Loaded> {
    // SAFETY: null, or what `Library::load` has leaked.
    unsafe { IN_USE.load(Ordering::Acquire).as_ref() }
}

/// A library whose functions are being looked up.
struct Module<'a> {
    library: libloading::Library,
    name: &'a str,
    sizes: Sizes,
}

impl<'a> Module<'a> {
    /// Loads a library and compares its sizes.
    fn open(path: &Path, name: &'a str, sizes: Sizes) -> Result<Self, LoadError> {
        // SAFETY: the library was built of a module that this program wrote, which has no code that runs when it is loaded.
        let library = unsafe { libloading::Library::new(path) };
        let module = Self {
            library: library.map_err(|error| LoadError::System(cause(&error)))?,
            name,
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
    /// What has the name must have the type.
    unsafe fn find<T: Copy>(&self, symbol: &str) -> Result<T, LoadError> {
        // SAFETY: the caller's.
        let found = unsafe { self.library.get::<T>(symbol) };
        let found = found.map(|found| *found);
        found.map_err(|error| LoadError::Missing {
            symbol: symbol.to_owned(),
            cause: cause(&error),
        })
    }

    /// A function that writes so many results, where it is among `functions`.
    ///
    /// # Safety
    /// As of [`Module::find`].
    unsafe fn function<T: Copy>(
        &self,
        functions: &[&str],
        function: &str,
        results: usize,
    ) -> Result<Option<T>, LoadError> {
        if !functions.contains(&function) {
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

    /// Its functions, all of `functions`.
    fn loaded(self, functions: &[&str]) -> Result<Loaded, LoadError> {
        let sizes = self.sizes;
        let Sizes {
            configuration,
            freedoms,
            speeds,
            derivatives,
            ..
        } = sizes;
        // SAFETY: every function of a module has the type that its arguments tell: these take three arrays …
        let three = |name, results| unsafe { self.function::<Three>(functions, name, results) };
        // SAFETY: … and these take two.
        let two = |name, results| unsafe { self.function::<Two>(functions, name, results) };
        let forward_dynamics = three("forward_dynamics", speeds)?;
        let derivatives = three("forward_dynamics_derivatives", derivatives)?;
        let momentum_rates = three("momentum_rates", 2 * speeds)?;
        let momenta = two("momenta", speeds)?;
        let speeds_from_momenta = two("speeds_from_momenta", speeds)?;
        let hamiltonian = two("hamiltonian", 1)?;
        Ok(Loaded {
            sizes,
            equations: Equations {
                scene: "the scene",
                configuration,
                freedoms,
                speeds,
                forward_dynamics: forward_dynamics.map(|_| call_forward_dynamics as _),
                inverse_dynamics: None,
                forward_dynamics_derivatives: derivatives.map(|_| call_derivatives as _),
                inverse_dynamics_derivatives: None,
                forward_slopes: derivatives.map_or(0, |_| sizes.derivatives),
                mass_matrix: None,
                inverse_mass_matrix: None,
                momenta: momenta.map(|_| call_momenta as _),
                speeds_from_momenta: speeds_from_momenta.map(|_| call_speeds as _),
                momentum_rates: momentum_rates.map(|_| call_momentum_rates as _),
                hamiltonian: hamiltonian.map(|_| call_hamiltonian as _),
                in_lanes: InLanes::NONE,
            },
            forward_dynamics,
            derivatives,
            momenta,
            speeds_from_momenta,
            momentum_rates,
            hamiltonian,
            _library: self.library,
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

impl Loaded {
    /// Whether these are a Q, v̄ or p̄, and results of those lengths.
    fn fits(&self, q: &[f64], speeds: &[f64], results: (&[f64], usize)) -> bool {
        let sizes = self.sizes;
        q.len() == sizes.configuration
            && speeds.len() == sizes.speeds
            && results.0.len() == results.1
    }

    /// Calls a function of Q and v̄ or p̄; of slices of other sizes the results are NaN.
    fn two(&self, function: Option<Two>, q: &[f64], speeds: &[f64], results: (&mut [f64], usize)) {
        let (results, count) = results;
        results.fill(f64::NAN);
        if let Some(function) = function
            && self.fits(q, speeds, (results, count))
        {
            // SAFETY: the sizes are those for which the function was written, and what it writes overlaps nothing that it reads.
            unsafe { function(q.as_ptr(), speeds.as_ptr(), results.as_mut_ptr()) }
        }
    }

    /// The same with τ.
    fn three(
        &self,
        function: Option<Three>,
        q: &[f64],
        speeds: &[f64],
        efforts: &[f64],
        results: (&mut [f64], usize),
    ) {
        let (results, count) = results;
        results.fill(f64::NAN);
        if let Some(function) = function
            && self.fits(q, speeds, (results, count))
            && efforts.len() == self.sizes.freedoms
        {
            let results = results.as_mut_ptr();
            // SAFETY: as in `two`.
            unsafe { function(q.as_ptr(), speeds.as_ptr(), efforts.as_ptr(), results) }
        }
    }
}

fn call_forward_dynamics(q: &[f64], v: &[f64], tau: &[f64], rates: &mut [f64]) {
    if let Some(loaded) = in_use() {
        loaded.three(
            loaded.forward_dynamics,
            q,
            v,
            tau,
            (rates, loaded.sizes.speeds),
        );
    }
}

fn call_derivatives(q: &[f64], v: &[f64], tau: &[f64], rows: &mut [f64]) {
    if let Some(loaded) = in_use() {
        loaded.three(
            loaded.derivatives,
            q,
            v,
            tau,
            (rows, loaded.sizes.derivatives),
        );
    }
}

fn call_momenta(q: &[f64], v: &[f64], p: &mut [f64]) {
    if let Some(loaded) = in_use() {
        loaded.two(loaded.momenta, q, v, (p, loaded.sizes.speeds));
    }
}

fn call_speeds(q: &[f64], p: &[f64], v: &mut [f64]) {
    if let Some(loaded) = in_use() {
        loaded.two(loaded.speeds_from_momenta, q, p, (v, loaded.sizes.speeds));
    }
}

thread_local! {
    /// v̄ and p̄̇, which the function writes one after the other.
    static BOTH: RefCell<Vec<f64>> = const { RefCell::new(Vec::new()) };
}

fn call_momentum_rates(q: &[f64], p: &[f64], tau: &[f64], v: &mut [f64], rates: &mut [f64]) {
    let Some(loaded) = in_use() else {
        return;
    };
    BOTH.with_borrow_mut(|both| {
        let count = 2 * loaded.sizes.speeds;
        both.resize(count, f64::NAN);
        loaded.three(loaded.momentum_rates, q, p, tau, (both, count));
        let (speeds, changes) = both.split_at(loaded.sizes.speeds);
        for (result, found) in [(v, speeds), (rates, changes)] {
            result
                .iter_mut()
                .zip(found)
                .for_each(|(to, from)| *to = *from);
        }
    });
}

fn call_hamiltonian(q: &[f64], p: &[f64]) -> f64 {
    let mut energy = [f64::NAN];
    if let Some(loaded) = in_use() {
        loaded.two(loaded.hamiltonian, q, p, (&mut energy, 1));
    }
    energy[0]
}
