//! What follows from a joint type and its parameters alone, kept for models that are made one after the other.

use std::cell::RefCell;
use std::collections::BTreeMap;

/// Values kept at most: where parameters differ from model to model, none is asked for again.
const KEPT: usize = 64;

/// Values by the bits of parameters.
#[derive(Clone, Debug)]
pub(crate) struct Remembered<T>(RefCell<BTreeMap<Vec<u64>, T>>);

impl<T> Default for Remembered<T> {
    fn default() -> Self {
        Self(RefCell::default())
    }
}

impl<T: Copy> Remembered<T> {
    /// The value for some parameters, found where it is not known.
    pub fn get(&self, parameters: &[f64], find: impl FnOnce() -> T) -> T {
        let key: Vec<u64> = parameters.iter().map(|number| number.to_bits()).collect();
        let known = self.0.borrow().get(&key).copied();
        known.unwrap_or_else(|| {
            let value = find();
            let mut all = self.0.borrow_mut();
            if all.len() < KEPT {
                all.insert(key, value);
            }
            value
        })
    }
}
