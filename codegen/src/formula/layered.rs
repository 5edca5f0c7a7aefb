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

#[cfg(test)]
mod tests {
    use super::Layered;

    #[test]
    fn copies_share_what_was_there_and_keep_their_own() {
        let mut map = Layered::<String, u8>::default();
        map.insert("a".into(), 1);
        map.share();
        let mut copy = map.clone();
        copy.insert("b".into(), 2);
        copy.insert("a".into(), 3);
        assert_eq!((map.get("a"), map.get("b")), (Some(&1), None));
        assert_eq!((copy.get("a"), copy.get("b")), (Some(&3), Some(&2)));
        copy.share();
        assert_eq!((copy.get("a"), map.get("a")), (Some(&3), Some(&1)));
    }
}
