//! The library, loaded, behind the functions that [`hamel::compiled::Compiled`] calls.
//!
//! Those are plain functions without data, so what they call stands in a static: one scene at a time.

#![allow(
    unsafe_code,
    reason = "functions of another language are called: see the safety comments"
)]

use crate::output::Failure;
use hamel::compiled::{Equations, InLanes};
use std::cell::RefCell;
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

/// The functions of a library, and the sizes for which they were written.
struct Loaded {
    configuration: usize,
    freedoms: usize,
    speeds: usize,
    /// Results of the derivatives.
    entries: usize,
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
    /// The library at `path`, which was built of the module `name` of a scene with these stored scalars, freedoms and speeds, and so many numbers in its
    /// derivatives of forward dynamics.
    ///
    /// # Errors
    /// A file that cannot be loaded; another library in use.
    pub fn load(path: &Path, name: &str, sizes: [usize; 4]) -> Result<Self, Failure> {
        let loaded = Box::leak(Box::new(loaded(path, name, sizes)?));
        let equations = &raw const loaded.equations;
        IN_USE
            .compare_exchange(ptr::null_mut(), loaded, Ordering::AcqRel, Ordering::Acquire)
            .map_err(|_| failed(&"those of another one are in use"))?;
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

fn failed(error: &dyn std::fmt::Display) -> Failure {
    Failure::Refused(format!("the compiled scene cannot be loaded: {error}"))
}

fn loaded(
    path: &Path,
    name: &str,
    [configuration, freedoms, speeds, entries]: [usize; 4],
) -> Result<Loaded, Failure> {
    // SAFETY: the library was built of a module that this program wrote, which has no code that runs when it is loaded.
    let library = unsafe { libloading::Library::new(path) }.map_err(|error| failed(&error))?;
    let two = |function: &str| {
        let symbol = format!("{name}_{function}");
        // SAFETY: every function of a module has the type that its arguments tell; `momenta`, `speeds_from_momenta` and `hamiltonian` take two.
        unsafe { library.get::<Two>(symbol) }.map(|found| *found)
    };
    let three = |function: &str| {
        let symbol = format!("{name}_{function}");
        // SAFETY: as above; `forward_dynamics`, its derivatives and `momentum_rates` take three.
        unsafe { library.get::<Three>(symbol) }.map(|found| *found)
    };
    let forward_dynamics = three("forward_dynamics").ok();
    let derivatives = three("forward_dynamics_derivatives").ok();
    let momenta = two("momenta").ok();
    let speeds_from_momenta = two("speeds_from_momenta").ok();
    let momentum_rates = three("momentum_rates").ok();
    let hamiltonian = two("hamiltonian").ok();
    Ok(Loaded {
        configuration,
        freedoms,
        speeds,
        entries,
        equations: Equations {
            scene: "the scene",
            configuration,
            freedoms,
            speeds,
            forward_dynamics: forward_dynamics.map(|_| call_forward_dynamics as _),
            inverse_dynamics: None,
            forward_dynamics_derivatives: derivatives.map(|_| call_derivatives as _),
            inverse_dynamics_derivatives: None,
            momenta: momenta.map(|_| call_momenta as _),
            speeds_from_momenta: speeds_from_momenta.map(|_| call_speeds as _),
            momentum_rates: momentum_rates.map(|_| call_momentum_rates as _),
            hamiltonian: hamiltonian.map(|_| call_hamiltonian as _),
            in_lanes: InLanes {
                forward_dynamics: None,
                inverse_dynamics: None,
            },
        },
        forward_dynamics,
        derivatives,
        momenta,
        speeds_from_momenta,
        momentum_rates,
        hamiltonian,
        _library: library,
    })
}

impl Loaded {
    /// Whether these are a Q, v̄ or p̄, and results of those lengths.
    fn fits(&self, q: &[f64], speeds: &[f64], results: (&[f64], usize)) -> bool {
        q.len() == self.configuration && speeds.len() == self.speeds && results.0.len() == results.1
    }

    /// Calls a function of Q and v̄ or p̄; slices of other sizes leave the results as they are.
    fn two(&self, function: Option<Two>, q: &[f64], speeds: &[f64], results: (&mut [f64], usize)) {
        let (results, count) = results;
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
        if let Some(function) = function
            && self.fits(q, speeds, (results, count))
            && efforts.len() == self.freedoms
        {
            let results = results.as_mut_ptr();
            // SAFETY: as in `two`.
            unsafe { function(q.as_ptr(), speeds.as_ptr(), efforts.as_ptr(), results) }
        }
    }
}

fn call_forward_dynamics(q: &[f64], v: &[f64], tau: &[f64], rates: &mut [f64]) {
    if let Some(loaded) = in_use() {
        loaded.three(loaded.forward_dynamics, q, v, tau, (rates, loaded.speeds));
    }
}

fn call_derivatives(q: &[f64], v: &[f64], tau: &[f64], rows: &mut [f64]) {
    if let Some(loaded) = in_use() {
        loaded.three(loaded.derivatives, q, v, tau, (rows, loaded.entries));
    }
}

fn call_momenta(q: &[f64], v: &[f64], p: &mut [f64]) {
    if let Some(loaded) = in_use() {
        loaded.two(loaded.momenta, q, v, (p, loaded.speeds));
    }
}

fn call_speeds(q: &[f64], p: &[f64], v: &mut [f64]) {
    if let Some(loaded) = in_use() {
        loaded.two(loaded.speeds_from_momenta, q, p, (v, loaded.speeds));
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
        let count = 2 * loaded.speeds;
        both.resize(count, f64::NAN);
        loaded.three(loaded.momentum_rates, q, p, tau, (both, count));
        let (speeds, changes) = both.split_at(loaded.speeds);
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
