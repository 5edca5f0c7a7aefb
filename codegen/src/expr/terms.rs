//! Terms of a sum: keys in ascending order, each with a coefficient that is not 0.
//!
//! Nearly all sums are short: a sorted list holds as many terms as there are, where the first node of a B-tree has room for eleven.

use super::{Rational, budget};
use num_traits::Zero;
use std::ops::{AddAssign, Index};
use std::sync::Arc;

/// Terms for which moving them spends one term operation: it takes the time of some twenty, so that only very long sums spend anything.
const MOVED: u64 = 1024;

/// The same for merging them into another sum.
const MERGED: u64 = 256;

/// Most terms that are added one by one.
const FEW: usize = 8;

/// The coefficients by their keys, ascending; none is 0.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Terms<K> {
    /// Shared between copies, which are many.
    entries: Arc<Vec<(K, Rational)>>,
}

impl<K> Default for Terms<K> {
    fn default() -> Self {
        Self {
            entries: Arc::default(),
        }
    }
}

impl<K: Clone + Ord> Terms<K> {
    /// The sum of one term, or 0.
    pub fn single(key: K, coefficient: Rational) -> Self {
        match coefficient.is_zero() {
            true => Self::default(),
            false => Self {
                entries: Arc::new(vec![(key, coefficient)]),
            },
        }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Whether the sum is 0.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// All of them, ascending.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = (&K, &Rational)> + ExactSizeIterator {
        self.entries.iter().map(|(key, value)| (key, value))
    }

    /// All keys, ascending.
    pub fn keys(&self) -> impl DoubleEndedIterator<Item = &K> + ExactSizeIterator {
        self.entries.iter().map(|(key, _)| key)
    }

    /// The term with the smallest key.
    pub fn first(&self) -> Option<(&K, &Rational)> {
        self.entries.first().map(|(key, value)| (key, value))
    }

    /// The term with the largest key.
    pub fn last(&self) -> Option<(&K, &Rational)> {
        self.entries.last().map(|(key, value)| (key, value))
    }

    /// The coefficient of a key, where it is not 0.
    pub fn get(&self, key: &K) -> Option<&Rational> {
        let place = self.place(key).ok()?;
        Some(&self.entries[place].1)
    }

    /// Takes the term with the largest key away.
    pub fn pop(&mut self) -> Option<(K, Rational)> {
        Arc::make_mut(&mut self.entries).pop()
    }

    /// Adds a term.
    pub fn add(&mut self, key: K, coefficient: Rational) {
        let place = self.place(&key);
        budget::spend(self.entries.len() as u64 / MOVED);
        let entries = Arc::make_mut(&mut self.entries);
        match place {
            Ok(place) => {
                entries[place].1 += coefficient;
                if entries[place].1.is_zero() {
                    entries.remove(place);
                }
            }
            Err(place) if !coefficient.is_zero() => entries.insert(place, (key, coefficient)),
            Err(_) => {}
        }
    }

    /// Where the key is, or would be.
    fn place(&self, key: &K) -> Result<usize, usize> {
        self.entries.binary_search_by(|(known, _)| known.cmp(key))
    }
}

/// The sum of terms in any order.
fn combined<K: Ord>(mut entries: Vec<(K, Rational)>) -> Vec<(K, Rational)> {
    if !entries.is_sorted_by(|(a, _), (b, _)| a < b) {
        // Stable, so that ascending runs are merged in one pass.
        entries.sort_by(|(a, _), (b, _)| a.cmp(b));
        entries.dedup_by(|(key, value), (kept, sum)| {
            let is_same = key == kept;
            if is_same {
                *sum += std::mem::take(value);
            }
            is_same
        });
    }
    entries.retain(|(_, value)| !value.is_zero());
    entries
}

impl<K: Clone + Ord> AddAssign for Terms<K> {
    fn add_assign(&mut self, other: Self) {
        if self.is_empty() {
            *self = other;
            return;
        }
        let other = Arc::unwrap_or_clone(other.entries);
        // Few among many are looked for one by one.
        if other.len() == 1 || other.len() <= FEW && 4 * other.len() < self.len() {
            for (key, value) in other {
                self.add(key, value);
            }
            return;
        }
        budget::spend(self.entries.len() as u64 / MERGED);
        let own = Arc::unwrap_or_clone(std::mem::take(&mut self.entries));
        self.entries = Arc::new(merged(own, other));
    }
}

/// The sum of two sums.
fn merged<K: Ord>(a: Vec<(K, Rational)>, b: Vec<(K, Rational)>) -> Vec<(K, Rational)> {
    let mut merged = Vec::with_capacity(a.len() + b.len());
    let (mut a, mut b) = (a.into_iter().peekable(), b.into_iter().peekable());
    while let (Some((x, _)), Some((y, _))) = (a.peek(), b.peek()) {
        let order = x.cmp(y);
        if order.is_gt() {
            merged.extend(b.next());
            continue;
        }
        let Some((key, mut value)) = a.next() else {
            break;
        };
        if let Some((_, other)) = b.next_if(|_| order.is_eq()) {
            value += other;
        }
        if !value.is_zero() {
            merged.push((key, value));
        }
    }
    merged.extend(a.chain(b));
    merged
}

impl<K: Clone + Ord> FromIterator<(K, Rational)> for Terms<K> {
    /// The sum of terms in any order.
    fn from_iter<I: IntoIterator<Item = (K, Rational)>>(terms: I) -> Self {
        Self {
            entries: Arc::new(combined(terms.into_iter().collect())),
        }
    }
}

impl<K: Clone + Ord> Index<&K> for Terms<K> {
    type Output = Rational;

    fn index(&self, key: &K) -> &Rational {
        self.get(key).expect("a term with this key")
    }
}

#[cfg(test)]
mod tests {
    use super::Terms;
    use crate::expr::Rational;

    fn terms(terms: &[(u8, i64)]) -> Terms<u8> {
        let terms = terms.iter();
        terms
            .map(|&(key, value)| (key, Rational::from(value)))
            .collect()
    }

    #[test]
    fn terms_are_sorted_and_equal_keys_are_one() {
        let sum = terms(&[(3, 1), (1, 2), (3, -1), (2, 0), (1, 5)]);
        assert_eq!(sum, terms(&[(1, 7)]));
        assert_eq!(sum.get(&3), None);
    }

    /// Both ways in which two sums are added: term by term, and as two lists.
    #[test]
    fn sums_lose_what_cancels() {
        let long: Vec<(u8, i64)> = (0..40).map(|key| (key, 1)).collect();
        for cancelled in [1, 2, 39, 40] {
            let mut sum = terms(&long);
            let opposite: Vec<(u8, i64)> = (0..cancelled).map(|key| (key, -1)).collect();
            sum += terms(&opposite);
            assert_eq!(sum, terms(&long[usize::from(cancelled)..]));
        }
    }

    #[test]
    fn a_term_is_added_in_its_place() {
        let mut sum = terms(&[(1, 1), (5, 1)]);
        sum.add(3, Rational::from(2));
        sum.add(4, Rational::from(0));
        sum.add(5, Rational::from(-1));
        assert_eq!(sum, terms(&[(1, 1), (3, 2)]));
        assert_eq!((sum.len(), &sum[&3]), (2, &Rational::from(2)));
    }
}
