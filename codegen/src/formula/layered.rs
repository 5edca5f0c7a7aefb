//! A map of which a part is shared between copies: names of a joint, to which every kernel adds its own.

use std::borrow::Borrow;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A map whose copies share what was in it when [`Layered::share`] was called.
#[derive(Clone, Debug)]
pub struct Layered<K, V> {
    shared: Arc<BTreeMap<K, V>>,
    own: BTreeMap<K, V>,
}

impl<K, V> Default for Layered<K, V> {
    fn default() -> Self {
        Self {
            shared: Arc::default(),
            own: BTreeMap::new(),
        }
    }
}

impl<K: Clone + Ord, V: Clone> Layered<K, V> {
    /// The value of a key.
    pub fn get<Q: Ord + ?Sized>(&self, key: &Q) -> Option<&V>
    where
        K: Borrow<Q>,
    {
        self.own.get(key).or_else(|| self.shared.get(key))
    }

    /// Whether the key has a value.
    pub fn contains<Q: Ord + ?Sized>(&self, key: &Q) -> bool
    where
        K: Borrow<Q>,
    {
        self.get(key).is_some()
    }

    /// Gives the key a value in place of any that it has.
    pub fn insert(&mut self, key: K, value: V) {
        self.own.insert(key, value);
    }

    /// Makes all that is in it now common to later copies.
    pub fn share(&mut self) {
        let own = std::mem::take(&mut self.own);
        Arc::make_mut(&mut self.shared).extend(own);
    }
}
